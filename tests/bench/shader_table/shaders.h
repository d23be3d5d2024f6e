// The shaders of the table, as sources; references.h has the same functions in C++.
#pragma once

#include <string>
#include <vector>

#include "core/lang/group.h"

namespace aerosol::bench {

struct TableShader {
  std::string name;
  std::string source;
  std::string widthSource;  ///< The same with a second output, the filter width of the first; empty: none.
};

/// All but the group and the texture.
std::vector<TableShader> tableShaders();

/// A thousand lines: 50 layers of 20 lines that differ, in a chain. `salt` makes it different from others.
lang::Group chainOfLayers(int count, int salt);

/// Looks a texture up by P; the file's name is a parameter.
TableShader textureShader();

}  // namespace aerosol::bench
