#include "core/render/aov/aov_table.h"

#include <algorithm>

namespace aerosol::render {

namespace {

AovType light(std::string_view name, std::string_view paths, std::string_view doc) {
  return {.name = name, .kind = AovKind::light, .channels = "RGB", .doc = doc, .paths = paths};
}
AovType feature(std::string_view name, AovFeature what, std::string_view channels, std::string_view doc) {
  return {.name = name, .kind = AovKind::feature, .channels = channels, .doc = doc, .feature = what};
}
AovType variance(std::string_view name, AovFeature what, std::string_view channels, std::string_view doc) {
  return {.name = name, .kind = AovKind::variance, .channels = channels, .doc = doc, .feature = what};
}

}  // namespace

std::span<const AovType> aovTypes() {
  using F = AovFeature;
  static const std::vector<AovType> types = {
      light("direct", "Cs*([^sLOB]s*)?[LOB]", "light that was scattered once at most, and what shines itself"),
      light("indirect", "C.*[^sLOB].*[^sLOB].*[LOB]", "the rest: direct and indirect are the picture"),
      light("emission", "Cs*[LO]", "what shines, seen straight"),
      light("background", "Cs*B", "what surrounds the scene, seen straight"),
      light("surface", "Cs*([^sVLOB].*[LOB]|L|<O[^V]>)", "light that comes from surfaces"),
      light("volume", "Cs*(V.*[LOB]|<OV>)",
            "light that comes from media: surface, volume and background are the picture"),
      light("diffuse", "Cs*D.*[LOB]", "light that surfaces scatter diffusely"),
      light("specular", "Cs*[GS].*[LOB]", "light that surfaces mirror or bend, glossy or clear"),
      light("direct_diffuse", "Cs*Ds*[LOB]", "of diffuse, what comes straight from lights"),
      light("indirect_diffuse", "Cs*D.*[^sLOB].*[LOB]", "of diffuse, the rest"),
      light("direct_specular", "Cs*[GS]s*[LOB]", "of specular, what comes straight from lights"),
      light("indirect_specular", "Cs*[GS].*[^sLOB].*[LOB]", "of specular, the rest"),
      light("direct_volume", "Cs*Vs*[LOB]", "light that media scatter and that comes straight from lights"),
      light("indirect_volume", "Cs*V.*[^sLOB].*[LOB]", "light that media scatter, the rest"),
      light("reflection", "Cs*R.*[LOB]", "light that surfaces reflect"),
      light("transmission", "Cs*<T[^s]>.*[LOB]", "light that comes through surfaces, bent or scattered"),
      {.name = "light_groups",
       .kind = AovKind::list,
       .channels = "",
       .doc = "the light of each light_group of the scene as light_NAME, that of all others as light_rest"},
      feature("albedo", F::albedo, "RGB", "what the first surface scatters of light, by its closures"),
      feature("depth", F::depth, "T", "distance from the camera to the first surface, whatever it is made of; 0: none"),
      feature("position", F::position, "XYZ", "place of the first surface in the world"),
      feature("uv", F::uv, "UV", "texture coordinates of the first surface"),
      feature("geo_normal", F::geometricNormal, "XYZ", "geometric normal of the first surface"),
      feature("sh_normal", F::shadingNormal, "XYZ", "interpolated normal of the first surface"),
      feature("dp_du", F::dPdu, "XYZ", "change of its position by u"),
      feature("dp_dv", F::dPdv, "XYZ", "change of its position by v"),
      feature("duv_dx", F::dUVdx, "UV", "change of its texture coordinates to the next pixel on the right"),
      feature("duv_dy", F::dUVdy, "UV", "change of its texture coordinates to the next pixel below"),
      feature("prim_index", F::primitiveIndex, "I", "number of the triangle of the first surface"),
      feature("shape_index", F::shapeIndex, "I", "number of the shape in the scene, from 1; 0: none"),
      feature(
          "motion", F::motion, "XY",
          "pixels by which the first surface moves in the picture while the shutter is open, to the right and down"),
      feature("visible_albedo", F::visibleAlbedo, "RGB",
              "what of light is scattered where the eye sees something first, a surface or a medium"),
      feature("visible_normal", F::visibleNormal, "XYZ",
              "there: the normal; in media, away from where they are denser"),
      feature("visible_depth", F::visibleDepth, "T", "mean distance to there, of what is seen"),
      feature("visible_motion", F::visibleMotion, "XY",
              "mean of the pixels by which what is seen moves in the picture while the shutter is open, media as well "
              "as surfaces: with their volumes, and by their velocities"),
      feature("half_a", F::halfA, "RGB", "the picture by one half of the samples"),
      feature("half_b", F::halfB, "RGB", "the picture by the other half"),
      {.name = "error", .kind = AovKind::standardError, .channels = "RGB", .doc = "standard error of the picture"},
      {.name = "variance", .kind = AovKind::pictureVariance, .channels = "RGB", .doc = "its square"},
      variance("visible_albedo_variance", F::visibleAlbedo, "RGB", "variance of that mean"),
      variance("visible_normal_variance", F::visibleNormal, "XYZ", "variance of that mean"),
      {.name = "denoise",
       .kind = AovKind::list,
       .channels = "",
       .doc = "all that aerosol denoise reads, and other denoisers",
       .members =
           "half_a half_b variance visible_albedo visible_albedo_variance visible_normal visible_normal_variance "
           "visible_depth"},
      {.name = "crypto_object",
       .kind = AovKind::objectMatte,
       .channels = "RGBA",
       .doc = "Cryptomatte of shapes and volumes by their ids, as CryptoObject00 and so on"},
      {.name = "crypto_material",
       .kind = AovKind::materialMatte,
       .channels = "RGBA",
       .doc = "Cryptomatte of materials and media by their ids or shaders, as CryptoMaterial00 and so on"},
      {.name = "samples", .kind = AovKind::sampleCount, .channels = "N", .doc = "samples of each pixel"},
      feature("cost", F::cost, "N", "points at which shaders were run, of a sample"),
      {.name = "picture",
       .kind = AovKind::picture,
       .channels = "RGBA",
       .doc = "the picture once more",
       .isListed = false},
      {.name = "picture_xyz",
       .kind = AovKind::feature,
       .channels = "XYZ",
       .doc = "the picture in CIE XYZ",
       .feature = F::pictureXyz,
       .isListed = false}};
  return types;
}

const AovType* findAovType(std::string_view name) {
  if (name == "normal") name = "sh_normal";
  for (const AovType& type : aovTypes()) {
    if (type.name == name) return &type;
  }
  return nullptr;
}

std::vector<std::string> aovNames() {
  std::vector<std::string> names;
  for (const AovType& type : aovTypes()) {
    if (type.isListed) names.emplace_back(type.name);
  }
  return names;
}

}  // namespace aerosol::render
