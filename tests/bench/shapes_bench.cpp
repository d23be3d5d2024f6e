// Spans a second for each volume primitive: lines through its bounds against its exact shape.
#include <benchmark/benchmark.h>

#include <random>

#include "core/render/registry.h"
#include "core/render/scene_services.h"
#include "plugins/registration.h"

namespace aerosol::bench {

namespace {

class Counter final : public accel::IntervalSink {
 public:
  void add(const accel::Interval& interval) override {
    ++count;
    length += interval.t1 - interval.t0;
  }
  std::int64_t count = 0;
  double length = 0;
};

/// The primitive with its defaults, and the mesh and voxel file of the scenes.
std::unique_ptr<const accel::VolumeShape> make(const std::string& type) {
  render::Registry registry;
  render::registerPlugins(registry);
  scene::Volume volume;
  volume.type = type;
  for (const scene::ParameterSpec& spec : registry.volume(type)->described.parameters) {
    if (spec.name == "filename") {
      const std::string folder = AEROSOL_SOURCE_DIR "/scenes/";
      volume.parameters.push_back({spec.name, folder + (type == "grid" ? "cloud.vdb" : "meshes/knot.ply")});
    } else if (spec.defaultValue) {
      volume.parameters.push_back({spec.name, *spec.defaultValue});
    }
  }
  const auto services = render::makeServices({{}, 16});
  Diagnostics warnings;
  auto made = registry.volume(type)->make({volume, registry.volume(type)->place(volume), {}, warnings, services.get()});
  return made ? std::move(*made) : nullptr;
}

void spans(benchmark::State& state, const char* type) {
  const auto shape = make(type);
  if (!shape) return state.SkipWithError("the primitive cannot be made");
  const Box<World> bounds = shape->worldBounds();
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<Ray<World>> rays(4096);
  const auto inside = [&] {
    Point<World> p;
    for (int i = 0; i < 3; ++i) p[i] = bounds.lower[i] + uniform(random) * (bounds.upper[i] - bounds.lower[i]);
    return p;
  };
  for (Ray<World>& ray : rays) {
    const Point<World> a = inside(), b = inside();
    ray.direction = normalize(b - a);
    ray.origin = a - 3.0f * (b - a);
  }
  Counter counter;
  for (auto _ : state) {
    for (const Ray<World>& ray : rays) shape->intersect(ray, counter);
  }
  benchmark::DoNotOptimize(counter.length);
  state.SetItemsProcessed(counter.count);
  state.counters["spans_per_ray"] =
      static_cast<double>(counter.count) / (static_cast<double>(state.iterations()) * static_cast<double>(rays.size()));
}

BENCHMARK_CAPTURE(spans, sphere, "sphere");
BENCHMARK_CAPTURE(spans, box, "box");
BENCHMARK_CAPTURE(spans, cylinder, "cylinder");
BENCHMARK_CAPTURE(spans, cone, "cone");
BENCHMARK_CAPTURE(spans, mesh, "mesh");
BENCHMARK_CAPTURE(spans, grid, "grid");

}  // namespace

}  // namespace aerosol::bench
