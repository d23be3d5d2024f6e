// What identifies this program's compiler of shaders.
#pragma once

#include <string_view>

namespace aerosol {

/// A hash of the sources that decide what code a shader becomes, as hexadecimal digits. Made by the build.
std::string_view codeVersion();

}  // namespace aerosol
