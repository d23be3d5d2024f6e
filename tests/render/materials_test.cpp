#include <fmt/format.h>

#include <complex>
#include <numbers>

#include "tests/render/film_checks.h"

// The materials of the library in light that has a closed form: an even sky (a furnace), or parallel light.

namespace aerosol::test {
namespace {

using std::numbers::pi;

constexpr const char* sky = R"(<emitter type="constant"><rgb name="radiance" value="1, 2, 0.5"/></emitter>)";
const Color skyColor(1, 2, 0.5f);

/// A wall at z = 0 across the view. It faces the camera, or `turn` degrees from it.
std::string wall(const std::string& bsdf, double turn = 0) {
  return fmt::format(R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="{}"/>
      <scale value="50"/></transform>{}</shape>)",
                     180 + turn, bsdf);
}

TestScene inFurnace(const std::string& bsdf, double turn = 0, const std::string& depth = "-1") {
  return loadScene(fmt::format(R"(<integer name="max_depth" value="{}"/>)", depth), {.fov = 40},
                   std::string(sky) + wall(bsdf, turn));
}

/// Mean of the film, by channel, over the sky's colour.
Color furnaceMean(const std::string& bsdf, double turn = 0) {
  const TestScene scene = inFurnace(bsdf, turn);
  if (!scene.scene()) return Color(-1);
  const auto film = scene.render(256);
  Color sum;
  const render::PixelRect area = film->area();
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) sum += film->estimate(x, y).color;
  }
  sum *= 1 / static_cast<float>(area.pixelCount());
  return {sum.r / skyColor.r, sum.g / skyColor.g, sum.b / skyColor.b};
}

void expectNear(Color found, Color expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance) << "channel " << c;
}

TEST(Materials, ASheetIsBlackFromBehindUnlessItIsTwoSided) {
  const std::string red = R"(<bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.4, 0.2"/></bsdf>)";
  const Color reflectance(0.8f, 0.4f, 0.2f);
  expectNear(furnaceMean(red), reflectance, 0.004f);
  expectNear(furnaceMean(red, 180), Color(), 1e-6f);
  expectNear(furnaceMean("<bsdf type=\"twosided\">" + red + "</bsdf>", 180), reflectance, 0.004f);
  const std::string grey = R"(<bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf>)";
  const std::string both = "<bsdf type=\"twosided\">" + red + grey + "</bsdf>";
  expectNear(furnaceMean(both), reflectance, 0.004f);
  expectNear(furnaceMean(both, 180), Color(0.5f), 0.004f);
}

TEST(Materials, MasksAndBlendsWeighWhatTheyHold) {
  const std::string red = R"(<bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.4, 0.2"/></bsdf>)";
  const Color masked = furnaceMean(R"(<bsdf type="mask"><float name="opacity" value="0.3"/>)" + red + "</bsdf>");
  expectNear(masked, Color(0.7f) + Color(0.8f, 0.4f, 0.2f) * 0.3f, 0.004f);
  const Color blended = furnaceMean(R"(<bsdf type="blendbsdf"><float name="weight" value="0.25"/>)" + red +
                                    R"(<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf></bsdf>)");
  expectNear(blended, Color(0.8f, 0.4f, 0.2f) * 0.75f, 0.004f);
}

TEST(Materials, AMaskShowsNoHiddenEnvironment) {
  const auto mean = [](const std::string& more) {
    const TestScene scene = loadScene(more, {.fov = 40}, std::string(sky) + wall(R"(<bsdf type="mask">
        <float name="opacity" value="0.25"/><bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf></bsdf>)"));
    EXPECT_TRUE(scene.scene());
    return scene.scene() ? scene.render(64)->estimate(8, 8).color.r : -1;
  };
  EXPECT_NEAR(mean(""), 0.75f, 0.2f);
  EXPECT_EQ(mean(R"(<boolean name="hide_emitters" value="true"/>)"), 0);
}

TEST(Materials, AColourWhereANumberIsAskedForIsItsLuminance) {
  const std::string black = R"(<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>)";
  expectNear(furnaceMean(R"(<bsdf type="mask"><rgb name="opacity" value="1, 0, 0"/>)" + black + "</bsdf>"),
             Color(1 - 0.2126f), 0.012f);
}

TEST(Materials, ClearOnesKeepAllLight) {
  for (const char* bsdf :
       {R"(<bsdf type="dielectric"/>)", R"(<bsdf type="thindielectric"/>)",
        R"(<bsdf type="dielectric"><string name="int_ior" value="Water"/><string name="ext_ior" value="air"/></bsdf>)",
        R"(<bsdf type="conductor"><string name="material" value="none"/></bsdf>)"}) {
    SCOPED_TRACE(bsdf);
    // One face of glass changes radiance by the square of the index; a pane and mirrors do not.
    const Color mean = furnaceMean(bsdf);
    const bool bends = std::string_view(bsdf).find("\"dielectric\"") != std::string_view::npos;
    if (!bends) expectNear(mean, Color(1), 0.004f);
    if (bends) EXPECT_LT(mean.r, 1);
  }
}

double conductor(double cosine, double eta, double k) {
  // By complex numbers, without the algebra of the renderer's form.
  using Complex = std::complex<double>;
  const Complex index(eta, k), sine2 = (1 - cosine * cosine) / (index * index);
  const Complex inside = std::sqrt(1.0 - sine2);
  const Complex s = (cosine - index * inside) / (cosine + index * inside);
  const Complex p = (index * cosine - inside) / (index * cosine + inside);
  return 0.5 * (std::norm(s) + std::norm(p));
}

TEST(Materials, MetalReflectsByFresnelsEquations) {
  const TestScene scene = inFurnace(R"(<bsdf type="conductor"><rgb name="eta" value="0.2, 0.9, 1.1"/>
      <rgb name="k" value="3.9, 2.4, 2.2"/><rgb name="specular_reflectance" value="1, 0.5, 1"/></bsdf>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(4);
  // The renderer computes in float, where nearly equal terms are subtracted: each pixel to 1e-4.
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      double expected[3] = {};
      for (int k = 0; k < 64; ++k) {
        const Ray<World> ray = scene.scene()->camera->ray(
            {.x = static_cast<float>(x + (k % 8 + 0.5) / 8), .y = static_cast<float>(y + (k / 8 + 0.5) / 8)});
        const double cosine = static_cast<double>(ray.direction.z);
        expected[0] += conductor(cosine, 0.2, 3.9) / 64;
        expected[1] += 2 * 0.5 * conductor(cosine, 0.9, 2.4) / 64;
        expected[2] += 0.5 * conductor(cosine, 1.1, 2.2) / 64;
      }
      const render::PixelEstimate pixel = film->estimate(x, y);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(static_cast<double>(pixel.color[c]), expected[c],
                    1e-4 * expected[c] + 4 * static_cast<double>(pixel.standardError[c]));
      }
    }
  }
}

double fresnel(double cosine, double eta) {
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
  const double s = (cosine - eta * inside) / (cosine + eta * inside);
  const double p = (eta * cosine - inside) / (eta * cosine + inside);
  return 0.5 * (s * s + p * p);
}

TEST(Materials, ALayerLetsPassWhatTheOneAboveDoesNotReflect) {
  const TestScene scene = inFurnace(R"(<bsdf type="varnished"><rgb name="below" value="0.8, 0.4, 0.2"/>
      <float name="amount" value="0.7"/></bsdf>)");
  EXPECT_TRUE(shows(scene, *scene.render(1024), [](const Ray<World>& ray) {
    const auto r = static_cast<float>(0.7 * fresnel(static_cast<double>(ray.direction.z), 1.5));
    return skyColor * (Color(r) + Color(0.8f, 0.4f, 0.2f) * (1 - r));
  }));
}

/// Plastic: the mirrored part, and the part below by its own formula, integrated here over the hemisphere of light.
TEST(Materials, PlasticAddsUp) {
  const TestScene scene = inFurnace(R"(<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.8, 0.4, 0.2"/>
      <float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>)");
  const double entering = 2 * integrate([](double c) { return c * (1 - fresnel(c, 1.5)); }, 0, 1, 20);
  const double inner = -1.4399 / 2.25 + 0.7099 / 1.5 + 0.6681 + 0.0636 * 1.5;
  EXPECT_TRUE(shows(scene, *scene.render(1024), [=](const Ray<World>& ray) {
    const double r = fresnel(static_cast<double>(ray.direction.z), 1.5);
    const auto below = static_cast<float>((1 - r) * entering / (2.25 * (1 - inner)));
    return skyColor * (Color(static_cast<float>(r)) + Color(0.8f, 0.4f, 0.2f) * below);
  }));
}

/// Without roughness: what enters once and leaves at once.
TEST(Materials, PolarizingPlasticLosesWhatItReflectsInside) {
  const TestScene scene = inFurnace(R"(<bsdf type="pplastic"><rgb name="diffuse_reflectance" value="0.8, 0.4, 0.2"/>
      <float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/><float name="alpha" value="1e-4"/></bsdf>)");
  const double entering = 2 * integrate([](double c) { return c * (1 - fresnel(c, 1.5)); }, 0, 1, 20);
  EXPECT_TRUE(shows(scene, *scene.render(1024), [=](const Ray<World>& ray) {
    const double r = fresnel(static_cast<double>(ray.direction.z), 1.5);
    return skyColor * (Color(static_cast<float>(r)) + Color(0.8f, 0.4f, 0.2f) * static_cast<float>((1 - r) * entering));
  }));
}

/// Those of the tables of Palik's handbook have names of their own; seen straight on.
TEST(Materials, MetalsHaveTheirNames) {
  struct Metal {
    const char* name;
    std::array<double, 3> eta, k;
  };
  const Metal metals[] = {{"Ni_palik", {2.367, 1.663, 1.467}, {4.499, 3.05, 2.345}},
                          {"Na_palik", {0.06027, 0.05614, 0.06199}, {3.179, 2.112, 1.579}},
                          {"V_palik", {4.278, 3.513, 2.761}, {3.491, 2.889, 3.112}}};
  for (const Metal& metal : metals) {
    SCOPED_TRACE(metal.name);
    const TestScene scene = loadScene(
        "", {.fov = 1},
        std::string(sky) +
            wall(fmt::format(R"(<bsdf type="conductor"><string name="material" value="{}"/></bsdf>)", metal.name)));
    EXPECT_TRUE(shows(scene, *scene.render(4), [&](const Ray<World>&) {
      return skyColor * color([&](int c) {
               const auto i = static_cast<std::size_t>(c);
               return conductor(1, metal.eta[i], metal.k[i]);
             });
    }));
  }
}

/// Light that travels along +z and to the right.
constexpr const char* sun = R"(<emitter type="directional"><vector name="direction" x="3" y="0" z="4"/>
    <rgb name="irradiance" value="2"/></emitter>)";

/// The rectangle is turned about y: u runs to the left over 100 units, v upwards.
TEST(Materials, NormalsOfMapsTiltTheLight) {
  const std::string grey = R"(<bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf>)";
  struct Case {
    std::string bsdf;
    std::array<double, 3> normal;  // To the right, up, towards the camera.
    bool isShadowed = false;       // By the function of Conty Estevez et al. 2019.
  };
  const std::vector<Case> cases = {
      {grey, {0, 0, 1}},
      {R"(<bsdf type="normalmap"><rgb name="normalmap" value="0.5, 0.5, 1"/>)" + grey + "</bsdf>", {0, 0, 1}},
      {R"(<bsdf type="normalmap"><rgb name="normalmap" value="0.8, 0.5, 0.9"/>)" + grey + "</bsdf>",
       {-0.6, 0, 0.8},
       true},
      {R"(<bsdf type="bumpmap"><texture type="slope" name="any"><float name="along" value="30"/></texture>
          <float name="scale" value="2"/><boolean name="use_shadowing_function" value="false"/>)" +
           grey + "</bsdf>",
       {0.6, 0, 1}},
      {R"(<bsdf type="bumpmap"><texture type="slope" name="any"><float name="along" value="30"/></texture>
          <float name="scale" value="2"/>)" +
           grey + "</bsdf>",
       {0.6, 0, 1},
       true}};
  for (const Case& each : cases) {
    SCOPED_TRACE(each.bsdf);
    const TestScene scene = loadScene(R"(<integer name="max_depth" value="2"/>)", {.fov = 20}, sun + wall(each.bsdf));
    const double size = std::hypot(each.normal[0], each.normal[1], each.normal[2]);
    const double cosine = (-0.6 * each.normal[0] + 0.8 * each.normal[2]) / size;
    const double squaredTangent = size * size / (each.normal[2] * each.normal[2]) - 1,
                 ofLight = 0.6 * 0.6 / (0.8 * 0.8);
    const double shadow = each.isShadowed ? 2 / (1 + std::sqrt(1 + 0.125 * squaredTangent * ofLight)) : 1;
    EXPECT_TRUE(shows(scene, *scene.render(4), [=](const Ray<World>&) {
      return Color(static_cast<float>(2 * std::max(cosine, 0.0) * shadow * 0.5 / pi));
    }));
  }
}

/// A light that shows its texture to the camera: texels of tiles.ppm, decoded and then interpolated.
TEST(Materials, BitmapsAreDecodedAndInterpolated) {
  const int texels[2][4][3] = {{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {128, 128, 128}},
                               {{255, 255, 0}, {0, 255, 255}, {255, 0, 255}, {20, 200, 100}}};
  for (const bool isNearest : {false, true}) {
    const std::string texture = fmt::format(R"(<texture type="bitmap" name="radiance">
        <string name="filename" value="tiles.ppm"/><string name="filter_type" value="{}"/></texture>)",
                                            isNearest ? "nearest" : "bilinear");
    const TestScene scene = loadScene("", {.fov = 30},
                                      R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/>
            </transform><emitter type="area">)" +
                                          texture + "</emitter></shape>");
    const auto expected = [&](const Ray<World>& ray) {
      const double t = 5 / static_cast<double>(ray.direction.z);
      const double u = 0.5 - 0.5 * t * static_cast<double>(ray.direction.x),
                   v = 0.5 + 0.5 * t * static_cast<double>(ray.direction.y);
      if (u < 0 || u > 1 || v < 0 || v > 1) return Color();
      const double x = u * 4 - (isNearest ? 0 : 0.5), y = v * 2 - (isNearest ? 0 : 0.5);
      const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
      const double a = isNearest ? 0 : x - i, b = isNearest ? 0 : y - j;
      return color([&](int c) {
        const auto texel = [&](int di, int dj) {
          return linearFromByte(texels[(j + dj + 2) % 2][(i + di + 4) % 4][c]);
        };
        return (1 - b) * ((1 - a) * texel(0, 0) + a * texel(1, 0)) + b * ((1 - a) * texel(0, 1) + a * texel(1, 1));
      });
    };
    // Pixels that an edge crosses are not told exactly by a few points of the closed form.
    const auto film = scene.render(64);
    ASSERT_TRUE(scene.scene());
    double worst = 0;
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) {
        Color mean;
        for (int k = 0; k < 256; ++k) {
          const auto px = static_cast<float>(x + (k % 16 + 0.5) / 16), py = static_cast<float>(y + (k / 16 + 0.5) / 16);
          mean += expected(scene.scene()->camera->ray({.x = px, .y = py})) * (1.0f / 256);
        }
        const render::PixelEstimate pixel = film->estimate(x, y);
        worst = std::max(worst, static_cast<double>(maximum(abs(pixel.color - mean) - pixel.standardError * 5.0f)));
      }
    }
    EXPECT_LT(worst, 0.01) << (isNearest ? "nearest" : "bilinear");
  }
}

TEST(Materials, HoldoutsCutHoles) {
  const TestScene scene = loadScene("", {.fov = 20}, std::string(sky) + wall(R"(<bsdf type="osl"><source><![CDATA[
      surface hole() { Ci = holdout(); }]]></source></bsdf>)"));
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(4);
  EXPECT_EQ(film->estimate(8, 8).color, Color());
  EXPECT_EQ(film->estimate(8, 8).alpha, 0);
}

}  // namespace
}  // namespace aerosol::test
