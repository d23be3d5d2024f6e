#include "core/render/aov/aov_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/render/aov/path_record.h"

namespace aerosol::render {
namespace {

using testing::HasSubstr;

AovScene someScene() {
  return {.lights = {{PathEvent::light, "key"}, {PathEvent::background, ""}, {PathEvent::medium, ""}},
          .objects = {{PathEvent::object, "key"}, {PathEvent::object, ""}}};
}

std::string errorsOf(const std::vector<scene::AovRequest>& requests, const AovScene& scene = someScene()) {
  const auto plan = planAovs(requests, scene);
  return plan ? "" : format(plan.errors());
}

TEST(AovPlan, GathersEachThingOnce) {
  const auto plan = planAovs(std::vector<scene::AovRequest>{{"d", "depth", {}},
                                                            {"again", "depth", {}},
                                                            {"direct", "direct", {}},
                                                            {"denoise", "denoise", {}},
                                                            {"error", "error", {}}},
                             someScene());
  ASSERT_TRUE(plan) << format(plan.errors());
  const AovLayout& layout = (*plan)->layout;
  EXPECT_TRUE(layout.isSound());
  EXPECT_EQ(layout.find("d")->first, layout.find("again")->first);
  EXPECT_EQ(layout.find("d")->channels, (std::vector<std::string>{"d.T"}));
  EXPECT_EQ(layout.find("visible_albedo_variance")->first, layout.find("visible_albedo")->first);
  EXPECT_EQ(layout.find("error")->finish, AovFinish::standardError);
  // depth, direct, two halves with weights, albedo and normal of what is seen with their squares, depth with a weight.
  EXPECT_EQ(layout.width, 1u + 3 + 8 + 12 + 2);
}

TEST(AovPlan, RefusesByNameAndPlace) {
  const SourceLocation place{"a.xml", 7, 30};
  EXPECT_THAT(errorsOf({{"b", "boundary_test", place}}), HasSubstr("a.xml:7:30: error: 'boundary_test' is no AOV"));
  EXPECT_THAT(errorsOf({{"b", "shnormal", place}}), HasSubstr("did you mean 'sh_normal'"));
  EXPECT_THAT(errorsOf({{"a", "depth", {}}, {"a", "uv", place}}),
              HasSubstr("7:30: error: a second AOV with the name 'a'"));
  EXPECT_THAT(errorsOf({{"x", "C<RX>L", place}}), HasSubstr("at byte 4, behind 'C<R'"));
  EXPECT_THAT(errorsOf({{"x", "C<L.'fill'>", place}}), HasSubstr("nothing has the label 'fill'; known are 'key'"));
  EXPECT_THAT(errorsOf({{"x", "CRD", place}}), HasSubstr("no light path matches 'CRD'"));
  EXPECT_THAT(errorsOf({{"x", "C<L'key'>D*", place}}), testing::IsEmpty());
  EXPECT_THAT(errorsOf({{"x", "(D|R)*L", place}}), HasSubstr("a path begins with C"));
  AovScene shown = someScene();
  EXPECT_THAT(errorsOf({{"x", "debug:wet", place}}, shown),
              HasSubstr("no surface shader of the scene calls debug(), and no volume shader has such an output"));
  shown.outputs = {{0, 1, "dry"}};
  EXPECT_THAT(errorsOf({{"x", "debug:wet", place}}, shown), HasSubstr("no shader has the output 'wet'"));
  EXPECT_EQ(errorsOf({{"debug:dry", "debug:dry", place}}, shown), "");
  AovScene dark = someScene();
  dark.lights[0].group = dark.objects[0].group = "";
  EXPECT_THAT(errorsOf({{"g", "light_groups", place}}, dark), HasSubstr("no light of the scene is in a group"));
  EXPECT_THAT(errorsOf({{"x", "C<L.'key'>", place}}, dark), HasSubstr("no emitter has a light_group"));
  dark.tracesPaths = false;
  for (const char* name : {"direct", "visible_depth", "visible_albedo_variance", "C.*L"})
    EXPECT_THAT(errorsOf({{"x", name, place}}, dark), HasSubstr("the integrator 'depth' follows no light"));
  EXPECT_EQ(errorsOf({{"x", "depth", place}}, dark), "");
}

/// A path that goes on as diffuse and as glossy at once.
TEST(PathRecord, FollowsAllKindsOfScatteringAtOnce) {
  const auto plan = planAovs(std::vector<scene::AovRequest>{{"d", "C<RD>.*L", {}},
                                                            {"g", "C<RG>.*L", {}},
                                                            {"dg", "CDGL", {}},
                                                            {"key", "C.*<L.'key'>", {}},
                                                            {"s", "CDsL", {}},
                                                            {"all", "C.*[LOB]", {}}},
                             someScene());
  ASSERT_TRUE(plan) << format(plan.errors());
  PathRecord record(**plan);
  record.begin();
  const Color light(1, 2, 4);
  const ScatterShare both[] = {{PathEvent::reflectDiffuse, Color(0.25f, 0.5f, 1)},
                               {PathEvent::reflectGlossy, Color(0.75f, 0.5f, 0)}};
  const ScatterShare straight[] = {{PathEvent::straight, Color(1)}};
  record.noteLight(0, {0, 0, 1}, false);
  record.addSampled(light, both);  // Direct: d 0.25 … and g 0.75 …
  record.noteLight(0, {0, 0, 1}, true);
  record.addSampled(light, both);  // The same behind a surface that lets shadow rays pass.
  record.scatter(both, Color(0.5f));
  record.weaken(Color(2));
  record.scatter(straight, Color(1));
  record.scatter(straight, Color(0.5f));  // In a row they are one event.
  record.addFromLight(light, 0);
  record.scatter(both, Color(1));
  record.addFromLight(light, 0);
  record.addFromLight(light, 1);
  const std::span<const float> values = record.finish({.color = light});
  const auto at = [&](const char* name, std::size_t c) { return values[(*plan)->layout.find(name)->first + c]; };
  EXPECT_FLOAT_EQ(at("d", 0), 0.25f + 0.25f + 0.125f + 0.125f);
  EXPECT_FLOAT_EQ(at("g", 0), 0.75f + 0.75f + 0.375f + 0.375f);
  EXPECT_FLOAT_EQ(at("d", 2), 4 * (1 + 1 + 0.5f + 0.5f));
  EXPECT_FLOAT_EQ(at("g", 2), 0);
  EXPECT_FLOAT_EQ(at("dg", 0), 0);  // A straight passing lies between.
  EXPECT_FLOAT_EQ(at("s", 1), 2 * (0.5f + 0.25f));
  EXPECT_FLOAT_EQ(at("key", 1), 2 * (1 + 1 + 0.5f + 0.5f));
  EXPECT_FLOAT_EQ(at("all", 1), 2 * (1 + 1 + 0.5f + 0.5f + 0.5f));
}

}  // namespace
}  // namespace aerosol::render
