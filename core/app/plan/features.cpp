#include "core/app/plan/features.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/app/plan/effects.h"

namespace aerosol::app {

namespace {

constexpr Feature allFeatures[] = {{"S1", "distances along a ray, with their densities"},
                                   {"S2", "light sampled at points in media and on surfaces"},
                                   {"S3", "distances chosen by the falloff of a light beside the ray"},
                                   {"S4", "the same for the area of lights"},
                                   {"S5", "many lights, in a hierarchy"},
                                   {"S6", "constant media in closed form"},
                                   {"S7", "voxels in closed form"},
                                   {"S8", "ray marching"},
                                   {"S9", "tables of transmittance along a ray"},
                                   {"S10", "null scattering"},
                                   {"S11", "null scattering around a control of each part of space"},
                                   {"S12", "one step through what is uniform or empty"},
                                   {"S13", "transmittance between marching and null scattering"},
                                   {"S14", "extinction with a colour"},
                                   {"S15", "media that glow"},
                                   {"S16", "coarser voxels for what is far or lit at length"},
                                   {"V1", "convex volume primitives"},
                                   {"V2", "meshes as volume primitives"},
                                   {"V3", "sparse voxel files"},
                                   {"V4", "voxels in the frustum of a camera"},
                                   {"V5", "blur by moving transforms"},
                                   {"V6", "blur by velocities"},
                                   {"V7", "voxels that change with time"},
                                   {"V8", "densities by shaders"},
                                   {"O1", "volume primitives that overlap and add"},
                                   {"O2", "shadows through media"},
                                   {"O3", "volume primitives in a partition of space"},
                                   {"O4", "media bounded by surfaces"},
                                   {"O5", "dielectrics within each other"},
                                   {"O6", "priorities of what overlaps"},
                                   {"O7", "where a ray begins"},
                                   {"O8", "media that clip"},
                                   {"O9", "hundreds of elements"},
                                   {"X5", "light that goes into bodies"},
                                   {"H1", "the shading language"},
                                   {"H4", "every look a shader"},
                                   {"H5", "bounds proven from shaders"},
                                   {"H6", "shader variants by what is asked"},
                                   {"E1", "scenes of Mitsuba"},
                                   {"E5", "pictures: layers, deep images"}};

struct EffectRows {
  std::string_view effect, rows;
};

constexpr EffectRows rowsByEffect[] = {{"depth-of-field", "E1"},
                                       {"motion", "V5 V6 V7"},
                                       {"moving-camera", "V5"},
                                       {"moving-shapes", "V5"},
                                       {"moving-lights", "V5"},
                                       {"moving-volumes", "V5"},
                                       {"velocity-blur", "V6"},
                                       {"holdouts", "E5"},
                                       {"media-probes", "O7"},
                                       {"light-sampling", "S2"},
                                       {"point-lights", "S2"},
                                       {"spot-lights", "S2"},
                                       {"projectors", "S2"},
                                       {"directional-lights", "S2"},
                                       {"constant-light", "S2"},
                                       {"environment-maps", "S2"},
                                       {"sun-and-sky", "S2"},
                                       {"background-shaders", "S2 H4"},
                                       {"area-lights", "S2 S4"},
                                       {"light-textures", "S2 H4"},
                                       {"light-hierarchy", "S5"},
                                       {"equiangular-sampling", "S3 S4"},
                                       {"light-links", "S2"},
                                       {"straight-shadows", "O2"},
                                       {"surfaces", "H4"},
                                       {"displacement", "H4"},
                                       {"medium-boundaries", "O4"},
                                       {"subsurface", "X5"},
                                       {"nested-media", "O5 O6 O8"},
                                       {"volumes", "V1 V2 V3 V4"},
                                       {"overlap", "O1 O3 O9"},
                                       {"heterogeneity", "V8 H6"},
                                       {"constant-media", "S6"},
                                       {"analytic-voxels", "S7"},
                                       {"null-scattering", "S10 S11"},
                                       {"ray-marching", "S8 S9 S13"},
                                       {"bound-trees", "H5 S12"},
                                       {"volume-scattering", "S1"},
                                       {"volume-emission", "S15"},
                                       {"chromatic-extinction", "S14"},
                                       {"level-of-detail", "S16"},
                                       {"light-splitting", "S5"},
                                       {"joint-lights", "S9"},
                                       {"lamp-directions", "S2 S3"},
                                       {"contribution-roulette", "S1"},
                                       {"clamped-indirect", "S2"},
                                       {"volume-looks", "H4"},
                                       {"multiple-scattering", "S1"},
                                       {"russian-roulette", "S1"},
                                       {"ray-tracing", "E1"},
                                       {"textures", "H1"},
                                       {"derivatives", "H1"},
                                       {"shader-messages", "H1"},
                                       {"layers", "E5"},
                                       {"deep-output", "E5"}};

bool hasRow(std::string_view rows, std::string_view row) {
  for (std::size_t at = rows.find(row); at != std::string_view::npos; at = rows.find(row, at + 1)) {
    const bool begins = at == 0 || rows[at - 1] == ' ';
    const bool ends = at + row.size() == rows.size() || rows[at + row.size()] == ' ';
    if (begins && ends) return true;
  }
  return false;
}

}  // namespace

std::span<const Feature> features() { return allFeatures; }

std::string_view rowsOfEffect(std::string_view effect) {
  const auto found = std::ranges::find(rowsByEffect, effect, &EffectRows::effect);
  return found == std::end(rowsByEffect) ? std::string_view() : found->rows;
}

std::string effectsPage() {
  std::string text =
      "Effects that aerosol plan lists, by what they are a part of. What a scene does not call for is not done.\n\n";
  for (const Feature& feature : allFeatures) {
    std::string effects;
    for (const EffectRows& each : rowsByEffect) {
      if (hasRow(each.rows, feature.row)) effects += fmt::format("{}{}", effects.empty() ? "" : ", ", each.effect);
    }
    text += fmt::format("  {:<4} {}\n", feature.row, feature.name);
    if (!effects.empty()) text += fmt::format("         {}\n", effects);
  }
  text += "\nEffects that --without forces off, and what that changes:\n\n";
  for (const RemovableEffect& effect : removableEffects()) {
    text += fmt::format("  {:<22} {}\n", effect.name, effect.consequence);
  }
  return text + "\nThe rest is what the scene is made of, or how the renderer gets to the same image.\n";
}

}  // namespace aerosol::app
