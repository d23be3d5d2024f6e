// Time a ray takes to find its way through many volume primitives, by both designs: all spans sorted and split, and the
// walk through a partition of space. `whole` takes all segments; `first` stops at the first one, as a path does that
// scatters there. Per ray, in nanoseconds.
//
// Arrangements: `heap` elements overlap in one place; `row` elements stand one behind the other, touching; `plain`
// elements lie side by side, so that the number under a ray does not grow: three overlap at each place.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "core/accel/span_stream.h"
#include "core/volume/segment_stream.h"

namespace aerosol::bench {

namespace {

enum class Arrangement : std::uint8_t { heap, row, plain };

Transform<World, Object> at(double x, double y, double z, double size) {
  const Matrix4 forward{{{size, 0, 0, x}, {0, size, 0, y}, {0, 0, size, z}, {0, 0, 0, 1}}};
  Matrix4 inverse;
  invert(forward, inverse);
  return {forward, inverse};
}

struct Setting {
  accel::Scene scene;
  std::vector<Ray<World>> rays;
};

Setting make(Arrangement arrangement, int count, accel::OverlapDesign design) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  accel::SceneBuilder builder;
  const int side = std::max(1, static_cast<int>(std::lround(std::sqrt(count))));
  for (int i = 0; i < count; ++i) {
    Transform<World, Object> place;
    if (arrangement == Arrangement::heap) place = at(uniform(random), uniform(random), uniform(random), 3);
    if (arrangement == Arrangement::row) place = at(0, 0, 6 + 6 * i, 3);
    if (arrangement == Arrangement::plain) place = at(2 * (i % side), 2 * (i / side), 0.5 * uniform(random), 1.73);
    std::unique_ptr<const accel::VolumeShape> shape;
    if (i % 2 == 0) {
      shape = std::make_unique<accel::SphereVolume>(place);
    } else {
      shape = std::make_unique<accel::BoxVolume>(place);
    }
    static_cast<void>(builder.addVolume(std::move(shape)));
  }
  auto scene = builder.build({.overlap = design});
  Setting setting{std::move(*scene), {}};
  for (int i = 0; i < 1024; ++i) {
    Ray<World> ray;
    if (arrangement == Arrangement::plain) {
      ray.origin = {static_cast<float>((uniform(random) + 1) * side), static_cast<float>((uniform(random) + 1) * side),
                    -9};
    } else {
      ray.origin = {static_cast<float>(uniform(random)), static_cast<float>(uniform(random)), -9};
    }
    ray.direction = normalize(
        Vector<World>(0.02f * static_cast<float>(uniform(random)), 0.02f * static_cast<float>(uniform(random)), 1));
    setting.rays.push_back(ray);
  }
  return setting;
}

/// As the renderer joins the two (core/render/path_spans.h), with one medium for all.
class Source final : public volume::SpanSource {
 public:
  accel::SpanStream stream;
  const volume::MediumSpan* peek(double limit) override {
    const accel::Span* const span = stream.peek(limit);
    if (!span) return nullptr;
    current_ = {span->t0, span->t1, &medium_};
    return &current_;
  }
  void pop() override { stream.pop(); }

 private:
  volume::Medium medium_;
  volume::MediumSpan current_;
};

void overlap(benchmark::State& state, Arrangement arrangement, accel::OverlapDesign design, bool isWhole) {
  const Setting setting = make(arrangement, static_cast<int>(state.range(0)), design);
  accel::SpanBuffer spans;
  accel::Counters counters;
  Source source;
  volume::SegmentStream segments;
  std::size_t count = 0, media = 0;
  for (auto _ : state) {
    for (const Ray<World>& ray : setting.rays) {
      static_cast<void>(setting.scene.closestHit(ray, spans, counters));
      if (design == accel::OverlapDesign::split) {
        source.stream.begin(spans);
      } else {
        source.stream.begin(setting.scene, ray, 0, 1e30, counters);
      }
      segments.begin(source);
      volume::Segment segment;
      while (segments.next(segment)) {
        ++count;
        media += segment.media.size();
        if (!isWhole) break;
      }
    }
  }
  benchmark::DoNotOptimize(media);
  const auto rays = static_cast<double>(state.iterations()) * static_cast<double>(setting.rays.size());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(setting.rays.size()));
  state.counters["ns_per_ray"] =
      benchmark::Counter(rays * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["segments"] = static_cast<double>(count) / rays;
}

#define AEROSOL_OVERLAP(arrangement)                                                                                   \
  BENCHMARK_CAPTURE(overlap, arrangement##_split_whole, Arrangement::arrangement, accel::OverlapDesign::split, true)   \
      ->Arg(1)                                                                                                         \
      ->Arg(10)                                                                                                        \
      ->Arg(100)                                                                                                       \
      ->Arg(500)                                                                                                       \
      ->Arg(2000);                                                                                                     \
  BENCHMARK_CAPTURE(overlap, arrangement##_partition_whole, Arrangement::arrangement, accel::OverlapDesign::partition, \
                    true)                                                                                              \
      ->Arg(1)                                                                                                         \
      ->Arg(10)                                                                                                        \
      ->Arg(100)                                                                                                       \
      ->Arg(500)                                                                                                       \
      ->Arg(2000);                                                                                                     \
  BENCHMARK_CAPTURE(overlap, arrangement##_split_first, Arrangement::arrangement, accel::OverlapDesign::split, false)  \
      ->Arg(1)                                                                                                         \
      ->Arg(10)                                                                                                        \
      ->Arg(100)                                                                                                       \
      ->Arg(500)                                                                                                       \
      ->Arg(2000);                                                                                                     \
  BENCHMARK_CAPTURE(overlap, arrangement##_partition_first, Arrangement::arrangement, accel::OverlapDesign::partition, \
                    false)                                                                                             \
      ->Arg(1)                                                                                                         \
      ->Arg(10)                                                                                                        \
      ->Arg(100)                                                                                                       \
      ->Arg(500)                                                                                                       \
      ->Arg(2000)

AEROSOL_OVERLAP(heap);
AEROSOL_OVERLAP(row);
AEROSOL_OVERLAP(plain);

}  // namespace

}  // namespace aerosol::bench
