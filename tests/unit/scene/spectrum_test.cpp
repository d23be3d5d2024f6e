#include "core/scene/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/loader.h"

namespace aerosol::scene {
namespace {

void expectNear(Color found, Color expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance) << "channel " << c;
}

Color colorOfText(const char* text, SpectrumUse use) {
  TextError error;
  const auto spectrum = parseSpectrum(text, error);
  EXPECT_TRUE(spectrum) << error.message;
  return spectrum ? colorOf(*spectrum, use) : Color(-1);
}

/// A factor that is the same everywhere is grey; such light is that of illuminant E, whose chromaticity is (1/3, 1/3).
TEST(Spectrum, FlatOnes) {
  expectNear(colorOf([](double) { return 0.5; }, SpectrumUse::factor), Color(0.5f), 1e-3f);
  const Color light = colorOf([](double) { return 1.0; }, SpectrumUse::emitted);
  const float x = 0.412453f * light.r + 0.357580f * light.g + 0.180423f * light.b;
  const float y = 0.212671f * light.r + 0.715160f * light.g + 0.072169f * light.b;
  const float z = 0.019334f * light.r + 0.119193f * light.g + 0.950227f * light.b;
  expectNear({x, y, z}, Color(1), 2e-3f);
}

/// Numbers that Mitsuba 3.9 finds for the same lists.
TEST(Spectrum, ListsOfWavelengths) {
  const char* const text = "400:0.1, 500:0.3, 600:0.9, 700:0.2";
  expectNear(colorOfText(text, SpectrumUse::factor), Color(0.88761f, 0.56284f, 0.15549f), 3e-3f);
  expectNear(colorOfText(text, SpectrumUse::emitted), Color(1.021149f, 0.54285f, 0.132375f), 3e-3f);
}

TEST(Spectrum, IsLinearBetweenItsWavelengthsAndNothingOutside) {
  const Spectrum spectrum{{400, 500, 700}, {1, 3, 2}};
  EXPECT_EQ(spectrum(399), 0);
  EXPECT_EQ(spectrum(400), 1);
  EXPECT_DOUBLE_EQ(spectrum(450), 2);
  EXPECT_DOUBLE_EQ(spectrum(600), 2.5);
  EXPECT_EQ(spectrum(700), 2);
  EXPECT_EQ(spectrum(701), 0);
}

/// Wien's law, and the law of Stefan and Boltzmann by summing up.
TEST(Spectrum, BlackBodies) {
  double total = 0, peak = 0, where = 0;
  for (double w = 50; w < 40000; w += 1) {
    const double radiance = blackbodyRadiance(w, 5000);
    total += radiance;
    if (radiance > peak) peak = radiance, where = w;
  }
  EXPECT_NEAR(where, 2.897771955e6 / 5000, 1);
  EXPECT_NEAR(total * 3.14159265358979 / (5.670374419e-8 * std::pow(5000.0, 4)), 1, 1e-3);
}

TEST(Spectrum, ErrorsAreLocated) {
  TextError error;
  EXPECT_FALSE(parseSpectrum("400:1 500", error));
  EXPECT_EQ(error.offset, 6u);
  EXPECT_FALSE(parseSpectrum("400:1, 5x0:1", error));
  EXPECT_EQ(error.offset, 7u);
  EXPECT_FALSE(parseSpectrum("400:1, 400:2", error));
  EXPECT_EQ(error.message, "wavelengths have to ascend");
  EXPECT_FALSE(parseSpectrum("400:1", error));
}

/// Each way to write one, in a scene.
TEST(Spectrum, InScenes) {
  const auto radiance = [](const std::string& spectrum) {
    Diagnostics warnings;
    const auto scene = loadString("<scene version=\"3.0.0\"><sensor type=\"perspective\"/><emitter type=\"constant\">" +
                                      spectrum + "</emitter></scene>",
                                  "test.xml", {}, {}, warnings);
    EXPECT_TRUE(scene) << spectrum;
    return scene ? scene->emitters.at(0).emitted : Color(-1);
  };
  expectNear(radiance(R"(<spectrum name="radiance" value="0.5"/>)"), Color(0.602397f, 0.474146f, 0.454458f), 1e-3f);
  expectNear(radiance(R"(<float name="radiance" value="0.5"/>)"), Color(0.5f), 0);
  expectNear(radiance(R"(<spectrum name="radiance" type="uniform"><float name="value" value="0.7"/></spectrum>)"),
             Color(0.7f), 0);
  expectNear(radiance(R"(<spectrum name="radiance" type="d65"><float name="scale" value="2"/></spectrum>)"), Color(2),
             0);
  expectNear(radiance(R"(<spectrum name="radiance" type="d65"><rgb name="color" value="0.1, 0.2, 0.3"/>
      <float name="scale" value="2"/></spectrum>)"),
             Color(0.2f, 0.4f, 0.6f), 1e-7f);
  expectNear(radiance(R"(<spectrum name="radiance" type="srgb"><rgb name="color" value="0.1, 0.2, 0.3"/></spectrum>)"),
             Color(0.1f, 0.2f, 0.3f), 0);
  const Color list = radiance(R"(<spectrum name="radiance" value="400:0.1, 500:0.3, 600:0.9, 700:0.2"/>)");
  expectNear(radiance(R"(<spectrum name="radiance" type="irregular">
      <string name="wavelengths" value="400, 500, 600, 700"/><string name="values" value="0.1, 0.3, 0.9, 0.2"/></spectrum>)"),
             list, 1e-6f);
  expectNear(radiance(R"(<spectrum name="radiance" type="regular"><float name="wavelength_min" value="400"/>
      <float name="wavelength_max" value="700"/><string name="values" value="0.1, 0.3, 0.9, 0.2"/></spectrum>)"),
             list, 1e-6f);
  const Color warm =
      radiance(R"(<spectrum name="radiance" type="blackbody"><float name="temperature" value="3000"/></spectrum>)");
  EXPECT_GT(warm.r, 2 * warm.g);
  EXPECT_GT(warm.g, 2 * warm.b);
}

/// One spectrum, wherever it stands and by whatever name, is light to a light and a factor to a material.
TEST(Spectrum, IsSharedByReference) {
  Diagnostics warnings;
  const auto scene = loadString(R"(<scene version="3.0.0"><sensor type="perspective"/>
      <shape type="sphere"><bsdf type="diffuse"><ref name="reflectance" id="late"/></bsdf></shape>
      <emitter type="constant"><ref name="radiance" id="other"/></emitter>
      <emitter type="point"><spectrum name="intensity" id="inner" value="400:1, 700:3"/></emitter>
      <shape type="sphere"><bsdf type="plastic"><ref name="diffuse_reflectance" id="inner"/></bsdf></shape>
      <spectrum id="late" type="uniform"><float name="value" value="0.3"/></spectrum>
      <spectrum id="flat" value="0.5"/><alias id="flat" as="same"/><alias id="same" as="other"/></scene>)",
                                "test.xml", {}, {}, warnings);
  ASSERT_TRUE(scene) << format(scene.errors());
  EXPECT_EQ(format(warnings), "");
  const auto colour = [&](std::size_t material, const char* name) {
    const ShaderParameter* parameter = scene->materials.at(material).find(name);
    return parameter ? std::get<Color>(parameter->value) : Color(-1);
  };
  expectNear(colour(0, "reflectance"), Color(0.3f), 0);
  expectNear(scene->emitters.at(0).emitted, Color(0.602397f, 0.474146f, 0.454458f), 1e-3f);
  const Spectrum rising{{400, 700}, {1, 3}};
  expectNear(scene->emitters.at(1).emitted, colorOf(rising, SpectrumUse::emitted), 1e-6f);
  expectNear(colour(1, "diffuse_reflectance"), colorOf(rising, SpectrumUse::factor), 1e-6f);
}

}  // namespace
}  // namespace aerosol::scene
