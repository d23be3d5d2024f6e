#include "tests/hard_cases/random_scene.h"

#include <fmt/format.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>

#include "tests/render/film_checks.h"

namespace aerosol::test {

namespace {

using rc::gen::element;
using rc::gen::inRange;
using Kind = RandomScene::Kind;
using Thing = RandomScene::Thing;

double between(double low, double high) { return low + (high - low) * *inRange(0, 1000) / 999.0; }
bool oneIn(int count) { return *inRange(0, count) == count - 1; }

Thing makeThing(bool skyAlone, bool moves) {
  Thing thing;
  thing.kind = static_cast<Kind>(*inRange(0, static_cast<int>(Kind::count)));
  for (double& x : thing.place) x = between(-1, 1);
  for (double& x : thing.size) x = between(0.2, 1.2);
  if (moves && oneIn(2)) {
    for (double& x : thing.step) x = between(-0.5, 0.5);
  }
  thing.angle = between(0, 90);
  thing.extinction = *element(0.0, 0.1, 1.0, 5.0, 40.0);
  thing.albedo = *element(0.0, 0.5, 0.95, 1.0);
  thing.anisotropy = *element(-0.9, 0.0, 0.6, 0.99);
  thing.ior = *element(1.0, 1.33, 1.5);
  thing.glow = skyAlone || !oneIn(3) ? 0 : 0.5;
  thing.priority = *inRange(0, 3);
  thing.distance = *element<std::string>("marching", "null", "null", "relaxed", "delta");
  thing.transmittance = *element<std::string>("auto", "auto", "marching", "ratio", "two_combs", "unbiased", "delta");
  thing.material = *element<std::string>("diffuse", "conductor", "roughconductor", "plastic");
  return thing;
}

std::string triple(const std::array<double, 3>& p, double unit) {
  return fmt::format("{:.9g}, {:.9g}, {:.9g}", p[0] * unit, p[1] * unit, p[2] * unit);
}

std::string transform(const Thing& t, double unit, double time) {
  std::array<double, 3> place{};
  for (std::size_t i = 0; i < 3; ++i) place[i] = t.place[i] + time * t.step[i];
  return fmt::format(
      R"(<scale x="{:.9g}" y="{:.9g}" z="{:.9g}"/><rotate x="0.3" y="1" z="0.2" angle="{:.9g}"/><translate value="{}"/>)",
      t.size[0] * unit, t.size[1] * unit, t.size[2] * unit, t.angle, triple(place, unit));
}

std::string placement(const Thing& t, double unit) {
  const bool moves = std::any_of(t.step.begin(), t.step.end(), [](double x) { return x < 0 || x > 0; });
  if (!moves) return fmt::format("<transform name=\"to_world\">{}</transform>", transform(t, unit, 0));
  return fmt::format(
      R"(<animation name="to_world"><transform time="0">{}</transform><transform time="1">{}</transform></animation>)",
      transform(t, unit, 0), transform(t, unit, 1));
}

std::string constantMedium(const Thing& t, double unit, const char* name = "") {
  return fmt::format(
      R"(<medium type="homogeneous" {}><rgb name="sigma_t" value="{:.9g}, {:.9g}, {:.9g}"/>
      <rgb name="albedo" value="{:.9g}"/><float name="g" value="{:.9g}"/></medium>)",
      name, t.extinction / unit, 0.5 * t.extinction / unit, t.extinction / unit, t.albedo, t.anisotropy);
}

std::string varyingMedium(const Thing& t, double unit) {
  return fmt::format(
      R"(<medium type="ramp"><string name="distance" value="{}"/><string name="transmittance" value="{}"/>
      <float name="step_size" value="{:.9g}"/><float name="at_zero" value="{:.9g}"/><float name="slope" value="{:.9g}"/>
      <float name="most" value="{:.9g}"/><rgb name="albedo" value="{:.9g}"/><float name="g" value="{:.9g}"/>
      <rgb name="glow" value="{:.9g}"/><float name="glow_slope" value="{:.9g}"/></medium>)",
      t.distance, t.transmittance, 0.1 * unit, t.extinction / unit, t.extinction / unit / unit,
      5 * (t.extinction + 0.01) / unit, t.albedo, t.anisotropy, t.glow / unit, 0.3 / unit);
}

std::string describe(const Thing& t, double unit) {
  const std::string place = placement(t, unit);
  const auto primitive = [&](const char* type, const std::string& medium) {
    return fmt::format("<volume type=\"{}\">{}{}</volume>\n", type, place, medium);
  };
  switch (t.kind) {
    case Kind::ball:
      return primitive("sphere", constantMedium(t, unit));
    case Kind::box:
      return primitive("box", varyingMedium(t, unit));
    case Kind::cylinder:
      return primitive("cylinder", varyingMedium(t, unit));
    case Kind::cone:
      return primitive("cone", varyingMedium(t, unit));
    case Kind::glass:
      return fmt::format(
          R"(<shape type="cube">{}<bsdf type="dielectric"><float name="ior" value="{}"/>
          <integer name="priority" value="{}"/></bsdf></shape>)",
          place, t.ior, t.priority);
    case Kind::frosted:
      return fmt::format(
          R"(<shape type="sphere">{}<bsdf type="roughdielectric"><float name="int_ior" value="{}"/>
          <float name="alpha" value="0.2"/></bsdf></shape>)",
          place, t.ior);
    case Kind::inside:
      return fmt::format(R"(<shape type="sphere">{}<integer name="priority" value="{}"/><bsdf type="null"/>{}</shape>)",
                         place, t.priority, constantMedium(t, unit, "name=\"interior\""));
    default:
      break;
  }
  const std::string colour =
      t.material == "diffuse" ? fmt::format(R"(<rgb name="reflectance" value="{:.9g}"/>)", t.albedo) : "";
  return fmt::format(R"(<shape type="sphere">{}<bsdf type="{}">{}</bsdf></shape>)", place, t.material, colour);
}

}  // namespace

RandomScene RandomScene::make(bool skyAlone) {
  RandomScene scene;
  const int count = *inRange(1, 6);
  scene.moves = oneIn(4);
  for (int i = 0; i < count; ++i) scene.things.push_back(makeThing(skyAlone, scene.moves));
  for (double& x : scene.camera) x = between(-4, 4);
  const auto may = [&] { return !skyAlone && oneIn(2); };
  scene.hasPoint = may();
  scene.hasSun = may();
  scene.hasSpot = may() && oneIn(2);
  scene.hasLamp = may();
  scene.hasGround = oneIn(2);
  for (double& x : scene.light) x = between(-3, 3);
  scene.view = *element(View::plain, View::plain, View::lens, View::parallel);
  scene.aperture = *element(0.05, 0.4);
  scene.overlap = *element<std::string>("auto", "split", "partition");
  scene.sampler = *element<std::string>("independent", "sobol");
  return scene;
}

double RandomScene::largestIndexAtCamera() const {
  // How far from the camera's place rays begin, and from a thing's place it reaches, moved or not.
  const double begin = view == View::parallel ? 2.2 : view == View::lens ? aperture + 0.05 : 0.05;
  double largest = 1;
  for (const Thing& t : things) {
    if (t.kind != Kind::glass && t.kind != Kind::frosted) continue;
    double squared = 0, moved = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      squared += (camera[i] - t.place[i]) * (camera[i] - t.place[i]);
      moved += t.step[i] * t.step[i];
    }
    const double size = *std::max_element(t.size.begin(), t.size.end());
    const double reach = std::sqrt(3.0) * size + std::sqrt(moved) + begin;
    if (squared < reach * reach) largest = std::max(largest, t.ior);
  }
  return largest;
}

std::string RandomScene::content(double unit) const {
  std::string text = R"(<emitter type="constant"/>)";
  const std::string place = triple(light, unit);
  if (hasPoint) {
    text += fmt::format(
        R"(<emitter type="point"><point name="position" value="{}"/><rgb name="intensity" value="{:.9g}"/></emitter>)",
        place, 4 * unit * unit);
  }
  if (hasSun) text += R"(<emitter type="directional"><vector name="direction" x="0.3" y="-1" z="0.4"/></emitter>)";
  if (hasSpot) {
    text += fmt::format(
        R"(<emitter type="spot"><transform name="to_world"><lookat origin="{}" target="{}" up="0, 1, 0.1"/>
        </transform><rgb name="intensity" value="{:.9g}"/></emitter>)",
        place, triple({0.1, 0.2, 0.3}, unit), 9 * unit * unit);
  }
  if (hasLamp) {
    text += fmt::format(
        R"(<shape type="sphere"><float name="radius" value="{:.9g}"/><point name="center" value="{}"/>
        <emitter type="area"><rgb name="radiance" value="5"/></emitter></shape>)",
        0.3 * unit, triple({light[2], light[0], light[1]}, unit));
  }
  if (hasGround) {
    text += fmt::format(
        R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="{:.9g}"/>
        <translate x="0" y="{:.9g}" z="0"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf>
        </shape>)",
        30 * unit, -2.5 * unit);
  }
  for (const Thing& thing : things) text += describe(thing, unit);
  return text;
}

TestScene RandomScene::load(double unit, const SceneOptions& options) const {
  TestSensor sensor{.origin = triple(camera, unit), .target = "0, 0, 0", .fov = 50, .width = 6, .height = 5};
  sensor.sampler = sampler;
  // Those of a parallel view are in the camera's own space, which is scaled.
  if (view != View::parallel) {
    sensor.nearClip *= unit;
    sensor.farClip *= unit;
  }
  if (view == View::lens) {
    sensor.type = "thinlens";
    sensor.medium =
        fmt::format(R"(<float name="aperture_radius" value="{:.9g}"/><float name="focus_distance" value="{:.9g}"/>)",
                    aperture * unit, 3 * unit);
  } else if (view == View::parallel) {
    sensor.type = "orthographic";
    sensor.placement = fmt::format(
        R"(<transform name="to_world"><scale value="{:.9g}"/><lookat origin="{}" target="0, 0, 0" up="0, 1, 0"/></transform>)",
        1.5 * unit, triple(camera, unit));
  }
  if (moves) sensor.medium += R"(<float name="shutter_open" value="0"/><float name="shutter_close" value="1"/>)";
  return loadScene(fmt::format(R"(<integer name="max_depth" value="30"/><integer name="rr_depth" value="8"/>
      <string name="overlap" value="{}"/>)",
                               overlap),
                   sensor, content(unit), options);
}

}  // namespace aerosol::test
