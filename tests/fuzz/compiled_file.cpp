// Reading a compiled file (.oso) from any bytes ends with a program or with errors.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/lang/compile.h"
#include "core/lang/compiled_file.h"

using namespace aerosol;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto source = lang::sourceOfCompiledFile(text, "fuzz.oso");
  if (!source) {
    if (format(source.errors()).empty()) std::abort();
    return 0;
  }
  lang::CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  const auto compiled = lang::compileString(*source, "fuzz.oso", options);
  if (!compiled && format(compiled.errors()).empty()) std::abort();
  return 0;
}
