// The textual form of shader groups:
//
//     param <type> <name> <value>… [[ <hints> ]] ;
//     shader <shader> <layer> ;
//     connect <layer>.<output> <layer>.<parameter> ;
//
// White space separates words; a '#' before a word starts a comment up to the end of the line. A comma may stand for
// a semicolon, and the last one may be left out. A `param` belongs to the next `shader`. Missing values are 0 or "".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/lang/group.h"

namespace aerosol::lang {

/// A group as written: its shaders are still names.
struct GroupText {
  struct Layer {
    std::string shader;
    std::string name;  ///< The shader's name where none is written.
    std::vector<GivenValue> values;
    SourceLocation shaderLocation;
    SourceLocation location;  ///< Of the layer's name.
  };
  std::vector<Layer> layers;
  std::vector<Connection> connections;
};

inline constexpr std::size_t maximumGroupTextBytes = std::size_t{16} << 20;

/// Reads a group. `start` is the place of the text's first character. As many errors as can be found in one run, up to
/// a hundred.
Result<GroupText> parseGroup(std::string_view text, const SourceLocation& start);

/// The text of a group, which `parseGroup` reads as the same group.
std::string format(const GroupText& group);

}  // namespace aerosol::lang
