// The one table of the language's built-in functions. What can be written in the language itself stands in
// shaders/stdosl.h instead.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/lang/type.h"

namespace aerosol::lang {

/// How a call becomes instructions.
enum class BuiltinKind : std::uint8_t {
  call,           ///< One call of the run-time library.
  componentwise,  ///< One call a component of triple arguments; floats beside triples serve all components.
  special,        ///< By the lowering of its name (core/lang/lower_*.cpp).
  derivative,     ///< As `call`; expandDerivatives replaces it.
  host,           ///< One call of the host's function `symbol`, whatever the types.
};

/// Signatures are written `result(parameters)`, separated by spaces, with one letter a type: f float, i int, s string,
/// c color, p point, v vector, n normal, m matrix, x void, C closure; g: float or any triple, the same in the whole
/// signature; r: a result that is float or any triple, whatever the parameters are; `!` before a parameter: it is
/// written; `?`: any value, arrays too, but no structure or closure; `A`: any array; `S`, `I`: any array of
/// strings, of ints; `*`: any more values.
struct BuiltinRow {
  const char* name;
  const char* signatures;
  const char* symbol;  ///< Base of the run-time symbol (see `symbolOf`); empty for special rows without one.
  BuiltinKind kind;
  bool pure;  ///< May be dropped, moved and repeated.
  const char* doc;
  std::uint8_t traits = 0;  ///< HostTrait bits, of host rows.
};

/// Everything but host rows.
std::span<const BuiltinRow> builtinTable();
/// The rows of the host's functions.
std::span<const BuiltinRow> hostBuiltinTable();

/// One signature of a row, spelled out.
struct BuiltinOverload {
  const BuiltinRow* row = nullptr;
  Type result;
  std::vector<Type> parameters;  ///< `none` for `?` and `A`; unsized for `S` and `I`.
  std::uint32_t outputs = 0;     ///< Bit i: parameter i is written.
  std::uint32_t arrays = 0;      ///< Bit i: parameter i is any array.
  std::uint32_t any = 0;         ///< Bit i: parameter i is any value.
  bool variadic = false;
};

/// The overloads of a name, kept for one compilation: pointers stay valid as long as this does.
class BuiltinOverloads {
 public:
  /// Empty when there is no such function.
  const std::vector<std::unique_ptr<BuiltinOverload>>& find(std::string_view name);

 private:
  std::map<std::string, std::vector<std::unique_ptr<BuiltinOverload>>, std::less<>> known_;
};

/// `float noise(string, float, …)`
std::string toString(const BuiltinOverload& overload);

/// Name in the run-time library, without the domain's prefix: `base_result_arguments`, such as `perlin_f_v`: letters
/// f i s v m, x for no result; capital letters for arrays.
std::string symbolOf(std::string_view base, const Type& result, std::span<const Type> arguments);

/// Names of all rows, for "did you mean".
std::vector<std::string> builtinNames();

}  // namespace aerosol::lang
