// Native plugins as LLVM bitcode: what is in them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace aerosol::jit {

/// What `aerosol_shader_plugin` of a bitcode file says (plugins/sdk/aerosol_shader.h).
struct NativeBitcode {
  struct Function {
    std::string declaration;
    std::string evaluate, range;  ///< Names in the bitcode; no range: empty.
  };
  std::string name, shader;
  std::vector<Function> functions;
};

/// Reads the description without running anything. An error (without a place) for bitcode of another version, for
/// another version of the interface, and for functions that need something from outside.
Result<NativeBitcode> readNativeBitcode(std::string_view bytes);

}  // namespace aerosol::jit
