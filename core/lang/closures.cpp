#include "core/lang/closures.h"

#include <array>

namespace aerosol::lang {

namespace {

constexpr std::array closures = {
    // Volumes
    ClosureRow{"anisotropic_vdf", "color albedo, color extinction, float anisotropy", "", false, true,
               "Scattering medium with the Henyey-Greenstein phase function; extinction per scene unit."},
    ClosureRow{"medium_vdf",
               "color albedo, float transmission_depth, color transmission_color, float anisotropy, float ior, "
               "int priority",
               "", false, true,
               "Medium whose white light has transmission_color after transmission_depth scene units; a depth of 0 has "
               "no extinction."},
    ClosureRow{"isotropic", "", "", false, true, "Scatters evenly; the weight is the scattering coefficient."},
    ClosureRow{"henyey_greenstein", "float g", "", false, true,
               "Henyey-Greenstein scattering with mean cosine g; the weight is the scattering coefficient."},
    ClosureRow{"absorption", "", "", false, true, "Absorbs; the weight is the absorption coefficient."},
    // Emission
    ClosureRow{"emission", "", "", true, true, "Emits; the weight is radiance (volumes: per scene unit)."},
    ClosureRow{"uniform_edf", "color emittance", "", true, true, "Emits evenly; radiance (volumes: per scene unit)."},
    ClosureRow{"background", "", "", true, false, "Radiance of the surroundings of the scene."},
    // Surfaces
    ClosureRow{"diffuse", "normal N", "", true, false, "Lambertian reflection."},
    ClosureRow{"oren_nayar", "normal N, float sigma", "", true, false, "Rough diffuse reflection."},
    ClosureRow{"translucent", "normal N", "", true, false, "Lambertian transmission."},
    ClosureRow{"phong", "normal N, float exponent", "", true, false, "Phong reflection."},
    ClosureRow{"ward", "normal N, vector T, float xrough, float yrough", "", true, false, "Ward reflection."},
    ClosureRow{"microfacet",
               "string distribution, normal N, vector T, float xalpha, float yalpha, float eta, int refract", "", true,
               false, "Microfacet reflection or refraction."},
    ClosureRow{"microfacet", "string distribution, normal N, float alpha, float eta, int refract", "", true, false,
               "Isotropic microfacet reflection or refraction."},
    ClosureRow{"reflection", "normal N, float eta", "", true, false, "Mirror reflection."},
    ClosureRow{"refraction", "normal N, float eta", "", true, false, "Refraction by a smooth boundary."},
    ClosureRow{"transparent", "", "", true, false, "What lies behind, unbent."},
    ClosureRow{"oren_nayar_diffuse_bsdf", "normal N, color albedo, float roughness", "int energy_compensation", true,
               false, "Rough diffuse reflection."},
    ClosureRow{"burley_diffuse_bsdf", "normal N, color albedo, float roughness", "", true, false,
               "Diffuse part of the Disney material."},
    ClosureRow{"dielectric_bsdf",
               "normal N, vector U, color reflection_tint, color transmission_tint, float roughness_x, "
               "float roughness_y, float ior, string distribution",
               "float thinfilm_thickness, float thinfilm_ior", true, false, "Microfacet dielectric."},
    ClosureRow{"conductor_bsdf",
               "normal N, vector U, float roughness_x, float roughness_y, color ior, color extinction, "
               "string distribution",
               "float thinfilm_thickness, float thinfilm_ior", true, false, "Microfacet metal."},
    ClosureRow{"generalized_schlick_bsdf",
               "normal N, vector U, color reflection_tint, color transmission_tint, float roughness_x, "
               "float roughness_y, color f0, color f90, float exponent, string distribution",
               "float thinfilm_thickness, float thinfilm_ior", true, false, "Microfacet with Schlick's Fresnel term."},
    ClosureRow{"translucent_bsdf", "normal N, color albedo", "", true, false, "Lambertian transmission."},
    ClosureRow{"transparent_bsdf", "", "", true, false, "What lies behind, unbent."},
    ClosureRow{"subsurface_bssrdf", "normal N, color albedo, color radius, float anisotropy", "", true, false,
               "Subsurface scattering."},
    ClosureRow{"sheen_bsdf", "normal N, color albedo, float roughness", "", true, false, "Back-scattering of cloth."},
    ClosureRow{"holdout", "", "", true, false, "Cuts a hole into the image."},
    ClosureRow{"debug", "string outputname", "", true, false, "Adds its weight to a named output."},
};

Type typeNamed(std::string_view name) {
  if (name == "float") return types::floating;
  if (name == "int") return types::integer;
  if (name == "string") return types::string;
  if (name == "color") return types::color;
  if (name == "vector") return types::vector;
  return types::normal;
}

std::vector<ClosureParameter> parse(std::string_view text) {
  std::vector<ClosureParameter> parameters;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    std::string_view one = text.substr(0, comma);
    text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
    one.remove_prefix(one.find_first_not_of(' '));
    const std::size_t space = one.find(' ');
    parameters.push_back({std::string(one.substr(space + 1)), typeNamed(one.substr(0, space))});
  }
  return parameters;
}

}  // namespace

std::span<const ClosureRow> closureTable() { return closures; }

std::vector<const ClosureRow*> findClosures(std::string_view name) {
  std::vector<const ClosureRow*> rows;
  for (const ClosureRow& row : closures)
    if (name == row.name) rows.push_back(&row);
  return rows;
}

std::vector<ClosureParameter> closureParameters(const ClosureRow& row) { return parse(row.parameters); }
std::vector<ClosureParameter> closureOptions(const ClosureRow& row) { return parse(row.options); }

std::string toString(const ClosureRow& row) {
  return std::string("closure color ") + row.name + "(" + row.parameters + ")";
}

std::vector<std::string> closureNames() {
  std::vector<std::string> names;
  for (const ClosureRow& row : closures) names.emplace_back(row.name);
  return names;
}

}  // namespace aerosol::lang
