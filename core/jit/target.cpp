#include "core/jit/target.h"

#include <array>

#include "core/base/diagnostic.h"

namespace aerosol::jit {

namespace {

struct IsaName {
  Isa isa;
  std::string_view name;
  std::string_view alias;
};
constexpr std::array isaNames = {IsaName{Isa::x86_64_v3, "x86-64-v3", "avx2"},
                                 IsaName{Isa::x86_64_v4, "x86-64-v4", "avx512"}};

Diagnostic targetError(std::string message, std::string note) {
  Diagnostic error;
  error.message = std::move(message);
  error.notes.push_back(std::move(note));
  return error;
}

}  // namespace

std::string_view name(Isa isa) {
  for (const IsaName& entry : isaNames) {
    if (entry.isa == isa) return entry.name;
  }
  return {};
}

std::optional<Isa> hostIsa() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v4")) return Isa::x86_64_v4;
  if (__builtin_cpu_supports("x86-64-v3")) return Isa::x86_64_v3;
#endif
  return {};
}

Result<Target> chooseTarget(std::optional<int> width, std::optional<std::string_view> isa) {
  const std::optional<Isa> host = hostIsa();
  if (!host) {
    return targetError("this processor cannot run compiled shaders", "AVX2 and FMA (x86-64-v3) are needed");
  }
  Target target;
  target.isa = *host;
  if (isa) {
    bool known = false;
    for (const IsaName& entry : isaNames) {
      if (*isa != entry.name && *isa != entry.alias) continue;
      known = true;
      target.isa = entry.isa;
    }
    if (!known) {
      return targetError("unknown instruction set '" + std::string(*isa) + "'",
                         "valid: x86-64-v3 (avx2), x86-64-v4 (avx512)");
    }
    if (target.isa > *host) {
      return targetError("this processor has no " + std::string(name(target.isa)),
                         "its best instruction set is " + std::string(name(*host)));
    }
  }
  target.width = target.isa == Isa::x86_64_v4 ? 16 : 8;
  if (width) {
    if (*width != 16 && *width != 8 && *width != 4 && *width != 1) {
      return targetError("no such width: " + std::to_string(*width), "valid: 16, 8, 4, 1");
    }
    target.width = *width;
  }
  return target;
}

}  // namespace aerosol::jit
