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
/// or the value does not fit; a warning when it is outside of the parameter's range.
std::optional<lang::GivenValue> givenValue(const lang::Program& program, const scene::ShaderParameter& parameter,
                                           Diagnostics& errors, Diagnostics& warnings);

/// Builds the group of one shader use: its inputs become layers before it, each once, however often it is used.
///
/// What turns normals for the materials inside of it (a bump map, both sides of a sheet) is a surface shader with an
/// output `normal nested_normal`. A copy of it without its materials comes before them, and that output feeds their
/// parameter `normal shading_normal`, through whatever lies between. Other conventions are metadata of parameters:
/// `follows = "map.gradient"` is fed by that output of whatever feeds `map` (with a `?` behind it: where there is one),
/// and `any_name = 1` takes the nested shader whose name is no parameter.
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

  /// The output that feeds the normal of nested materials: the layer's name; empty: the surface's own normal.
  using Frame = std::string;

  std::optional<Range> add(const scene::ShaderUse& use, const std::string& name, bool isWhole, const Frame& frame);
  std::optional<Range> addInput(const scene::ShaderInput& input, const Frame& frame);
  std::optional<Frame> addFrame(const scene::ShaderUse& use, const std::string& name,
                                const std::vector<std::optional<Range>>& inputs, const Frame& outer);
  void connectFrame(Range range, const Frame& frame, const SourceLocation& location);
  void connectFollowers(const lang::GroupLayer& layer, const std::string& parameter, const lang::GroupLayer& source,
                        const SourceLocation& location);
  bool addLayers(const scene::ShaderUse& use, const std::string& name, bool isWhole);
  bool addGroupText(const scene::ShaderUse& use, const std::string& prefix);
  void setValues(const scene::ShaderUse& use, Range range);
  void connect(const scene::ShaderUse& use, Range range, const std::vector<std::optional<Range>>& inputs);
  std::string chooseOutput(const scene::ShaderInput& input, const lang::Program& source, const lang::Program& target,
                           const std::string& parameter) const;
  std::string parameterFor(const scene::ShaderInput& input, const lang::GroupLayer& layer, const std::string& named);
  std::string closureParameter(const lang::GroupLayer& layer, const SourceLocation& location);
  lang::GroupLayer* layerOf(const std::string& name, Range range, std::string& parameter);
  std::string uniqueName(const std::string& wanted) const;

  const std::vector<scene::ShaderUse>& layers_;
  shading::ShaderLibrary& library_;
  Diagnostics& warnings_;
  Diagnostics errors_;
  lang::Group group_;
  std::map<std::pair<scene::Index, Frame>, std::optional<Range>> known_;
};

}  // namespace aerosol::render
