// From the layers of a command line to one program with its values.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/app/tools/shade_arguments.h"
#include "core/base/result.h"
#include "core/lang/compile.h"
#include "core/shading/shading_system.h"

namespace aerosol::app {

struct ShadeGroup {
  struct Layer {
    std::string name, shader;
    std::shared_ptr<const lang::Program> program;  ///< As a layer of groups.
  };
  std::string name;
  std::vector<Layer> layers;
  std::vector<ShadeConnection> connections;
  std::vector<ShadeLayer> requests;              ///< Of the layers, with their names.
  std::shared_ptr<const lang::Program> program;  ///< All layers; parameters are `layer.parameter`.
  std::vector<shading::ParameterValue> values;
  Diagnostics warnings;
  Diagnostics remarks;  ///< What OSL says when it makes code of the shaders.

  /// "layer.variable" for an output of that name, or of the last layer that has it where `variable` names no layer.
  std::optional<std::string> findOutput(std::string_view variable) const;
  /// "layer.output" of all.
  std::vector<std::string> outputs() const;
  /// The layer whose code stands at this place; the last one when none does.
  std::size_t layerAt(const SourceLocation& location) const;
};

/// Finds and compiles the shaders: in the current folder, then in `folders`. Values that fit no parameter are left out
/// with a warning. `isChanged`: with the parameters that --reparam gives.
Result<ShadeGroup> buildShadeGroup(const ShadeArguments& arguments, const std::vector<std::filesystem::path>& folders,
                                   const lang::CompileOptions& options, bool isChanged);

}  // namespace aerosol::app
