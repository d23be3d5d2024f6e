// The language's functions that the host answers. What runs is found by the symbol: among the pure functions
// (pure_functions.h), otherwise among the host's (core/shading/host_functions.h).
#include <array>

#include "core/lang/builtins.h"

namespace aerosol::lang {

namespace {

constexpr auto host = BuiltinKind::host;
constexpr auto special = BuiltinKind::special;

constexpr std::array table = {
    // Strings
    BuiltinRow{"concat", "s(s*)", "concat", special, true, "The strings one after the other."},
    BuiltinRow{"strlen", "i(s)", "strlen", host, true, "Number of bytes."},
    BuiltinRow{"startswith", "i(ss)", "startswith", host, true, "Whether the first begins with the second."},
    BuiltinRow{"endswith", "i(ss)", "endswith", host, true, "Whether the first ends with the second."},
    BuiltinRow{"stoi", "i(s)", "stoi", host, true, "The int at the beginning, or 0."},
    BuiltinRow{"stof", "f(s)", "stof", host, true, "The float at the beginning, or 0."},
    BuiltinRow{"substr", "s(si) s(sii)", "substr", host, true, "Part of a string: (text, start [, length])."},
    BuiltinRow{"getchar", "i(si)", "getchar", host, true, "Byte of a string, 0 outside."},
    BuiltinRow{"hash", "i(s)", "stringhash", host, true, "A whole number that depends on all characters."},
    BuiltinRow{"split", "i(s!S) i(s!Ss) i(s!Ssi)", "split", host, true,
               "Puts the parts of a string between separators (default: blanks) into an array, at most as many as the "
               "last argument says, and gives their number."},
    BuiltinRow{"format", "s(s*)", "format", special, true, "The text that printf would print."},
};

}  // namespace

std::span<const BuiltinRow> hostBuiltinTable() { return table; }

}  // namespace aerosol::lang
