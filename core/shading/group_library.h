// Shader groups as families: one merged program for all groups that differ in values only.
#pragma once

#include <memory>
#include <string>
#include <unordered_map>

#include "core/lang/group.h"
#include "core/lang/group_text.h"
#include "core/shading/shader_library.h"
#include "core/shading/shading_system.h"

namespace aerosol::shading {

/// A group's program and what its instance gives.
struct BoundGroup {
  std::shared_ptr<const lang::Program> program;
  std::vector<ParameterValue> values;
};

/// Not thread-safe: used while a scene is prepared.
class GroupLibrary {
 public:
  /// Resolves and merges a group. Groups of the same structure get the same program.
  Result<BoundGroup> bind(const lang::Group& group, Diagnostics& warnings, const lang::GroupOptions& options = {});

 private:
  struct Known {
    std::shared_ptr<const lang::Program> program;
    std::vector<std::shared_ptr<const lang::Program>> layers;  ///< Keeps what the key tells by address.
  };
  std::unordered_map<std::string, Known> known_;
};

/// The layers of a group's text with their shaders found by name.
Result<lang::Group> loadGroup(const lang::GroupText& text, const std::string& name, ShaderLibrary& library,
                              Diagnostics& warnings);

}  // namespace aerosol::shading
