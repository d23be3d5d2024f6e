#include "core/lang/closures.h"

#include <array>

namespace aerosol::lang {

namespace {

/// Options of every MaterialX closure.
#define AEROSOL_LABEL "string label"
#define AEROSOL_THIN_FILM "float thinfilm_thickness, float thinfilm_ior, string label"

constexpr std::array closures = {
    // Volumes. Surfaces may layer over them: they describe the interior.
    ClosureRow{"anisotropic_vdf", "color albedo, color extinction, float anisotropy", AEROSOL_LABEL, true, true,
               "Scattering medium with the Henyey-Greenstein phase function; extinction per scene unit."},
    ClosureRow{"medium_vdf",
               "color albedo, float transmission_depth, color transmission_color, float anisotropy, float ior, "
               "int priority",
               AEROSOL_LABEL, true, true,
               "Medium whose white light has transmission_color after transmission_depth scene units; a depth of 0 has "
               "no extinction."},
    ClosureRow{"isotropic", "", "", false, true, "Scatters evenly; the weight is the scattering coefficient."},
    ClosureRow{"henyey_greenstein", "float g", "", false, true,
               "Henyey-Greenstein scattering with mean cosine g; the weight is the scattering coefficient."},
    ClosureRow{"absorption", "", "", false, true, "Absorbs; the weight is the absorption coefficient."},
    // Emission
    ClosureRow{"emission", "", "", true, true, "Emits; the weight is radiance (volumes: per scene unit)."},
    ClosureRow{"uniform_edf", "color emittance", AEROSOL_LABEL, true, true,
               "Emits evenly; radiance (volumes: per scene unit)."},
    ClosureRow{"background", "", "", true, false, "Radiance of the surroundings of the scene."},
    // Surfaces
    ClosureRow{"diffuse", "normal N", AEROSOL_LABEL, true, false, "Lambertian reflection."},
    ClosureRow{"oren_nayar", "normal N, float sigma", "", true, false, "Rough diffuse reflection."},
    ClosureRow{"translucent", "normal N", "", true, false, "Lambertian transmission."},
    ClosureRow{"phong", "normal N, float exponent", AEROSOL_LABEL, true, false, "Phong reflection."},
    ClosureRow{"ward", "normal N, vector T, float xrough, float yrough", "", true, false, "Ward reflection."},
    ClosureRow{"microfacet",
               "string distribution, normal N, vector T, float xalpha, float yalpha, float eta, int refract", "", true,
               false, "Microfacet reflection or refraction."},
    ClosureRow{"reflection", "normal N, float eta", "", true, false, "Mirror reflection."},
    ClosureRow{"refraction", "normal N, float eta", "", true, false, "Refraction by a smooth boundary."},
    ClosureRow{"transparent", "", "", true, false, "What lies behind, unbent."},
    ClosureRow{"subsurface", "float eta, float g, color mfp, color albedo", "", true, false, "Subsurface scattering."},
    ClosureRow{"oren_nayar_diffuse_bsdf", "normal N, color albedo, float roughness",
               "int energy_compensation, string label", true, false, "Rough diffuse reflection."},
    ClosureRow{"burley_diffuse_bsdf", "normal N, color albedo, float roughness", AEROSOL_LABEL, true, false,
               "Diffuse part of the Disney material."},
    ClosureRow{"dielectric_bsdf",
               "normal N, vector U, color reflection_tint, color transmission_tint, float roughness_x, "
               "float roughness_y, float ior, string distribution",
               AEROSOL_THIN_FILM, true, false, "Microfacet dielectric."},
    ClosureRow{"conductor_bsdf",
               "normal N, vector U, float roughness_x, float roughness_y, color ior, color extinction, "
               "string distribution",
               AEROSOL_THIN_FILM, true, false, "Microfacet metal."},
    ClosureRow{"generalized_schlick_bsdf",
               "normal N, vector U, color reflection_tint, color transmission_tint, float roughness_x, "
               "float roughness_y, color f0, color f90, float exponent, string distribution",
               AEROSOL_THIN_FILM, true, false, "Microfacet with Schlick's Fresnel term."},
    ClosureRow{"translucent_bsdf", "normal N, color albedo", AEROSOL_LABEL, true, false, "Lambertian transmission."},
    ClosureRow{"transparent_bsdf", "", AEROSOL_LABEL, true, false, "What lies behind, unbent."},
    ClosureRow{"subsurface_bssrdf", "normal N, color albedo, color radius, float anisotropy", AEROSOL_LABEL, true,
               false, "Subsurface scattering."},
    ClosureRow{"subsurface_bssrdf",
               "normal N, color albedo, float transmission_depth, color transmission_color, float anisotropy",
               AEROSOL_LABEL, true, false, "Subsurface scattering, by the colour that is left after a depth."},
    ClosureRow{"sheen_bsdf", "normal N, color albedo, float roughness", AEROSOL_LABEL, true, false,
               "Back-scattering of cloth."},
    ClosureRow{"chiang_hair_bsdf",
               "normal N, vector curve_direction, color tint_R, color tint_TT, color tint_TRT, float ior, "
               "float longitudual_roughness_R, float longitudual_roughness_TT, float longitudual_roughness_TRT, "
               "float azimuthal_roughness_R, float azimuthal_roughness_TT, float azimuthal_roughness_TRT, "
               "float cuticle_angle, color absorption_coefficient",
               AEROSOL_LABEL, true, false, "Fibre scattering after Chiang et al. 2016."},
    // Relations and signals
    ClosureRow{layerClosure, "closure color top, closure color base", "", true, true,
               "The base seen through the top: base (1 - reflectance(top)) + top. In volumes: their sum."},
    ClosureRow{"holdout", "", "", true, false, "Cuts a hole into the image."},
    ClosureRow{"debug", "string outputname", "", true, false, "Adds its weight to a named output."},
};

#undef AEROSOL_LABEL
#undef AEROSOL_THIN_FILM

Type typeNamed(std::string_view name) {
  if (name == "float") return types::floating;
  if (name == "int") return types::integer;
  if (name == "string") return types::string;
  if (name == "color") return types::color;
  if (name == "vector") return types::vector;
  if (name == "closure color") return types::closure;
  return types::normal;
}

std::vector<ClosureParameter> parse(std::string_view text) {
  std::vector<ClosureParameter> parameters;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    std::string_view one = text.substr(0, comma);
    text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
    one.remove_prefix(one.find_first_not_of(' '));
    const std::size_t space = one.rfind(' ');
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
