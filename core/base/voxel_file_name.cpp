#include "core/base/voxel_file_name.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace aerosol {

bool isVoxelFileName(std::string_view path) {
  constexpr std::array<std::string_view, 3> extensions{".vdb", ".vol", ".avt"};
  return std::ranges::any_of(extensions, [path](std::string_view extension) {
    // A name that is nothing but an extension is a hidden file.
    return path.size() > extension.size() && path[path.size() - extension.size() - 1] != '/' &&
           std::ranges::equal(path.substr(path.size() - extension.size()), extension,
                              [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
  });
}

}  // namespace aerosol
