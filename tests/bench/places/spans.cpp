// Spans a second of each volume primitive: lines through its bounds against its exact shape.
#include <fmt/format.h>

#include <random>

#include "core/render/registry.h"
#include "core/render/scene_services.h"
#include "plugins/registration.h"
#include "tests/bench/places/tables.h"

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

struct Primitive {
  const char* name;
  const char* type;
  const char* file = "";
  std::int32_t overlayCells = 0;
};

/// With its defaults.
std::unique_ptr<const accel::VolumeShape> make(const Primitive& primitive, const render::Registry& registry,
                                               shading::Services& services) {
  scene::Volume volume;
  volume.type = primitive.type;
  const render::VolumeType& type = *registry.volume(volume.type);
  for (const scene::ParameterSpec& spec : type.described.parameters) {
    if (spec.name == "filename") {
      volume.parameters.push_back({spec.name, std::string(AEROSOL_SOURCE_DIR "/scenes/") + primitive.file});
    } else if (spec.name == "overlay_cells") {
      volume.parameters.push_back({spec.name, primitive.overlayCells});
    } else if (spec.defaultValue) {
      volume.parameters.push_back({spec.name, *spec.defaultValue});
    }
  }
  Diagnostics warnings;
  auto made = type.make({volume, type.place(volume), {}, warnings, &services});
  return made ? std::move(*made) : nullptr;
}

std::vector<Ray<World>> raysThrough(const Box<World>& bounds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  const auto inside = [&] {
    Point<World> p;
    for (int i = 0; i < 3; ++i) p[i] = bounds.lower[i] + uniform(random) * (bounds.upper[i] - bounds.lower[i]);
    return p;
  };
  std::vector<Ray<World>> rays(16384);
  for (Ray<World>& ray : rays) {
    const Point<World> a = inside(), b = inside();
    ray.direction = normalize(b - a);
    ray.origin = a - 3.0f * (b - a);
  }
  return rays;
}

}  // namespace

void printSpans() {
  render::Registry registry;
  render::registerPlugins(registry);
  const auto services = render::makeServices({{}, 16});
  const Primitive primitives[] = {{"sphere", "sphere"},
                                  {"box", "box"},
                                  {"cylinder", "cylinder"},
                                  {"cone", "cone"},
                                  {"mesh (2160 triangles)", "mesh", "meshes/knot.ply"},
                                  {"sparse grid", "grid", "cloud.vdb"},
                                  {"frustum grid, planes of blocks", "grid", "frustum_cloud.vdb"},
                                  {"frustum grid, 64 cells over it", "grid", "frustum_cloud.vdb", 64},
                                  {"curves in time", "grid", "flame.avt"}};
  fmt::print("\nSpans of one primitive\n  {:<34}{:>14}{:>12}{:>14}\n", "", "spans a line", "ns a line",
             "million spans/s");
  for (const Primitive& primitive : primitives) {
    const auto shape = make(primitive, registry, *services);
    if (!shape) {
      fmt::print("  {:<34}cannot be made\n", primitive.name);
      continue;
    }
    const std::vector<Ray<World>> rays = raysThrough(shape->worldBounds());
    Counter counter;
    const std::function<void()> work = [&] {
      counter.count = 0;
      for (const Ray<World>& ray : rays) shape->intersect(ray, counter);
    };
    const double seconds = medianSeconds({&work, 1})[0];
    const auto lines = static_cast<double>(rays.size()), spans = static_cast<double>(counter.count);
    fmt::print("  {:<34}{:>14.2f}{:>12.1f}{:>14.2f}\n", primitive.name, spans / lines, 1e9 * seconds / lines,
               1e-6 * spans / seconds);
  }
}

}  // namespace aerosol::bench
