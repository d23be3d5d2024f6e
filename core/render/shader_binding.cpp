#include "core/render/shader_binding.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/base/cie_xyz.h"
#include "core/render/group_binding.h"
#include "core/render/parameter_range.h"

namespace aerosol::render {

namespace {

using lang::BaseType;
using lang::ConstantValue;
using scene::ValueType;

/// The scene's type of a shader parameter; nothing for what a scene file cannot hold.
std::optional<ValueType> sceneType(const lang::Type& type) {
  if (type.isArray() || type.closure) return {};
  switch (type.base) {
    case BaseType::integer:
      return ValueType::integer;
    case BaseType::floating:
      return ValueType::number;
    case BaseType::string:
      return ValueType::string;
    case BaseType::color:
      return ValueType::color;
    case BaseType::point:
      return ValueType::point;
    case BaseType::vector:
    case BaseType::normal:
      return ValueType::vector;
    case BaseType::matrix:
      return ValueType::transform;
    default:
      return {};
  }
}

template <class Triple>
ConstantValue tripleValue(const Triple& t) {
  return std::vector<float>{t[0], t[1], t[2]};
}

/// Matrices of the language act on row vectors, those of scenes on column vectors.
ConstantValue matrixValue(const Matrix4& m) {
  std::vector<float> elements;
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column) elements.push_back(static_cast<float>(m[column][row]));
  }
  return elements;
}

ConstantValue shaderValue(const scene::Value& value) {
  switch (scene::typeOf(value)) {
    case ValueType::boolean:
      return std::vector<std::int32_t>{std::get<bool>(value)};
    case ValueType::integer:
      return std::vector<std::int32_t>{std::get<int>(value)};
    case ValueType::number:
      return std::vector<float>{std::get<float>(value)};
    case ValueType::string:
      return std::vector<std::string>{std::get<std::string>(value)};
    case ValueType::color:
      return tripleValue(std::get<Color>(value));
    case ValueType::point:
      return tripleValue(std::get<Point<scene::Unplaced>>(value));
    case ValueType::vector:
      return tripleValue(std::get<Vector<scene::Unplaced>>(value));
    case ValueType::transform:
      return matrixValue(std::get<Matrix4>(value));
  }
  return {};
}

Diagnostic unknownParameter(const lang::Program& program, const scene::ShaderParameter& parameter) {
  std::vector<std::string> known;
  std::string list;
  for (const lang::Parameter& p : program.parameters) {
    if (p.isOutput) continue;
    known.push_back(p.name);
    list += fmt::format("{}{} {}", list.empty() ? "" : ", ", lang::toString(p.type), p.name);
  }
  Diagnostic error{.location = parameter.location,
                   .message = fmt::format("shader '{}' has no parameter '{}'", program.name, parameter.name)};
  if (const std::string hint = didYouMean(parameter.name, known); !hint.empty()) error.notes.push_back(hint);
  error.notes.push_back(known.empty() ? "it has no parameters" : "its parameters: " + list);
  return error;
}

/// Numbers that have names: metadata `string names = "water 1.333, bk7 1.5046"` of a number. Nothing when it has none.
std::optional<std::vector<std::pair<std::string, float>>> namedNumbers(const lang::Parameter& parameter) {
  for (const lang::MetadataValue& entry : parameter.metadata) {
    const auto* texts = std::get_if<std::vector<std::string>>(&entry.value);
    if (entry.name != "names" || !texts || texts->empty() || parameter.type != lang::types::floating) continue;
    std::vector<std::pair<std::string, float>> numbers;
    std::string_view rest = texts->front();
    while (!rest.empty()) {
      const std::size_t comma = rest.find(',');
      const std::string_view one = scene::trim(rest.substr(0, comma));
      rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
      const std::size_t space = one.rfind(' ');
      scene::TextError error;
      const auto number = space == one.npos ? std::nullopt : scene::parseFloat(one.substr(space + 1), error);
      if (number) numbers.emplace_back(std::string(scene::trim(one.substr(0, space))), *number);
    }
    return numbers;
  }
  return {};
}

/// The number that a text names; nothing when the parameter takes no names. An unknown name is an error.
std::optional<scene::Value> namedNumber(const lang::Parameter& parameter, const scene::ShaderParameter& given,
                                        bool& isKnown, Diagnostics& errors) {
  const auto* text = std::get_if<std::string>(&given.value);
  const auto numbers = text ? namedNumbers(parameter) : std::nullopt;
  if (!numbers) return {};
  std::string lower = *text;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::vector<std::string> names;
  std::string list;
  for (const auto& [name, number] : *numbers) {
    if (name == lower) return scene::Value(number);
    names.push_back(name);
    list += (list.empty() ? "known names: " : ", ") + name;
  }
  isKnown = false;
  Diagnostic error{.location = given.valueLocation,
                   .message = fmt::format("'{}' is no number, and no name that '{}' knows", *text, parameter.name)};
  if (const std::string hint = didYouMean(lower, names); !hint.empty()) error.notes.push_back(hint);
  error.notes.push_back(list);
  errors.add(std::move(error));
  return {};
}

/// A parameter by its name, or by metadata `string written = "volume"`: a name that is a word of the language.
std::optional<std::uint32_t> parameterWritten(const lang::Program& program, const std::string& name) {
  if (const auto index = shading::findParameter(program, name)) return index;
  for (std::uint32_t i = 0; i < program.parameters.size(); ++i) {
    for (const lang::MetadataValue& entry : program.parameters[i].metadata) {
      const auto* texts = std::get_if<std::vector<std::string>>(&entry.value);
      if (entry.name == "written" && texts && !texts->empty() && texts->front() == name) return i;
    }
  }
  return {};
}

bool isOfKind(const scene::ShaderUse& use, const lang::Program& program, std::string_view kind, Diagnostics& errors) {
  // A shader of no special kind has no coefficients to give.
  if (program.kind == kind || (program.kind == "shader" && kind != "volume")) return true;
  if (kind == "surface" && program.isSurface()) return true;
  errors.error(use.nameLocation,
               fmt::format("'{}' is a {}{}; a {} shader is needed here", use.code ? program.name : use.name,
                           program.kind, program.kind == "shader" ? "" : " shader", kind));
  return false;
}

Result<shading::BoundGroup> bindGroup(const scene::ShaderUse& use, std::string_view kind, const ShaderSources& sources,
                                      Diagnostics& warnings) {
  const auto group = GroupBuilder(sources.layers, sources.library, warnings).build(use);
  if (!group) return group.errors();
  Diagnostics errors;
  if (!isOfKind(use, *group->layers.back().program, kind, errors)) return errors;
  return sources.groups.bind(*group, warnings);
}

Result<shading::BoundGroup> bindSingle(const scene::ShaderUse& use, std::string_view kind, const ShaderSources& sources,
                                       Diagnostics& warnings) {
  const auto program = sources.library.find(use.name, use.nameLocation, warnings);
  if (!program) return program.errors();
  Diagnostics errors;
  if (!isOfKind(use, **program, kind, errors)) return errors;
  shading::BoundGroup bound{*program, {}};
  for (const scene::ShaderParameter& parameter : use.parameters) {
    auto value = givenValue(**program, parameter, errors, warnings);
    const auto index = parameterWritten(**program, parameter.name);
    if (value && index) bound.values.push_back({*index, std::move(value->value)});
  }
  if (errors.hasErrors()) return errors;
  return bound;
}

}  // namespace

lang::Constant constantOf(const scene::Value& value) {
  const auto type = [&] {
    switch (scene::typeOf(value)) {
      case ValueType::boolean:
      case ValueType::integer:
        return lang::types::integer;
      case ValueType::number:
        return lang::types::floating;
      case ValueType::string:
        return lang::types::string;
      case ValueType::color:
        return lang::types::color;
      case ValueType::point:
        return lang::types::point;
      case ValueType::vector:
        return lang::types::vector;
      case ValueType::transform:
        return lang::types::matrix;
    }
    return lang::types::none;
  };
  return {type(), shaderValue(value)};
}

std::optional<lang::GivenValue> givenValue(const lang::Program& program, const scene::ShaderParameter& parameter,
                                           Diagnostics& errors, Diagnostics& warnings) {
  const std::optional<std::uint32_t> index = parameterWritten(program, parameter.name);
  if (!index) {
    errors.add(unknownParameter(program, parameter));
    return std::nullopt;
  }
  const lang::Type& type = program.parameters[*index].type;
  const std::optional<ValueType> wanted = sceneType(type);
  std::optional<scene::Value> value = wanted ? parameter.convertTo(*wanted) : std::nullopt;
  // A colour where a number is asked for is its luminance, as the values of textures are.
  if (const Color* color = std::get_if<Color>(&parameter.value); !value && color && wanted == ValueType::number)
    value = scene::Value(toXyz(*color)[1]);
  if (!value) {
    bool isKnown = true;
    value = namedNumber(program.parameters[*index], parameter, isKnown, errors);
    if (!isKnown) return std::nullopt;
  }
  if (!value) {
    errors.error(parameter.valueLocation,
                 fmt::format("parameter '{}' of shader '{}' is a {}; {} does not fit", parameter.name, program.name,
                             lang::toString(type), scene::name(scene::typeOf(parameter.value))));
    return std::nullopt;
  }
  lang::GivenValue given{program.parameters[*index].name, type, shaderValue(*value), parameter.location};
  warnOutsideRange(program.parameters[*index], given.value, program.name, parameter.valueLocation, warnings);
  return given;
}

Result<shading::InstanceRef> bindShader(const scene::ShaderUse& use, std::string_view kind,
                                        const Transform<World, Object>& objectToWorld, const ShaderSources& sources,
                                        shading::ShadingSystem& shading, Diagnostics& warnings,
                                        const BoundChange& change) {
  const bool isGroup = use.code || !use.inputs.empty();
  auto bound = isGroup ? bindGroup(use, kind, sources, warnings) : bindSingle(use, kind, sources, warnings);
  if (!bound) return bound.errors();
  if (change) change(*bound);
  shading::Instance instance;
  instance.objectToWorld = objectToWorld;
  instance.values = std::move(bound->values);
  return shading.add(std::move(bound->program), std::move(instance));
}

}  // namespace aerosol::render
