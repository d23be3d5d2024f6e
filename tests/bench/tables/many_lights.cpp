// Very many lights, as printed tables: what the hierarchy costs to build and to ask, its noise beside that of a choice
// in proportion to power, what splitting clusters gains at equal time, and what it is worth that media which glow are
// lights.
//
//   many_lights [POINT_LIGHTS [TRIANGLES [SAMPLES]]]
//
// Variances are of one sample, relative to the square of the mean; times are of one thread. `gain` is the product of
// both, of the first row over that of the row.

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "core/render/light_set.h"
#include "core/render/registry.h"
#include "plugins/registration.h"
#include "tests/statistical/statistics.h"
#include "tests/support/rendering.h"

namespace {

using namespace aerosol;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Lamps over a plane as in a town: in streets, of strengths over two orders of magnitude.
struct Lamp {
  Point<World> place;
  float intensity = 0;
};
std::vector<Lamp> town(int count) {
  test::Uniforms random(1);
  std::vector<Lamp> lamps;
  for (int i = 0; i < count; ++i) {
    const float along = 20 * random.next() - 10, street = std::floor(20 * random.next()) - 9.5f;
    const bool isAcross = random.next() < 0.5f;
    lamps.push_back(
        {{isAcross ? along : street, 0.05f + 0.4f * random.next() * random.next(), isAcross ? street : along},
         std::exp(4.6f * random.next())});
  }
  return lamps;
}

/// A field of waves, every triangle of which shines.
accel::TriangleMesh waves(int triangles) {
  accel::TriangleMesh mesh;
  const int n = std::max(1, static_cast<int>(std::sqrt(triangles / 2)));
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const float x = 4 * static_cast<float>(i) / static_cast<float>(n) - 2,
                  y = 4 * static_cast<float>(j) / static_cast<float>(n) - 2;
      mesh.positions.push_back({x, 0.2f * std::sin(6 * x) * std::cos(5 * y), y});
    }
  }
  const auto row = static_cast<std::uint32_t>(n + 1);
  for (std::uint32_t i = 0; i + 1 < row; ++i) {
    for (std::uint32_t j = 0; j + 1 < row; ++j) {
      const std::uint32_t a = i * row + j;
      mesh.triangles.push_back({a, a + 1, a + row});
      mesh.triangles.push_back({a + 1, a + row + 1, a + row});
    }
  }
  return mesh;
}

void printChoice(const char* name, const test::RunningMean& values, double seconds, double& first) {
  const double variance = values.variance() / (values.mean() * values.mean());
  const double cost = variance * seconds;
  if (!(first > 0)) first = cost;
  fmt::print("  {:<44}{:>12.4g}{:>12.3g}{:>11.0f} ns{:>10.1f}\n", name, values.mean(), variance,
             1e9 * seconds / static_cast<double>(values.count()), first / cost);
}

/// One sample after another; `sample(u)` gives its estimate of the irradiance.
template <class Sample>
void measureChoice(const char* name, int samples, double& first, const Sample& sample) {
  test::Uniforms random(2);
  test::RunningMean values;
  const auto start = Clock::now();
  for (int i = 0; i < samples; ++i) values.add(sample(random));
  printChoice(name, values, secondsSince(start), first);
}

void choiceHeader(const std::string& what) {
  fmt::print("\n{}\n  {:<44}{:>12}{:>12}{:>14}{:>10}\n", what, "", "mean", "variance", "a sample", "gain");
}

void comparePoints(const render::Registry& registry, const std::vector<Lamp>& lamps, int samples) {
  std::vector<std::unique_ptr<const render::Light>> lights;
  std::vector<double> cumulative;
  for (const Lamp& lamp : lamps) {
    const Point<scene::Unplaced> p(lamp.place.x, lamp.place.y, lamp.place.z);
    lights.push_back(
        std::move(*makeLight(registry, "point", {{"intensity", Color(lamp.intensity)}, {"position", p}}, nullptr)));
    cumulative.push_back((cumulative.empty() ? 0 : cumulative.back()) + static_cast<double>(lamp.intensity));
  }
  const auto start = Clock::now();
  const render::LightSet set(std::move(lights), 20);
  fmt::print("\n{} point lights: hierarchy of {:.1f} MB built in {:.1f} ms\n", lamps.size(),
             1e-6 * static_cast<double>(set.tree().bytes()), 1e3 * secondsSince(start));
  for (const auto& [name, from] : {std::pair{"in a street", Point<World>(0.5f, 0.01f, 2)},
                                   {"between streets", Point<World>(3.1f, 0.01f, -2)},
                                   {"high above", Point<World>(0, 15, 0)}}) {
    choiceHeader(fmt::format("light that arrives {}, nothing in between", name));
    double first = 0;
    measureChoice("in proportion to power", samples, first, [&](test::Uniforms& random) {
      const double mass = static_cast<double>(random.next()) * cumulative.back();
      const auto i =
          static_cast<std::size_t>(std::upper_bound(cumulative.begin(), cumulative.end(), mass) - cumulative.begin());
      return cumulative.back() / static_cast<double>(squaredLength(lamps[std::min(i, lamps.size() - 1)].place - from));
    });
    for (const float threshold : {render::neverSplit, 0.5f, 0.25f, 0.1f}) {
      const std::string how = std::isinf(threshold) ? "the hierarchy" : fmt::format("split at {}", threshold);
      measureChoice(how.c_str(), samples, first, [&](test::Uniforms& random) {
        const auto picks = set.pick(from, random.next(), threshold);
        double sum = 0;
        for (std::size_t k = 0; k < picks.count; ++k) {
          const auto choice = set.choose(picks, k, from);
          const auto sample = choice ? set.sample(choice->id(), from, {}) : std::nullopt;
          if (sample) sum += static_cast<double>(sample->value.g / (sample->pdf * choice->probability));
        }
        return sum;
      });
    }
  }
}

void compareMesh(const render::Registry& registry, int triangles, int samples) {
  accel::SceneBuilder builder;
  if (!builder.addMesh(waves(triangles))) std::exit(1);
  const auto scene = builder.build();
  const auto surfaceStart = Clock::now();
  std::shared_ptr<const render::LightSurface> surface = render::makeMeshLight(*scene->mesh(0));
  const double surfaceSeconds = secondsSince(surfaceStart);
  const auto alone = makeLight(registry, "area", {}, surface);
  std::vector<std::unique_ptr<const render::Light>> lights;
  lights.push_back(std::move(*makeLight(registry, "area", {}, surface)));
  const auto start = Clock::now();
  const render::LightSet set(std::move(lights), 4);
  fmt::print("\na mesh of {} triangles that shine: areas in {:.0f} ms, hierarchy of {:.1f} MB in {:.0f} ms\n",
             scene->mesh(0)->triangles.size(), 1e3 * surfaceSeconds, 1e-6 * static_cast<double>(set.tree().bytes()),
             1e3 * secondsSince(start));
  for (const auto& [name, from] :
       {std::pair{"close to it", Point<World>(0.3f, 0.3f, 0.1f)}, {"at some distance", Point<World>(0.5f, 2, -0.4f)}}) {
    choiceHeader(fmt::format("light that arrives {}", name));
    double first = 0;
    const auto value = [](const std::optional<render::LightSample>& s) {
      return s ? static_cast<double>(s->value.g / s->pdf) : 0.0;
    };
    measureChoice("in proportion to power", samples, first, [&](test::Uniforms& random) {
      const float u = random.next();
      return value((*alone)->sample(from, {u, random.next2D()}));
    });
    measureChoice("the hierarchy", samples, first, [&](test::Uniforms& random) {
      const float u = random.next(), choice = random.next();
      return value(set.sample(from, u, {choice, random.next2D()}));
    });
  }
}

struct Rendered {
  double mean = 0, variance = 0, seconds = 0;
};

Rendered render(const std::string& integrator, const std::string& content, const test::TestSensor& sensor,
                std::uint32_t samples) {
  const test::TestScene scene(test::sceneXml(integrator, sensor, content),
                              {.shaderFolder = AEROSOL_SOURCE_DIR "/tests/bench/equal_time/shaders"});
  if (!scene.scene()) std::exit(1);
  auto film = scene.film();
  const render::RenderReport report = scene.renderInto(*film, {.threads = 1, .endSample = samples});
  Rendered result{.seconds = report.seconds};
  const render::PixelRect area = film->area();
  double squares = 0;
  const auto pixels = static_cast<double>(area.pixelCount());
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const render::PixelEstimate p = film->estimate(x, y);
      result.mean += static_cast<double>(p.color.g) / pixels;
      result.variance += std::pow(static_cast<double>(p.standardError.g), 2) * samples / pixels;
      squares += std::pow(static_cast<double>(p.color.g), 2) / pixels;
    }
  }
  result.variance /= squares;
  return result;
}

void compareRenders(const std::string& what, const std::string& content, const test::TestSensor& sensor,
                    std::uint32_t samples, const std::vector<std::pair<std::string, std::string>>& ways) {
  fmt::print("\n{}\n  {:<44}{:>12}{:>12}{:>12}{:>10}\n", what, "", "mean", "variance", "seconds", "gain");
  double first = 0;
  for (const auto& [name, integrator] : ways) {
    const Rendered r = render(integrator, content, sensor, samples);
    const double cost = r.variance * r.seconds;
    if (!(first > 0)) first = cost;
    fmt::print("  {:<44}{:>12.4g}{:>12.3g}{:>12.3f}{:>10.2f}\n", name, r.mean, r.variance, r.seconds, first / cost);
    std::fflush(stdout);
  }
}

std::vector<std::pair<std::string, std::string>> thresholds(const std::string& depth) {
  std::vector<std::pair<std::string, std::string>> ways;
  for (const char* threshold : {"0", "1", "0.5", "0.25", "0.1", "0.05"}) {
    ways.emplace_back(fmt::format("split at {}", threshold),
                      depth + fmt::format(R"(<float name="split_lights" value="{}"/>)", threshold));
  }
  return ways;
}

void compareSplitting(const std::vector<Lamp>& lamps, std::uint32_t samples) {
  std::string lights;
  for (const Lamp& lamp : lamps) {
    lights += fmt::format(R"(<emitter type="point"><point name="position" x="{}" y="{}" z="{}"/>
        <rgb name="intensity" value="{}"/></emitter>)",
                          lamp.place.x, lamp.place.y, lamp.place.z, 1e-3f * lamp.intensity);
  }
  const std::string ground = R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
      <scale value="12"/></transform><bsdf type="diffuse"/></shape>)";
  std::string houses;
  for (int i = 0; i < 81; ++i) {
    houses += fmt::format(R"(<shape type="cube"><transform name="to_world"><scale x="0.3" y="{}" z="0.3"/>
        <translate x="{}" z="{}"/></transform><bsdf type="diffuse"/></shape>)",
                          0.2 + 0.05 * (i % 7), i / 9 - 4, i % 9 - 4);
  }
  const std::string haze = R"(<volume type="box"><transform name="to_world"><scale x="11" y="1" z="11"/></transform>
      <medium type="homogeneous"><rgb name="sigma_t" value="0.15"/><rgb name="albedo" value="0.9"/></medium></volume>)";
  const test::TestSensor sensor{.origin = "0, 6, -9", .target = "0, 0, 0", .fov = 50, .width = 48, .height = 32};
  const auto depth = [](int n) { return fmt::format(R"(<integer name="max_depth" value="{}"/>)", n); };
  const std::string count = fmt::format("{} lamps in a town", lamps.size());
  compareRenders(count + ", direct light", lights + ground + houses, sensor, samples, thresholds(depth(2)));
  compareRenders(count + ", up to 6 segments", lights + ground + houses, sensor, samples, thresholds(depth(6)));
  compareRenders(count + ", in haze", lights + ground + houses + haze, sensor, samples, thresholds(depth(4)));
}

void compareGlow(std::uint32_t samples) {
  const auto wall = [](const char* turn, const char* move) {
    return fmt::format(
        R"(<shape type="rectangle"><transform name="to_world">{}<scale value="2"/><translate {}/></transform>
        <bsdf type="diffuse"/></shape>)",
        turn, move);
  };
  const std::string room =
      wall(R"(<rotate x="1" angle="-90"/>)", R"(y="-2")") + wall(R"(<rotate x="1" angle="90"/>)", R"(y="2")") +
      wall(R"(<rotate y="1" angle="180"/>)", R"(z="2")") + wall(R"(<rotate y="1" angle="90"/>)", R"(x="-2")") +
      wall(R"(<rotate y="1" angle="-90"/>)", R"(x="2")");
  const std::string fire = R"(<volume type="sphere"><transform name="to_world"><scale value="0.4"/>
      <translate y="-1.5" x="0.3"/></transform><medium type="glowing_wisps"/></volume>)";
  const test::TestSensor sensor{.origin = "0, 0.3, -1.9", .target = "0, 0.3, 2", .fov = 60, .width = 48, .height = 32};
  const std::string depth = R"(<integer name="max_depth" value="5"/>)";
  compareRenders(
      "a fire that lights a room", room + fire, sensor, samples,
      {{"met by chance", depth + R"(<boolean name="volume_lights" value="false"/>)"}, {"sampled as a light", depth}});
}

}  // namespace

int main(int count, char** arguments) {
  const auto number = [&](int i, long otherwise) {
    return static_cast<int>(count > i ? std::max(2l, std::strtol(arguments[i], nullptr, 10)) : otherwise);
  };
  const int points = number(1, 10000), triangles = number(2, 1000000), samples = number(3, 64);
  render::Registry registry;
  render::registerPlugins(registry);
  const std::vector<Lamp> lamps = town(points);
  comparePoints(registry, lamps, 200000);
  compareMesh(registry, triangles, 100000);
  compareSplitting(lamps, static_cast<std::uint32_t>(samples));
  compareGlow(static_cast<std::uint32_t>(samples));
}
