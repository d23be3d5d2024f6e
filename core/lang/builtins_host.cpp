// The language's functions that the host answers. What runs is found by the symbol: among the pure functions
// (pure_functions.h), otherwise among the host's (core/shading/host_functions.h).
#include <array>

#include "core/lang/builtins.h"
#include "core/lang/program.h"

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
    BuiltinRow{
        "regex_search", "i(ss) i(s!Is)", "regex_search", host, true,
        "Whether a part of the string matches a regular expression: (text, [array that receives begin and end of "
        "the match and of each group,] expression)."},
    BuiltinRow{
        "regex_match", "i(ss) i(s!Is)", "regex_match", host, true,
        "Whether the whole string matches a regular expression: (text, [array that receives begin and end of the "
        "match and of each group,] expression)."},
    BuiltinRow{"format", "s(s*)", "format", special, true, "The text that printf would print."},
    // Textures. Their options stand in texture_options.cpp.
    BuiltinRow{"texture", "f(sff*) c(sff*) v(sff*) f(sffffff*) c(sffffff*) v(sffffff*)", "texture", special, true,
               "An image filtered around (s, t), over an area given by the derivatives of these by x and y."},
    BuiltinRow{
        "texture3d", "f(sp*) c(sp*) v(sp*) f(spvvv*) c(spvvv*) v(spvvv*)", "texture3d", special, true,
        "A volume image or a grid of an OpenVDB file at a point, filtered over an area given by its derivatives by "
        "x, y and z. Option subimage names the grid."},
    BuiltinRow{"environment", "f(sv*) c(sv*) v(sv*) f(svvv*) c(svvv*) v(svvv*)", "environment", special, true,
               "An environment image in a direction, filtered over an area given by its derivatives by x and y."},
    BuiltinRow{"gettextureinfo", "i(ss!?) i(sffs!?)", "gettextureinfo", host, true,
               "Puts an entry of a texture file's header into a variable of the same type; 0 when there is none."},
    // Point clouds
    BuiltinRow{"pointcloud_search", "i(spfi*)", "pointcloud_search", special, true,
               "Puts attributes of the nearest points within a radius into arrays and gives their number: (cloud, "
               "position, radius, at most, [whether to sort,] name, array ...). Attributes \"distance\" and \"index\" "
               "are always there."},
    BuiltinRow{
        "pointcloud_get", "i(sIi*)", "pointcloud_get", special, true,
        "Puts attributes of points into arrays: (cloud, indices, how many, name, array ...); 1 when all is there."},
    BuiltinRow{"pointcloud_write", "i(sp*)", "pointcloud_write", host, false,
               "Adds a point to a cloud that is saved when the image is finished: (cloud, position, name, value ...)."},
    BuiltinRow{"fprintf", "x(ss*)", "", special, false, "Prints at the end of a file: (file name, format, …)."},
    BuiltinRow{"aerosol_colors", "c(ssc)", "colors", host, true,
               "A colour between colour spaces that the colour configuration knows: (from, to, colour)."},
    // What the renderer knows
    BuiltinRow{
        "getattribute", "i(s!?) i(si!?) i(ss!?) i(ssi!?)", "getattribute", special, true,
        "Value of a named attribute: ([object,] name [, index of an element], variable). 1 when it was found and "
        "could become the variable's type; otherwise the variable stays as it is.",
        dependsOnPoint},
    BuiltinRow{"raytype", "i(s)", "raytype", host, true, "Whether the ray is of a kind such as \"camera\".",
               dependsOnPoint},
    BuiltinRow{"backfacing", "i()", "backfacing", host, true, "Whether the surface is seen from behind.",
               dependsOnPoint},
    BuiltinRow{"surfacearea", "f()", "surfacearea", host, true, "Area of the object, in square scene units.",
               dependsOnPoint},
    BuiltinRow{
        "random", "f() c() p() v() n()", "random", special, true,
        "A random number from 0 to 1, another one for each call, point and sample, and the same again in the same "
        "image.",
        dependsOnPoint},
    BuiltinRow{"setmessage", "x(s?)", "setmessage", host, false,
               "Keeps a value by name for getmessage, for the rest of the point's shading.", writesMessages},
    BuiltinRow{
        "getmessage", "i(s!?) i(ss!?)", "getmessage", host, true,
        "Value that setmessage, or the source named first (\"trace\"), keeps under a name: 1 when there is one of "
        "the variable's type.",
        dependsOnPoint | readsMessages},
    BuiltinRow{
        "trace", "i(pv*)", "trace", host, false,
        "Whether a ray from a position in a direction hits anything: (position, direction, name, value ...) with "
        "\"mindist\", \"maxdist\", \"shade\" and \"traceset\". getmessage(\"trace\", ...) tells what was hit.",
        dependsOnPoint | writesMessages},
    BuiltinRow{"dict_find", "i(ss) i(is)", "dict_find", host, true,
               "The first node of a dictionary (XML text, or the name of such a file), or below a node, that an XPath "
               "query matches; 0: none, -1: no dictionary."},
    BuiltinRow{"dict_next", "i(i)", "dict_next", host, true, "The next node that matched the node's query, or 0."},
    BuiltinRow{"dict_value", "i(is!?)", "dict_value", host, true,
               "Puts an attribute of a node, or with \"\" its text, into a variable: 1 when it can be of its type."},
    BuiltinRow{"isconstant", "i(?)", "isconstant", special, true,
               "Whether the value is the same for all points of an instance."},
};

}  // namespace

std::span<const BuiltinRow> hostBuiltinTable() { return table; }

}  // namespace aerosol::lang
