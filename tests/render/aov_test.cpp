#include <fmt/format.h>

#include <bit>

#include "core/render/aov/aov_pixels.h"
#include "core/render/film_archive.h"
#include "tests/render/stills.h"

// Pictures beside the picture: that they add up, that each is what another scene or a closed form says it is, and that
// nothing in the order of work changes a bit.

namespace aerosol::test {
namespace {

/// A scene whose integrator stands in one that shows AOVs.
TestScene aovScene(const std::string& aovs, const std::string& integrator, const TestSensor& sensor,
                   const std::string& content) {
  TestSensor seeded = sensor;
  seeded.seed = static_cast<int>(seedOfTest(static_cast<std::uint64_t>(sensor.seed)) % 1000000);
  std::string xml = sceneXml(integrator, seeded, content);
  const std::string plain = "<integrator type=\"path\">";
  if (!aovs.empty()) {
    xml.replace(xml.find(plain), plain.size(),
                fmt::format("<integrator type=\"aov\"><string name=\"aovs\" value=\"{}\"/>{}", aovs, plain));
    xml.replace(xml.find("</integrator>"), 13, "</integrator></integrator>");
  }
  SceneOptions options;
  options.shaderFolder = shaderFolder();
  return TestScene(xml, options);
}

/// All pixels of a layer; the channels of one follow each other.
std::vector<float> layer(const render::Film& film, const std::string& name) {
  const render::AovLayer* found = film.layout().find(name);
  EXPECT_TRUE(found) << name;
  return found ? render::layerPixels(film, *found) : std::vector<float>();
}

std::vector<float> beauty(const render::Film& film) {
  std::vector<float> rgb;
  const std::vector<float> rgba = film.rgba();
  for (std::size_t i = 0; i < rgba.size(); ++i) {
    if (i % 4 != 3) rgb.push_back(rgba[i]);
  }
  return rgb;
}

/// The layers add up to the picture as floats can.
void expectSum(const render::Film& film, const std::vector<std::string>& names) {
  const std::vector<float> expected = beauty(film);
  std::vector<double> sum(expected.size());
  for (const std::string& name : names) {
    const std::vector<float> part = layer(film, name);
    ASSERT_EQ(part.size(), sum.size());
    double total = 0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += static_cast<double>(part[i]);
      total += static_cast<double>(part[i]);
    }
    EXPECT_NE(total, 0) << name << " shows nothing";
  }
  for (std::size_t i = 0; i < sum.size(); ++i)
    ASSERT_NEAR(sum[i], static_cast<double>(expected[i]), 4e-6 * (1 + std::fabs(sum[i]))) << names[0] << ' ' << i;
}

constexpr const char* everything = R"(
  <emitter type="constant"><rgb name="radiance" value="0.2, 0.3, 0.5"/></emitter>
  <emitter type="point"><point name="position" x="1" y="2" z="-2"/><rgb name="intensity" value="6, 5, 4"/>
    <string name="light_group" value="key"/></emitter>
  <shape type="rectangle"><string name="light_group" value="lamp"/>
    <transform name="to_world"><scale value="0.4"/><rotate x="1" angle="90"/><translate y="1.6"/></transform>
    <emitter type="area"><rgb name="radiance" value="8, 6, 3"/></emitter></shape>
  <shape type="rectangle"><transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/><translate y="-1"/>
    </transform><bsdf type="principled"><rgb name="base_color" value="0.7, 0.4, 0.3"/>
    <float name="roughness" value="0.4"/><float name="clearcoat" value="0.7"/></bsdf></shape>
  <shape type="sphere"><point name="center" x="-0.8" y="-0.4" z="0"/><float name="radius" value="0.5"/>
    <bsdf type="dielectric"/></shape>
  <shape type="sphere"><point name="center" x="0.8" y="-0.4" z="0"/><float name="radius" value="0.5"/>
    <bsdf type="roughplastic"/></shape>
  <shape type="rectangle"><transform name="to_world"><scale value="0.5"/><rotate y="1" angle="180"/>
    <translate y="0.3" z="-0.9"/></transform><bsdf type="mask"><float name="opacity" value="0.4"/>
    <bsdf type="twosided"><bsdf type="diffuse"/></bsdf></bsdf></shape>
  <volume type="sphere"><point name="center" x="0" y="0.2" z="0.3"/><float name="radius" value="0.7"/>
    <medium type="homogeneous"><rgb name="sigma_t" value="1, 2, 3"/><rgb name="albedo" value="0.9, 0.7, 0.5"/>
    </medium></volume>)";
constexpr const char* flame = R"(<volume type="sphere"><point name="center" x="-0.2" y="0.9" z="0"/>
    <float name="radius" value="0.4"/><medium type="homogeneous"><rgb name="sigma_t" value="0.5"/>
    <rgb name="albedo" value="0.4"/><rgb name="emission" value="1, 0.4, 0.1"/></medium></volume>)";

constexpr TestSensor sensorOfAll() { return {.fov = 50, .width = 24, .height = 18}; }

TEST(Aovs, AddUpToThePicture) {
  const TestScene scene = aovScene(
      "direct:direct,indirect:indirect,surface:surface,volume:volume,background:background,diffuse:diffuse,"
      "specular:specular,lights:light_groups,dd:direct_diffuse,id:indirect_diffuse,ds:direct_specular,"
      "is:indirect_specular,dv:direct_volume,iv:indirect_volume,shine:C<T.>*<O[^V]>|CL|CsL,glow:CO,reflection:"
      "reflection,"
      "transmission:transmission,rest:C(.*[LO]|B|.+B)",
      R"(<integer name="max_depth" value="8"/>)", sensorOfAll(), std::string(everything) + flame);
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(48);
  expectSum(*film, {"direct", "indirect"});
  expectSum(*film, {"surface", "volume", "background"});
  expectSum(*film, {"light_key", "light_lamp", "light_rest"});
  expectSum(*film, {"rest"});
  const auto sum = [&](const std::string& a, const std::string& b) {
    std::vector<float> x = layer(*film, a);
    const std::vector<float> y = layer(*film, b);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += y[i];
    return x;
  };
  const auto expectNear = [&](const std::vector<float>& a, const std::vector<float>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 4e-6f * (1 + std::fabs(b[i]))) << i;
  };
  expectNear(sum("dd", "id"), layer(*film, "diffuse"));
  expectNear(sum("ds", "is"), layer(*film, "specular"));
  expectNear(sum("reflection", "transmission"), sum("diffuse", "specular"));
}

/// Light that is dimmed is dimmed in all of them.
TEST(LightLayers, AddUpWhereLightIsClamped) {
  const TestScene scene = aovScene("direct:direct,indirect:indirect,lights:light_groups",
                                   R"(<float name="clamp_indirect" value="0.1"/>)", sensorOfAll(), everything);
  ASSERT_TRUE(scene.scene());
  const auto film = scene.film();
  const auto report = scene.renderInto(*film, {.threads = 1, .endSample = 32});
  EXPECT_GT(report.statistics.work.of(render::Work::clamping), 100u);
  expectSum(*film, {"direct", "indirect"});
  expectSum(*film, {"light_key", "light_lamp", "light_rest"});
}

/// Two closures of one kind, the one twice the other, and one of another kind, each with a label.
/// A lamp deep in fog that the pixels at the rim hardly see: paths that come near it are split.
TEST(Aovs, AddUpWherePathsAreSplit) {
  const TestScene scene =
      aovScene("direct:direct,indirect:indirect,volume:volume,surface:surface,lights:light_groups",
               R"(<integer name="max_depth" value="20"/>
                                   <string name="roulette" value="contribution"/>)",
               sensorOfAll(), R"(<emitter type="point"><point name="position" x="0.5" y="0.1" z="0.6"/>
      <rgb name="intensity" value="6, 5, 4"/><string name="light_group" value="key"/></emitter>
      <shape type="rectangle"><transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/><translate y="-1"/>
      </transform><bsdf type="diffuse"/></shape>
      <volume type="sphere"><float name="radius" value="1.5"/><medium type="homogeneous">
      <rgb name="sigma_t" value="2, 2.5, 3"/><rgb name="albedo" value="0.9, 0.8, 0.7"/></medium></volume>)");
  ASSERT_TRUE(scene.scene());
  ASSERT_FALSE(scene.scene()->contributions.isEmpty());
  ASSERT_GT(scene.scene()->contributions.branches({0.5f, 0.1f, 0.6f}, Color(1), 1, 8), 1);
  const auto film = scene.render(256);
  expectSum(*film, {"direct", "indirect"});
  expectSum(*film, {"surface", "volume"});
  expectSum(*film, {"light_key"});
}

TEST(Aovs, LabelsOfClosuresSplitWhatASurfaceScatters) {
  const std::string content = R"(<emitter type="constant"><rgb name="radiance" value="0.2, 0.3, 0.5"/></emitter>
      <emitter type="point"><point name="position" x="1" y="2" z="-2"/><rgb name="intensity" value="6, 5, 4"/>
        <string name="light_group" value="key"/></emitter>
      <shape type="sphere"><bsdf type="osl"><source><![CDATA[
        surface labelled() {
          Ci = 0.15 * diffuse(N, "label", "thin") + 0.3 * diffuse(N, "label", "thick") +
               color(0.3, 0.2, 0.1) * conductor_bsdf(N, dPdu, 0.3, 0.3, color(0.2), color(3), "ggx",
                                                       "label", "gloss") +
               0.1 * transparent() + 0.05 * diffuse(N);
        }]]></source></bsdf></shape>)";
  const TestScene scene = aovScene(
      "thin:C<R.'thin'>.*[LOB],thick:C<R.'thick'>.*[LOB],gloss:C<RG'gloss'>.*[LOB],"
      "rest:C(<[RT].[^'thin''thick''gloss']>.*)?[LOB],keyed:C<RD'thick'>.*<L.'key'>,both:C<R.['thin''thick']>.*[LOB]",
      R"(<integer name="max_depth" value="5"/>)", {.fov = 50}, content);
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(64);
  expectSum(*film, {"thin", "thick", "gloss", "rest"});
  expectSum(*film, {"both", "gloss", "rest"});
  const std::vector<float> thin = layer(*film, "thin"), thick = layer(*film, "thick"), keyed = layer(*film, "keyed");
  double sum = 0;
  for (std::size_t i = 0; i < thin.size(); ++i) {
    ASSERT_NEAR(thick[i], 2 * thin[i], 4e-6f * (1 + thick[i]));
    ASSERT_LE(keyed[i], thick[i] * (1 + 1e-5f));
    sum += static_cast<double>(keyed[i]);
  }
  EXPECT_GT(sum, 0);
}

/// What is scattered once at most is what a render shows that stops there: the same samples, sample by sample.
TEST(Aovs, DirectLightIsThatOfShorterPaths) {
  const std::string content = everything;
  const std::string surfaces = content.substr(0, content.find("<volume"));
  const TestScene all = aovScene("direct:direct", R"(<integer name="rr_depth" value="50"/>)", sensorOfAll(), surfaces);
  const TestScene shorter = aovScene("", R"(<integer name="max_depth" value="2"/>)", sensorOfAll(), surfaces);
  const auto film = all.render(16), expected = shorter.render(16);
  const std::vector<float> direct = layer(*film, "direct"), picture = beauty(*expected), whole = beauty(*film);
  // Passing straight through the mask takes a segment: such pixels differ.
  int equal = 0, differing = 0;
  for (std::size_t i = 0; i < direct.size(); ++i) {
    equal += std::fabs(direct[i] - picture[i]) <= 4e-6f * (1 + std::fabs(direct[i]));
    differing += std::fabs(direct[i] - whole[i]) > 0.01f;
  }
  EXPECT_GT(equal, static_cast<int>(direct.size() * 3 / 4));
  EXPECT_GT(differing, static_cast<int>(direct.size() / 10));
}

/// Means of a layer and of a picture of another scene, with the error of their difference.
void expectSameMean(const std::vector<float>& found, const render::Film& film, const render::Film& other,
                    double resolution = 0.004) {
  const std::vector<float> expected = beauty(other);
  ASSERT_EQ(found.size(), expected.size());
  double a = 0, b = 0, variance = 0;
  for (std::size_t i = 0; i < found.size(); i += 3) {
    const int x = static_cast<int>(i / 3) % film.area().width(), y = static_cast<int>(i / 3) / film.area().width();
    a += static_cast<double>(found[i]);
    b += static_cast<double>(expected[i]);
    // The layer is a part of the picture: its error is hardly larger.
    variance += std::pow(static_cast<double>(film.estimate(x, y).standardError.r), 2) +
                std::pow(static_cast<double>(other.estimate(x, y).standardError.r), 2);
  }
  EXPECT_LT(std::sqrt(variance), resolution * b);
  EXPECT_LT(std::fabs(a - b), 4 * std::sqrt(variance)) << a << " of " << b;
}

TEST(Aovs, ALightGroupIsTheSceneWithItsLightsAlone) {
  const std::string key = R"(<emitter type="directional"><vector name="direction" x="0.3" y="-0.5" z="1"/>
      <rgb name="irradiance" value="3"/><string name="light_group" value="key"/></emitter>)";
  const std::string rim = R"(<emitter type="directional"><vector name="direction" x="-0.6" y="0.2" z="1"/>
      <rgb name="irradiance" value="1"/></emitter>)";
  const std::string world = R"(<shape type="sphere"><float name="radius" value="0.8"/><bsdf type="diffuse"/></shape>
      <volume type="sphere"><float name="radius" value="1"/><medium type="homogeneous"><rgb name="sigma_t" value="0.3"/>
      <rgb name="albedo" value="0.9"/></medium></volume>)";
  const TestSensor sensor{.fov = 10, .width = 8, .height = 8};
  const TestScene both =
      aovScene("g:light_groups", R"(<integer name="max_depth" value="3"/>)", sensor, key + rim + world);
  const TestScene alone = loadScene(R"(<integer name="max_depth" value="3"/>)",
                                    {.fov = 10, .width = 8, .height = 8, .seed = 1}, key + world);
  ASSERT_TRUE(both.scene() && alone.scene());
  const auto film = both.render(4096), expected = alone.render(4096);
  expectSameMean(layer(*film, "light_key"), *film, *expected);
}

TEST(Aovs, DiffuseIsTheDiffusePartOfTheMaterial) {
  const std::string light = R"(<emitter type="constant"><rgb name="radiance" value="1"/></emitter>)";
  const auto plane = [](const std::string& bsdf) {
    return R"(<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate y="1" angle="160"/></transform>)" +
           bsdf + "</shape>";
  };
  const std::string matte = R"(<bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.3, 0.2"/></bsdf>)";
  const std::string mixed = R"(<bsdf type="blendbsdf"><float name="weight" value="0.25"/>)" + matte +
                            R"(<bsdf type="roughconductor"><string name="material" value="Au"/></bsdf></bsdf>)";
  const std::string depth = R"(<integer name="max_depth" value="2"/>)";
  const TestSensor sensor{.fov = 20, .width = 8, .height = 8};
  const TestScene whole = aovScene("diffuse:C<RD>B,shine:C<RG>B", depth, sensor, light + plane(mixed));
  ASSERT_TRUE(whole.scene());
  const auto film = whole.render(2048);
  const std::vector<float> diffuse = layer(*film, "diffuse");
  double mean = 0;
  for (std::size_t i = 0; i < diffuse.size(); i += 3) mean += static_cast<double>(diffuse[i]) / 64;
  EXPECT_NEAR(mean, 0.75 * 0.6, 0.002);
  expectSum(*film, {"diffuse", "shine"});
}

TEST(Aovs, ShowTheFirstSurface) {
  // A rectangle of 4 x 2 at z = 1, seen from 5 in front of it.
  const TestScene scene = aovScene(
      "depth:depth,p:position,n:geo_normal,sn:sh_normal,uv:uv,du:dp_du,dv:dp_dv,dx:duv_dx,dy:duv_dy,i:shape_index,"
      "a:albedo,t:prim_index,m:motion",
      "", {.origin = "0, 0, -4", .target = "0, 0, 1", .fov = 20, .width = 9, .height = 9},
      R"(<shape type="sphere"><point name="center" x="50" y="0" z="0"/></shape>
         <shape type="rectangle"><transform name="to_world"><scale x="2"/><rotate y="1" angle="180"/>
           <translate z="1"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.1, 0.2, 0.3"/></bsdf>
         </shape>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(64);
  const std::size_t centre = 40;
  EXPECT_NEAR(layer(*film, "depth")[centre], 5, 0.01);
  EXPECT_NEAR(layer(*film, "p")[3 * centre + 2], 1, 1e-5);
  EXPECT_NEAR(layer(*film, "p")[3 * (centre + 1)], -2 * 5 * std::tan(10 * M_PI / 180) / 9, 0.02);
  for (const char* name : {"n", "sn"}) EXPECT_NEAR(layer(*film, name)[3 * centre + 2], -1, 1e-5) << name;
  EXPECT_NEAR(layer(*film, "uv")[2 * centre], 0.5, 0.02);
  // From -2 to 2 in x by u, turned around; from -1 to 1 in y by v.
  EXPECT_NEAR(layer(*film, "du")[3 * centre], -4, 1e-5);
  EXPECT_NEAR(std::fabs(layer(*film, "dv")[3 * centre + 1]), 2, 1e-5);
  const double pixel = 2 * 5 * std::tan(10 * M_PI / 180) / 9;
  EXPECT_NEAR(std::fabs(layer(*film, "dx")[2 * centre]), pixel / 4, 1e-4 * pixel);
  EXPECT_NEAR(std::fabs(layer(*film, "dy")[2 * centre + 1]), pixel / 2, 1e-4 * pixel);
  // From pixel to pixel the coordinates change as it says.
  const std::vector<float> uv = layer(*film, "uv"), dx = layer(*film, "dx"), dy = layer(*film, "dy");
  EXPECT_NEAR(uv[2 * (centre + 2)] - uv[2 * (centre - 2)], 4 * dx[2 * centre], 0.02);
  EXPECT_NEAR(uv[2 * (centre + 18) + 1] - uv[2 * (centre - 18) + 1], 4 * dy[2 * centre + 1], 0.03);
  EXPECT_EQ(layer(*film, "i")[centre], 2);
  EXPECT_NEAR(layer(*film, "a")[3 * centre + 2], 0.3, 1e-6);
  EXPECT_EQ(layer(*film, "m")[2 * centre], 0);
}

TEST(Aovs, MotionIsThatOfTheSurfaceAndOfTheCamera) {
  const auto motionOf = [](const std::string& content, const std::string& camera) {
    std::string xml = sceneXml("", {.fov = 20, .width = 9, .height = 9, .medium = shutter(0, 1)}, content);
    if (!camera.empty()) {
      const std::size_t begin = xml.find("<transform name=\"to_world\"><lookat"), end = xml.find("</transform>", begin);
      xml.replace(begin, end + 12 - begin, camera);
    }
    const std::string plain = "<integrator type=\"path\"></integrator>";
    xml.replace(xml.find(plain), plain.size(),
                R"(<integrator type="aov"><string name="aovs" value="m:motion"/></integrator>)");
    const TestScene scene(xml);
    EXPECT_TRUE(scene.scene());
    const auto film = scene.render(16);
    const std::vector<float> pixels = layer(*film, "m");
    return std::array{static_cast<double>(pixels[80]), static_cast<double>(pixels[81])};
  };
  // A wall at distance 5 that goes 0.2 to the right (as the camera sees it, towards -x) and 0.1 up.
  const auto wall = [](double x, double y) {
    return fmt::format(R"(<shape type="rectangle"><animation name="to_world">
        <transform time="0"><scale value="9"/><rotate y="1" angle="180"/></transform>
        <transform time="1"><scale value="9"/><rotate y="1" angle="180"/><translate x="{}" y="{}"/></transform>
        </animation></shape>)",
                       x, y);
  };
  const double pixels = 9 / (2 * 5 * std::tan(10 * M_PI / 180));
  const auto moving = motionOf(wall(-0.2, 0.1), "");
  EXPECT_NEAR(moving[0], 0.2 * pixels, 1e-3);
  EXPECT_NEAR(moving[1], -0.1 * pixels, 1e-3);
  const auto panning = motionOf(
      R"(<shape type="rectangle"><transform name="to_world"><scale value="9"/><rotate y="1" angle="180"/></transform></shape>)",
      R"(<animation name="to_world"><transform time="0"><lookat origin="0,0,-5" target="0,0,0" up="0,1,0"/></transform>
         <transform time="1"><lookat origin="-0.2,0.1,-5" target="-0.2,0.1,0" up="0,1,0"/></transform></animation>)");
  EXPECT_NEAR(panning[0], -0.2 * pixels, 1e-3);
  EXPECT_NEAR(panning[1], 0.1 * pixels, 1e-3);
}

/// A slab of optical depth 1.2 in front of black: what is seen of it, and how far away.
TEST(Aovs, SeeIntoMedia) {
  const TestScene scene =
      aovScene("a:visible_albedo,z:visible_depth,n:visible_normal", "", {.fov = 0.5, .width = 4, .height = 4},
               R"(<emitter type="constant"/><volume type="box"><transform name="to_world"><scale z="0.5"/>
      </transform><medium type="homogeneous"><rgb name="sigma_t" value="1.2"/><rgb name="albedo" value="0.75"/></medium>
      </volume>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(4096);
  const auto meanOf = [&](const char* name, std::size_t stride) {
    const std::vector<float> pixels = layer(*film, name);
    double sum = 0;
    for (std::size_t i = 0; i < pixels.size(); i += stride) sum += static_cast<double>(pixels[i]);
    return sum * static_cast<double>(stride) / static_cast<double>(pixels.size());
  };
  const double tau = 1.2, seen = 1 - std::exp(-tau);
  EXPECT_NEAR(meanOf("a", 3), 0.75 * seen, 0.006);
  // The mean of an exponential distribution that is cut off.
  EXPECT_NEAR(meanOf("z", 1), 4.5 + (1 / 1.2) - std::exp(-tau) / seen, 0.006);
}

/// In a medium that is denser towards the right, normals point to the left.
TEST(Aovs, NormalsOfMediaPointToWhereTheyAreThinner) {
  const TestScene scene = aovScene("n:visible_normal", "", {.fov = 1, .width = 2, .height = 2},
                                   R"(<emitter type="constant"/><volume type="box"><medium type="ramp">
      <float name="at_zero" value="2"/><float name="slope" value="0.5"/><float name="most" value="3"/><rgb name="albedo" value="0.9"/></medium>
      </volume>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(256);
  const std::vector<float> n = layer(*film, "n");
  EXPECT_LT(std::max({std::fabs(n[0]), std::fabs(n[1])}), 1e-3);
  EXPECT_LT(n[2], -0.5);
}

TEST(Aovs, HalvesAreIndependentAndTheirMeanIsThePicture) {
  const TestScene scene = aovScene("a:half_a,b:half_b,v:variance", "", {.fov = 20, .width = 16, .height = 16},
                                   R"(<emitter type="constant"/><shape type="sphere"><float name="radius" value="0.7"/>
      <bsdf type="diffuse"/></shape><volume type="sphere"><float name="radius" value="1"/><medium type="homogeneous">
      <rgb name="sigma_t" value="0.5"/><rgb name="albedo" value="0.6"/></medium></volume>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(64);
  const std::vector<float> a = layer(*film, "a"), b = layer(*film, "b"), v = layer(*film, "v"), all = beauty(*film);
  double squares = 0, variance = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    ASSERT_NEAR(0.5f * (a[i] + b[i]), all[i], 2e-6f * (1 + all[i]));
    squares += std::pow(static_cast<double>(a[i] - b[i]) / 2, 2);
    variance += static_cast<double>(v[i]);
  }
  EXPECT_NEAR(squares / variance, 1, 0.2);
}

TEST(Aovs, MomentsAreThoseOfTheSamples) {
  std::string xml = sceneXml("", sensorOfAll(), everything);
  const std::string plain = "<integrator type=\"path\"></integrator>";
  xml.replace(xml.find(plain), plain.size(),
              R"(<integrator type="moment"><integrator type="aov" name="inner"><string name="aovs" value="d:depth"/>
                 <integrator type="path"/></integrator></integrator>)");
  const TestScene scene(xml);
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(32);
  std::vector<std::string> names;
  for (const render::AovLayer& each : film->layout().layers) names.push_back(each.name);
  EXPECT_EQ(names, (std::vector<std::string>{"inner.d", "inner", "m2_inner.d", "m2_inner"}));
  EXPECT_EQ(film->layout().find("m2_inner")->channels[1], "m2_inner.Y");
  const std::vector<float> y = layer(*film, "inner"), m2 = layer(*film, "m2_inner"), all = beauty(*film);
  for (std::size_t i = 0; i < all.size(); i += 3) {
    ASSERT_NEAR(y[i + 1], 0.2126f * all[i] + 0.7152f * all[i + 1] + 0.0722f * all[i + 2], 1e-4f * (1 + y[i + 1]));
    ASSERT_GE(m2[i + 1], y[i + 1] * y[i + 1] * 0.9999f);
  }
  // A wall fills this pixel: all its depths are alike.
  const std::vector<float> d = layer(*film, "inner.d"), d2 = layer(*film, "m2_inner.d");
  const std::size_t below = 17 * 24 + 12;
  EXPECT_NEAR(d2[below], d[below] * d[below], 0.05 * d2[below]);
}

TEST(Aovs, TheDepthIntegratorShowsDistances) {
  std::string xml = sceneXml("", {.fov = 20, .width = 3, .height = 3},
                             R"(<shape type="sphere"><float name="radius" value="1.5"/></shape>)");
  xml.replace(xml.find("type=\"path\""), 11, "type=\"depth\"");
  const TestScene scene(xml);
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(64);
  const auto distance = [](const Ray<World>& ray) { return Color(static_cast<float>(throughSphere(ray, 1.5)[0])); };
  EXPECT_TRUE(shows(scene, *film, distance));
  EXPECT_EQ(film->estimate(1, 1).alpha, 1);
}

/// Weights of debug("…") in materials, behind fog that hides a part of them; they add nothing to the picture.
TEST(Aovs, ShadersShowWhatTheyLike) {
  const auto sceneWith = [](const std::string& source, const std::string& aovs) {
    return aovScene(aovs, "", {.fov = 1, .width = 2, .height = 2},
                    R"(
      <emitter type="constant"/><shape type="rectangle"><transform name="to_world"><scale value="2"/>
        <rotate y="1" angle="180"/><translate z="3"/></transform><bsdf type="osl"><source><![CDATA[)" +
                        source + R"(]]></source></bsdf></shape>
      <volume type="box"><transform name="to_world"><scale z="0.5"/></transform><medium type="homogeneous">
        <rgb name="sigma_t" value="0.7"/><rgb name="albedo" value="0"/></medium></volume>)");
  };
  const std::string matte = "surface s(string tag = \"wet\") { Ci = 0.5 * diffuse(N)";
  const TestScene shown =
      sceneWith(matte + R"(+ color(1, 2, u) * debug(tag) + 3 * debug("dry") + (-1) * debug("wet"); })",
                "wet:debug:wet,d:debug:dry");
  const TestScene plain = sceneWith(matte + "; }", "");
  ASSERT_TRUE(shown.scene() && plain.scene());
  const auto film = shown.render(4096), without = plain.render(4096);
  const double through = std::exp(-0.7);
  const std::vector<float> wet = layer(*film, "wet"), dry = layer(*film, "d");
  EXPECT_NEAR(wet[0], 0, 1e-6);
  EXPECT_NEAR(wet[1], through, 0.03);
  EXPECT_NEAR(wet[2], -0.5 * through, 0.03);
  EXPECT_NEAR(dry[2], 3 * through, 0.1);
  EXPECT_NEAR(beauty(*film)[0], beauty(*without)[0], 0.02);
}

/// What a volume shader gives to an output parameter, where the path first scatters: its share of what is seen. A
/// surface behind it may show the same.
TEST(Aovs, VolumeShadersGiveOutputs) {
  const TestScene scene =
      aovScene("heat:debug:heat,place:debug:place,n:debug:steps", "", {.fov = 1, .width = 2, .height = 2},
               R"(<emitter type="constant"/>
      <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><translate z="3"/></transform>
        <bsdf type="osl"><source>surface s() { Ci = 0.5 * diffuse(N) + 10 * debug("heat"); }</source></bsdf></shape>
      <volume type="box"><transform name="to_world"><scale z="0.5"/></transform>
        <medium type="osl"><source><![CDATA[volume v(output float heat = 0, output vector place = 0, output int steps = 0) {
          heat = 4; place = vector(2, 0, -1); steps = P[2] > 10 ? 5 : 3;
          Ci = 1.2 * anisotropic_vdf(color(0.5), color(1), 0); }]]></source></medium></volume>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(4096);
  const double through = std::exp(-1.2), seen = 0.5 * (1 - through);
  EXPECT_NEAR(layer(*film, "heat")[0], 4 * seen + 10 * through, 0.2);
  EXPECT_NEAR(layer(*film, "place")[0], 2 * seen, 0.03);
  EXPECT_NEAR(layer(*film, "place")[2], -seen, 0.015);
  EXPECT_NEAR(layer(*film, "n")[1], 3 * seen, 0.045);
}

/// By its volume's animation, by a velocity, and by both against each other; a wall behind stands still.
TEST(Aovs, MotionOfMedia) {
  const auto motionOf = [](const std::string& place, const std::string& velocity) {
    const TestScene scene =
        aovScene("m:visible_motion", "", {.fov = 20, .width = 9, .height = 9, .medium = shutter(0, 1)},
                 R"(<emitter type="constant"/><volume type="box">)" + place + velocity +
                     R"(<medium type="osl"><source><![CDATA[volume v(output vector drift = 0) {
        drift = vector(-0.1, 0.05, 0); Ci = 300 * anisotropic_vdf(color(0.8), color(1), 0); }]]></source></medium>
      </volume>)");
    EXPECT_TRUE(scene.scene());
    if (!scene.scene()) return std::array{0.0, 0.0};
    const std::vector<float> pixels = layer(*scene.render(64), "m");
    return std::array{static_cast<double>(pixels[80]), static_cast<double>(pixels[81])};
  };
  const std::string still = R"(<transform name="to_world"><scale value="2"/><translate z="2"/></transform>)";
  const std::string moving = R"(<animation name="to_world"><transform time="0"><scale value="2"/><translate z="2"/>
      </transform><transform time="1"><scale value="2"/><translate x="-0.2" y="0.1" z="2"/></transform></animation>)";
  const std::string carried = R"(<string name="velocity" value="drift"/><float name="reference_time" value="0.3"/>)";
  // The face that is seen is at distance 5, and the camera's right is -x.
  const double pixels = 9 / (2 * 5 * std::tan(10 * M_PI / 180));
  const auto byPlace = motionOf(moving, ""), byVelocity = motionOf(still, carried), byBoth = motionOf(moving, carried);
  EXPECT_NEAR(byPlace[0], 0.2 * pixels, 0.01 * pixels);
  EXPECT_NEAR(byPlace[1], -0.1 * pixels, 0.01 * pixels);
  EXPECT_NEAR(byVelocity[0], 0.1 * pixels, 0.01 * pixels);
  EXPECT_NEAR(byVelocity[1], -0.05 * pixels, 0.01 * pixels);
  EXPECT_NEAR(byBoth[0], 0.3 * pixels, 0.01 * pixels);
  EXPECT_NEAR(motionOf(still, "")[0], 0, 1e-6);
}

/// A wall that covers the left half, with a window; fog hides a part of it, by its transmittance.
TEST(Aovs, MattesSayHowMuchIsSeenOfEachThing) {
  const TestScene scene =
      aovScene("crypto_object:crypto_object,m:crypto_material", "", {.fov = 1, .width = 2, .height = 2}, R"(
      <bsdf type="diffuse" id="paint"/><emitter type="constant"/>
      <shape type="rectangle" id="wall"><transform name="to_world"><rotate y="1" angle="180"/><translate x="1" z="3"/>
        </transform><ref id="paint"/></shape>
      <volume type="box" id="fog"><transform name="to_world"><scale z="0.5"/></transform><medium type="homogeneous">
        <rgb name="sigma_t" value="0.7"/><rgb name="albedo" value="1"/></medium></volume>)");
  ASSERT_TRUE(scene.scene());
  const auto film = scene.render(4096);
  const auto shareOf = [&](const std::string& name, std::size_t pixel, const std::string& thing) {
    for (const char* part : {"00", "01", "02"}) {
      const std::vector<float> pixels = layer(*film, name + part);
      for (std::size_t rank = 0; rank < 2; ++rank) {
        if (std::bit_cast<std::uint32_t>(pixels[4 * pixel + 2 * rank]) == render::matteId(thing))
          return static_cast<double>(pixels[4 * pixel + 2 * rank + 1]);
      }
    }
    return 0.0;
  };
  // The camera looks along +z: +x is on the left.
  const double through = std::exp(-0.7);
  EXPECT_NEAR(shareOf("CryptoObject", 0, "wall"), through, 0.03);
  EXPECT_NEAR(shareOf("CryptoObject", 0, "fog"), 1 - through, 0.03);
  EXPECT_EQ(shareOf("CryptoObject", 1, "wall"), 0);
  EXPECT_NEAR(shareOf("CryptoObject", 1, "fog"), 1 - through, 0.03);
  EXPECT_NEAR(shareOf("m", 0, "paint"), through, 0.03);
  EXPECT_NEAR(shareOf("m", 0, "homogeneous"), 1 - through, 0.03);
  EXPECT_EQ(film->layout().mattes[0].names.size(), 2u);
}

constexpr const char* manyAovs =
    "direct:direct,volume:volume,g:light_groups,d:denoise,depth:depth,albedo:albedo,cost:cost,n:sh_normal,x:C.+'key',"
    "co:crypto_object,cm:crypto_material";

TEST(Aovs, NeitherThreadsNorCropsNorPartsChangeABit) {
  TestSensor sensor = sensorOfAll();
  sensor.sampler = "sobol";
  const TestScene scene = aovScene(manyAovs, "", sensor, everything);
  ASSERT_TRUE(scene.scene());
  const auto whole = scene.render(80);

  const auto threads = scene.film();
  scene.renderInto(*threads, {.threads = 3, .endSample = 80, .pathsInFlight = 37, .batchSize = 16});
  EXPECT_TRUE(identical(*whole, *threads));

  // Parts of samples and of pixels, each written to bytes and read back, joined in another order.
  const auto joined = scene.film();
  const std::array<std::pair<std::uint32_t, std::uint32_t>, 3> ranges = {{{70, 80}, {0, 13}, {13, 70}}};
  for (const auto& [first, end] : ranges) {
    for (const render::PixelRect& area : {render::PixelRect{0, 0, 11, 18}, render::PixelRect{11, 0, 24, 18}}) {
      const auto part = scene.film(area);
      scene.renderInto(*part, {.threads = 1, .firstSample = first, .endSample = end});
      const auto read = render::decodeFilm(render::encodeFilm(*part));
      ASSERT_TRUE(read) << format(read.errors());
      const Diagnostics errors = joined->merge(**read);
      ASSERT_TRUE(errors.empty()) << format(errors);
    }
  }
  EXPECT_TRUE(identical(*whole, *joined));
  for (const render::AovLayer& each : whole->layout().layers)
    EXPECT_EQ(render::layerPixels(*whole, each), render::layerPixels(*joined, each)) << each.name;

  // The picture is the one without AOVs.
  const TestScene plain = aovScene("", "", sensor, everything);
  EXPECT_EQ(beauty(*plain.render(80)), beauty(*whole));
}

TEST(Aovs, OfAnotherKindAreNotMerged) {
  const TestScene one = aovScene("d:direct", "", sensorOfAll(), everything);
  const TestScene other = aovScene("d:indirect", "", sensorOfAll(), everything);
  EXPECT_TRUE(one.film()->merge(*other.film()).hasErrors());
  std::string damaged = render::encodeFilm(*one.film());
  damaged[40] = static_cast<char>(damaged[40] ^ 1);
  EXPECT_FALSE(render::decodeFilm(damaged));
}

}  // namespace
}  // namespace aerosol::test
