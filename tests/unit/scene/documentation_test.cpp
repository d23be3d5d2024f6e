#include "core/scene/documentation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/unit/scene/scene_test_support.h"

namespace aerosol::scene {
namespace {

constexpr const char* someFile = AEROSOL_SOURCE_DIR "/README.md";

/// A scene that holds one object with one parameter written.
std::string sceneWith(const ObjectDoc& object, const std::string& parameter) {
  std::string children;
  for (const ParameterSpec& p : object.parameters) {
    if (!p.required) continue;
    const bool isFile = p.type == ValueType::string;
    children += isFile ? fmt::format("<string name=\"{}\" value=\"{}\"/>", p.name, someFile)
                       : fmt::format("<float name=\"{}\" value=\"1\"/>", p.name);
  }
  if (object.tag == "volume") children += "<medium type=\"fog\"/>";
  if (object.type == "background") children += "<bsdf type=\"sky\"/>";
  if (object.type == "blendphase") children += "<phase type=\"isotropic\"/><phase type=\"rayleigh\"/>";
  const std::string element =
      fmt::format("<{0} type=\"{1}\">{2}{3}</{0}>", object.tag, object.type, children, parameter);
  const auto inSensor = [](const std::string& text) { return "<sensor type=\"perspective\">" + text + "</sensor>"; };
  if (object.tag == "film" || object.tag == "sampler") return inSensor(element);
  if (object.tag == "rfilter") return inSensor("<film type=\"hdrfilm\">" + element + "</film>");
  if (object.tag == "phase") return "<volume type=\"box\"><medium type=\"fog\">" + element + "</medium></volume>";
  if (object.tag == "medium") return "<volume type=\"box\">" + element + "</volume>";
  if (object.type == "area" || object.tag == "displacement") return "<shape type=\"cube\">" + element + "</shape>";
  return element;
}

std::string write(const ParameterSpec& spec, const Value& value) {
  return fmt::format("<{} name=\"{}\" value=\"{}\"/>", name(spec.type), spec.name, format(value));
}

TEST(Documentation, EveryDefaultCanBeWritten) {
  int count = 0;
  for (const ObjectDoc& object : objectDocs({})) {
    for (const ParameterSpec& spec : object.parameters) {
      if (!spec.defaultValue || spec.name == "fov_axis") continue;
      Diagnostics warnings;
      read(sceneWith(object, write(spec, *spec.defaultValue)), {}, &warnings);
      ++count;
    }
  }
  EXPECT_GT(count, 40);
}

TEST(Documentation, EveryRangeIsEnforced) {
  int count = 0;
  for (const ObjectDoc& object : objectDocs({})) {
    for (const ParameterSpec& spec : object.parameters) {
      const double outside = spec.range.openMinimum ? spec.range.minimum : spec.range.minimum - 1;
      if (!(outside > -1e30) || spec.required) continue;
      Value value = static_cast<float>(outside);
      if (spec.type == ValueType::integer) value = static_cast<int>(outside);
      const std::string errors = readErrors(sceneWith(object, write(spec, value)));
      EXPECT_NE(errors.find(fmt::format("'{}' is ", spec.name)), std::string::npos) << errors;
      ++count;
    }
  }
  EXPECT_GT(count, 25);
}

TEST(Documentation, NamesEveryParameterWithItsUnit) {
  const std::string text = documentation({});
  for (const ObjectDoc& object : objectDocs({})) {
    EXPECT_NE(text.find(fmt::format("<{} type=\"{}\">", object.tag, object.type)), std::string::npos);
    for (const ParameterSpec& spec : object.parameters) {
      EXPECT_NE(text.find(spec.name), std::string::npos);
      EXPECT_FALSE(spec.doc.empty()) << object.tag << " " << spec.name;
    }
  }
}

TEST(Documentation, CanBeAskedForOneTopic) {
  const std::string sphere = documentation({}, "sphere");
  EXPECT_NE(sphere.find("<shape type=\"sphere\">"), std::string::npos);
  EXPECT_NE(sphere.find("<volume type=\"sphere\">"), std::string::npos);
  EXPECT_EQ(sphere.find("<shape type=\"cube\">"), std::string::npos);
  EXPECT_NE(documentation({}, "volpath").find("max_depth"), std::string::npos);
  EXPECT_EQ(documentation({}, "nonsense"), "");
}

}  // namespace
}  // namespace aerosol::scene
