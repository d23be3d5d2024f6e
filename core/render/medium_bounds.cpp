#include "core/render/medium_bounds.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <thread>

#include "core/base/random.h"
#include "core/render/coefficient_layout.h"

namespace aerosol::render {

namespace {

constexpr int boxesAtOnce = 256;
constexpr int pointsAtOnce = 1024;
/// Where rays may come to; further out there is nothing.
constexpr Box<Object> everywhere{{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}};

/// Ranges are rounded outwards: what is surely 0 comes as a few of the smallest numbers on both sides.
constexpr float nothing = volume::negligibleExtinction;

bool isSound(const shading::Bound& bound) { return bound.low >= -nothing && std::isfinite(bound.high); }

bool areZero(std::span<const shading::Bound> bounds) {
  return std::ranges::all_of(bounds, [](const shading::Bound& b) { return b.low >= -nothing && b.high <= nothing; });
}

/// Nothing that the render would have to report: no NaN, no infinity, nothing negative.
bool isSound(const shading::CoefficientBounds& bounds) {
  const auto sound = [](const shading::Bound& b) { return isSound(b); };
  const auto isFinite = [](const shading::Bound& b) { return std::isfinite(b.low) && std::isfinite(b.high); };
  bool all = !bounds.mayBeNan && std::ranges::all_of(bounds.sigmaT, sound) &&
             std::ranges::all_of(bounds.sigmaS, sound) && std::ranges::all_of(bounds.emission, isFinite);
  for (std::uint32_t i = 0; i < bounds.lobeCount; ++i) all = all && isFinite(bounds.lobes[i].anisotropy);
  return all;
}

float highOf(std::span<const shading::Bound> bounds) {
  float high = 0;
  for (const shading::Bound& b : bounds) high = std::max(high, b.high);
  return high;
}
float lowOf(std::span<const shading::Bound> bounds) {
  float low = std::numeric_limits<float>::infinity();
  for (const shading::Bound& b : bounds) low = std::min(low, b.low);
  return low;
}

std::uint64_t keyOf(const shading::CoefficientBounds& bounds) {
  std::uint64_t key = bounds.lobeCount;
  const auto add = [&](const shading::Bound& b) { key = combineHashes(key, std::bit_cast<std::uint64_t>(b)); };
  std::ranges::for_each(bounds.sigmaT, add);
  std::ranges::for_each(bounds.sigmaS, add);
  std::ranges::for_each(bounds.emission, add);
  for (std::uint32_t i = 0; i < bounds.lobeCount; ++i) {
    std::ranges::for_each(bounds.lobes[i].sigmaS, add);
    add(bounds.lobes[i].anisotropy);
  }
  return key;
}

volume::BoxKnowledge knowledgeFrom(const shading::CoefficientBounds& bounds) {
  volume::BoxKnowledge k;
  k.ranges = {.extinctionLow = bounds.mayBeNan ? 0.0f : std::max(0.0f, lowOf(bounds.sigmaT)),
              .extinctionHigh = highOf(bounds.sigmaT),
              .scatteringHigh = highOf(bounds.sigmaS),
              .emissionLow = lowOf(bounds.emission),
              .emissionHigh = highOf(bounds.emission)};
  if (!isSound(bounds)) return k;
  k.isEmpty = areZero(bounds.sigmaT) && areZero(bounds.sigmaS) && areZero(bounds.emission);
  k.isUniform = bounds.isUniform(shading::uniformTolerance);
  k.uniformKey = keyOf(bounds);
  return k;
}

/// Points of a box: the R3 sequence (Roberts 2018), moved by a number that depends on the box alone.
class BoxPoints {
 public:
  explicit BoxPoints(const Box<Object>& box) : box_(box) {
    std::uint64_t key = 0;
    for (int i = 0; i < 3; ++i) key = combineHashes(key, std::bit_cast<std::uint32_t>(box.lower[i]));
    for (std::size_t i = 0; i < 3; ++i)
      shift_[i] = static_cast<double>(randomFloat(key, 0, static_cast<std::uint32_t>(i)));
  }
  Point<Object> operator[](int n) const {
    constexpr std::array<double, 3> step{0.8191725133961645, 0.6710436067037893, 0.5497004779019702};
    Point<Object> p;
    for (int i = 0; i < 3; ++i) {
      const double x = shift_[static_cast<std::size_t>(i)] + (n + 1) * step[static_cast<std::size_t>(i)];
      p[i] = box_.lower[i] + static_cast<float>(x - std::floor(x)) * (box_.upper[i] - box_.lower[i]);
    }
    return p;
  }

  /// In [0, 1): by the golden ratio, which the three steps have nothing to do with.
  float time(int n) const {
    const double x = shift_[0] + shift_[1] + (n + 1) * 0.6180339887498949;
    return static_cast<float>(x - std::floor(x));
  }

 private:
  const Box<Object>& box_;
  std::array<double, 3> shift_{};
};

/// Over places that come from a box, where nothing is outside of what confines them.
void confine(volume::BoxKnowledge& knowledge, const Box<Object>& from, const Box<Object>& within) {
  bool isOutside = false;
  for (int i = 0; i < 3; ++i)
    isOutside = isOutside || from.lower[i] > within.upper[i] || from.upper[i] < within.lower[i];
  if (isOutside) {
    knowledge = {.isEmpty = true};
    return;
  }
  knowledge.isUniform = false;
  knowledge.ranges.extinctionLow = 0;
  knowledge.ranges.emissionLow = std::min(knowledge.ranges.emissionLow, 0.0f);
  knowledge.ranges.emissionHigh = std::max(knowledge.ranges.emissionHigh, 0.0f);
}

/// As renders take it: what is not finite or negative counts as 0.
float soundValue(float x) { return x > 0 && std::isfinite(x) ? x : 0.0f; }

}  // namespace

/// What one thread works with.
struct MediumRanges::Context {
  Context(const PreparedScene& scene, const shading::Family& family)
      : host(scene.namedSpaces, scene.loopBudget, scene.services.get()), boxes(boxesAtOnce), batch(pointsAtOnce) {
    points.bind(family, shading::Variant::extinction);
    boxes.allowFootprints(scene.keepsFootprints ? scene.largestFootprint : 0);
  }
  Context(const PreparedScene& scene, const shading::Family& family, const MediumVelocity* velocity)
      : Context(scene, family) {
    if (velocity) movers.bind(scene.shading.family(velocity->shader), shading::Variant::velocity);
  }
  shading::KernelHost host;
  shading::BoundsBatch boxes;
  shading::Batch batch;
  shading::PointArrays points;
  shading::PointArrays movers;  ///< Points whose velocity is asked for.
  std::vector<shading::VolumePoint> places;
  std::vector<shading::VolumeBox> volumeBoxes;
  std::vector<shading::VelocityBounds> velocities;
  std::vector<shading::CoefficientBounds> bounds;
};

MediumRanges::MediumRanges(const PreparedScene& scene, const volume::Medium& medium, int threads)
    : scene_(scene),
      shader_(scene.mediumShaders[medium.index]),
      family_(scene.shading.family(shader_)),
      velocity_(scene.velocityOf(medium.index)),
      look_(scene.lookOf(medium.index)),
      threads_(std::max(1, threads)) {}

MediumRanges::~MediumRanges() = default;

bool MediumRanges::canProve() const {
  const bool moves = family_.instances[shader_.index].motion.has_value();
  if (velocity_ && (moves || !scene_.shading.family(velocity_->shader).velocityBounds)) return false;
  return family_.bounds && !(moves && shading::usesPlaceBeyondP(*family_.program));
}

/// From boxes of points to boxes of the places where their matter was: x - s v(x), with s in the shutter's interval of
/// times since the reference, scaled, and v in its range over the box. Where nothing bounds the velocity, everywhere.
void MediumRanges::moveBoxes(Context& context) const {
  if (!velocity_) return;
  context.velocities.assign(context.volumeBoxes.size(), {});
  context.boxes.evaluateVelocity(context.host, scene_.shading.family(velocity_->shader), velocity_->shader.index,
                                 context.volumeBoxes, context.velocities);
  const Transform<World, Object>& place = family_.instances[shader_.index].objectToWorld;
  const Matrix4 &m = place.matrix(), &inverse = place.inverseMatrix();
  const double factor = static_cast<double>(velocity_->factor);
  const double s0 = factor * (static_cast<double>(scene_.shutter.open) - static_cast<double>(velocity_->referenceTime));
  const double s1 =
      factor * (static_cast<double>(scene_.shutter.close) - static_cast<double>(velocity_->referenceTime));
  for (std::size_t i = 0; i < context.volumeBoxes.size(); ++i) {
    Box<Object>& box = context.volumeBoxes[i].box;
    std::array<double, 3> low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v0 = static_cast<double>(context.velocities[i].velocity[k].low);
      const auto v1 = static_cast<double>(context.velocities[i].velocity[k].high);
      low[k] = -std::max({s0 * v0, s0 * v1, s1 * v0, s1 * v1});
      high[k] = -std::min({s0 * v0, s0 * v1, s1 * v0, s1 * v1});
      double magnitude = std::fabs(m[k][3]) + std::max(std::fabs(low[k]), std::fabs(high[k]));
      for (std::size_t a = 0; a < 3; ++a) {
        const int axis = static_cast<int>(a);
        magnitude +=
            std::fabs(m[k][a]) * static_cast<double>(std::max(std::fabs(box.lower[axis]), std::fabs(box.upper[axis])));
      }
      low[k] -= 0x1p-21 * magnitude;  // Points, velocities and their products are floats.
      high[k] += 0x1p-21 * magnitude;
    }
    const Box<Object> before = box;
    for (std::size_t a = 0; a < 3; ++a) {
      const int axis = static_cast<int>(a);
      double from = 0, to = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        from += std::min(inverse[a][k] * low[k], inverse[a][k] * high[k]);
        to += std::max(inverse[a][k] * low[k], inverse[a][k] * high[k]);
      }
      const double lower = static_cast<double>(before.lower[axis]) + from,
                   upper = static_cast<double>(before.upper[axis]) + to;
      const bool isKnown = std::fabs(lower) < 1e30 && std::fabs(upper) < 1e30 && !context.velocities[i].mayBeNan;
      box.lower[axis] = isKnown ? std::nextafter(static_cast<float>(lower), -1e38f) : everywhere.lower[axis];
      box.upper[axis] = isKnown ? std::nextafter(static_cast<float>(upper), 1e38f) : everywhere.upper[axis];
      // A velocity that is no number moves nothing.
      box.lower[axis] = std::min(box.lower[axis], before.lower[axis]);
      box.upper[axis] = std::max(box.upper[axis], before.upper[axis]);
    }
  }
}

/// As the render moves them.
std::vector<Point<World>> MediumRanges::movedPoints(Context& context,
                                                    std::span<const shading::VolumePoint> points) const {
  std::vector<Point<World>> moved;
  for (const shading::VolumePoint& p : points) moved.push_back(p.point);
  if (!velocity_) return moved;
  for (const shading::VolumePoint& p : points) context.movers.push(p, velocity_->shader.index);
  context.batch.run(context.host, context.movers, 0);
  context.movers.shrink(0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto axis = [&](std::size_t k) { return context.batch.output(k)[i]; };
    const float seconds = velocity_->factor * (points[i].time - velocity_->referenceTime);
    const Point<World> there = points[i].point - Vector<World>(axis(0), axis(1), axis(2)) * seconds;
    if (std::isfinite(there.x + there.y + there.z)) moved[i] = there;
  }
  return moved;
}

/// The box for points that are rounded in the world, wherever the instance is.
Box<Object> MediumRanges::everywhereOnItsWay(const Box<Object>& box) const {
  const shading::Instance& instance = family_.instances[shader_.index];
  if (!instance.motion) return box;
  Box<Object> joined = box;
  constexpr int looks = 5;
  for (int i = 0; i < looks; ++i) {
    const auto place = instance.motion->at(scene_.shutter.at(static_cast<float>(i) / (looks - 1)));
    const Box<Object> rounded = volume::withRounding(box, place);
    joined.extend(rounded.lower);
    joined.extend(rounded.upper);
  }
  return joined;
}

bool MediumRanges::areDeclared() const { return canProve() && family_.bounds->interface().hasDeclaredRanges; }

bool MediumRanges::mayLeaveOut() const {
  // Neither messages nor what the host keeps (points written to a cloud) may depend on where bounds are known.
  const auto changesWorld = [](const lang::FunctionUse& function) { return function.host && !function.pure; };
  if (std::ranges::any_of(family_.program->functions, changesWorld)) return false;
  const auto& sites = family_.kernel(shading::Variant::coefficients).interface().sites;
  return std::ranges::none_of(sites, [](const jit::MessageSite& site) {
    return site.kind == AEROSOL_MESSAGE_PRINT || site.kind == AEROSOL_MESSAGE_WARNING ||
           site.kind == AEROSOL_MESSAGE_ERROR;
  });
}

std::unique_ptr<MediumRanges::Context> MediumRanges::takeContext() {
  const std::lock_guard lock(mutex_);
  if (free_.empty()) return std::make_unique<Context>(scene_, family_, velocity_);
  auto context = std::move(free_.back());
  free_.pop_back();
  return context;
}

void MediumRanges::giveBack(std::unique_ptr<Context> context) {
  const std::lock_guard lock(mutex_);
  free_.push_back(std::move(context));
}

template <class Run>
void MediumRanges::inParts(std::size_t count, std::size_t step, const Run& run) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    auto context = takeContext();
    for (std::size_t first = next.fetch_add(step); first < count; first = next.fetch_add(step)) {
      run(*context, first, std::min(first + step, count));
      context->host.records().clear();
    }
    giveBack(std::move(context));
  };
  std::vector<std::jthread> threads;
  const std::size_t workers = std::min<std::size_t>(static_cast<std::size_t>(threads_), (count + step - 1) / step);
  for (std::size_t i = 1; i < workers; ++i) threads.emplace_back(work);
  if (count > 0) work();
}

void MediumRanges::prove(std::span<const Box<Object>> boxes, std::span<volume::BoxKnowledge> knowledge) {
  if (!canProve()) {
    volume::BoxKnowledge unknown;
    unknown.ranges.extinctionHigh = unknown.ranges.scatteringHigh = unknown.ranges.emissionHigh =
        std::numeric_limits<float>::infinity();
    unknown.ranges.emissionLow = -unknown.ranges.emissionHigh;
    std::ranges::fill(knowledge, unknown);
    return;
  }
  inParts(boxes.size(), boxesAtOnce, [&](Context& context, std::size_t first, std::size_t end) {
    context.volumeBoxes.clear();
    for (std::size_t i = first; i < end; ++i) {
      context.volumeBoxes.push_back({everywhereOnItsWay(boxes[i]), scene_.shutter.open, scene_.shutter.close});
    }
    moveBoxes(context);
    context.bounds.resize(end - first);
    context.boxes.evaluate(context.host, family_, shader_.index, context.volumeBoxes, context.bounds);
    for (std::size_t i = first; i < end; ++i) {
      knowledge[i] = knowledgeFrom(context.bounds[i - first]);
      // Only what is proven may be left out.
      if (areDeclared()) knowledge[i].isEmpty = knowledge[i].isUniform = false;
      if (look_) look_->apply(knowledge[i]);
      if (velocity_ && velocity_->within && !(knowledge[i].isEmpty && !areDeclared()))
        confine(knowledge[i], context.volumeBoxes[i - first].box, velocity_->within->boundsAtReference());
    }
  });
}

void MediumRanges::sample(std::span<const Box<Object>> boxes, int pointsPerBox, std::span<volume::BoxSamples> samples) {
  const shading::Instance& instance = family_.instances[shader_.index];
  const Transform<World, Object>& toWorld = instance.objectToWorld;
  const bool isInstant = scene_.shutter.isInstant();
  const auto perBox = static_cast<std::size_t>(pointsPerBox);
  inParts(boxes.size(), std::max<std::size_t>(1, pointsAtOnce / perBox),
          [&](Context& context, std::size_t first, std::size_t end) {
            for (std::size_t i = first; i < end; ++i) {
              const BoxPoints points(boxes[i]);
              for (int k = 0; k < pointsPerBox; ++k) {
                const float time = isInstant ? scene_.shutter.open : scene_.shutter.at(points.time(k));
                const Point<World> point = instance.motion ? instance.motion->at(time)(points[k]) : toWorld(points[k]);
                context.places.push_back({point, Vector<World>(0, 0, 1), time});
              }
            }
            const std::vector<Point<World>> moved = movedPoints(context, context.places);
            std::vector<bool> isOutside(moved.size());
            for (std::size_t i = 0; i < moved.size(); ++i) {
              isOutside[i] = velocity_ && !velocity_->held(instance, moved[i], context.places[i].time);
              context.points.push(shading::VolumePoint{moved[i], context.places[i].direction, context.places[i].time},
                                  shader_.index);
            }
            context.places.clear();
            context.batch.run(context.host, context.points, 0);
            context.points.shrink(0);
            for (std::size_t i = first; i < end; ++i) {
              volume::BoxSamples& box = samples[i];
              box = {std::numeric_limits<float>::infinity(), 0, 0};
              double sum = 0;
              for (std::size_t k = (i - first) * perBox; k < (i - first + 1) * perBox; ++k) {
                Color sigmaT(soundValue(context.batch.output(0)[k]), soundValue(context.batch.output(1)[k]),
                             soundValue(context.batch.output(2)[k]));
                if (isOutside[k]) sigmaT = Color();
                if (look_) sigmaT *= look_->factorAt(maximum(sigmaT));
                box.low = std::min(box.low, minimum(sigmaT));
                box.high = std::max(box.high, maximum(sigmaT));
                sum += static_cast<double>(maximum(sigmaT));
              }
              box.mean = static_cast<float>(sum / pointsPerBox);
            }
          });
}

volume::Coefficients MediumRanges::at(Point<Object> point) {
  auto context = takeContext();
  shading::VolumePoint place{family_.instances[shader_.index].objectToWorld(point), Vector<World>(0, 0, 1),
                             scene_.shutter.open};
  place.point = movedPoints(*context, {&place, 1}).front();
  if (velocity_ && !velocity_->held(family_.instances[shader_.index], place.point, place.time)) {
    giveBack(std::move(context));
    return {};
  }
  shading::PointArrays points;
  points.bind(family_, shading::Variant::coefficients);
  points.push(place, shader_.index);
  context->batch.run(context->host, points, 0);
  volume::Coefficients coefficients = readCoefficients(context->batch, 0);
  if (look_) look_->apply(coefficients);
  context->host.records().clear();
  giveBack(std::move(context));
  return coefficients;
}

std::optional<volume::Coefficients> MediumRanges::uniformOver(const Box<Object>& box) {
  if (!canProve() || !mayLeaveOut()) return {};
  std::array<volume::BoxKnowledge, 1> knowledge;
  prove({&box, 1}, knowledge);
  if (!knowledge[0].isUniform) return {};
  Point<Object> centre;
  for (int i = 0; i < 3; ++i) centre[i] = 0.5f * box.lower[i] + 0.5f * box.upper[i];
  return at(centre);
}

std::optional<volume::Coefficients> MediumRanges::uniformEverywhere() { return uniformOver(everywhere); }

std::optional<float> MediumRanges::boundEverywhere() {
  if (!canProve()) return {};
  std::array<volume::BoxKnowledge, 1> knowledge;
  prove({&everywhere, 1}, knowledge);
  const float high = knowledge[0].ranges.extinctionHigh;
  return std::isfinite(high) ? std::optional(high) : std::nullopt;
}

}  // namespace aerosol::render
