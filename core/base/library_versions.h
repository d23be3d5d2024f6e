// The libraries under the base layer.
#pragma once

#include <string>
#include <vector>

namespace aerosol {

/// "fmt 9.1.0" and the like, one entry a library.
std::vector<std::string> baseLibraryVersions();

}  // namespace aerosol
