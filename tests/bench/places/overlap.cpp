// Time a ray takes to find its way through many volume primitives, by both designs: all spans sorted and split, and the
// walk through a partition of space. `whole` takes all segments; `first` stops at the first one, as a path does that
// scatters there.
//
// Arrangements: in a heap all elements overlap; in a row they stand one behind the other, touching; apart, piles of
// five overlapping elements stand side by side, so that there are five under each ray however many there are.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "core/accel/span_stream.h"
#include "core/volume/segment_stream.h"
#include "tests/bench/places/tables.h"

namespace aerosol::bench {

namespace {

enum class Arrangement : std::uint8_t { heap, row, apart };
constexpr int pile = 5;

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
  const int piles = (count + pile - 1) / pile;
  const int side = static_cast<int>(std::ceil(std::sqrt(piles)));
  const auto placeOf = [&](int number) { return std::pair{9 * (number % side), 9 * (number / side)}; };
  for (int i = 0; i < count; ++i) {
    Transform<World, Object> place;
    if (arrangement == Arrangement::heap) place = at(uniform(random), uniform(random), uniform(random), 3);
    if (arrangement == Arrangement::row) place = at(0, 0, 6 + 6 * i, 3);
    if (arrangement == Arrangement::apart) {
      const auto [x, y] = placeOf(i / pile);
      place = at(x + 0.3 * uniform(random), y + 0.3 * uniform(random), uniform(random), 3);
    }
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
  // Of a heap the segments and the media of each grow with the count.
  const int rays = arrangement == Arrangement::heap && count > 100 ? 32 : 1024;
  for (int i = 0; i < rays; ++i) {
    Ray<World> ray;
    if (arrangement == Arrangement::apart) {
      const auto [x, y] = placeOf(static_cast<int>(random() % static_cast<unsigned>(piles)));
      ray.origin = {static_cast<float>(x + uniform(random)), static_cast<float>(y + uniform(random)), -9};
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

class Walk {
 public:
  Walk(Arrangement arrangement, int count, accel::OverlapDesign design, bool isWhole)
      : setting_(make(arrangement, count, design)), design_(design), isWhole_(isWhole) {}

  void operator()() {
    segments_ = 0;
    for (const Ray<World>& ray : setting_.rays) {
      static_cast<void>(setting_.scene.closestHit(ray, spans_, counters_));
      if (design_ == accel::OverlapDesign::split) {
        source_.stream.begin(spans_);
      } else {
        source_.stream.begin(setting_.scene, ray, 0, 1e30, counters_);
      }
      stream_.begin(source_);
      volume::Segment segment;
      while (stream_.next(segment)) {
        ++segments_;
        if (!isWhole_) break;
      }
    }
  }

  double rays() const { return static_cast<double>(setting_.rays.size()); }
  double segmentsPerRay() const { return static_cast<double>(segments_) / rays(); }

 private:
  Setting setting_;
  accel::OverlapDesign design_;
  bool isWhole_;
  accel::SpanBuffer spans_;
  accel::Counters counters_;
  Source source_;
  volume::SegmentStream stream_;
  std::size_t segments_ = 0;
};

constexpr std::array counts{1, 10, 100, 500, 2000};
using accel::OverlapDesign;

/// Nanoseconds a ray for split and partition, whole and first.
std::array<double, 4> printRow(Arrangement arrangement, int count) {
  std::vector<std::unique_ptr<Walk>> walks;
  std::vector<std::function<void()>> works;
  for (const bool isWhole : {true, false}) {
    for (const OverlapDesign design : {OverlapDesign::split, OverlapDesign::partition}) {
      walks.push_back(std::make_unique<Walk>(arrangement, count, design, isWhole));
      works.emplace_back(std::ref(*walks.back()));
    }
  }
  const std::vector<double> seconds = medianSeconds(works, count < 500 ? 15 : 7);
  std::array<double, 4> times{};
  for (std::size_t i = 0; i < 4; ++i) times[i] = 1e9 * seconds[i] / walks[i]->rays();
  fmt::print("    {:>6}{:>14.1f}{:>14.0f}{:>14.0f}{:>14.0f}{:>14.0f}\n", count, walks[0]->segmentsPerRay(), times[0],
             times[1], times[2], times[3]);
  return times;
}

}  // namespace

void printOverlap() {
  fmt::print("\nMany primitives: nanoseconds a ray\n");
  for (const auto& [arrangement, name] :
       {std::pair{Arrangement::heap, "all overlap"}, std::pair{Arrangement::row, "disjoint, one behind the other"},
        std::pair{Arrangement::apart, "side by side, five under each ray"}}) {
    fmt::print("  {}\n    {:>6}{:>14}{:>14}{:>14}{:>14}{:>14}\n", name, "", "segments", "split", "partition",
               "split, first", "part., first");
    std::vector<std::array<double, 4>> rows;
    for (const int count : counts) rows.push_back(printRow(arrangement, count));
    if (arrangement != Arrangement::apart) continue;
    fmt::print("    growth from 10 elements on; the logarithm's own is in brackets\n");
    for (std::size_t i = 2; i < counts.size(); ++i) {
      fmt::print("    {:>6}{:>14}", counts[i], fmt::format("({:.2f})", std::log(counts[i]) / std::log(10.0)));
      for (std::size_t k = 0; k < 4; ++k) fmt::print("{:>14.2f}", rows[i][k] / rows[1][k]);
      fmt::print("\n");
    }
  }
}

}  // namespace aerosol::bench
