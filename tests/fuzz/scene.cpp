// Reading a scene from any bytes ends with a description or with errors; it never crashes and never hangs.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/scene/loader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace aerosol;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const scene::LoadOptions options{.defines = {}, .overrides = {"*.step_scale=2", "film.width=8"}, .knownTypes = {}};
  Diagnostics warnings;
  const auto scene = scene::loadString(text, "fuzz.xml", {}, options, warnings);
  if (!scene && format(scene.errors()).empty()) std::abort();
  return 0;
}
