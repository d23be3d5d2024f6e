#include "core/render/medium_facts.h"

#include <algorithm>
#include <cmath>

#include "core/lang/output_facts.h"
#include "core/shading/instance_values.h"

namespace aerosol::render {

namespace {

Answer certain(bool isSo) { return isSo ? Answer::yes : Answer::no; }
Answer unless(bool isRuledOut) { return isRuledOut ? Answer::no : Answer::unknown; }

MediumFacts factsOf(const volume::Coefficients& c) {
  const bool isColoured = c.sigmaT.r != c.sigmaT.g || c.sigmaT.g != c.sigmaT.b;
  return {certain(!isBlack(c.sigmaS)), certain(!isBlack(c.emission)), certain(isColoured)};
}

}  // namespace

/// As the code of the shader shows, and what the volume makes of it.
MediumFacts factsOfShader(const PreparedScene& scene, const volume::Medium& medium) {
  const shading::InstanceRef shader = scene.mediumShaders[medium.index];
  const shading::Family& family = scene.shading.family(shader);
  const lang::Program& program = *family.program;
  const lang::ParameterValues values = shading::valuesOf(program, family.instances[shader.index]);
  MediumFacts facts{unless(lang::isZero(program, values, lang::OutputKind::sigmaS)),
                    unless(lang::isZero(program, values, lang::OutputKind::emission)),
                    unless(lang::isGrey(program, values, lang::OutputKind::sigmaT))};
  const VolumeLook* const look = scene.lookOf(medium.index);
  if (!look) return facts;
  if (look->scattersAll) facts.scatters = Answer::unknown;
  if (look->scattersAll || look->emission == 0) facts.emits = Answer::no;
  return facts;
}

MediumFacts factsOf(const PreparedScene& scene, const volume::Medium& medium) {
  if (medium.constant) return factsOf(*medium.constant);
  if (medium.voxels) return factsOf(medium.voxels->unit);
  MediumFacts facts = factsOfShader(scene, medium);
  // Outside of the tree there is none of most media.
  const volume::BoundTree* const tree = medium.tree;
  if (!tree || tree->ranges.empty()) return facts;
  const auto anywhere = [&](auto&& isSo) { return certain(std::ranges::any_of(tree->ranges, isSo)); };
  if (facts.scatters == Answer::unknown)
    facts.scatters = anywhere([](const volume::BoundRanges& r) { return r.scatteringHigh > 0; });
  if (facts.emits == Answer::unknown) {
    facts.emits = anywhere(
        [](const volume::BoundRanges& r) { return std::fabs(r.emissionLow) > 0 || std::fabs(r.emissionHigh) > 0; });
  }
  return facts;
}

float extentOf(const PreparedScene& scene, const volume::Medium& medium) {
  const auto sizeOf = [](const Box<World>& box) { return length(box.upper - box.lower); };
  for (std::size_t v = 0; v < scene.volumes.size(); ++v) {
    if (scene.volumes[v] && scene.volumes[v]->index == medium.index)
      return sizeOf(scene.geometry->volume(static_cast<accel::VolumeId>(v)).worldBounds());
  }
  const Box<World> all = scene.geometry->bounds();
  return all.isEmpty() ? 1.0f : sizeOf(all);
}

double stepsAcross(const PreparedScene& scene, const volume::Medium& medium) {
  if (medium.constant || medium.method != volume::DistanceMethod::marching) return 0;
  return static_cast<double>(extentOf(scene, medium)) / static_cast<double>(medium.stepSize);
}

double mostStepsAcross(const PreparedScene& scene) {
  double most = 0;
  for (const volume::Medium& medium : scene.media) most = std::max(most, stepsAcross(scene, medium));
  return most;
}

}  // namespace aerosol::render
