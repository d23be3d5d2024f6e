#include "core/render/medium_preparation.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/render/kernel_queue.h"

namespace aerosol::render {

using volume::DistanceMethod;

namespace {

/// Collects questions of a single path and answers them at once.
class ImmediateSink final : public QuestionSink {
 public:
  void post(PathContext&) override {}
};

/// Runs one question through the queues, outside of any render.
template <class Take>
auto askOnce(const PreparedScene& scene, const Question& question, Take take) {
  WorkerStatistics statistics;
  ImmediateSink sink;
  PathContext path(scene, sink, statistics);
  path.prepareAnswer(question);
  KernelQueues queues(scene, statistics, AEROSOL_MAXIMUM_WIDTH);
  queues.push(question, path, {0, 0});
  PathContext* const paths[] = {&path};
  queues.runFullest(paths);
  return take(path, statistics);
}

}  // namespace

std::optional<volume::Coefficients> constantCoefficients(const PreparedScene& scene, shading::InstanceRef shader) {
  if (!scene.shading.family(shader).kernel(shading::Variant::coefficients).interface().isConstant()) return {};
  volume::Medium medium;
  for (std::size_t i = 0; i < scene.mediumShaders.size(); ++i) {
    const shading::InstanceRef& each = scene.mediumShaders[i];
    if (each.family == shader.family && each.index == shader.index) medium.index = static_cast<std::uint32_t>(i);
  }
  const Question question{&medium, volume::Quantity::coefficients, {}, {}, nullptr};
  return askOnce(scene, question,
                 [&](PathContext& path, const WorkerStatistics& statistics) -> std::optional<volume::Coefficients> {
                   if (statistics.invalidCoefficients == 0) return path.answer(0);
                   scene.messages->forgetInvalid(medium);  // The render will say where.
                   return {};
                 });
}

std::optional<SurfaceAnswer> constantClosures(const PreparedScene& scene, shading::InstanceRef shader) {
  if (!scene.shading.family(shader).kernel(shading::Variant::surface).interface().isConstant()) return {};
  const shading::ShadingPoint point;
  const Question question{nullptr, volume::Quantity::coefficients, {}, shader, &point};
  return askOnce(scene, question,
                 [](PathContext& path, const WorkerStatistics&) { return std::optional(path.surfaceAnswer()); });
}

std::optional<float> declaredBound(const shading::Family& family, const shading::Instance& instance) {
  for (const lang::MetadataValue& entry : family.program->metadata) {
    if (entry.name != "extinction_bound") continue;
    const auto* names = std::get_if<std::vector<std::string>>(&entry.value);
    if (!names || names->empty()) return {};
    const auto parameter = shading::findParameter(*family.program, names->front());
    if (!parameter) return {};
    const lang::ConstantValue* value = shading::valueOf(*family.program, instance, *parameter);
    const auto* floats = value ? std::get_if<std::vector<float>>(value) : nullptr;
    if (!floats || floats->empty()) return {};
    float largest = 0;
    for (const float f : *floats) largest = std::max(largest, f);
    return largest;
  }
  return {};
}

Diagnostics decideSampling(const PreparedScene& scene, volume::Medium& medium, const scene::MediumSampling& sampling,
                           const scene::Integrator& integrator, float extent) {
  Diagnostics errors;
  const shading::InstanceRef shader = scene.mediumShaders[medium.index];
  const shading::Family& family = scene.shading.family(shader);
  const float defaultStep = std::isfinite(extent) && extent > 0 ? extent / 100 : 1.0f;
  medium.stepSize = sampling.stepSize.value_or(defaultStep) * integrator.stepScale;
  medium.constant = constantCoefficients(scene, shader);
  if (medium.constant) {
    medium.method = DistanceMethod::closedForm;
    return errors;
  }
  const std::optional<float> declared =
      sampling.densityBound ? sampling.densityBound : declaredBound(family, family.instances[shader.index]);
  if (declared) medium.bound = {*declared, volume::Provenance::declared};

  const scene::DistanceSampling wanted = sampling.distance.value_or(integrator.distance);
  if (wanted == scene::DistanceSampling::nullScattering && !medium.bound) {
    errors.error(
        scene.mediumLocations[medium.index],
        fmt::format("null scattering needs a bound on the extinction of '{}'", scene.mediumNames[medium.index]),
        {"give the medium or volume a float 'density_bound', or the shader the metadata "
         "[[ string extinction_bound = \"PARAMETER\" ]], or choose distance 'marching'"});
  }
  const bool marches = wanted == scene::DistanceSampling::marching || !medium.bound;
  medium.method = marches ? DistanceMethod::marching : DistanceMethod::nullScattering;
  return errors;
}

}  // namespace aerosol::render
