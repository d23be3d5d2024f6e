// The comparisons of Kulla 2019 ("Path Tracing in Production – Volumes") as printed tables: ray marching with steps of
// 1 to 16 times, null scattering under exact and under relaxed bounds, and distances chosen for a light or not. Time,
// bias and variance stand apart.
//
//   talk_tables [SAMPLES [REFERENCE_SAMPLES]]
//
// The bias is the relative difference of the image's mean from a reference, of which one half comes from null
// scattering and one from fine ray marching; their difference is printed. The variance is that of one sample relative
// to the square of the mean, averaged over pixels. Times are of one thread.

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/support/rendering.h"

namespace {

using namespace aerosol;

struct Density {
  const char* name;
  const char* xml;
  const char* light;
};

constexpr const char* sun = R"(<emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>
    <emitter type="directional"><vector name="direction" x="-0.6" y="-1" z="0.3"/><rgb name="irradiance" value="4"/></emitter>)";

constexpr Density densities[] = {{"dense", R"(<volume type="sphere"><medium type="cumulus"/></volume>)", sun},
                                 {"thin features", R"(<volume type="sphere"><medium type="wisps"/></volume>)", sun},
                                 {"soft", R"(<volume type="sphere"><medium type="pyroclastic"/></volume>)", sun},
                                 {"thin fog", R"(<volume type="box"><medium type="ground_fog"/></volume>)", sun}};

/// The sums of an image that the tables show.
struct Measurement {
  double mean = 0, meanError = 0;  ///< Of all pixels' luminance (green).
  double variance = 0;             ///< Of one sample, relative.
  double seconds = 0, pointsPerSample = 0;
};

std::string scene(const Density& density, const std::string& integrator) {
  test::TestSensor sensor;
  sensor.fov = 26;
  sensor.width = 32;
  sensor.height = 24;
  return test::sceneXml(R"(<integer name="max_depth" value="4"/>)" + integrator, sensor,
                        std::string(density.light) + density.xml);
}

Measurement measure(const Density& density, const std::string& integrator, std::uint32_t samples) {
  const test::TestScene prepared(scene(density, integrator));
  auto film = prepared.film();
  const render::RenderReport report = prepared.renderInto(*film, {.threads = 1, .endSample = samples});
  Measurement m;
  double squares = 0, errors = 0;
  const render::PixelRect area = film->area();
  const auto pixels = static_cast<double>(area.pixelCount());
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const render::PixelEstimate p = film->estimate(x, y);
      const auto error = static_cast<double>(p.standardError.g);
      m.mean += static_cast<double>(p.color.g) / pixels;
      squares += std::pow(static_cast<double>(p.color.g), 2) / pixels;
      errors += error * error;
    }
  }
  m.meanError = std::sqrt(errors) / pixels;
  m.variance = errors / pixels * samples / squares;
  m.seconds = report.seconds;
  m.pointsPerSample =
      static_cast<double>(report.statistics.kernelPoints) / static_cast<double>(report.statistics.samples);
  return m;
}

void print(const char* name, const Measurement& m, const Measurement& reference) {
  fmt::print("  {:<34}{:>8.3f} s{:>9.1f}{:>11.2f} % ±{:>5.2f}{:>12.3g}{:>14.3g}\n", name, m.seconds, m.pointsPerSample,
             100 * (m.mean / reference.mean - 1), 100 * std::hypot(m.meanError, reference.meanError) / reference.mean,
             m.variance, m.variance * m.seconds);
}

void header(const char* title) {
  fmt::print("\n{}\n  {:<34}{:>10}{:>9}{:>20}{:>12}{:>14}\n", title, "", "time", "points", "bias", "variance",
             "variance·time");
}

std::string distance(const char* method, double scale) {
  return fmt::format(R"(<string name="distance" value="{}"/><float name="step_scale" value="{}"/>)", method, scale);
}

void compareMethods(const Density& density, std::uint32_t samples, std::uint32_t many) {
  const Measurement byNull = measure(density, distance("null", 1), many / 2);
  const Measurement byMarching = measure(density, distance("marching", 0.25), many / 2);
  Measurement reference = byNull;
  header(density.name);
  fmt::print("  (halves of the reference differ by {:.2f} % ± {:.2f})\n", 100 * (byMarching.mean / byNull.mean - 1),
             100 * std::hypot(byNull.meanError, byMarching.meanError) / byNull.mean);
  for (const int scale : {1, 2, 4, 8, 16}) {
    print(fmt::format("ray marching, step size {}×", scale).c_str(),
          measure(density, distance("marching", scale), samples), reference);
  }
  print("null scattering, exact bound", measure(density, distance("null", 1), samples), reference);
  print("null scattering, max(bound, 1/step)", measure(density, distance("relaxed", 1), samples), reference);
  for (const char* transmittance : {"two_combs", "unbiased"}) {
    const std::string way = fmt::format(R"(<string name="transmittance" value="{}"/>)", transmittance);
    print(fmt::format("null scattering, {} to lights", transmittance).c_str(),
          measure(density, distance("null", 1) + way, samples), reference);
  }
}

void compareLights(std::uint32_t samples, std::uint32_t many) {
  const std::string fog = R"(<volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="1.5"/>
      <rgb name="albedo" value="0.8"/></medium></volume>)";
  const std::string sphere = R"(<shape type="sphere"><point name="center" x="0.1" y="0.3" z="-0.2"/>
      <float name="radius" value="0.01"/><emitter type="area"><rgb name="radiance" value="5000"/></emitter></shape>)";
  const std::string rectangle = R"(<shape type="rectangle"><transform name="to_world"><scale value="0.2"/>
      <rotate y="1" angle="120"/><translate y="0.3"/></transform><emitter type="area"><rgb name="radiance" value="20"/>
      </emitter></shape>)";
  std::string lamps;
  for (int i = 0; i < 1000; ++i) {
    lamps += fmt::format(R"(<emitter type="point"><point name="position" x="{:.3f}" y="{:.3f}" z="{:.3f}"/>
        <rgb name="intensity" value="0.002"/></emitter>)",
                         -0.9 + 0.2 * (i % 10), -0.9 + 0.2 * (i / 10 % 10), -0.9 + 0.2 * (i / 100));
  }
  for (const auto& [name, light] : {std::pair<const char*, const std::string&>{"a sphere of 0.01 in fog", sphere},
                                    {"a rectangle of 0.2 in fog", rectangle},
                                    {"1000 points in fog", lamps}}) {
    const std::string xml = light + fog;
    const Density lit{name, xml.c_str(), ""};
    // Seen by the camera itself, the lamp's edge would be all that varies.
    const std::string hidden = R"(<boolean name="hide_emitters" value="true"/>)";
    const Measurement reference = measure(lit, hidden, many);
    header(name);
    print("transmittance alone", measure(lit, hidden + R"(<boolean name="equiangular" value="false"/>)", samples),
          reference);
    print("and distances for the light", measure(lit, hidden, samples), reference);
    print("and directions towards lamps left out",
          measure(lit, hidden + R"(<boolean name="lamp_directions" value="false"/>)", samples), reference);
    print("joint table of media and lights",
          measure(lit, hidden + R"(<boolean name="joint_lights" value="true"/>)", samples), reference);
  }
}

}  // namespace

int main(int count, char** arguments) {
  const auto number = [&](int i, long otherwise) {
    return static_cast<std::uint32_t>(count > i ? std::max(2l, std::strtol(arguments[i], nullptr, 10)) : otherwise);
  };
  const std::uint32_t samples = number(1, 64), many = number(2, 1024);
  fmt::print("{} samples a pixel, {} of the reference; points are shader points a sample\n", samples, many);
  for (const Density& density : densities) compareMethods(density, samples, many);
  compareLights(samples, many);
}
