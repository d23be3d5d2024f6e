#include "core/render/medium_preparation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "core/jit/cost.h"
#include "core/render/kernel_queue.h"
#include "core/render/medium_bounds.h"
#include "core/render/medium_facts.h"

namespace aerosol::render {

using volume::DistanceMethod;
using volume::TransmittanceMethod;

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
  while (!queues.empty()) queues.runFullest(paths);
  return take(path, statistics);
}

}  // namespace

std::optional<volume::Coefficients> constantCoefficients(const PreparedScene& scene, const volume::Medium& medium) {
  const shading::InstanceRef shader = scene.mediumShaders[medium.index];
  const shading::Family& family = scene.shading.family(shader);
  if (!family.kernel(shading::Variant::coefficients).interface().isConstant()) return {};
  if (family.instances[shader.index].motion && shading::usesPlaceBeyondP(*family.program)) return {};
  const Question question{&medium, volume::Quantity::coefficients, {}, {}, nullptr};
  return askOnce(scene, question, [&](PathContext& path, const WorkerStatistics& statistics) {
    // What is no number has become zero; the render will not ask again.
    if (statistics.invalidCoefficients + statistics.amplifyingCoefficients > 0)
      scene.messages->markInvalidEverywhere(medium);
    return path.answer(0);
  });
}

SurfaceAnswer askSurface(const PreparedScene& scene, shading::InstanceRef shader, const shading::ShadingPoint& point) {
  const Question question{nullptr, volume::Quantity::coefficients, {}, shader, &point};
  return askOnce(scene, question, [](PathContext& path, const WorkerStatistics&) { return path.surfaceAnswer(); });
}

void askSurfaces(const PreparedScene& scene, shading::InstanceRef shader, std::span<const shading::ShadingPoint> points,
                 const std::function<void(const SurfaceAnswer&)>& take) {
  constexpr std::size_t atOnce = 64;
  WorkerStatistics statistics;
  ImmediateSink sink;
  std::vector<std::unique_ptr<PathContext>> paths;
  std::vector<PathContext*> slots;
  for (std::size_t i = 0; i < std::min(atOnce, points.size()); ++i) {
    paths.push_back(std::make_unique<PathContext>(scene, sink, statistics));
    slots.push_back(paths.back().get());
  }
  KernelQueues queues(scene, statistics, AEROSOL_MAXIMUM_WIDTH);
  for (std::size_t first = 0; first < points.size(); first += atOnce) {
    const std::size_t count = std::min(atOnce, points.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Question question{nullptr, volume::Quantity::coefficients, {}, shader, &points[first + i]};
      slots[i]->prepareAnswer(question);
      queues.push(question, *slots[i], {static_cast<std::uint32_t>(i), 0});
    }
    while (!queues.empty()) queues.runFullest(slots);
    for (std::size_t i = 0; i < count; ++i) take(slots[i]->surfaceAnswer());
  }
}

void askExtinction(const PreparedScene& scene, const volume::Medium& medium, std::span<const Point<World>> points,
                   const std::function<void(Color)>& take) {
  WorkerStatistics statistics;
  ImmediateSink sink;
  PathContext path(scene, sink, statistics);
  KernelQueues queues(scene, statistics, AEROSOL_MAXIMUM_WIDTH);
  PathContext* const paths[] = {&path};
  for (std::size_t first = 0; first < points.size(); first += AEROSOL_MAXIMUM_WIDTH) {
    const auto group = points.subspan(first, std::min<std::size_t>(AEROSOL_MAXIMUM_WIDTH, points.size() - first));
    path.prepareAnswers(medium, group);
    for (std::uint32_t i = 0; i < group.size(); ++i) queues.push(path.questions()[i], path, {0, i});
    while (!queues.empty()) queues.runFullest(paths);
    for (std::size_t i = 0; i < group.size(); ++i) take(path.answer(i).sigmaT);
  }
}

std::optional<SurfaceAnswer> constantClosures(const PreparedScene& scene, shading::InstanceRef shader) {
  if (!scene.shading.family(shader).kernel(shading::Variant::surface).interface().isConstant()) return {};
  return askSurface(scene, shader, {});
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

std::string problemOfDeclaredBound(const lang::Program& program) {
  for (const lang::MetadataValue& entry : program.metadata) {
    if (entry.name != "extinction_bound") continue;
    const auto* names = std::get_if<std::vector<std::string>>(&entry.value);
    if (!names || names->size() != 1) return "its metadata 'extinction_bound' is not the name of a parameter";
    const auto parameter = shading::findParameter(program, names->front());
    const lang::Type* const type = parameter ? &program.parameters[*parameter].type : nullptr;
    const bool isNumber = type && !type->isArray() && (type->base == lang::BaseType::floating || type->isTriple());
    if (isNumber) return {};
    return fmt::format("its metadata 'extinction_bound' names '{}', which is no parameter with a number or a colour",
                       names->front());
  }
  return {};
}

namespace {

/// Coefficients of a medium that are the same wherever it is: its shader reads nothing that varies, or what it reads
/// turns out to make no difference. What velocities carry out of a primitive has an end wherever it is.
std::optional<volume::Coefficients> constantOf(const PreparedScene& scene, const volume::Medium& medium,
                                               MediumRanges& ranges, const MediumPlace& place) {
  const MediumVelocity* const velocity = scene.velocityOf(medium.index);
  if (velocity && velocity->within) return {};
  if (auto constant = constantCoefficients(scene, medium)) return constant;
  const shading::InstanceRef shader = scene.mediumShaders[medium.index];
  if (!place.domain || !place.staysInside) return ranges.uniformEverywhere();
  const shading::Instance& instance = scene.shading.family(shader).instances[shader.index];
  return ranges.uniformOver(volume::withRounding(*place.domain, instance.objectToWorld));
}

/// The lower of what is proven and what is declared. `isDeclared`: the proof rests on what plugins say.
std::optional<volume::ExtinctionBound> lowestBound(std::optional<float> proven, std::optional<float> declared,
                                                   bool isDeclared) {
  if (proven && (!declared || *proven <= *declared))
    return volume::ExtinctionBound{*proven, isDeclared ? volume::Provenance::declared : volume::Provenance::proven};
  if (declared) return volume::ExtinctionBound{*declared, volume::Provenance::declared};
  return {};
}

/// Builds the tree and makes the medium's bound the largest in it.
void plantTree(PreparedScene& scene, volume::Medium& medium, MediumRanges& ranges,
               const volume::BoundRequest& request) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  volume::BoundStatistics& statistics = scene.treeStatistics[medium.index];
  auto tree = std::make_unique<volume::BoundTree>(volume::buildBoundTree(ranges, request, statistics));
  volume::ExtinctionBound largest{0, volume::Provenance::proven};
  const auto include = [&](const volume::BoundNode& node) {
    if (node.kind() == volume::LeafKind::inner) return;
    largest.value = std::max(largest.value, node.limit);
    largest.provenance = std::max(largest.provenance, node.provenance());
  };
  std::ranges::for_each(tree->nodes, include);
  medium.bound = largest;
  medium.tree = tree.get();
  scene.trees[medium.index] = std::move(tree);
  statistics.seconds = std::chrono::duration<double>(Clock::now() - start).count();
}

/// May the medium do so (scatter, emit) somewhere, as far as is proven?
bool isPossible(const PreparedScene& scene, const volume::Medium& medium, Answer MediumFacts::* fact) {
  if (factsOfShader(scene, medium).*fact == Answer::no) return false;
  const bool isEmptyOutside = medium.tree && medium.tree->outside.kind() == volume::LeafKind::empty;
  return !isEmptyOutside || factsOf(scene, medium).*fact != Answer::no;
}

/// Is there emission that is worth to be looked for?
bool isWorthIntegrating(const volume::Medium& medium) {
  return medium.tree &&
         std::ranges::any_of(medium.tree->ranges, [](const volume::BoundRanges& r) { return r.emissionHigh > 0; });
}

/// Shader points that a distance takes through the whole medium, with one step scale for both methods.
struct DistanceCost {
  double tracking = 0, marching = 0;
  /// Marching has a bias, tracking has none: to be left, it must cost very much more.
  bool isTrackingHopeless() const { return tracking > 64 * marching; }
};

/// A flight that meets the optical depth τ under a bound that is k times as much has k (1 − exp(−τ)) tentative
/// collisions on average; marching ends where next to nothing is left.
DistanceCost distanceCost(const volume::BoundStatistics& statistics, double stepSize) {
  const double bounds = statistics.meanBound * statistics.chord;
  const double bounded = 1 - statistics.emptyVolume - statistics.uniformVolume;
  if (!(bounds > 0) || !std::isfinite(bounds) || !(bounded > 0)) return {};
  const double depth = statistics.tightness > 0 ? bounds / statistics.tightness : 0;
  const double tracking = depth > 0 ? -std::expm1(-depth) * bounds / depth : bounds;
  const double visible = 8 / std::max(depth, 8.0);
  return {tracking, std::max(visible * bounded * statistics.chord / stepSize, 1.0)};
}

TransmittanceMethod transmittanceMethod(scene::TransmittanceSampling wanted, bool tracks) {
  switch (wanted) {
    case scene::TransmittanceSampling::automatic:
      break;
    case scene::TransmittanceSampling::marching:
      return TransmittanceMethod::marching;
    case scene::TransmittanceSampling::ratio:
      return TransmittanceMethod::ratioTracking;
    case scene::TransmittanceSampling::twoCombs:
      return TransmittanceMethod::twoCombs;
    case scene::TransmittanceSampling::unbiased:
      return TransmittanceMethod::unbiasedMarching;
    case scene::TransmittanceSampling::delta:
      return TransmittanceMethod::deltaTracking;
  }
  return tracks ? TransmittanceMethod::ratioTracking : TransmittanceMethod::marching;
}

/// What a shader's point costs, in steps over the faces of a tree of bounds. The parts were measured once; they are
/// constants, so that no image depends on a clock: a step takes about 25 ns, a question and its answer 60 ns, and a
/// lane's instruction 0.08 ns with 8 lanes.
double pointCost(double instructions) { return (60 + 0.08 * instructions) / 25; }

bool isTracking(scene::DistanceSampling wanted) {
  using scene::DistanceSampling;
  return wanted != DistanceSampling::automatic && wanted != DistanceSampling::marching &&
         wanted != DistanceSampling::analytic;
}

volume::Collisions collisionsOf(scene::DistanceSampling wanted) {
  switch (wanted) {
    case scene::DistanceSampling::delta:
      return volume::Collisions::analogue;
    case scene::DistanceSampling::decomposition:
      return volume::Collisions::decomposed;
    case scene::DistanceSampling::candidates:
      return volume::Collisions::listed;
    default:
      return volume::Collisions::weighted;
  }
}

std::string describeDistances(const volume::Medium& medium, bool isAsked, const DistanceCost& cost = {}) {
  const char* const asked = isAsked ? ", as the scene asks" : "";
  switch (medium.method) {
    case DistanceMethod::closedForm:
      return "closed form: its coefficients are constant";
    case DistanceMethod::analytic:
      return fmt::format("closed form, voxel by voxel: its coefficients are voxels times constants{}", asked);
    case DistanceMethod::marching:
      if (isAsked) return fmt::format("ray marching by {:.4g}{}", medium.stepSize, asked);
      if (cost.isTrackingHopeless())
        return fmt::format(
            "ray marching by {:.4g}: under the bound of {:.4g}, null scattering would take {:.3g} points a "
            "distance instead of {:.3g}",
            medium.stepSize, medium.bound->value, cost.tracking, cost.marching);
      return fmt::format("ray marching by {:.4g}: no bound on its extinction is {}", medium.stepSize,
                         medium.bound ? "more than an estimate" : "known");
    case DistanceMethod::nullScattering:
      break;
  }
  constexpr std::array provenances{"proven", "declared", "estimated"};
  const char* const provenance = provenances[static_cast<std::size_t>(medium.bound->provenance)];
  constexpr std::array kinds{"null scattering", "analogue delta tracking", "decomposition tracking",
                             "null scattering with lists of candidates"};
  return fmt::format("{}{}: extinction is at most {:.4g}, {}{}{}", kinds[static_cast<std::size_t>(medium.collisions)],
                     medium.relaxesBound ? fmt::format(" with a collision each {:.4g} at least", medium.stepSize) : "",
                     medium.bound->value, provenance, medium.tree ? " place by place" : "", asked);
}

std::string describeTransmittance(const volume::Medium& medium) {
  switch (medium.transmittance) {
    case TransmittanceMethod::closedForm:
    case TransmittanceMethod::analytic:
      return "";
    case TransmittanceMethod::marching:
      return medium.method == DistanceMethod::marching ? "" : "; marching to lights";
    case TransmittanceMethod::ratioTracking:
      return medium.method == DistanceMethod::nullScattering ? "" : "; ratio tracking to lights";
    case TransmittanceMethod::twoCombs:
      return "; two combs to lights";
    case TransmittanceMethod::deltaTracking:
      return "; delta tracking to lights";
    case TransmittanceMethod::unbiasedMarching:
      break;
  }
  return "; unbiased marching to lights";
}

/// A medium that has no bound although its method needs one.
void refuseWithoutBound(const PreparedScene& scene, const volume::Medium& medium, const char* method,
                        const char* instead, Diagnostics& errors) {
  errors.error(scene.mediumLocations[medium.index],
               fmt::format("{} needs a bound on the extinction of '{}'", method, scene.mediumNames[medium.index]),
               {fmt::format("give the medium or volume a float 'density_bound', or the shader the metadata "
                            "[[ string extinction_bound = \"PARAMETER\" ]], or choose {} 'marching'",
                            instead)});
}

void warnOfLooseBound(const PreparedScene& scene, const volume::Medium& medium, const DistanceCost& cost,
                      Diagnostics& errors) {
  errors.warning(
      scene.mediumLocations[medium.index],
      fmt::format("null scattering in '{}' will take {:.3g} shader points a distance: its bound of {:.4g} is "
                  "far above its extinction",
                  scene.mediumNames[medium.index], cost.tracking, medium.bound->value),
      {fmt::format("ray marching takes {:.3g}; a lower 'density_bound' makes null scattering faster", cost.marching)});
}

}  // namespace

Diagnostics decideSampling(PreparedScene& scene, volume::Medium& medium, const scene::MediumSampling& sampling,
                           const scene::Integrator& integrator, const MediumPlace& place,
                           const volume::BoundBudget& budget, int threads) {
  Diagnostics errors;
  const shading::InstanceRef shader = scene.mediumShaders[medium.index];
  const shading::Family& family = scene.shading.family(shader);
  const shading::Instance& instance = family.instances[shader.index];
  const float defaultStep = std::isfinite(place.extent) && place.extent > 0 ? place.extent / 100 : 1.0f;
  const float step = sampling.stepSize.value_or(defaultStep);
  medium.stepSize = step * integrator.stepScale * place.stepScale;
  const auto keepChoice = [&] {
    scene.samplingPlan[medium.index] = choiceOf(scene.mediumNames[medium.index], medium, step);
  };
  MediumRanges ranges(scene, medium, threads);
  medium.constant = constantOf(scene, medium, ranges, place);
  if (medium.constant) {
    medium.method = DistanceMethod::closedForm;
    medium.transmittance = TransmittanceMethod::closedForm;
    medium.mayScatter = !isBlack(medium.constant->sigmaS);
    medium.mayEmit = !isBlack(medium.constant->emission);
    scene.samplingReasons[medium.index] = describeDistances(medium, false);
    keepChoice();
    return errors;
  }
  std::optional<float> declared = declaredBound(family, instance);
  if (const VolumeLook* look = scene.lookOf(medium.index); declared && look) *declared *= look->largestFactor();
  if (sampling.densityBound) declared = sampling.densityBound;
  const std::optional<float> everywhere = ranges.boundEverywhere();
  medium.bound = lowestBound(everywhere, declared, ranges.areDeclared());
  using scene::DistanceSampling;
  using scene::TransmittanceSampling;
  const DistanceSampling wanted = sampling.distance.value_or(integrator.distance);
  const TransmittanceSampling wantedToLights = sampling.transmittance.value_or(integrator.transmittance);
  const bool isAnalogue = wanted == DistanceSampling::delta;
  const bool wantsTracking = isTracking(wanted);
  const bool tracksToLights =
      wantedToLights == TransmittanceSampling::ratio || wantedToLights == TransmittanceSampling::delta;
  const bool needsBound = wantsTracking || tracksToLights;
  const bool hasVoxels = medium.voxels && ranges.mayLeaveOut();
  const double instructions = jit::Cost(*family.program).of(family.program->body);
  if (wanted == DistanceSampling::analytic && !hasVoxels) {
    errors.error(
        scene.mediumLocations[medium.index],
        fmt::format("distances in '{}' have no closed form: its coefficients vary, and are not voxels times constants",
                    scene.mediumNames[medium.index]),
        {"choose distance 'auto', 'marching' or 'null' for this medium"});
    return errors;
  }
  const bool hasBudget = budget.boxes > 0 || (needsBound && !medium.bound);
  if (place.domain && hasBudget && (ranges.canProve() || declared || needsBound)) {
    plantTree(scene, medium, ranges,
              {.domain = *place.domain,
               .objectToWorld = instance.objectToWorld,
               .declared = declared,
               .everywhere = everywhere,
               .rangesAreDeclared = ranges.areDeclared(),
               .stepSize = medium.stepSize,
               .pointCost = pointCost(instructions),
               .mayLeaveOut = ranges.mayLeaveOut(),
               .budget = budget});
  }
  if (wantsTracking && !medium.bound) {
    refuseWithoutBound(scene, medium, isAnalogue ? "delta tracking" : "null scattering", "distance", errors);
  } else if (tracksToLights && !medium.bound) {
    const bool isRatio = wantedToLights == TransmittanceSampling::ratio;
    refuseWithoutBound(scene, medium, isRatio ? "ratio tracking" : "delta tracking", "transmittance", errors);
  }
  medium.mayScatter = isPossible(scene, medium, &MediumFacts::scatters);
  medium.mayEmit = isPossible(scene, medium, &MediumFacts::emits);
  const bool isKnown = medium.bound && medium.bound->provenance != volume::Provenance::estimated;
  const bool mayChoose = wanted == DistanceSampling::automatic || wanted == DistanceSampling::analytic;
  // Under a bound that is far too loose, hardly anything but null collisions would ever happen.
  const DistanceCost cost =
      medium.tree ? distanceCost(scene.treeStatistics[medium.index], medium.stepSize) : DistanceCost{};
  const bool isHopeless = mayChoose && isKnown && cost.isTrackingHopeless();
  const bool tracks = wantsTracking || (mayChoose && isKnown && !isHopeless);
  if (wantsTracking && !isAnalogue && cost.isTrackingHopeless()) warnOfLooseBound(scene, medium, cost, errors);
  medium.relaxesBound = wanted == DistanceSampling::relaxed;
  medium.integratesEmission =
      tracks && !isAnalogue && wanted != DistanceSampling::candidates && isWorthIntegrating(medium);
  medium.besideOthers = tracks ? DistanceMethod::nullScattering : DistanceMethod::marching;
  const bool isAnalytic = hasVoxels && (wanted == DistanceSampling::automatic || wanted == DistanceSampling::analytic);
  medium.method = isAnalytic ? DistanceMethod::analytic : medium.besideOthers;
  medium.collisions = collisionsOf(wanted);
  medium.transmittance = isAnalytic && wantedToLights == TransmittanceSampling::automatic
                             ? TransmittanceMethod::analytic
                             : transmittanceMethod(wantedToLights, tracks);
  if (isAnalogue && medium.tree) {
    // One bound for all of the medium, the least that is known: nothing else of the tree is used.
    medium.tree = nullptr;
    scene.trees[medium.index].reset();
    scene.treeStatistics[medium.index] = {};
  }
  if (errors.hasErrors()) return errors;
  scene.samplingReasons[medium.index] = describeDistances(medium, wanted != DistanceSampling::automatic, cost) +
                                        describeTransmittance(medium) +
                                        fmt::format("; a point takes about {:.3g} instructions", instructions);
  keepChoice();
  return errors;
}

}  // namespace aerosol::render
