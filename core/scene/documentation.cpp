#include "core/scene/documentation.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/scene/reporter.h"
#include "core/scene/tables.h"

namespace aerosol::scene {

namespace {

template <class T>
std::vector<ParameterSpec> specsOf(const std::vector<Field<T>>& fields) {
  std::vector<ParameterSpec> specs;
  for (const Field<T>& field : fields) specs.push_back(field.spec);
  return specs;
}

template <class T>
void addTables(const std::string& tag, const std::vector<TypeTable<T>>& tables, std::vector<ObjectDoc>& docs) {
  for (const TypeTable<T>& table : tables) {
    docs.push_back({tag, table.type, table.aliases, table.doc, table.nested, specsOf(table.fields)});
  }
}

/// "float, degrees", "x | y | diagonal".
std::string typeText(const ParameterSpec& spec) {
  std::string text =
      spec.choices.empty() ? std::string(name(spec.type)) : fmt::format("{}", fmt::join(spec.choices, " | "));
  if (!spec.unit.empty()) text += ", " + spec.unit;
  if (const std::string range = format(spec.range); !range.empty()) text += ", " + range;
  return text;
}

std::string defaultText(const ParameterSpec& spec) {
  if (spec.required) return "required";
  if (!spec.defaultText.empty()) return "default: " + spec.defaultText;
  return spec.defaultValue ? "default: " + format(*spec.defaultValue) : "optional";
}

std::string page(const ObjectDoc& object) {
  std::string text = fmt::format("<{} type=\"{}\">  {}\n", object.tag, object.type, object.doc);
  if (!object.aliases.empty()) text += fmt::format("  also called: {}\n", join(object.aliases));
  std::size_t width = 0;
  for (const ParameterSpec& spec : object.parameters) width = std::max(width, spec.name.size());
  for (const ParameterSpec& spec : object.parameters) {
    text += fmt::format("  {:{}}  {} ({}; {})\n", spec.name, width, spec.doc, typeText(spec), defaultText(spec));
  }
  if (!object.nested.empty()) text += fmt::format("  inside: {}\n", object.nested);
  return text;
}

constexpr const char* introduction =
    R"(<scene version="3.0.0"> holds the objects below. Any object can have an id="…"; <ref id="…"/> then stands for it.

  <default name="…" value="…"/>  gives $name a value, unless -D name=value does; $name or ${name} works in any attribute
  <include filename="…"/>        reads another file in this place
  <path value="…"/>              adds a folder in which files and shaders are looked for
  <alias id="…" as="…"/>         gives an object a second id

Parameters are written <TYPE name="…" value="…"/> with the types
  float, integer, boolean (true, false), string
  rgb (one number, three, or #rrggbb in sRGB), spectrum (one number, or three)
  point, vector (value="x, y, z", or x, y and z apart)
  transform, which holds steps, each applied after those before it:
    <translate x y z | value/>  <scale x y z | value/>  <rotate x y z | value, angle (degrees)/>
    <lookat origin target up/>  <matrix value (16 or 9 numbers, row by row)/>
  animation, in the place of a to_world of sensors, shapes and volumes: 1 to 64 <transform time="…"> (seconds). Between
    two of them translations and stretches change evenly and rotations take the shortest way; outside they stand still.
    Blur shows from shutter_open to shutter_close of the sensor.

Shaders (bsdf, medium, displacement, texture) take other shaders as inputs of their parameters:
  <texture name="PARAMETER" type="SHADER" output="…"> in a shader is a layer whose output feeds that parameter, or the
  part of it that is named (c.r, p[0], a[2], s.field). Without output="…" it is the first output that fits. A bsdf in a
  bsdf, or a medium in a medium, feeds a closure parameter. A layer with an id can be used many times by
  <ref id="…" name="PARAMETER"/>: it is evaluated once, where something first reads it.

A shader of type osl is written into the scene:
  <source><![CDATA[ … ]]></source>  OSL source; or <source file="…"/>
  <group><![CDATA[ … ]]></group>    a shader group, or <group file="…"/>, of which the last layer is the shader:
    param TYPE NAME VALUE… ;  shader SHADER LAYER ;  connect LAYER.OUTPUT LAYER.PARAMETER ;
    Its parameters are set as LAYER.NAME, by elements beside the group.

--set shader.parameter=value and --set shader.layer.parameter=value change parameters; layer is the name of a layer of a
group, or of the parameter that a texture feeds.

)";

}  // namespace

std::vector<ObjectDoc> objectDocs(const KnownTypes& known) {
  std::vector<ObjectDoc> docs;
  addTables("integrator", integratorTypes(), docs);
  addTables("sensor", sensorTypes(), docs);
  addTables("film", filmTypes(), docs);
  addTables("rfilter", filterTypes(), docs);
  addTables("sampler", samplerTypes(), docs);
  addTables("shape", shapeTypes(), docs);
  for (const VolumeType& type : known.volumes) {
    ObjectDoc object{"volume", type.type, {}, type.doc, "medium", type.parameters};
    for (const ParameterSpec& spec : specsOf(volumeFields())) object.parameters.push_back(spec);
    for (const ParameterSpec& spec : specsOf(velocityFields())) object.parameters.push_back(spec);
    for (const ParameterSpec& spec : specsOf(samplingFields())) object.parameters.push_back(spec);
    docs.push_back(std::move(object));
  }
  docs.push_back({"medium",
                  "SHADER",
                  {},
                  "a volume shader: SHADER.osl on the search path; its parameters, and",
                  "texture, medium named as the parameter they feed; phase; source "
                  "or group",
                  specsOf(samplingFields())});
  addTables("phase", phaseTypes(), docs);
  docs.push_back({"bsdf",
                  "SHADER",
                  {},
                  "a surface shader: diffuse, null, or SHADER.osl on the search path; its parameters",
                  "texture, bsdf named as the parameter they feed; source or group",
                  {}});
  docs.push_back(
      {"displacement",
       "SHADER",
       {},
       "a displacement shader: SHADER.osl on the search path moves P (in world space, before the render); its "
       "parameters, and",
       "texture named as the parameter it feeds; source or group",
       specsOf(tessellationFields())});
  docs.push_back({"texture",
                  "SHADER",
                  {},
                  "a layer: a shader on the search path with outputs; its parameters",
                  "texture named as the parameter it feeds; source or group",
                  {}});
  addTables("emitter", emitterTypes(), docs);
  return docs;
}

std::string documentation(const KnownTypes& known, const std::string& topic) {
  std::string text = topic.empty() ? introduction : "";
  bool first = true;
  for (const ObjectDoc& object : objectDocs(known)) {
    if (!topic.empty() && topic != object.tag && topic != object.type &&
        std::find(object.aliases.begin(), object.aliases.end(), topic) == object.aliases.end()) {
      continue;
    }
    if (!std::exchange(first, false)) text += '\n';
    text += page(object);
  }
  return text;
}

}  // namespace aerosol::scene
