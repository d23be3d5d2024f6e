#include "core/app/tools/shade_group.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/app/tools/shader_files.h"
#include "core/lang/compile.h"

namespace aerosol::app {

namespace fs = std::filesystem;

namespace {

/// In the current folder, or else on the search path.
Result<std::shared_ptr<const lang::Program>> findShader(const ShadeLayer& layer, shading::ShaderLibrary& library,
                                                        Diagnostics& warnings) {
  if (!layer.expression.empty()) return library.compile(layer.expression, layer.shader, warnings);
  std::vector<fs::path> folders = {""};
  folders.insert(folders.end(), library.searchPath().begin(), library.searchPath().end());
  if (const auto file = findShaderFile(layer.shader, folders)) return library.load(*file, warnings);
  return library.find(layer.shader, {}, warnings);  // Says what there is.
}

void bindValues(const ShadeLayer& layer, ShadeGroup& group) {
  for (const NamedValue& given : layer.values) {
    const auto index = shading::findParameter(*group.program, given.name);
    if (!index) {
      group.warnings.warning({}, "attempting to set nonexistent parameter: " + given.name);
      continue;
    }
    const lang::Type& type = group.program->parameters[*index].type;
    auto value = bindValue(type, given.value);
    if (!value) {
      group.warnings.warning({}, fmt::format("attempting to set parameter with wrong type: {} (expected '{}', "
                                             "received '{}')",
                                             given.name, lang::toString(type), lang::toString(given.value.type)));
      continue;
    }
    std::erase_if(group.values, [&](const shading::ParameterValue& known) { return known.parameter == *index; });
    group.values.push_back({*index, std::move(*value)});
  }
}

}  // namespace

Result<ShadeGroup> buildShadeGroup(const ShadeArguments& arguments, shading::ShaderLibrary& library) {
  if (arguments.layers.size() != 1 || !arguments.connections.empty())
    return Diagnostic{Severity::error, {}, "only a single shader can be run", {}, {}};
  const ShadeLayer& layer = arguments.layers.front();
  ShadeGroup group;
  group.name = arguments.groupName.empty() ? "unnamed_group_1" : arguments.groupName;
  auto program = findShader(layer, library, group.warnings);
  if (!program) return program.errors();
  group.program = std::move(*program);
  group.shaders = {group.program->name};
  group.layers = {layer.layer.empty() ? fmt::format("{}_{}", group.program->name, 0) : layer.layer};
  bindValues(layer, group);
  return group;
}

}  // namespace aerosol::app
