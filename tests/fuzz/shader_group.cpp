// Reading a shader group from any bytes ends with a group or with errors; what was read is written and read again as
// the same; resolving and merging it, with shaders that have every kind of parameter, ends with a program or errors.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>

#include "core/lang/compile.h"
#include "core/lang/group_text.h"

namespace {

using namespace aerosol;

std::shared_ptr<const lang::Program> compiled(const char* source) {
  lang::CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  const auto result = lang::compileString(source, "fuzz.osl", options);
  if (!result) std::abort();
  return result->layer;
}

/// The shaders a, b and c; other names are those of none.
const std::map<std::string, std::shared_ptr<const lang::Program>>& shaders() {
  static const std::map<std::string, std::shared_ptr<const lang::Program>> all = {
      {"a",
       compiled(
           "struct S { float x; color y[2]; };\n"
           "shader a(float f = 1, int i = 2, color c = P, string s = \"t\", matrix m = 1, float l[3] = {1, 2, 3},\n"
           "         S t = {1, {2, 3}}, output float f1 = 0, output color c1 = 0, output float l1[3] = {0, 0, 0},\n"
           "         output S t1 = {1, {2, 3}}, output closure color k = 0, output string s1 = \"\") {\n"
           "  f1 = f + i + l[1] + t.x; c1 = c * t.y[1]; l1 = l; t1 = t; k = c * diffuse(N); s1 = s;\n}")},
      {"b", compiled("surface b(float f = 1, closure color k = 0, output float f1 = 0) {\n"
                     "  printf(\"%g %d\", f, isconnected(f)); if (u > 0) Ci += k; f1 = f; }")},
      {"c", compiled("shader c(float f = u, color c = 0, output float f1 = 0, output color c1 = 0) {\n"
                     "  for (int i = 0; i < 3; ++i) { if (f > i) continue; f1 += c[0]; }\n  if (v > 0) c1 = c; }")}};
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto group = lang::parseGroup(text, {"fuzz", 1, 1});
  if (!group) {
    if (format(group.errors()).empty()) std::abort();
    return 0;
  }
  const std::string written = lang::format(*group);
  const auto again = lang::parseGroup(written, {"fuzz", 1, 1});
  if (again && lang::format(*again) != written) std::abort();
  lang::Group layers;
  for (const auto& layer : group->layers) {
    const auto known = shaders().find(layer.shader);
    if (known == shaders().end()) return 0;
    layers.layers.push_back({layer.name, known->second, layer.values, layer.location});
  }
  layers.connections = group->connections;
  const auto resolved = lang::resolve(layers);
  if (!resolved) return 0;
  const auto program = lang::merge(*resolved);
  if (!program && format(program.errors()).empty()) std::abort();
  return 0;
}
