// IR to optimised machine code.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/jit/compiler.h"

namespace aerosol::jit {

enum class CodeForm : std::uint8_t { object, intermediate, assembly };

struct GeneratedCode {
  std::string code;  ///< An ELF object with the function `kernel`, or text.
  KernelInterface interface;
  CompileTimes times;
};

/// `runtime` is the bitcode of the runtime library for the request's domain and width.
Result<GeneratedCode> generateCode(const KernelRequest& request, std::string_view runtime, CodeForm form);

}  // namespace aerosol::jit
