// From a shader that a scene builds of layers to a group.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/lang/group.h"
#include "core/scene/description.h"
#include "core/shading/group_library.h"
#include "core/shading/shader_library.h"

namespace aerosol::render {

/// The value of a written parameter as one of the program's; errors at its place when the program has no such parameter
/// or the value does not fit.
std::optional<lang::GivenValue> givenValue(const lang::Program& program, const scene::ShaderParameter& parameter,
                                           Diagnostics& errors);

/// Builds the group of one shader use: its inputs become layers before it, each once, however often it is used.
class GroupBuilder {
 public:
  GroupBuilder(const std::vector<scene::ShaderUse>& layers, shading::ShaderLibrary& library, Diagnostics& warnings)
      : layers_(layers), library_(library), warnings_(warnings) {}

  /// The group; its last layer is the shader itself.
  Result<lang::Group> build(const scene::ShaderUse& shader);

 private:
  /// Layers of the group that one use became: several where it is a group itself.
  struct Range {
    std::size_t first = 0;
    std::size_t last = 0;
  };

  std::optional<Range> add(const scene::ShaderUse& use, const std::string& name, bool isWhole);
  bool addLayers(const scene::ShaderUse& use, const std::string& name, bool isWhole);
  bool addGroupText(const scene::ShaderUse& use, const std::string& prefix);
  void setValues(const scene::ShaderUse& use, Range range);
  void connect(const scene::ShaderUse& use, Range range, const std::vector<std::optional<Range>>& inputs);
  std::string chooseOutput(const scene::ShaderInput& input, const lang::Program& source, const lang::Program& target,
                           const std::string& parameter) const;
  std::string closureParameter(const lang::GroupLayer& layer, const SourceLocation& location);
  lang::GroupLayer* layerOf(const std::string& name, Range range, std::string& parameter);
  std::string uniqueName(const std::string& wanted) const;

  const std::vector<scene::ShaderUse>& layers_;
  shading::ShaderLibrary& library_;
  Diagnostics& warnings_;
  Diagnostics errors_;
  lang::Group group_;
  std::map<scene::Index, std::optional<Range>> known_;
};

}  // namespace aerosol::render
