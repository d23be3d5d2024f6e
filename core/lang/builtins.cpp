#include "core/lang/builtins.h"

#include <array>
#include <cassert>
#include <cctype>

namespace aerosol::lang {

namespace {

constexpr auto call = BuiltinKind::call;
constexpr auto comp = BuiltinKind::componentwise;
constexpr auto special = BuiltinKind::special;
constexpr auto derivative = BuiltinKind::derivative;

constexpr const char* noiseSignatures = "r(f) r(ff) r(p) r(pf)";
constexpr const char* derivativeSignatures = "f(f) v(p) v(v) v(n) c(c)";
constexpr const char* periodicSignatures = "r(ff) r(ffff) r(pp) r(pfpf)";

constexpr std::array table = {
    // Trigonometry
    BuiltinRow{"sin", "g(g)", "sin", comp, true, "Sine of an angle in radians."},
    BuiltinRow{"cos", "g(g)", "cos", comp, true, "Cosine of an angle in radians."},
    BuiltinRow{"tan", "g(g)", "tan", comp, true, "Tangent of an angle in radians."},
    BuiltinRow{"asin", "g(g)", "asin", comp, true, "Arc sine of the argument clamped to [-1, 1], in radians."},
    BuiltinRow{"acos", "g(g)", "acos", comp, true, "Arc cosine of the argument clamped to [-1, 1], in radians."},
    BuiltinRow{"atan", "g(g) g(gg)", "", special, true,
               "Arc tangent in radians; of y / x by quadrant with two arguments."},
    BuiltinRow{"atan2", "g(gg)", "atan2", comp, true, "Angle of the point (x, y), given as (y, x), in radians."},
    BuiltinRow{"sinh", "g(g)", "sinh", comp, true, "Hyperbolic sine."},
    BuiltinRow{"cosh", "g(g)", "cosh", comp, true, "Hyperbolic cosine."},
    BuiltinRow{"tanh", "g(g)", "tanh", comp, true, "Hyperbolic tangent."},
    BuiltinRow{"sincos", "x(g!g!g)", "", special, true, "Sine and cosine of an angle in radians at once."},
    BuiltinRow{"degrees", "g(g)", "degrees", comp, true, "Radians to degrees."},
    BuiltinRow{"radians", "g(g)", "radians", comp, true, "Degrees to radians."},
    // Powers and logarithms
    BuiltinRow{"pow", "g(gg) g(gf)", "pow", comp, true, "x to the power y; 0 where undefined."},
    BuiltinRow{"exp", "g(g)", "exp", comp, true, "e to the power x."},
    BuiltinRow{"exp2", "g(g)", "exp2", comp, true, "2 to the power x."},
    BuiltinRow{"expm1", "g(g)", "expm1", comp, true, "exp(x) - 1, accurate near 0."},
    BuiltinRow{"log", "g(g) g(gf)", "log", comp, true,
               "Natural logarithm, or to the base given second; arguments below the least normal float count as it."},
    BuiltinRow{"log2", "g(g)", "log2", comp, true, "Logarithm to base 2."},
    BuiltinRow{"log10", "g(g)", "log10", comp, true, "Logarithm to base 10."},
    BuiltinRow{"logb", "g(g)", "logb", comp, true, "Exponent of x as a float."},
    BuiltinRow{"sqrt", "g(g)", "sqrt", comp, true, "Square root; 0 for negative x."},
    BuiltinRow{"inversesqrt", "g(g)", "inversesqrt", comp, true, "1 / sqrt(x); 0 for x <= 0."},
    BuiltinRow{"cbrt", "g(g)", "cbrt", comp, true, "Cube root, of the sign of x."},
    BuiltinRow{"hypot", "f(ff) f(fff)", "hypot", call, true, "Square root of the sum of squares."},
    BuiltinRow{"erf", "f(f)", "erf", call, true, "Error function."},
    BuiltinRow{"erfc", "f(f)", "erfc", call, true, "1 - erf(x), accurate for large x."},
    // Rounding, choice
    BuiltinRow{"abs", "g(g) i(i)", "abs", comp, true, "Absolute value."},
    BuiltinRow{"fabs", "g(g) i(i)", "abs", comp, true, "Absolute value."},
    BuiltinRow{"sign", "g(g)", "sign", comp, true, "1, 0 or -1."},
    BuiltinRow{"floor", "g(g)", "floor", comp, true, "The greatest integer not above x."},
    BuiltinRow{"ceil", "g(g)", "ceil", comp, true, "The least integer not below x."},
    BuiltinRow{"round", "g(g)", "round", comp, true, "The nearest integer, halves away from 0."},
    BuiltinRow{"trunc", "g(g)", "trunc", comp, true, "The integral part."},
    BuiltinRow{"fmod", "g(gg) g(gf)", "fmod", comp, true,
               "Remainder with the sign of the first argument; 0 for a divisor of 0."},
    BuiltinRow{"mod", "g(gg) g(gf)", "mod", comp, true, "a - b floor(a / b)."},
    BuiltinRow{"min", "g(gg) i(ii)", "min", comp, true, "The lesser one."},
    BuiltinRow{"max", "g(gg) i(ii)", "max", comp, true, "The greater one."},
    BuiltinRow{"clamp", "g(ggg) i(iii)", "clamp", comp, true, "max(min(x, high), low) of (x, low, high)."},
    BuiltinRow{"mix", "g(ggg) g(ggf)", "mix", comp, true, "x (1 - a) + y a."},
    BuiltinRow{"step", "g(gg)", "step", comp, true, "0 where x < edge, else 1, of (edge, x)."},
    BuiltinRow{"smoothstep", "g(ggg)", "smoothstep", comp, true,
               "0 to 1 from low to high by a cubic, of (low, high, x)."},
    BuiltinRow{"linearstep", "g(ggg)", "linearstep", comp, true,
               "0 to 1 from low to high by a line, of (low, high, x)."},
    BuiltinRow{"fma", "g(ggg)", "fma", comp, true, "a b + c, rounded once."},
    BuiltinRow{"select", "g(ggg) g(ggf) g(ggi)", "", special, true,
               "The second where the third is not 0, else the first."},
    BuiltinRow{"isnan", "i(f)", "isnan", call, true, "Whether x is no number."},
    BuiltinRow{"isinf", "i(f)", "isinf", call, true, "Whether x is infinite."},
    BuiltinRow{"isfinite", "i(f)", "isfinite", call, true, "Whether x is neither infinite nor NaN."},
    // Geometry
    BuiltinRow{"dot", "f(vv)", "dot", call, true, "Inner product."},
    BuiltinRow{"cross", "v(vv)", "cross", call, true, "Vector product."},
    BuiltinRow{"length", "f(v)", "length", call, true, "Length."},
    BuiltinRow{"distance", "f(pp)", "distance", call, true, "Distance of two points."},
    BuiltinRow{"normalize", "v(v) n(n)", "normalize", call, true, "Of unit length; 0 stays 0."},
    BuiltinRow{"transform", "p(mp) v(mv) n(mn) p(sp) v(sv) n(sn) p(ssp) v(ssv) n(ssn)", "", special, true,
               "Into another space, by a matrix or by names of spaces ([from,] to)."},
    BuiltinRow{"transformu", "f(sf) f(ssf)", "", special, true, "Between units of length or of time."},
    // Matrices
    BuiltinRow{"determinant", "f(m)", "determinant", call, true, "Determinant."},
    BuiltinRow{"transpose", "m(m)", "transpose", call, true, "Transposed matrix."},
    BuiltinRow{"getmatrix", "i(ss!m)", "getmatrix", special, true,
               "Matrix between two named spaces; 0 when one is unknown."},
    // Patterns
    BuiltinRow{
        "noise", "r(f) r(ff) r(p) r(pf) r(sf*) r(sff*) r(sp*) r(spf*)", "uperlin", special, true,
        "Unsigned Perlin noise, or the kind named first; behind the place, pairs of a name and a value are options "
        "of gabor noise."},
    BuiltinRow{"snoise", noiseSignatures, "perlin", call, true, "Signed Perlin noise."},
    BuiltinRow{"cellnoise", noiseSignatures, "cell", call, true, "Constant on unit cells, in [0, 1]."},
    BuiltinRow{"hashnoise", noiseSignatures, "hash", call, true, "Uncorrelated value in [0, 1] for every coordinate."},
    BuiltinRow{"pnoise", "r(ff) r(ffff) r(pp) r(pfpf) r(sff*) r(sffff*) r(spp*) r(spfpf*)", "puperlin", special, true,
               "Periodic unsigned Perlin noise, or the kind named first, with options as in noise."},
    BuiltinRow{"psnoise", periodicSignatures, "pperlin", call, true, "Periodic signed Perlin noise."},
    BuiltinRow{"pcellnoise", periodicSignatures, "pcell", call, true, "Periodic cell noise."},
    BuiltinRow{"phashnoise", periodicSignatures, "phash", call, true, "Periodic hash noise."},
    BuiltinRow{"spline", "g(sfgggg*)", "", special, true,
               "Value at x in [0, 1] of a spline with the given knots (also as an array, or a count and an array); the "
               "basis is catmull-rom, bezier, bspline, hermite, linear or constant."},
    BuiltinRow{"splineinverse", "f(sfffff*)", "", special, true,
               "The x at which spline gives the value; the knots rise or fall."},
    BuiltinRow{"aerosol_hash", "i(iiii)", "hash", call, true, "The standard library's own: a hash of four ints."},
    BuiltinRow{"hash", "i(i) i(f) i(ff) i(p) i(pf)", "hash", call, true, "A whole number that depends on all bits."},
    // Derivatives: core/lang/derivatives.h
    BuiltinRow{"Dx", derivativeSignatures, "dx", derivative, true, "Change to the next shading sample in x."},
    BuiltinRow{"Dy", derivativeSignatures, "dy", derivative, true, "Change to the next shading sample in y."},
    BuiltinRow{"Dz", derivativeSignatures, "dz", derivative, true,
               "Change to the next shading sample in depth, in volumes."},
    BuiltinRow{"filterwidth", "f(f) v(p) v(v)", "filterwidth", derivative, true,
               "Square root of Dx(x)^2 + Dy(x)^2: how much x changes between shading samples."},
    BuiltinRow{"area", "f(p)", "area", derivative, true, "Area that one shading sample covers of the surface p."},
    BuiltinRow{"calculatenormal", "v(p)", "calculatenormal", derivative, true,
               "Perpendicular to the surface p, of the side that faces out; its length is area(p)."},
    // Strings
    BuiltinRow{"printf", "x(s*)", "", special, false, "Prints."},
    BuiltinRow{"warning", "x(s*)", "", special, false, "Prints as a warning of the shader."},
    BuiltinRow{"error", "x(s*)", "", special, false, "Prints as an error of the shader."},
    // Others
    BuiltinRow{"arraylength", "i(A)", "", special, true, "Number of elements."},
    BuiltinRow{"isconnected", "i(*)", "", special, true,
               "Whether a parameter is connected: 1 to an earlier layer, 2 to a later one, 3 to both, else 0."},
    BuiltinRow{"exit", "x()", "", special, false, "Ends the shader."},
};

constexpr std::string_view genericLetters = "fcpvn";

Type typeOf(char letter) {
  switch (letter) {
    case 'f':
      return types::floating;
    case 'i':
      return types::integer;
    case 's':
      return types::string;
    case 'c':
      return types::color;
    case 'p':
      return types::point;
    case 'v':
      return types::vector;
    case 'n':
      return types::normal;
    case 'm':
      return types::matrix;
    case 'C':
      return types::closure;
    case 'S':
      return types::string.arrayOf(Type::unsized);
    case 'I':
      return types::integer.arrayOf(Type::unsized);
    default:
      return types::none;
  }
}

template <class Visit>
void forEachRow(Visit&& visit) {
  for (const BuiltinRow& row : builtinTable()) visit(row);
  for (const BuiltinRow& row : hostBuiltinTable()) visit(row);
}

/// One signature with `g` and `r` standing for `generic`.
BuiltinOverload parse(const BuiltinRow& row, std::string_view text, char generic) {
  const auto resolve = [&](char letter) { return typeOf(letter == 'g' || letter == 'r' ? generic : letter); };
  BuiltinOverload overload;
  overload.row = &row;
  overload.result = resolve(text[0]);
  assert(text[1] == '(' && text.back() == ')');
  bool output = false;
  for (const char letter : text.substr(2, text.size() - 3)) {
    const auto bit = std::uint32_t{1} << overload.parameters.size();
    if (letter == '!') {
      output = true;
    } else if (letter == '*') {
      overload.variadic = true;
    } else {
      if (output) overload.outputs |= bit;
      if (letter == 'A') overload.arrays |= bit;
      if (letter == '?') overload.any |= bit;
      overload.parameters.push_back(resolve(letter));
      output = false;
    }
  }
  return overload;
}

char letterOf(const Type& type) {
  char letter = 'x';
  if (type.isTriple()) letter = 'v';
  if (type.base == BaseType::floating) letter = 'f';
  if (type.base == BaseType::integer) letter = 'i';
  if (type.base == BaseType::string) letter = 's';
  if (type.base == BaseType::matrix) letter = 'm';
  return type.isArray() ? static_cast<char>(std::toupper(letter)) : letter;
}

}  // namespace

std::span<const BuiltinRow> builtinTable() { return table; }

const std::vector<std::unique_ptr<BuiltinOverload>>& BuiltinOverloads::find(std::string_view name) {
  const auto known = known_.find(name);
  if (known != known_.end()) return known->second;
  auto& overloads = known_[std::string(name)];
  forEachRow([&](const BuiltinRow& row) {
    if (name != row.name) return;
    std::string_view rest = row.signatures;
    while (!rest.empty()) {
      const std::size_t end = rest.find(' ');
      const std::string_view one = rest.substr(0, end);
      rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
      const bool isGeneric = one.find_first_of("gr") != std::string_view::npos;
      for (const char generic : isGeneric ? genericLetters : std::string_view("f")) {
        auto overload = std::make_unique<BuiltinOverload>(parse(row, one, generic));
        bool isNew = true;
        for (const auto& other : overloads)
          if (other->result == overload->result && other->parameters == overload->parameters &&
              other->arrays == overload->arrays && other->any == overload->any)
            isNew = false;
        if (isNew) overloads.push_back(std::move(overload));
      }
    }
  });
  return overloads;
}

std::string toString(const BuiltinOverload& overload) {
  std::string text = toString(overload.result) + " " + overload.row->name + "(";
  for (std::size_t i = 0; i < overload.parameters.size(); ++i) {
    if (i > 0) text += ", ";
    if ((overload.outputs >> i & 1u) != 0) text += "output ";
    text += (overload.arrays >> i & 1u) != 0 ? "any[]"
            : (overload.any >> i & 1u) != 0  ? "any"
                                             : toString(overload.parameters[i]);
  }
  if (overload.variadic) text += overload.parameters.empty() ? "..." : ", ...";
  return text + ")";
}

std::string symbolOf(std::string_view base, const Type& result, std::span<const Type> arguments) {
  std::string symbol(base);
  symbol += '_';
  symbol += letterOf(result);
  symbol += '_';
  for (const Type& type : arguments) symbol += letterOf(type);
  return symbol;
}

std::vector<std::string> builtinNames() {
  std::vector<std::string> names;
  forEachRow([&](const BuiltinRow& row) { names.emplace_back(row.name); });
  return names;
}

}  // namespace aerosol::lang
