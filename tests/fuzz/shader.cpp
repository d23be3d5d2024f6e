// Compiling a shader from any bytes, from the preprocessor to a specialised program, ends with a program or with
// errors; it never crashes, never hangs and never takes unbounded memory.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/lang/analysis.h"
#include "core/lang/compile.h"
#include "core/lang/serialize.h"

namespace {

using namespace aerosol;

/// What a host does with a program: cut to outputs, fixed parameters, to bytes and back.
void use(const lang::Program& program) {
  const lang::Program part = lang::slice(program, program.outputs, lang::Messages::drop);
  lang::ParameterValues defaults;
  for (std::uint32_t i = 0; i < part.parameters.size(); ++i) defaults[i] = {};
  const lang::Program fixed = lang::specialise(part, defaults);
  for (const lang::Output& output : fixed.outputs) lang::isConstant(fixed, output);
  if (!lang::deserialiseProgram(lang::serialise(fixed))) std::abort();
  if (lang::toString(fixed).empty()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  lang::CompileOptions options;
  // The library costs most of the time, so only some inputs get it; without, an empty header stands in.
  const bool withLibrary = size % 8 == 0;
  options.standardLibrary = AEROSOL_SOURCE_DIR + std::string(withLibrary ? "/shaders/stdosl.h" : "/tests/fuzz/empty.h");
  const auto compiled = lang::compileString(text, "fuzz.osl", options);
  if (!compiled) {
    if (format(compiled.errors()).empty()) std::abort();
    return 0;
  }
  use(*compiled->program);
  return 0;
}
