#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "core/render/registry.h"
#include "core/scene/tables.h"
#include "plugins/registration.h"
#include "tests/render/film_checks.h"

// Every pair of kinds of distance sampling, transmittance, phase function and light in one render at least, with
// distances chosen for the light, against null scattering without that choice in the same voxels.

namespace aerosol::test {
namespace {

struct Kind {
  std::string name, xml;
};

std::string word(const char* parameter, std::string_view value) {
  return fmt::format(R"(<string name="{}" value="{}"/>)", parameter, value);
}

template <class E>
std::vector<Kind> wordsOf(const char* parameter) {
  std::vector<Kind> kinds;
  for (const char* each : scene::Words<E>::words) kinds.push_back({each, word(parameter, each)});
  return kinds;
}

std::vector<Kind> phases() {
  const std::map<std::string, std::string> parameters{
      {"hg", R"(<float name="g" value="0.6"/>)"},
      {"draine", R"(<float name="g" value="0.4"/><float name="alpha" value="2"/>)"},
      {"mie", R"(<float name="particle_diameter" value="0.05"/>)"},
      {"tabphase", R"(<string name="values" value="0.5, 1, 2"/>)"},
      {"blendphase", R"(<float name="weight" value="0.4"/><phase type="rayleigh"/><phase type="hg"/>)"}};
  std::vector<Kind> kinds;
  for (const scene::TypeTable<scene::Phase>& table : scene::phaseTypes()) {
    const std::string& type = table.type;
    const auto found = parameters.find(type);
    const std::string inside = found == parameters.end() ? "" : found->second;
    kinds.push_back({type, fmt::format(R"(<phase type="{}">{}</phase>)", type, inside)});
  }
  return kinds;
}

/// A new type of light is tested by a line here. Environment images need a file: they have tests of their own.
const std::map<std::string, std::string>& lightElements() {
  static const std::map<std::string, std::string> elements{
      {"point", R"(<emitter type="point"><point name="position" x="0.3" y="0.9" z="-0.6"/>
          <rgb name="intensity" value="2"/></emitter>)"},
      {"spot", R"(<emitter type="spot"><transform name="to_world"><lookat origin="0.3, 1.4, -0.6" target="0, 0, 0"
          up="1, 0, 0"/></transform><rgb name="intensity" value="4"/></emitter>)"},
      {"constant", R"(<emitter type="constant"/>)"},
      {"directional", R"(<emitter type="directional"><vector name="direction" x="-0.5" y="-1" z="0.4"/>
          <rgb name="irradiance" value="2"/></emitter>)"},
      {"area", R"(<shape type="rectangle"><transform name="to_world"><scale value="0.6"/><rotate x="1" angle="90"/>
          <translate y="1.3"/></transform><emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>)"},
      {"projector", R"(<emitter type="projector"><float name="fov" value="50"/><transform name="to_world">
          <lookat origin="0.3, 1.4, -0.6" target="0, 0, 0" up="1, 0, 0"/></transform>
          <rgb name="irradiance" value="4"/></emitter>)"},
      {"sunsky", R"(<emitter type="sunsky"><vector name="sun_direction" x="0.5" y="-0.4" z="1"/>
          <float name="sun_scale" value="0"/><float name="sky_scale" value="40"/></emitter>)"}};
  return elements;
}

std::vector<Kind> lights() {
  std::vector<Kind> kinds;
  render::Registry registry;
  render::registerPlugins(registry);
  for (const render::LightType& type : registry.lights()) {
    const auto found = lightElements().find(type.name);
    if (found != lightElements().end()) kinds.push_back({type.name, found->second});
  }
  kinds.push_back({"sphere", R"(<shape type="sphere"><point name="center" x="0.2" y="0.8" z="-0.5"/>
      <float name="radius" value="0.1"/><emitter type="area"><rgb name="radiance" value="40"/></emitter></shape>)"});
  kinds.push_back({"glow", R"(<volume type="sphere"><transform name="to_world"><scale value="0.4"/>
      <translate y="1.2"/></transform><medium type="ramp"><float name="at_zero" value="0.2"/><rgb name="glow" value="3"/></medium></volume>)"});
  return kinds;
}

constexpr std::size_t factorCount = 4;
using Combination = std::array<std::size_t, factorCount>;

const std::array<std::vector<Kind>, factorCount>& factors() {
  static const std::array<std::vector<Kind>, factorCount> all{wordsOf<scene::DistanceSampling>("distance"),
                                                              wordsOf<scene::TransmittanceSampling>("transmittance"),
                                                              phases(), lights()};
  return all;
}

using Pair = std::array<std::size_t, 4>;  ///< Factor, kind, factor, kind.

void forPairs(const Combination& c, const std::function<void(const Pair&)>& use) {
  for (std::size_t a = 0; a < factorCount; ++a) {
    for (std::size_t b = a + 1; b < factorCount; ++b) use({a, c[a], b, c[b]});
  }
}

/// Combinations in which all pairs occur: again and again the one of many that holds most of those still missing.
std::vector<Combination> pairwise() {
  std::set<Pair> missing;
  for (std::size_t a = 0; a < factorCount; ++a) {
    for (std::size_t b = a + 1; b < factorCount; ++b) {
      for (std::size_t i = 0; i < factors()[a].size(); ++i) {
        for (std::size_t j = 0; j < factors()[b].size(); ++j) missing.insert({a, i, b, j});
      }
    }
  }
  std::mt19937 random(1);
  std::vector<Combination> all;
  while (!missing.empty()) {
    Combination best{};
    int most = -1;
    for (int i = 0; i < 200; ++i) {
      Combination c;
      for (std::size_t f = 0; f < factorCount; ++f) c[f] = random() % factors()[f].size();
      const Pair& wanted = *missing.begin();
      c[wanted[0]] = wanted[1];
      c[wanted[2]] = wanted[3];
      int count = 0;
      forPairs(c, [&](const Pair& pair) { count += missing.contains(pair); });
      if (count > most) {
        most = count;
        best = c;
      }
    }
    forPairs(best, [&](const Pair& pair) { missing.erase(pair); });
    all.push_back(best);
  }
  return all;
}

const Kind& kindOf(const Combination& c, std::size_t factor) { return factors()[factor][c[factor]]; }

std::string nameOf(const Combination& c) {
  std::string name;
  for (std::size_t f = 0; f < factorCount; ++f) name += (f > 0 ? "_" : "") + kindOf(c, f).name;
  std::erase(name, '_');
  return name;
}

class Pairs : public ::testing::TestWithParam<Combination> {};

TEST_P(Pairs, HaveTheMeanOfNullScattering) {
  const std::string file = AEROSOL_SOURCE_DIR "/scenes/cloud.vdb";
  const auto scene = [&](const std::string& sampling, const std::string& integrator, int seed) {
    const std::string content = fmt::format(
        R"({}<volume type="grid"><string name="filename" value="{}"/><medium type="grid">
           <string name="filename" value="{}"/><float name="density" value="3"/><float name="step_size" value="0.03"/>
           <rgb name="albedo" value="0.9, 0.6, 0.3"/>{}{}</medium></volume>)",
        kindOf(GetParam(), 3).xml, file, file, kindOf(GetParam(), 2).xml, sampling);
    TestSensor sensor{.target = "0, -0.1, 0", .fov = 14, .width = 8, .height = 8, .seed = seed};
    return loadScene(R"(<integer name="max_depth" value="3"/><boolean name="hide_emitters" value="true"/>
                        <integer name="bound_boxes" value="4000"/>)" +
                         integrator,
                     sensor, content);
  };
  const TestScene tested = scene(kindOf(GetParam(), 0).xml + kindOf(GetParam(), 1).xml, "", 1);
  // What is tested has to differ from what it is tested against.
  const bool isNull = kindOf(GetParam(), 0).name == "null";
  const TestScene reference =
      scene(word("distance", isNull ? "analytic" : "null"), R"(<boolean name="equiangular" value="false"/>)", 2);
  ASSERT_TRUE(tested.scene() && reference.scene());
  EXPECT_TRUE(showTheSame(*tested.render(1024), *reference.render(1024), 0.04));
}

INSTANTIATE_TEST_SUITE_P(All, Pairs, ::testing::ValuesIn(pairwise()),
                         [](const auto& info) { return fmt::format("{}_{}", info.index, nameOf(info.param)); });

TEST(PairsTest, HoldAllPairsOfAllKinds) {
  std::set<Pair> pairs;
  for (const Combination& c : pairwise()) {
    forPairs(c, [&](const Pair& pair) { pairs.insert(pair); });
  }
  std::size_t expected = 0;
  for (std::size_t a = 0; a < factorCount; ++a) {
    for (std::size_t b = a + 1; b < factorCount; ++b) expected += factors()[a].size() * factors()[b].size();
  }
  EXPECT_EQ(pairs.size(), expected);
}

TEST(PairsTest, KnowAllLights) {
  render::Registry registry;
  render::registerPlugins(registry);
  for (const render::LightType& type : registry.lights()) {
    EXPECT_TRUE(type.name == "envmap" || lightElements().contains(type.name)) << type.name;
  }
}

}  // namespace
}  // namespace aerosol::test
