#include "core/app/tools/shade_group.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <utility>

#include "core/app/tools/group_text.h"
#include "core/app/tools/shader_files.h"
#include "core/lang/array_lengths.h"
#include "core/lang/group.h"
#include "core/lang/user_data.h"
#include "core/shading/native_plugins.h"

namespace aerosol::app {

namespace fs = std::filesystem;

namespace {

bool isImageOutput(const lang::Parameter& parameter) { return parameter.isOutput && !parameter.type.closure; }

/// The layers and connections asked for; those of a group's text where there is one.
Result<GroupText> requested(const ShadeArguments& arguments) {
  if (arguments.group.empty()) return GroupText{arguments.layers, arguments.connections};
  std::string text = arguments.group, file = "group";
  std::error_code ignored;
  if (text.size() < 4096 && fs::is_regular_file(text, ignored)) {
    file = text;
    std::ifstream stream(file, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(stream), {});
  }
  auto group = parseGroupText(text, file);
  if (group) std::ranges::copy(arguments.connections, std::back_inserter(group->connections));
  return group;
}

/// Compiles each shader once.
class Compiler {
 public:
  Diagnostics remarks;  ///< Of all shaders that were compiled.

  Compiler(const std::vector<fs::path>& folders, const lang::CompileOptions& options)
      : folders_{""}, options_(options) {
    folders_.insert(folders_.end(), folders.begin(), folders.end());
  }

  /// `lengths` of arrays that the shader declares without one.
  Result<std::shared_ptr<const lang::Program>> compile(const ShadeLayer& layer, Diagnostics& warnings,
                                                       const lang::ArrayLengths& lengths = {}) {
    auto& known = compiled_[{layer.shader, lengths}];
    if (!known) {
      auto source = layer.expression.empty() ? compileFile(layer.shader, lengths)
                                             : lang::compileString(layer.expression, layer.shader, options_, lengths);
      if (!source) return source.errors();
      warnings.append(source->warnings);
      remarks.append(source->remarks);
      known = source->layer;
    }
    std::shared_ptr<const lang::Program> program = known;
    for (const NamedValue& value : layer.values)
      if (value.interpolated) program = std::make_shared<lang::Program>(lang::bindUserData(*program, value.name));
    return program;
  }

 private:
  Result<lang::CompiledSource> compileFile(const std::string& name, const lang::ArrayLengths& lengths) const {
    if (const auto file = findShaderFile(name, folders_)) {
      return shading::isPluginFile(*file) ? shading::compilePlugin(*file, options_)
                                          : lang::compileFile(*file, options_, lengths);
    }
    return Diagnostic{Severity::error, {}, fmt::format("No .oso file could be found for shader \"{}\"", name), {}, {}};
  }

  std::vector<fs::path> folders_;
  const lang::CompileOptions& options_;
  std::map<std::pair<std::string, lang::ArrayLengths>, std::shared_ptr<const lang::Program>> compiled_;
};

/// With the parameter's own type where OSL lets the value stand for one of it: a float for a colour.
lang::GivenValue bound(const NamedValue& given, const lang::Program& program) {
  const auto parameter = std::ranges::find(program.parameters, given.name, &lang::Parameter::name);
  if (parameter != program.parameters.end() && parameter->type.isTriple()) {
    if (auto value = bindValue(parameter->type, given.value)) return {given.name, parameter->type, *value, {}};
  }
  return {given.name, given.value.type, given.value.value, {}};
}

lang::Group describe(const ShadeGroup& group, const ShadeArguments& arguments) {
  lang::Group described;
  described.name = group.name;
  described.entryLayers = arguments.entryLayers;
  for (std::size_t i = 0; i < group.layers.size(); ++i) {
    lang::GroupLayer layer{group.layers[i].name, group.layers[i].program, {}, {}};
    for (const NamedValue& given : group.requests[i].values) layer.values.push_back(bound(given, *layer.program));
    described.layers.push_back(std::move(layer));
  }
  for (const ShadeConnection& c : group.connections)
    described.connections.push_back({c.fromLayer, c.fromOutput, c.toLayer, c.toInput, {}, {}});
  for (const ShadeOutput& output : arguments.outputs)
    if (const auto name = group.findOutput(output.variable)) described.outputs.push_back(*name);
  for (const std::string& output : arguments.entryOutputs)
    if (const auto name = group.findOutput(output)) described.outputs.push_back(*name);
  return described;
}

}  // namespace

std::optional<std::string> ShadeGroup::findOutput(std::string_view variable) const {
  for (std::size_t i = layers.size(); i-- > 0;) {
    const Layer& layer = layers[i];
    for (const lang::Parameter& parameter : layer.program->parameters) {
      if (!isImageOutput(parameter)) continue;
      const std::string full = layer.name + "." + parameter.name;
      if (variable == parameter.name || variable == full) return full;
    }
  }
  return {};
}

std::vector<std::string> ShadeGroup::outputs() const {
  std::vector<std::string> names;
  for (const Layer& layer : layers)
    for (const lang::Parameter& parameter : layer.program->parameters)
      if (isImageOutput(parameter)) names.push_back(layer.name + "." + parameter.name);
  return names;
}

std::size_t ShadeGroup::layerAt(const SourceLocation& location) const {
  for (std::size_t i = layers.size(); i-- > 0;) {
    const auto& places = layers[i].program->locations;
    if (std::ranges::find(places, location) != places.end()) return i;
  }
  return layers.size() - 1;
}

Result<ShadeGroup> buildShadeGroup(const ShadeArguments& arguments, const std::vector<fs::path>& folders,
                                   const lang::CompileOptions& options, bool isChanged) {
  auto request = requested(arguments);
  if (!request) return request.errors();
  ShadeGroup group;
  group.name = arguments.groupName.empty() ? "unnamed_group_1" : arguments.groupName;
  group.connections = std::move(request->connections);
  group.requests = std::move(request->layers);
  if (group.requests.empty()) return Diagnostic{.message = "No shader or group was specified."};
  Compiler compiler(folders, options);
  for (ShadeLayer& layer : group.requests) {
    auto program = compiler.compile(layer, group.warnings);
    if (!program) return program.errors();
    if (layer.layer.empty()) layer.layer = fmt::format("{}_{}", (*program)->name, group.layers.size());
    if (isChanged) {
      for (const ShadeReparameter& change : arguments.reparameters)
        if (change.layer == layer.layer) layer.values.push_back(change.value);
    }
    group.layers.push_back({layer.layer, (*program)->name, *program});
  }
  lang::GroupOptions groupOptions;
  groupOptions.exactTypes = true;
  groupOptions.userDataIsConnected = arguments.userDataIsConnected;
  lang::Group described = describe(group, arguments);
  const Diagnostics misfits = lang::fitArrays(described, [&](std::size_t layer, const lang::ArrayLengths& lengths) {
    return compiler.compile(group.requests[layer], group.warnings, lengths);
  });
  if (misfits.hasErrors()) return misfits;
  for (std::size_t i = 0; i < group.layers.size(); ++i) group.layers[i].program = described.layers[i].program;
  group.remarks = std::move(compiler.remarks);
  const auto resolved = lang::resolve(described, groupOptions);
  if (!resolved) return resolved.errors();
  group.warnings.append(resolved->warnings);
  auto merged = lang::merge(*resolved);
  if (!merged) return merged.errors();
  group.program = std::move(*merged);
  for (const auto& [parameter, value] : resolved->values) group.values.push_back({parameter, value});
  return group;
}

}  // namespace aerosol::app
