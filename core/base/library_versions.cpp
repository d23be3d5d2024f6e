#include "core/base/library_versions.h"

#include <ImathConfig.h>
#include <fmt/core.h>
#include <xxhash.h>

namespace aerosol {

namespace {

std::string dotted(unsigned number) {
  return std::to_string(number / 10000) + "." + std::to_string(number / 100 % 100) + "." + std::to_string(number % 100);
}

}  // namespace

std::vector<std::string> baseLibraryVersions() {
  return {"fmt " + dotted(FMT_VERSION), "Imath " IMATH_VERSION_STRING, "xxHash " + dotted(XXH_versionNumber())};
}

}  // namespace aerosol
