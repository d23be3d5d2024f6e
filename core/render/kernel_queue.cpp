#include "core/render/kernel_queue.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/base/hash.h"
#include "core/render/aov/path_record.h"
#include "core/render/coefficient_layout.h"
#include "core/render/message_log.h"
#include "core/render/prepared_scene.h"

namespace aerosol::render {

namespace {

constexpr std::size_t floatOffset(std::size_t bytes) { return bytes / sizeof(float); }

/// The closure's field that a parameter of the site names.
std::optional<std::size_t> fieldOf(const Closure& closure, const lang::ClosureSite& site, std::uint32_t parameter) {
  const auto fields = closure.fields();
  for (std::size_t f = 0; f < fields.size(); ++f) {
    if (fields[f].name == site.parameterNames[parameter]) return f;
  }
  return {};
}

/// Floats of the fields before.
std::size_t offsetOf(const Closure& closure, std::size_t field) {
  return static_cast<std::size_t>(componentCount(closure.fields().first(field)));
}

/// Where the weight of a layer on the site's closure goes: behind its fields.
std::optional<std::size_t> layerWeightOffset(const Closure& closure, const lang::ClosureSite& site,
                                             std::uint32_t parameter) {
  for (std::size_t k = 0; k < site.layers.size(); ++k) {
    if (site.layers[k].weight == parameter) return static_cast<std::size_t>(componentCount(closure.fields())) + 3 * k;
  }
  return {};
}

bool isSound(Color c) { return isFinite(c) && minimum(c) >= 0; }

}  // namespace

KernelQueues::KernelQueues(const PreparedScene& scene, WorkerStatistics& statistics, int batchSize)
    : scene_(scene),
      statistics_(statistics),
      host_(scene.namedSpaces, scene.loopBudget, scene.services.get()),
      facts_(scene),
      batch_(batchSize) {
  host_.calls().setAttributes(&scene.attributes);
  host_.calls().setFacts(&facts_);
  const auto& families = scene.shading.families();
  queues_.resize(families.size() * shading::variantCount);
  statistics_.kernels.resize(queues_.size());
  for (std::size_t i = 0; i < queues_.size(); ++i) {
    queues_[i].family = static_cast<std::uint32_t>(i / shading::variantCount);
    queues_[i].variant = static_cast<shading::Variant>(i % shading::variantCount);
    if (!families[queues_[i].family].kernels[i % shading::variantCount]) continue;
    queues_[i].points.bind(families[queues_[i].family], queues_[i].variant);
    prepareLayout(queues_[i]);
  }
}

void KernelQueues::prepareLayout(Queue& queue) const {
  const shading::Family& family = scene_.shading.families()[queue.family];
  const auto& outputs = family.kernel(queue.variant).interface().outputs;
  if (queue.variant == shading::Variant::surface) {
    prepareSurfaceLayout(queue);
    return;
  }
  if (queue.variant == shading::Variant::velocity || queue.variant == shading::Variant::outputs) return;
  for (const jit::OutputComponent& output : outputs) {
    if (output.kind == lang::OutputKind::sigmaT) queue.sigmaT[output.component] = queue.destinations.size();
    if (output.kind == lang::OutputKind::sigmaS) queue.sigmaS[output.component] = queue.destinations.size();
    queue.destinations.push_back(coefficientOffset(output));
    const bool mayBeNegative =
        output.kind == lang::OutputKind::emission || output.kind == lang::OutputKind::lobeAnisotropy;
    queue.least.push_back(mayBeNegative ? std::numeric_limits<float>::lowest() : 0.0f);
    if (output.kind == lang::OutputKind::lobeAnisotropy) queue.lobes = std::max(queue.lobes, output.index + 1);
  }
  queue.copiesSigmaS = queue.lobes == 1;
}

/// Parameters go by name to the fields of the site's closure; a field that the shader does not give has its default.
/// What the closure does not know has been refused, or means nothing to a renderer (labels).
void KernelQueues::prepareSurfaceLayout(Queue& queue) const {
  const shading::Family& family = scene_.shading.families()[queue.family];
  const auto& outputs = family.kernel(queue.variant).interface().outputs;
  const auto& sites = family.program->closureSites;
  queue.sites = static_cast<std::uint32_t>(sites.size());
  constexpr std::size_t stride = floatOffset(sizeof(SurfaceAnswer::Site));
  constexpr std::size_t first = floatOffset(offsetof(SurfaceAnswer::Site, parameters));
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const jit::OutputComponent& output = outputs[k];
    if (output.kind == lang::OutputKind::siteWeight) {
      queue.parameters.push_back({k, output.index * stride + output.component, output.type, {}});
      continue;
    }
    const Closure* closure = scene_.siteClosures[queue.family][output.index];
    const std::optional<std::size_t> field =
        closure ? fieldOf(*closure, sites[output.index], output.subIndex) : std::nullopt;
    if (closure && !field) {
      if (const auto offset = layerWeightOffset(*closure, sites[output.index], output.subIndex)) {
        queue.parameters.push_back({k, output.index * stride + first + *offset + output.component, output.type, {}});
      }
    }
    if (!field) continue;
    SurfaceParameter parameter{
        k, output.index * stride + first + offsetOf(*closure, *field) + output.component, output.type, {}};
    for (const std::string_view text : closure->fields()[*field].choices) {
      parameter.choices.push_back(hashString(text));
    }
    queue.parameters.push_back(std::move(parameter));
  }
  std::vector<bool> isReached(queue.sites, false);
  for (const jit::OutputComponent& output : outputs)
    if (output.kind == lang::OutputKind::siteWeight) isReached[output.index] = true;
  for (std::uint32_t site = 0; site < queue.sites; ++site) {
    if (!isReached[site]) {
      for (std::size_t c = 0; c < 3; ++c) queue.defaults.emplace_back(site * stride + c, 0.0f);
      continue;
    }
    const Closure* closure = scene_.siteClosures[queue.family][site];
    if (!closure) continue;
    const auto fields = closure->fields();
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const auto& names = sites[site].parameterNames;
      if (std::find(names.begin(), names.end(), fields[f].name) != names.end()) continue;
      for (int c = 0; c < fields[f].components(); ++c) {
        queue.defaults.emplace_back(site * stride + first + offsetOf(*closure, f) + static_cast<std::size_t>(c),
                                    fields[f].defaultValue);
      }
    }
  }
}

void KernelQueues::push(const Question& question, const PathContext& path, PendingQuestion from) {
  ++waiting_;
  if (!question.medium) {
    Queue& queue = queueOf(question.surface, shading::Variant::surface);
    queue.questions.push_back(from);
    queue.points.push(*question.surfacePoint, question.surface.index);
    return;
  }
  const MediumVelocity* const moves = scene_.velocityOf(question.medium->index);
  if (!moves) [[likely]]
    return pushMedium(question, path, question.point, from);
  Queue& queue = queueOf(moves->shader, shading::Variant::velocity);
  queue.questions.push_back(from);
  pushPoint(queue, path, question.point, moves->shader.index);
}

/// A medium's shader is asked at `point`.
void KernelQueues::pushMedium(const Question& question, const PathContext& path, Point<World> point,
                              PendingQuestion from) {
  const shading::InstanceRef shader = scene_.mediumShaders[question.medium->index];
  Queue& queue = queueOf(shader, question.fact == MediumFact::outputs                ? shading::Variant::outputs
                                 : question.quantity == volume::Quantity::extinction ? shading::Variant::extinction
                                                                                     : shading::Variant::coefficients);
  queue.questions.push_back(from);
  pushPoint(queue, path, point, shader.index);
}

void KernelQueues::pushPoint(Queue& queue, const PathContext& path, Point<World> point, std::uint32_t instance) {
  const shading::VolumePoint place{point, path.direction(), path.time()};
  if (!hasOptionalEffects || !queue.points.readsFootprints()) [[likely]]
    return queue.points.push(place, instance);
  statistics_.work.add(Work::footprint);
  queue.points.push(place, footprintIn(path.askedFootprint(), point, scene_.largestFootprint), instance);
}

/// Takes velocities from the batch and asks the media where their matter was at the reference time. Velocities that are
/// no numbers move nothing, and are counted. What was outside of a volume that confines its matter is nothing.
void KernelQueues::moveQuestions(std::span<PathContext* const> paths) {
  waiting_ += running_.size();
  settled_.clear();
  for (std::size_t lane = 0; lane < running_.size(); ++lane) {
    const PathContext& path = *paths[running_[lane].slot];
    const Question& question = path.questions()[running_[lane].question];
    const MediumVelocity& moves = *scene_.velocityOf(question.medium->index);
    const Vector<World> velocity(batch_.output(0)[lane], batch_.output(1)[lane], batch_.output(2)[lane]);
    if (question.fact == MediumFact::velocity) {
      paths[running_[lane].slot]->record->velocity() = velocity;
      settled_.push_back(running_[lane]);
      continue;
    }
    Point<World> point = question.point - velocity * (moves.factor * (path.time() - moves.referenceTime));
    if (!std::isfinite(point.x + point.y + point.z)) [[unlikely]] {
      ++statistics_.invalidVelocities;
      point = question.point;
    }
    const shading::InstanceRef shader = scene_.mediumShaders[question.medium->index];
    if (moves.within && !moves.held(scene_.shading.instance(shader), point, path.time())) {
      paths[running_[lane].slot]->answer(running_[lane].question) = {};
      settled_.push_back(running_[lane]);
      continue;
    }
    pushMedium(question, path, point, running_[lane]);
  }
  waiting_ -= settled_.size();
}

/// NaN, infinite and negative results become zero: counted, and reported once a shader with the point that gave them.
void KernelQueues::checkCoefficients(volume::Coefficients& answer, std::uint32_t index, PathContext& path) {
  bool sound = isSound(answer.sigmaT) && isSound(answer.sigmaS) && isFinite(answer.emission);
  for (std::uint32_t i = 0; i < answer.lobeCount; ++i) {
    sound = sound && isSound(answer.lobes[i].sigmaS) && std::isfinite(answer.lobes[i].anisotropy);
  }
  if (sound) return;
  ++statistics_.invalidCoefficients;
  const Question& question = path.questions()[index];
  scene_.messages->reportInvalid(*question.medium, question.point, answer, path.id(), path.questionNumber(index));
  const auto mend = [](Color& c, bool mayBeNegative) {
    for (int i = 0; i < 3; ++i) {
      if (!std::isfinite(c[i]) || (c[i] < 0 && !mayBeNegative)) c[i] = 0;
    }
  };
  mend(answer.sigmaT, false);
  mend(answer.sigmaS, false);
  mend(answer.emission, true);
  for (std::uint32_t i = 0; i < answer.lobeCount; ++i) {
    volume::Lobe& lobe = answer.lobes[i];
    mend(lobe.sigmaS, false);
    if (!std::isfinite(lobe.anisotropy)) lobe.anisotropy = 0;
  }
}

/// Whether all results of the batch are finite, and those that must be are not negative. One pass without branches.
bool KernelQueues::allSound(const Queue& queue) const {
  bool sound = true;
  for (std::size_t k = 0; k < queue.destinations.size(); ++k) {
    const float* values = batch_.output(k);
    // NaN fails both comparisons.
    const float least = queue.least[k];
    for (std::size_t lane = 0; lane < running_.size(); ++lane) {
      sound &= values[lane] >= least && values[lane] <= std::numeric_limits<float>::max();
    }
  }
  return sound;
}

/// More than rounding of sums of closures.
constexpr float largestAlbedo = 1 + 1e-4f;

/// Whether some result of the batch scatters more than it takes from rays. One pass without branches.
bool KernelQueues::someAmplify(const Queue& queue) const {
  bool amplifies = false;
  for (std::size_t c = 0; c < 3; ++c) {
    const float *sigmaT = batch_.output(queue.sigmaT[c]), *sigmaS = batch_.output(queue.sigmaS[c]);
    for (std::size_t lane = 0; lane < running_.size(); ++lane) amplifies |= sigmaS[lane] > largestAlbedo * sigmaT[lane];
  }
  return amplifies;
}

/// An albedo above 1 is counted, and reported once a shader with the point that gave it; the result stays as it is.
void KernelQueues::checkAlbedo(const volume::Coefficients& answer, std::uint32_t index, const PathContext& path) {
  bool amplifies = false;
  for (int c = 0; c < 3; ++c) amplifies = amplifies || answer.sigmaS[c] > largestAlbedo * answer.sigmaT[c];
  if (!amplifies) return;
  ++statistics_.amplifyingCoefficients;
  const Question& question = path.questions()[index];
  scene_.messages->reportAmplifying(*question.medium, question.point, answer, path.id(), path.questionNumber(index));
}

const std::optional<VolumeLook>& KernelQueues::lookOf(const PathContext& path, const PendingQuestion& from) const {
  return scene_.looks[path.questions()[from.question].medium->index];
}

void KernelQueues::scatterCoefficients(const Queue& queue, std::span<PathContext* const> paths) {
  const bool sound = allSound(queue), hasLooks = hasOptionalEffects && !scene_.looks.empty();
  const bool amplifies = someAmplify(queue);
  const std::size_t outputs = queue.destinations.size();
  for (std::size_t lane = 0; lane < running_.size(); ++lane) {
    PathContext& path = *paths[running_[lane].slot];
    volume::Coefficients& answer = path.answer(running_[lane].question);
    answer.emission = Color();
    auto* floats = reinterpret_cast<float*>(&answer);
    for (std::size_t k = 0; k < outputs; ++k) floats[queue.destinations[k]] = batch_.output(k)[lane];
    answer.lobeCount = queue.lobes;
    if (queue.copiesSigmaS) answer.lobes[0].sigmaS = answer.sigmaS;
    if (!sound) [[unlikely]]
      checkCoefficients(answer, running_[lane].question, path);
    if (amplifies) [[unlikely]]
      checkAlbedo(answer, running_[lane].question, path);
    if (hasLooks) {
      if (const auto& look = lookOf(path, running_[lane])) {
        look->apply(answer);
        statistics_.work.add(Work::look);
      }
    }
  }
}

void KernelQueues::scatterExtinction(const Queue& queue, std::span<PathContext* const> paths) {
  const bool sound = allSound(queue), hasLooks = hasOptionalEffects && !scene_.looks.empty();
  const float* const r = batch_.output(0);
  const float* const g = batch_.output(1);
  const float* const b = batch_.output(2);
  for (std::size_t lane = 0; lane < running_.size(); ++lane) {
    PathContext& path = *paths[running_[lane].slot];
    volume::Coefficients& answer = path.answer(running_[lane].question);
    answer.sigmaT = Color(r[lane], g[lane], b[lane]);
    if (!sound) [[unlikely]] {
      answer.sigmaS = Color();
      answer.emission = Color();
      answer.lobeCount = 0;
      checkCoefficients(answer, running_[lane].question, path);
    }
    if (hasLooks) {
      if (const auto& look = lookOf(path, running_[lane])) answer.sigmaT *= look->factorAt(maximum(answer.sigmaT));
    }
  }
}

void KernelQueues::scatterSurfaces(const Queue& queue, std::span<PathContext* const> paths) {
  for (std::size_t lane = 0; lane < running_.size(); ++lane) {
    SurfaceAnswer& answer = paths[running_[lane].slot]->surfaceAnswer();
    if (answer.sites.size() != queue.sites) answer.sites.resize(queue.sites);
    auto* floats = reinterpret_cast<float*>(answer.sites.data());
    for (const auto& [place, value] : queue.defaults) floats[place] = value;
    for (const SurfaceParameter& parameter : queue.parameters) {
      const void* values = batch_.output(parameter.output);
      float& place = floats[parameter.destination];
      if (parameter.type == lang::BaseType::integer) {
        place = static_cast<float>(static_cast<const std::int32_t*>(values)[lane]);
      } else if (parameter.type == lang::BaseType::string) {
        const std::uint64_t text = static_cast<const std::uint64_t*>(values)[lane];
        const auto known = std::find(parameter.choices.begin(), parameter.choices.end(), text);
        place = known == parameter.choices.end() ? 0.0f : static_cast<float>(known - parameter.choices.begin());
      } else {
        place = static_cast<const float*>(values)[lane];
      }
    }
  }
}

/// A number is shown as grey, what is no number as black.
void KernelQueues::scatterOutputs(std::span<PathContext* const> paths) {
  const auto& components = batch_.interface().outputs;
  for (std::size_t lane = 0; lane < running_.size(); ++lane) {
    PathContext& path = *paths[running_[lane].slot];
    const auto wanted = path.record->plan().outputsOf(*path.questions()[running_[lane].question].medium);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      std::array<float, 3> value{};
      std::size_t count = 0;
      for (std::size_t k = 0; k < components.size(); ++k) {
        if (components[k].index != wanted[i].site) continue;
        const bool isInteger = components[k].type == lang::BaseType::integer;
        const float* const floats = batch_.output(k);
        const float number = isInteger ? static_cast<float>(std::bit_cast<std::int32_t>(floats[lane])) : floats[lane];
        value[count++] = std::isfinite(number) ? number : 0.0f;
      }
      path.record->shown(i) = count == 1 ? Color(value[0]) : Color(value[0], value[1], value[2]);
    }
  }
}

void KernelQueues::count(const Queue& queue, int points, int width, std::uint64_t nanoseconds) {
  ++statistics_.kernelCalls;
  statistics_.kernelPoints += static_cast<std::uint64_t>(points);
  statistics_.kernelLanes += static_cast<std::uint64_t>((points + width - 1) / width * width);
  KernelStatistics& kernel = statistics_.kernels[static_cast<std::size_t>(&queue - queues_.data())];
  ++kernel.calls;
  kernel.points += static_cast<std::uint64_t>(points);
  kernel.lanes += static_cast<std::uint64_t>((points + width - 1) / width * width);
  kernel.nanoseconds += nanoseconds;
  kernel.countedLanesRun += host_.counters().lanesRun - statistics_.countedLanesRun;
  kernel.countedLanesUsed += host_.counters().lanesUsed - statistics_.countedLanesUsed;
  statistics_.countedLanesRun = host_.counters().lanesRun;
  statistics_.countedLanesUsed = host_.counters().lanesUsed;
}

std::span<const PendingQuestion> KernelQueues::runFullest(std::span<PathContext* const> paths) {
  const PhaseScope gathering(statistics_.accel.phase, Phase::gathering);
  Queue& queue = *std::max_element(queues_.begin(), queues_.end(), [](const Queue& a, const Queue& b) {
    return a.questions.size() < b.questions.size();
  });
  // The latest questions are taken: their paths are still in the cache.
  const std::size_t first = batch_.firstOfLast(queue.points);
  running_.assign(queue.questions.begin() + static_cast<std::ptrdiff_t>(first), queue.questions.end());
  facts_.begin(running_, paths);
  const auto start = std::chrono::steady_clock::now();
  {
    const PhaseScope phase(statistics_.accel.phase, Phase::shaders);
    batch_.run(host_, queue.points, first);
  }
  const auto elapsed = std::chrono::steady_clock::now() - start;
  queue.questions.resize(first);
  queue.points.shrink(first);
  waiting_ -= running_.size();

  count(queue, static_cast<int>(running_.size()), batch_.interface().width,
        static_cast<std::uint64_t>(std::chrono::nanoseconds(elapsed).count()));
  if (!host_.records().empty()) scene_.messages->collect(host_, batch_, running_, paths);
  switch (queue.variant) {
    case shading::Variant::surface:
      scatterSurfaces(queue, paths);
      break;
    case shading::Variant::extinction:
      scatterExtinction(queue, paths);
      break;
    case shading::Variant::coefficients:
      scatterCoefficients(queue, paths);
      break;
    case shading::Variant::velocity:
      moveQuestions(paths);
      return settled_;
    case shading::Variant::outputs:
      scatterOutputs(paths);
      break;
    case shading::Variant::displacement:  // Run before the first ray.
      break;
  }
  return running_;
}

}  // namespace aerosol::render
