// A shader as structured three-address code: what every number domain (wide, range, dual) is lowered from.
//
// User functions are inlined, structures are flattened to their leaf fields, spaces and conversions are explicit
// instructions. Control flow stays structured (if, loop, scope), so that a back end can run it under masks. Every
// analysis (liveness, uniformity, what is read) is done here, once for all domains, and without LLVM.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/lang/type.h"

namespace aerosol::lang {

struct NativeFunction;

/// Index into `Program::variables`.
using VariableId = std::uint32_t;
inline constexpr VariableId noVariable = 0xffffffffu;

/// The shader globals, in the order in which kernels receive them; the tangents dPdu … are ordinary values. Those
/// behind Ci have no name in the language: how the others change from a shading sample to its neighbours in x and y
/// (and in depth, z), and whether the surface's handedness is flipped (not 0), which turns `calculatenormal`.
enum class Global : std::uint8_t {
  P,
  I,
  N,
  Ng,
  u,
  v,
  dPdu,
  dPdv,
  Ps,
  time,
  dtime,
  dPdtime,
  Ci,
  dPdx,
  dPdy,
  dPdz,
  dIdx,
  dIdy,
  dudx,
  dudy,
  dvdx,
  dvdy,
  dPsdx,
  dPsdy,
  flipHandedness,
};
inline constexpr int namedGlobalCount = 13;
inline constexpr int globalCount = 25;

enum class Storage : std::uint8_t {
  constant,   ///< `value` holds it.
  parameter,  ///< Shader parameter; its instance value, or the result of the initialiser code in `Program::body`.
  global,     ///< Shader global; readable, and writable as a local copy (Ci is the result).
  local,      ///< Declared by the author (or a formal parameter of an inlined function). Starts zeroed.
  temporary,  ///< Written exactly once, before every read of it, in the block of its reads or an enclosing one.
};

/// Leaf values: ints, floats (also triples and matrices, row-major) or strings; arrays one element after the other.
using ConstantValue =
    std::variant<std::monostate, std::vector<std::int32_t>, std::vector<float>, std::vector<std::string>>;

/// One variable. Its type is int, float, string, a triple, matrix, `closure color`, or a sized array of one of these
/// (no closures in arrays); structures do not occur.
struct Variable {
  std::string name;  ///< As in source; fields of structures as `s.field`; temporaries are unnamed.
  Type type;
  Storage storage = Storage::local;
  std::uint32_t location = 0;   ///< Index into `Program::locations`.
  std::uint32_t parameter = 0;  ///< Index into `Program::parameters` when storage is parameter.
  Global global{};              ///< When storage is global.
  ConstantValue value;          ///< When storage is constant.
};

/// Messages that are closures are variables with such names, one for all layers of a group.
inline constexpr std::string_view closureMessagePrefix = "closure message ";
bool isClosureMessage(const Variable& variable);

enum class Op : std::uint8_t {
  // result = op(arguments). A triple argument beside a float one means: the float is used for all three components.
  assign,        ///< (x): same type, arrays too; triples of any kind, closures too.
  toFloat,       ///< (int) → float
  toInt,         ///< (float) → int, truncating, saturating; NaN → 0
  toTriple,      ///< (float) → triple with three equal components
  toMatrix,      ///< (float) → matrix with that diagonal
  makeTriple,    ///< (x, y, z)
  makeMatrix,    ///< (16 floats, row by row)
  toBool,        ///< (int | float | triple | string …) → int 0 or 1: is any component not zero, is the string not empty
  component,     ///< (triple, int index) → float; out of range: clamped and reported
  setComponent,  ///< result[arg0] = arg1, result a triple (read and written)
  matrixElement,     ///< (matrix, int row, int column) → float
  setMatrixElement,  ///< result[arg0][arg1] = arg2
  element,           ///< (array, int index) → element; out of range: clamped and reported
  setElement,        ///< result[arg0] = arg1, result an array
  negate,
  bitNot,
  logicalNot,
  add,
  subtract,
  multiply,
  divide,
  modulo,  ///< ints, floats, triples, matrices; x/0 = 0 and x%0 = 0 as OSL has it; ints wrap
  bitAnd,
  bitOr,
  bitXor,
  shiftLeft,
  shiftRight,  ///< shift counts are taken modulo 32
  less,
  lessEqual,
  greater,
  greaterEqual,
  equal,
  notEqual,  ///< → int; equality on every type, order on int and float
  logicalAnd,
  logicalOr,  ///< of ints, both sides evaluated (the front end uses `branch` where the right side has effects or may be
              ///< dear)
  select,     ///< (int condition, a, b) → a or b, both evaluated
  call,       ///< a library function: `function` names the row and overload
  message,    ///< printf, warning, error, fprintf: arguments[0] is the constant format string; kind in `function`
  // Closures. A closure value is, for every call site of the program, a weight (colour) and the site's parameters.
  // These
  // operations exist within the front end only: it takes closures apart (expandClosures), and a finished program has no
  // variable of closure type. A constant of closure type is the null closure.
  closureMake,       ///< closure with site `site` at weight 1; arguments are the parameters of the closure's row
  closureScale,      ///< (closure, float | colour): weights are multiplied
  closureAdd,        ///< (closure, closure): weights add; parameters of a site present in both: the mean, weighted by
                     ///< |weight|
  closureWeight,     ///< (closure) → colour: weight of site `site`
  closureParameter,  ///< (closure) → parameter number `scopeId` of site `site`
  closureLayer,      ///< (top, base) → both, the sites of the base below those of the top; `site` numbers the layerings
  // Control flow. Bodies are blocks of instructions.
  branch,  ///< if (arg0 int ≠ 0) bodies[0] else bodies[1]
  loop,    ///< bodies[0]: computes the condition variable arg0; bodies[1]: body; bodies[2]: step. testsLast: do-while
  breakLoop,
  continueLoop,  ///< of the innermost loop
  scope,         ///< bodies[0]; `scopeId`
  leave,  ///< to the end of the enclosing scope with `scopeId` (return of an inlined function or of the shader; exit)
};

struct Instruction {
  Op op{};
  bool testsLast = false;
  bool quiet = false;  ///< Indices out of range are clamped without a report: another instruction has reported them.
                       ///< Of calls of getmatrix: spaces that there are not are no mistake.
  VariableId result = noVariable;
  std::uint32_t location = 0;  ///< Index into `Program::locations`.
  std::uint32_t scopeId = 0;
  std::uint32_t site = 0;      ///< Index into `Program::closureSites`.
  std::uint32_t function = 0;  ///< Index into `Program::functions` for `call`, or a MessageKind for `message`.
  std::vector<VariableId> arguments;
  std::vector<std::vector<Instruction>> bodies;
};
using Code = std::vector<Instruction>;

enum class MessageKind : std::uint8_t {
  print,
  warning,
  error,
  file = 6,  ///< arguments[1] is the file's name; what the format shows follows.
};

/// What a function of the host has to do with more than its arguments.
enum HostTrait : std::uint8_t {
  dependsOnPoint = 1,  ///< Its results may differ between points although the arguments do not.
  readsMessages = 2,   ///< Reads what setmessage and its like left.
  writesMessages = 4,  ///< Leaves something for those.
};

/// A library function as called: `symbol` is its name in the run-time library without the domain's prefix, such as
/// `perlin_f_v` (see builtins.h), or the name of a function of the host. Pure functions may be dropped, moved and
/// repeated.
struct FunctionUse {
  std::string symbol;
  bool pure = true;
  std::uint32_t outputs = 0;  ///< Bit i set: arguments[i] is written. (The result is separate.)
  bool host = false;          ///< Answered by the host (AerosolHostServices::call), not by the run-time library.
  std::uint8_t traits = 0;    ///< HostTrait bits.
  std::shared_ptr<const NativeFunction> native = nullptr;  ///< Of a plugin; not kept in caches (see native.h).

  bool dependsOnArgumentsAlone() const { return pure && (traits & (dependsOnPoint | readsMessages)) == 0; }
};

/// What lies on a closure: light passes the fraction 1 - w reflectance(top) of it.
struct ClosureLayer {
  std::uint32_t top = 0;     ///< Index of the site above, whose parameters say what it is.
  std::uint32_t weight = 0;  ///< w, a colour, is this parameter (by number) of the site below.

  bool operator==(const ClosureLayer&) const = default;
};

/// A closure constructor as it stands in the source. One that is layered below another is a site of its own, with the
/// parameters of the plain one and the weights of what lies on it.
struct ClosureSite {
  std::string closure;  ///< Name of the closure's row: "anisotropic_vdf".
  std::uint32_t location = 0;
  std::vector<Type> parameterTypes;  ///< float, int, string or triple
  std::vector<std::string> parameterNames;
  std::vector<ClosureLayer> layers;  ///< All that lies on it, from the nearest to the farthest.
};

/// A metadata entry, folded to a constant.
struct MetadataValue {
  std::string name;
  Type type;
  ConstantValue value;
};

/// A leaf shader parameter. (A parameter that is a structure gives one entry a field: `s.a`.)
struct Parameter {
  std::string name;
  Type type;
  bool isOutput = false;
  bool hasConstantDefault = true;  ///< Otherwise the default is computed by the body where no instance value is given.
  ConstantValue defaultValue;
  std::vector<MetadataValue> metadata;
  SourceLocation location;
  VariableId variable = noVariable;  ///< Its value in `Program::variables`.
  VariableId isSet = noVariable;  ///< Int variable (storage parameter) that is 1 when an instance gives a value; only
                                  ///< when !hasConstantDefault.
  VariableId isConnected = noVariable;  ///< Int variable that `isconnected` reads, where the source asks. Layers only.
};

/// What a kernel can deliver. A variant of a kernel delivers a subset; what only the others need is not computed.
enum class OutputKind : std::uint8_t {
  // Volume shaders: coefficients of Ci, linear in the closure weights.
  sigmaT,          ///< Colour, per unit length: extinction.
  sigmaS,          ///< Colour, per unit length: scattering, all lobes together.
  emission,        ///< Colour, radiance per unit length.
  lobeSigmaS,      ///< Colour; `index` is the lobe (one a scattering call site, at most `maximumLobes`).
  lobeAnisotropy,  ///< Float in [-1, 1]; `index` is the lobe.
  // Surface shaders: Ci as weights and parameters of its closure call sites.
  siteWeight,     ///< Colour; `index` is the site.
  siteParameter,  ///< `index` is the site, `subIndex` the parameter.
  // Any shader.
  parameter,  ///< An output parameter; `index` is the parameter.
  // Displacement shaders.
  displaced,  ///< Where the surface is, and its normal there; `index` 0 is P, 1 is N.
};

struct Output {
  OutputKind kind{};
  std::uint32_t index = 0;
  std::uint32_t subIndex = 0;
  VariableId variable = noVariable;  ///< Holds the value when the body has run.
};

/// What displacement shaders change, by the index of OutputKind::displaced.
inline constexpr std::array displacedGlobals = {Global::P, Global::N};
inline Output displacedOutput(Global global, VariableId variable) {
  return {OutputKind::displaced, global == Global::P ? 0u : 1u, 0, variable};
}

inline constexpr int maximumLobes = 4;

/// A compiled shader before code generation. As a layer of a group it still has its closure operations, `ci` and
/// parameters that are closures; `complete` (see lower.h) makes it a program of its own, which has none.
struct Program {
  std::string kind;  ///< surface | volume | displacement | shader
  std::string name;
  std::vector<MetadataValue> metadata;
  std::vector<Parameter> parameters;
  std::vector<Variable> variables;
  std::vector<FunctionUse> functions;
  std::vector<ClosureSite> closureSites;
  std::vector<SourceLocation> locations;
  Code body;
  VariableId ci = noVariable;   ///< The closure variable Ci (surface and volume shaders).
  std::vector<Output> outputs;  ///< Everything that can be asked of a kernel, computed at the end of `body`.

  bool isVolume() const { return kind == "volume"; }
  /// Whether it is about surfaces and gives a closure: lights are emissive surfaces.
  bool isSurface() const { return kind == "surface" || kind == "light"; }
};

/// A readable listing, for tests and debugging.
std::string toString(const Program& program);

}  // namespace aerosol::lang
