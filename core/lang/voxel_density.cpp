#include "core/lang/voxel_density.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace aerosol::lang {

namespace {

/// What is known of a variable: numbers, or numbers times the grid's value.
struct Known {
  enum class Kind : unsigned char { numbers, multiples, toObject, objectPoint } kind = Kind::numbers;
  std::vector<float> factors;  ///< One, or three of a triple.

  bool areZero() const {
    return std::ranges::all_of(factors, [](float f) { return f == 0; });
  }
};

/// Follows a straight run of instructions, and gives up at the first that it does not know.
class Follower {
 public:
  explicit Follower(const Program& program) : program_(program) {}

  bool follow(const Code& code) {
    return std::ranges::all_of(code, [&](const Instruction& instruction) { return step(instruction); });
  }

  /// Of a variable as it stands; nothing where it is not of a kind that is known.
  std::optional<Known> valueOf(VariableId id) const {
    const Variable& variable = program_.variables[id];
    if (variable.storage == Storage::constant) {
      const auto* floats = std::get_if<std::vector<float>>(&variable.value);
      if (!floats || floats->size() > 3) return {};
      return Known{Known::Kind::numbers, *floats};
    }
    const auto found = known_.find(id);
    if (found == known_.end()) return {};
    return found->second;
  }

  const std::optional<VoxelLookup>& lookup() const { return lookup_; }
  float largestValue() const { return largestValue_; }

 private:
  bool step(const Instruction& instruction) {
    if (!instruction.bodies.empty()) return false;
    if (instruction.op == Op::call) return call(instruction);
    if (instruction.result == noVariable || updatesResult(instruction.op)) return false;
    const auto result = operation(instruction);
    if (result) {
      known_[instruction.result] = *result;
    } else {
      known_.erase(instruction.result);  // Harmless unless something that counts reads it.
    }
    return true;
  }

  std::optional<Known> operation(const Instruction& instruction) const {
    std::vector<Known> arguments;
    for (const VariableId id : instruction.arguments) {
      auto value = valueOf(id);
      if (!value && instruction.op != Op::component) return {};
      if (value) arguments.push_back(*std::move(value));
    }
    switch (instruction.op) {
      case Op::assign:
        return arguments[0];
      case Op::toTriple:
        return wide(arguments[0]);
      case Op::makeTriple:
        return triple(arguments);
      case Op::component:
        return component(instruction, arguments);
      case Op::negate:
        return combine(arguments[0], Known{Known::Kind::numbers, {-1}}, [](float a, float b) { return a * b; });
      case Op::multiply:
        return product(arguments[0], arguments[1]);
      case Op::divide:
        return quotient(arguments[0], arguments[1]);
      case Op::add:
        return sum(arguments[0], arguments[1], 1);
      case Op::subtract:
        return sum(arguments[0], arguments[1], -1);
      default:
        return {};
    }
  }

  static bool isScalarKind(const Known& k) {
    return k.kind == Known::Kind::numbers || k.kind == Known::Kind::multiples;
  }

  static std::optional<Known> wide(const Known& k) {
    if (!isScalarKind(k)) return {};
    return Known{k.kind, std::vector<float>(3, k.factors[0])};
  }

  static std::optional<Known> triple(const std::vector<Known>& parts) {
    if (parts.size() != 3) return {};
    Known result;
    for (const Known& part : parts) {
      if (!isScalarKind(part) || part.factors.size() != 1) return {};
      if (part.kind == Known::Kind::multiples) result.kind = part.kind;
    }
    for (const Known& part : parts) {
      // A number beside multiples has to be none.
      if (part.kind != result.kind && !part.areZero()) return {};
      result.factors.push_back(part.factors[0]);
    }
    return result;
  }

  std::optional<Known> component(const Instruction& instruction, const std::vector<Known>& arguments) const {
    const Variable& index = program_.variables[instruction.arguments[1]];
    const auto* ints = std::get_if<std::vector<std::int32_t>>(&index.value);
    if (index.storage != Storage::constant || !ints || arguments.empty() || !isScalarKind(arguments[0])) return {};
    const auto i = static_cast<std::size_t>((*ints)[0]);
    if ((*ints)[0] < 0 || i >= arguments[0].factors.size()) return {};
    return Known{arguments[0].kind, {arguments[0].factors[i]}};
  }

  template <class Combine>
  static std::optional<Known> combine(const Known& a, const Known& b, const Combine& f) {
    Known result{a.kind, {}};
    const std::size_t size = std::max(a.factors.size(), b.factors.size());
    for (std::size_t i = 0; i < size; ++i) {
      result.factors.push_back(f(a.factors[a.factors.size() == 1 ? 0 : i], b.factors[b.factors.size() == 1 ? 0 : i]));
    }
    return result;
  }

  static std::optional<Known> product(const Known& a, const Known& b) {
    if (!isScalarKind(a) || !isScalarKind(b)) return {};
    if (a.kind == Known::Kind::multiples && b.kind == Known::Kind::multiples) return {};
    const bool swaps = b.kind == Known::Kind::multiples;
    return combine(swaps ? b : a, swaps ? a : b, [](float x, float y) { return x * y; });
  }

  static std::optional<Known> quotient(const Known& a, const Known& b) {
    if (!isScalarKind(a) || b.kind != Known::Kind::numbers) return {};
    return combine(a, b, [](float x, float y) { return y == 0 ? 0.0f : x / y; });
  }

  static std::optional<Known> sum(const Known& a, const Known& b, float sign) {
    if (!isScalarKind(a) || !isScalarKind(b)) return {};
    if (a.kind != b.kind && !(a.kind == Known::Kind::numbers ? a.areZero() : b.areZero())) return {};
    auto result = combine(a, b, [sign](float x, float y) { return x + sign * y; });
    if (a.kind != b.kind) result->kind = Known::Kind::multiples;
    return result;
  }

  std::optional<std::string> textOf(VariableId id) const {
    const Variable& variable = program_.variables[id];
    const auto* texts = std::get_if<std::vector<std::string>>(&variable.value);
    if (variable.storage != Storage::constant || !texts || texts->size() != 1) return {};
    return (*texts)[0];
  }

  std::optional<float> numberOf(VariableId id) const {
    const Variable& variable = program_.variables[id];
    if (variable.storage != Storage::constant) return {};
    if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&variable.value)) {
      return static_cast<float>(ints->front());
    }
    const auto* floats = std::get_if<std::vector<float>>(&variable.value);
    return floats && floats->size() == 1 ? std::optional(floats->front()) : std::nullopt;
  }

  bool call(const Instruction& instruction) {
    const FunctionUse& function = program_.functions[instruction.function];
    const auto& arguments = instruction.arguments;
    if (instruction.result != noVariable) known_.erase(instruction.result);
    if (function.symbol.starts_with("getmatrix")) {
      const auto from = textOf(arguments[0]), to = textOf(arguments[1]);
      known_.erase(arguments[2]);
      if ((from == "common" || from == "world") && to == "object") known_[arguments[2]].kind = Known::Kind::toObject;
      return true;
    }
    if (function.symbol.starts_with("transformp_")) {
      const auto matrix = known_.find(arguments[0]);
      const Variable& point = program_.variables[arguments[1]];
      const bool isP = point.storage == Storage::global && point.global == Global::P;
      if (matrix != known_.end() && matrix->second.kind == Known::Kind::toObject && isP) {
        known_[instruction.result].kind = Known::Kind::objectPoint;
      }
      return true;
    }
    if (function.symbol == "texture3d") return texture(instruction);
    if (function.symbol.starts_with("clamp_")) return clamp(instruction);
    return function.pure && function.outputs == 0;  // Nothing is known of its result.
  }

  /// Of multiples, between bounds around 0: true as far as the value is small enough.
  bool clamp(const Instruction& instruction) {
    const auto x = valueOf(instruction.arguments[0]), low = valueOf(instruction.arguments[1]),
               high = valueOf(instruction.arguments[2]);
    if (!x || !low || !high || x->kind != Known::Kind::multiples) return true;
    if (low->kind != Known::Kind::numbers || high->kind != Known::Kind::numbers) return true;
    for (std::size_t i = 0; i < x->factors.size(); ++i) {
      const float a = low->factors[low->factors.size() == 1 ? 0 : i];
      const float b = high->factors[high->factors.size() == 1 ? 0 : i];
      if (!(a <= 0 && b >= 0 && x->factors[i] >= 0)) return true;
      if (x->factors[i] > 0) largestValue_ = std::min(largestValue_, b / x->factors[i]);
    }
    known_[instruction.result] = *x;
    return true;
  }

  bool texture(const Instruction& instruction) {
    const auto& arguments = instruction.arguments;
    constexpr std::size_t fixed = 5;  // The file, the point and its derivatives.
    const FunctionUse& function = program_.functions[instruction.function];
    if (function.outputs != 0 || arguments.size() < fixed ||
        program_.variables[instruction.result].type != types::floating) {
      return false;
    }
    const auto file = textOf(arguments[0]);
    const auto point = known_.find(arguments[1]);
    if (!file || point == known_.end() || point->second.kind != Known::Kind::objectPoint) return false;
    VoxelLookup lookup{.file = *file, .grid = {}, .interpolation = "smartcubic"};
    for (std::size_t i = fixed; i + 1 < arguments.size(); i += 2) {
      const auto name = textOf(arguments[i]);
      const auto text = textOf(arguments[i + 1]);
      const auto number = numberOf(arguments[i + 1]);
      if (name == "subimage" && text) {
        lookup.grid = *text;
      } else if (name == "interp" && text) {
        lookup.interpolation = *text;
      } else if (name == "firstchannel" && number) {
        lookup.channel = static_cast<int>(*number);
      } else if (name == "time" && number) {
        lookup.time = *number;
      } else {
        return false;
      }
    }
    if (lookup_ && !(*lookup_ == lookup)) return false;
    lookup_ = lookup;
    known_[instruction.result] = Known{Known::Kind::multiples, {1}};
    return true;
  }

  const Program& program_;
  std::map<VariableId, Known> known_;
  std::optional<VoxelLookup> lookup_;
  float largestValue_ = std::numeric_limits<float>::infinity();
};

/// The factors of a coefficient; nothing where it is not in proportion to the grid's value.
std::optional<std::array<float, 3>> coefficient(const Follower& follower, VariableId id) {
  const auto value = follower.valueOf(id);
  if (!value || (value->kind != Known::Kind::multiples && !(value->kind == Known::Kind::numbers && value->areZero()))) {
    return {};
  }
  std::array<float, 3> factors{};
  for (std::size_t i = 0; i < 3; ++i) factors[i] = value->factors[value->factors.size() == 1 ? 0 : i];
  const auto isSound = [](float f) { return f >= 0 && std::isfinite(f); };
  return std::ranges::all_of(factors, isSound) ? std::optional(factors) : std::nullopt;
}

bool isCoefficient(const Output& output) { return output.kind <= OutputKind::lobeAnisotropy; }

}  // namespace

std::optional<VoxelDensity> findVoxelDensity(const Program& program, const ParameterValues& values) {
  if (!program.isVolume()) return {};
  const Program fixed = specialise(program, values);
  std::vector<Output> outputs;
  std::ranges::copy_if(fixed.outputs, std::back_inserter(outputs), isCoefficient);
  const Program part = slice(fixed, outputs, Messages::keep);
  Follower follower(part);
  if (!follower.follow(part.body) || !follower.lookup()) return {};
  VoxelDensity density{.lookup = *follower.lookup(), .largestValue = follower.largestValue()};
  for (const Output& output : part.outputs) {
    if (output.kind == OutputKind::lobeAnisotropy) {
      const auto g = follower.valueOf(output.variable);
      if (!g || g->kind != Known::Kind::numbers || g->factors.size() != 1) return {};
      density.lobes.resize(std::max<std::size_t>(density.lobes.size(), output.index + 1));
      density.lobes[output.index].anisotropy = g->factors[0];
      continue;
    }
    const auto factors = coefficient(follower, output.variable);
    if (!factors) return {};
    if (output.kind == OutputKind::sigmaT) density.sigmaT = *factors;
    if (output.kind == OutputKind::sigmaS) density.sigmaS = *factors;
    if (output.kind == OutputKind::emission) density.emission = *factors;
    if (output.kind != OutputKind::lobeSigmaS) continue;
    density.lobes.resize(std::max<std::size_t>(density.lobes.size(), output.index + 1));
    density.lobes[output.index].sigmaS = *factors;
  }
  return density;
}

}  // namespace aerosol::lang
