#include "tests/bench/equal_time/scenes.h"

#include <fmt/format.h>

#include <cmath>

#include "core/base/random.h"

namespace aerosol::bench {

namespace {

std::string word(const char* parameter, const char* value) {
  return fmt::format(R"(<string name="{}" value="{}"/>)", parameter, value);
}
std::string steps(double scale) { return fmt::format(R"(<float name="step_scale" value="{}"/>)", scale); }
const std::string plainRoulette = word("roulette", "throughput");
const std::string noEquiangular = R"(<boolean name="equiangular" value="false"/>)";

const std::string sunAndSky = R"(
  <emitter type="constant"><rgb name="radiance" value="0.3, 0.4, 0.6"/></emitter>
  <emitter type="directional"><vector name="direction" x="-0.6" y="-1" z="0.3"/>
    <rgb name="irradiance" value="4, 3.7, 3.2"/></emitter>)";

/// 200 balls of four kinds of media that overlap by the dozen, at places of a counter-based sequence.
std::string manyElements() {
  std::string xml = sunAndSky;
  const auto number = [](std::uint32_t i, std::uint32_t k) { return static_cast<double>(randomFloat(200, i, k)); };
  for (std::uint32_t i = 0; i < 200; ++i) {
    const double size = 0.12 + 0.3 * number(i, 0);
    const auto at = [&](std::uint32_t axis) { return 1.6 * number(i, axis) - 0.8; };
    const std::string place =
        fmt::format(R"(<transform name="to_world"><scale value="{:.4f}"/><translate x="{:.4f}" y="{:.4f}"
          z="{:.4f}"/></transform>)",
                    size, at(1), 0.7 * at(2), at(3));
    constexpr const char* kinds[] = {"cumulus", "pyroclastic", "wisps", "homogeneous"};
    const char* const kind = kinds[i % 4];
    const std::string density = i % 4 == 3 ? R"(<rgb name="sigma_t" value="0.6"/>)"
                                           : fmt::format(R"(<float name="density" value="{:.2f}"/>)", 4 / size);
    xml += fmt::format(R"(<volume type="sphere">{}<medium type="{}">{}</medium></volume>)", place, kind, density);
  }
  return xml;
}

}  // namespace

const std::vector<Method>& allMethods() {
  static const std::vector<Method> methods{
      {automaticName, ""},
      {"roulette by throughput", plainRoulette},
      {"no directions towards lamps", R"(<boolean name="lamp_directions" value="false"/>)"},
      {"null scattering", word("distance", "null")},
      {"null scattering, relaxed bounds", word("distance", "relaxed")},
      {"decomposition tracking", word("distance", "decomposition")},
      {"null scattering, lists of candidates", word("distance", "candidates")},
      {"null scattering, unbiased marching to lights", word("distance", "null") + word("transmittance", "unbiased")},
      {"null scattering, two combs to lights", word("distance", "null") + word("transmittance", "two_combs")},
      {"null scattering, no equiangular", word("distance", "null") + noEquiangular},
      {"marching", word("distance", "marching")},
      {"marching, steps of 4", word("distance", "marching") + steps(4)},
      {"marching, ratio tracking to lights", word("distance", "marching") + word("transmittance", "ratio")},
      {simplestName, word("distance", "delta") + word("transmittance", "ratio") + noEquiangular + plainRoulette},
      {"simplest, delta tracking to lights",
       word("distance", "delta") + word("transmittance", "delta") + noEquiangular + plainRoulette},
  };
  return methods;
}

Method firstReference(const BenchScene& scene) {
  return {"null scattering", scene.varies ? word("distance", "null") : std::string()};
}

Method secondReference(const BenchScene& scene) {
  if (!scene.varies) return {"no distances chosen for lights", noEquiangular};
  return {"marching, quarter steps, two combs to lights",
          word("distance", "marching") + word("transmittance", "two_combs") + steps(0.25)};
}

std::vector<BenchScene> allScenes(const std::filesystem::path& voxels) {
  const auto depth = [](int n) { return fmt::format(R"(<integer name="max_depth" value="{}"/>)", n); };
  const std::string cloud = R"(<float name="density" value="40"/><rgb name="albedo" value="0.999"/>)";
  std::vector<BenchScene> scenes;
  // Seen by the camera itself, the lamp's edge would be all that varies.
  scenes.push_back({.name = "embedded light",
                    .integrator = depth(16) + R"(<boolean name="hide_emitters" value="true"/>)",
                    .content = R"(
  <shape type="sphere"><point name="center" x="0.1" y="0.3" z="-0.2"/><float name="radius" value="0.01"/>
    <bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="5000"/></emitter></shape>
  <volume type="sphere"><medium type="homogeneous"><rgb name="sigma_t" value="1.5"/>
    <rgb name="albedo" value="0.8"/></medium></volume>)",
                    .varies = false});
  scenes.push_back(
      {.name = "dense cloud",
       .integrator = depth(100),
       .content = sunAndSky + R"(<volume type="sphere"><medium type="cumulus">)" + cloud + "</medium></volume>"});
  scenes.push_back({.name = "dense cloud in voxels",
                    .integrator = depth(100),
                    .content = sunAndSky + fmt::format(R"(<volume type="grid"><string name="filename" value="{0}"/>
    <medium type="baked"><string name="filename" value="{0}"/><float name="g" value="0.6"/>
    <rgb name="albedo" value="0.999"/></medium></volume>)",
                                                       voxels.string())});
  scenes.push_back({.name = "emissive wisps",
                    .integrator = depth(8),
                    .content = R"(<volume type="sphere"><medium type="glowing_wisps"/></volume>
  <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/>
    <translate y="-1"/></transform><bsdf type="diffuse"/></shape>)"});
  scenes.push_back({.name = "200 elements", .integrator = depth(16), .content = manyElements()});
  scenes.push_back({.name = "subsurface slab",
                    .integrator = depth(100),
                    .content = R"(
  <emitter type="constant"><rgb name="radiance" value="0.4"/></emitter>
  <emitter type="point"><point name="position" x="1" y="1.5" z="-2.5"/><rgb name="intensity" value="12"/></emitter>
  <shape type="cube"><transform name="to_world"><scale x="0.9" y="0.6" z="0.25"/><rotate y="1" angle="25"/></transform>
    <bsdf type="null"/><medium name="interior" type="homogeneous"><rgb name="sigma_t" value="6, 18, 40"/>
    <rgb name="albedo" value="0.998, 0.98, 0.9"/></medium></shape>)",
                    .varies = false});
  return scenes;
}

}  // namespace aerosol::bench
