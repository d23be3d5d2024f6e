// From a shader as a scene names it to an instance of its program.
#pragma once

#include <functional>
#include <string_view>

#include "core/lang/fold.h"
#include "core/scene/description.h"
#include "core/shading/group_library.h"
#include "core/shading/shader_library.h"
#include "core/shading/shading_system.h"

namespace aerosol::render {

/// Where shaders come from.
struct ShaderSources {
  shading::ShaderLibrary& library;
  shading::GroupLibrary& groups;
  const std::vector<scene::ShaderUse>& layers;  ///< Of the scene.
};

/// Changes what is bound before it becomes an instance; may be empty.
using BoundChange = std::function<void(shading::BoundGroup&)>;

/// Finds the program or builds the group, checks that it is of `kind` ("volume", "surface"), and converts the
/// parameters to the types that it declares. Every unknown parameter and every value that does not fit is an error at
/// its place.
Result<shading::InstanceRef> bindShader(const scene::ShaderUse& use, std::string_view kind,
                                        const Transform<World, Object>& objectToWorld, const ShaderSources& sources,
                                        shading::ShadingSystem& shading, Diagnostics& warnings,
                                        const BoundChange& change = {});

/// A scene's value as one of the shading language.
lang::Constant constantOf(const scene::Value& value);

}  // namespace aerosol::render
