// What a shader shows of itself: its parameters as declared, with defaults and metadata.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/lang/compile.h"
#include "core/lang/program.h"

namespace aerosol::lang {

/// A parameter, or a field `s.a` of one that is a structure; a structure itself stands before its fields.
struct ParameterInterface {
  std::string name;
  Type type;  ///< Of structures base and array length alone.
  bool isOutput = false;
  std::string structName;                     ///< Of structures: the name of the type.
  std::vector<std::string> fields;            ///< Of structures.
  std::optional<ConstantValue> defaultValue;  ///< Nothing where it is computed, as oslc sees it, and of structures.
  std::vector<MetadataValue> metadata;
};

struct ShaderInterface {
  std::string kind, name;
  std::vector<MetadataValue> metadata;
  std::vector<ParameterInterface> parameters;  ///< In their order.
};

/// Of the shader of a source file or a compiled file. It has to compile.
Result<ShaderInterface> readShaderInterface(const std::filesystem::path& path, const CompileOptions& options);

}  // namespace aerosol::lang
