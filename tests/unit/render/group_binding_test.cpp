#include "core/render/group_binding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/loader.h"

namespace aerosol::render {
namespace {

using ::testing::HasSubstr;

/// The first material of a scene as a group, or what is wrong with it.
struct Bound {
  explicit Bound(const std::string& bsdf, const std::string& more = "", std::vector<std::string> overrides = {}) {
    const std::string xml = "<scene version=\"3.0.0\"><sensor type=\"perspective\"/>\n" + more +
                            "<shape type=\"sphere\">\n" + bsdf + "</shape></scene>";
    Diagnostics warnings;
    auto scene = scene::loadString(xml, "test.xml", {},
                                   {.defines = {}, .overrides = std::move(overrides), .knownTypes = {}}, warnings);
    if (!scene) {
      errors = format(scene.errors());
      return;
    }
    lang::CompileOptions options;
    options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
    shading::ShaderLibrary library({AEROSOL_SOURCE_DIR "/tests/render/shaders", AEROSOL_SOURCE_DIR "/shaders"}, options,
                                   nullptr);
    auto built = GroupBuilder(scene->layers, library, warnings).build(scene->materials.at(0));
    if (!built) {
      errors = format(built.errors());
      return;
    }
    group = std::move(*built);
    const auto resolved = lang::resolve(group);
    if (!resolved) errors = format(resolved.errors());
  }

  std::vector<std::string> layers() const {
    std::vector<std::string> names;
    for (const lang::GroupLayer& layer : group.layers) names.push_back(layer.name);
    return names;
  }
  std::vector<std::string> connections() const {
    std::vector<std::string> all;
    for (const lang::Connection& c : group.connections)
      all.push_back(c.sourceLayer + "." + c.source + " " + c.layer + "." + c.parameter);
    return all;
  }
  float value(const std::string& layer, const std::string& parameter) const {
    for (const lang::GroupLayer& one : group.layers)
      for (const lang::GivenValue& given : one.values)
        if (one.name == layer && given.parameter == parameter) return std::get<std::vector<float>>(given.value).at(0);
    return -1;
  }

  lang::Group group;
  std::string errors;
};

using Names = std::vector<std::string>;

TEST(GroupBuilder, NestedTexturesAreLayers) {
  const Bound bound(R"(<bsdf type="diffuse"><texture name="reflectance" type="line">
                         <texture name="slope" type="line"/></texture></bsdf>)");
  EXPECT_EQ(bound.errors, "");
  EXPECT_EQ(bound.layers(), (Names{"slope", "reflectance", "diffuse"}));
  EXPECT_EQ(bound.connections(), (Names{"slope.value reflectance.slope", "reflectance.sides diffuse.reflectance"}));
}

TEST(GroupBuilder, ReferencesShareALayer) {
  const Bound bound(R"(<bsdf type="blend"><bsdf type="diffuse"><ref id="t" name="reflectance"/></bsdf>
                         <bsdf type="diffuse"><ref id="t" name="reflectance"/></bsdf>
                         <ref id="t" name="weight"/></bsdf>)",
                    R"(<texture type="line" id="t"/>)");
  EXPECT_EQ(bound.errors, "");
  EXPECT_EQ(bound.layers(), (Names{"t", "diffuse", "diffuse2", "blend"}));
  EXPECT_EQ(bound.connections(), (Names{"t.sides diffuse.reflectance", "t.sides diffuse2.reflectance",
                                        "diffuse.Ci blend.first", "diffuse2.Ci blend.second", "t.value blend.weight"}));
}

TEST(GroupBuilder, ValuesReachLayersOfAGroup) {
  const char* const bsdf = R"(<bsdf type="osl" id="wall"><float name="l.slope" value="3"/>
    <group>shader line l, shader diffuse d, connect l.sides d.reflectance</group></bsdf>)";
  EXPECT_EQ(Bound(bsdf).value("l", "slope"), 3);
  EXPECT_EQ(Bound(bsdf, "", {"wall.l.slope=4"}).value("l", "slope"), 4);
  EXPECT_EQ(Bound(bsdf, "", {"bsdf.l.at_zero=5"}).value("l", "at_zero"), 5);
}

TEST(GroupBuilder, ValuesReachTextures) {
  const char* const bsdf = R"(<bsdf type="diffuse" id="wall"><texture name="reflectance" type="line" id="t"/></bsdf>)";
  EXPECT_EQ(Bound(bsdf, "", {"wall.reflectance.slope=4"}).value("t", "slope"), 4);
  EXPECT_EQ(Bound(bsdf, "", {"t.slope=5"}).value("t", "slope"), 5);
  EXPECT_EQ(Bound(bsdf, "", {"wall.reflectance=0.25"}).layers(), Names{"diffuse"});
}

TEST(GroupBuilder, WhatTurnsNormalsComesBeforeItsMaterialsToo) {
  const Bound bound(R"(<bsdf type="twosided"><bsdf type="bumpmap"><texture name="anything" type="slope"/>
                         <bsdf type="diffuse"/></bsdf></bsdf>)");
  EXPECT_EQ(bound.errors, "");
  EXPECT_EQ(bound.layers(), (Names{"twosided_normal", "anything", "bumpmap_normal", "diffuse", "bumpmap", "twosided"}));
  EXPECT_EQ(bound.connections(),
            (Names{"anything.value bumpmap_normal.map", "anything.gradient bumpmap_normal.map_gradient",
                   "twosided_normal.nested_normal bumpmap_normal.shading_normal",
                   "bumpmap_normal.nested_normal diffuse.shading_normal", "anything.value bumpmap.map",
                   "anything.gradient bumpmap.map_gradient", "diffuse.Ci bumpmap.bsdf",
                   "twosided_normal.nested_normal bumpmap.shading_normal", "bumpmap.Ci twosided.bsdf"}));
}

TEST(GroupBuilder, OneMaterialInTwoFramesIsTwoLayers) {
  const Bound bound(R"(<bsdf type="blendbsdf"><ref id="m"/><bsdf type="twosided"><ref id="m"/></bsdf></bsdf>)",
                    R"(<bsdf type="diffuse" id="m"/>)");
  EXPECT_EQ(bound.errors, "");
  EXPECT_EQ(bound.layers(), (Names{"m", "twosided_normal", "m2", "twosided", "blendbsdf"}));
  EXPECT_EQ(bound.connections(), (Names{"twosided_normal.nested_normal m2.shading_normal", "m2.Ci twosided.bsdf",
                                        "m.Ci blendbsdf.bsdf_0", "twosided.Ci blendbsdf.bsdf_1"}));
}

TEST(GroupBuilder, NumbersMayHaveNames) {
  const auto glass = [](const char* name) {
    return Bound(std::string("<bsdf type=\"twosided\"><bsdf type=\"plastic\"><string name=\"int_ior\" value=\"") +
                 name + "\"/></bsdf></bsdf>");
  };
  EXPECT_FLOAT_EQ(glass("Water ice").value("plastic", "int_ior"), 1.31f);
  EXPECT_THAT(glass("watr").errors,
              HasSubstr("test.xml:3:74: error: 'watr' is no number, and no name that 'int_ior' knows"));
  EXPECT_THAT(glass("watr").errors, HasSubstr("did you mean 'water'"));
}

TEST(GroupBuilder, ErrorsOfMaterialsInsideOfOthersAreLocated) {
  EXPECT_THAT(Bound("<bsdf type=\"mask\"><bsdf type=\"diffuse\"/><bsdf type=\"null\"/></bsdf>").errors,
              HasSubstr("shader 'mask' takes no more than 1 nested material"));
  EXPECT_THAT(Bound("<bsdf type=\"bumpmap\"><texture type=\"line\" name=\"x\"/><bsdf type=\"diffuse\"/></bsdf>").errors,
              HasSubstr("shader 'line' has no output 'gradient', which 'map_gradient' of shader 'bumpmap' needs"));
}

TEST(GroupBuilder, ErrorsAreLocated) {
  const std::string unknown =
      Bound("<bsdf type=\"diffuse\"><texture name=\"reflectanc\" type=\"line\"/></bsdf>").errors;
  EXPECT_THAT(unknown,
              HasSubstr("test.xml:3:37: error: layer 'diffuse' (shader 'diffuse') has no parameter 'reflectanc'"));
  EXPECT_THAT(unknown, HasSubstr("did you mean 'reflectance'?"));
  const std::string output =
      Bound("<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"line\" output=\"tint\"/></bsdf>").errors;
  EXPECT_THAT(output, HasSubstr("test.xml:3:70: error: layer 'reflectance' (shader 'line') has no output 'tint'"));
  EXPECT_THAT(output, HasSubstr("its outputs: float value, color sides"));
  const std::string parameter = Bound(
                                    "<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"line\">\n"
                                    "<float name=\"slop\" value=\"1\"/></texture></bsdf>")
                                    .errors;
  EXPECT_THAT(parameter, HasSubstr("test.xml:4:14: error: shader 'line' has no parameter 'slop'"));
  EXPECT_THAT(Bound("<bsdf type=\"diffuse\"><texture type=\"line\"/></bsdf>").errors,
              HasSubstr("test.xml:3:22: error: name=\"…\" is missing: the parameter that this shader feeds"));
  EXPECT_THAT(Bound("<bsdf type=\"osl\"><group>\nshader line l ;\n shader diffus d ;</group></bsdf>").errors,
              HasSubstr("test.xml:5:9: error: unknown shader 'diffus'"));
  EXPECT_THAT(Bound("<bsdf type=\"osl\"><source><![CDATA[\nsurface s() {\n  Ci = x;\n}]]></source></bsdf>").errors,
              HasSubstr("test.xml:5:8: error: "));
  EXPECT_THAT(Bound("<bsdf type=\"osl\"/>").errors, HasSubstr("a bsdf of type osl needs its <source> or <group>"));
  EXPECT_THAT(Bound("<bsdf type=\"diffuse\"><source>x</source></bsdf>").errors,
              HasSubstr("a bsdf with <source> is of type osl"));
  EXPECT_THAT(Bound("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1\"/>"
                    "<texture name=\"reflectance\" type=\"line\"/></bsdf>")
                  .errors,
              HasSubstr("parameter 'reflectance' is given twice"));
  EXPECT_THAT(Bound("<bsdf type=\"diffuse\"><ref id=\"a\" name=\"reflectance\"/></bsdf>",
                    "<texture id=\"a\" type=\"line\"><ref id=\"a\" name=\"slope\"/></texture>")
                  .errors,
              HasSubstr("'a' is connected to itself"));
}

}  // namespace
}  // namespace aerosol::render
