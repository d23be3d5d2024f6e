#include "tests/unit/lang/interpreter.h"

#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <cstdio>
#include <functional>

#include "core/lang/pure_functions.h"
#include "core/lang/uniformity.h"

namespace aerosol::lang::testing {

namespace {

using Floats = std::vector<float>;
using Ints = std::vector<std::int32_t>;
enum class Flow { next, breaks, continues, leaves };

constexpr int loopBudget = 100000;

float safe(double value) { return static_cast<float>(value); }

float hermite(float low, float high, float x) {
  if (x < low) return 0.0f;
  if (x >= high) return 1.0f;
  const float t = (x - low) / (high - low);
  return t * t * (3 - 2 * t);
}

const std::map<std::string, std::function<float(const Floats&)>>& floatFunctions() {
  using F = const Floats&;
  static const std::map<std::string, std::function<float(F)>> table = {
      {"sin_f_f", [](F a) { return std::sin(a[0]); }},
      {"cos_f_f", [](F a) { return std::cos(a[0]); }},
      {"tan_f_f", [](F a) { return std::tan(a[0]); }},
      {"asin_f_f", [](F a) { return std::asin(std::fmin(std::fmax(a[0], -1.0f), 1.0f)); }},
      {"acos_f_f", [](F a) { return std::acos(std::fmin(std::fmax(a[0], -1.0f), 1.0f)); }},
      {"atan_f_f", [](F a) { return std::atan(a[0]); }},
      {"atan2_f_ff", [](F a) { return std::atan2(a[0], a[1]); }},
      {"sinh_f_f", [](F a) { return std::sinh(a[0]); }},
      {"cosh_f_f", [](F a) { return std::cosh(a[0]); }},
      {"tanh_f_f", [](F a) { return std::tanh(a[0]); }},
      {"degrees_f_f", [](F a) { return a[0] * 57.2957795f; }},
      {"radians_f_f", [](F a) { return a[0] * 0.0174532925f; }},
      {"pow_f_ff",
       [](F a) {
         const float r = std::pow(a[0], a[1]);
         return std::isfinite(r) ? r : 0.0f;
       }},
      {"exp_f_f", [](F a) { return std::exp(a[0]); }},
      {"exp2_f_f", [](F a) { return std::exp2(a[0]); }},
      {"expm1_f_f", [](F a) { return std::expm1(a[0]); }},
      {"log_f_f", [](F a) { return std::log(std::fmax(a[0], FLT_MIN)); }},
      {"log_f_ff", [](F a) { return std::log(std::fmax(a[0], FLT_MIN)) / std::log(std::fmax(a[1], FLT_MIN)); }},
      {"log2_f_f", [](F a) { return std::log2(std::fmax(a[0], FLT_MIN)); }},
      {"log10_f_f", [](F a) { return std::log10(std::fmax(a[0], FLT_MIN)); }},
      {"logb_f_f", [](F a) { return std::logb(std::fmin(std::fmax(std::fabs(a[0]), FLT_MIN), FLT_MAX)); }},
      {"sqrt_f_f", [](F a) { return a[0] < 0 ? 0.0f : std::sqrt(a[0]); }},
      {"inversesqrt_f_f", [](F a) { return a[0] <= 0 ? 0.0f : 1 / std::sqrt(a[0]); }},
      {"cbrt_f_f", [](F a) { return std::cbrt(a[0]); }},
      {"hypot_f_ff", [](F a) { return std::sqrt(a[0] * a[0] + a[1] * a[1]); }},
      {"hypot_f_fff", [](F a) { return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }},
      {"erf_f_f", [](F a) { return std::erf(a[0]); }},
      {"erfc_f_f", [](F a) { return std::erfc(a[0]); }},
      {"abs_f_f", [](F a) { return std::fabs(a[0]); }},
      {"sign_f_f", [](F a) { return a[0] > 0   ? 1.0f
                                    : a[0] < 0 ? -1.0f
                                               : 0.0f; }},
      {"floor_f_f", [](F a) { return std::floor(a[0]); }},
      {"ceil_f_f", [](F a) { return std::ceil(a[0]); }},
      {"round_f_f", [](F a) { return std::round(a[0]); }},
      {"trunc_f_f", [](F a) { return std::trunc(a[0]); }},
      {"fmod_f_ff", [](F a) { return a[1] == 0 ? 0.0f : a[0] - a[1] * std::trunc(a[0] / a[1]); }},
      {"mod_f_ff", [](F a) { return a[1] == 0 ? a[0] : a[0] - a[1] * std::floor(a[0] / a[1]); }},
      {"min_f_ff", [](F a) { return std::fmin(a[0], a[1]); }},
      {"max_f_ff", [](F a) { return std::fmax(a[0], a[1]); }},
      {"clamp_f_fff", [](F a) { return std::fmax(std::fmin(a[0], a[2]), a[1]); }},
      {"mix_f_fff", [](F a) { return a[0] * (1 - a[2]) + a[1] * a[2]; }},
      {"step_f_ff", [](F a) { return a[1] < a[0] ? 0.0f : 1.0f; }},
      {"smoothstep_f_fff", [](F a) { return hermite(a[0], a[1], a[2]); }},
      {"linearstep_f_fff",
       [](F a) {
         if (a[0] == a[1]) return a[2] < a[0] ? 0.0f : 1.0f;
         return (std::fmax(std::fmin(a[2], a[1]), a[0]) - a[0]) / (a[1] - a[0]);
       }},
      {"fma_f_fff", [](F a) { return std::fma(a[0], a[1], a[2]); }},
      {"dot_f_vv", [](F a) { return a[0] * a[3] + a[1] * a[4] + a[2] * a[5]; }},
      {"length_f_v", [](F a) { return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }},
      {"distance_f_vv",
       [](F a) {
         return std::sqrt((a[0] - a[3]) * (a[0] - a[3]) + (a[1] - a[4]) * (a[1] - a[4]) +
                          (a[2] - a[5]) * (a[2] - a[5]));
       }},
  };
  return table;
}

Floats inverse(const Floats& m) {
  std::array<std::array<double, 8>, 4> a{};
  for (std::size_t r = 0; r < 4; ++r) {
    for (std::size_t c = 0; c < 4; ++c) a[r][c] = m[r * 4 + c];
    a[r][4 + r] = 1;
  }
  for (std::size_t c = 0; c < 4; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < 4; ++r)
      if (std::fabs(a[r][c]) > std::fabs(a[pivot][c])) pivot = r;
    std::swap(a[c], a[pivot]);
    if (a[c][c] == 0) return Floats(16, 0.0f);
    const double scale = 1 / a[c][c];
    for (double& x : a[c]) x *= scale;
    for (std::size_t r = 0; r < 4; ++r) {
      if (r == c) continue;
      const double factor = a[r][c];
      for (std::size_t k = 0; k < 8; ++k) a[r][k] -= factor * a[c][k];
    }
  }
  Floats result(16);
  for (std::size_t i = 0; i < 16; ++i) result[i] = safe(a[i / 4][4 + i % 4]);
  return result;
}

Floats product(const Floats& a, const Floats& b) {
  Floats result(16, 0.0f);
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c)
      for (std::size_t k = 0; k < 4; ++k) result[r * 4 + c] += a[r * 4 + k] * b[k * 4 + c];
  return result;
}

Floats scaled(Floats m, float by) {
  for (float& x : m) x *= by;
  return m;
}

Floats applied(const Floats& m, const Floats& v, float w) {
  Floats result(4, 0.0f);
  const Floats in = {v[0], v[1], v[2], w};
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t k = 0; k < 4; ++k) result[c] += in[k] * m[k * 4 + c];
  if (w != 0)
    for (std::size_t c = 0; c < 3; ++c) result[c] /= result[3];
  result.pop_back();
  return result;
}

class Interpreter {
 public:
  Interpreter(const Program& program, const PointInputs& inputs) : program_(program), inputs_(inputs) {
    for (const Variable& variable : program.variables) values_.push_back(initial(variable));
  }

  PointResult run() {
    EXPECT_EQ(run(program_.body), Flow::next) << "a jump leaves the program";
    for (const Output& output : program_.outputs) result_.outputs[nameOf(output)] = values_[output.variable];
    return std::move(result_);
  }

 private:
  Constant initial(const Variable& variable) const {
    if (variable.storage == Storage::constant) return {variable.type, variable.value};
    if (variable.storage == Storage::global) {
      const auto given = inputs_.globals.find(variable.name);
      if (given != inputs_.globals.end()) return {variable.type, given->second};
    }
    if (variable.storage == Storage::parameter) {
      const Parameter& parameter = program_.parameters[variable.parameter];
      const auto given = inputs_.parameters.find(parameter.name);
      const bool isSet = given != inputs_.parameters.end();
      if (&program_.variables[parameter.variable == noVariable ? 0 : parameter.variable] != &variable)
        return Constant::ofInt(isSet ? 1 : 0);
      if (isSet) return {variable.type, given->second};
      if (parameter.hasConstantDefault) return {variable.type, parameter.defaultValue};
    }
    return zeroConstant(variable.type);
  }

  std::string nameOf(const Output& output) const {
    const std::string index = std::to_string(output.index);
    switch (output.kind) {
      case OutputKind::sigmaT:
        return "sigmaT";
      case OutputKind::sigmaS:
        return "sigmaS";
      case OutputKind::emission:
        return "emission";
      case OutputKind::lobeSigmaS:
        return "lobeSigmaS" + index;
      case OutputKind::lobeAnisotropy:
        return "lobeAnisotropy" + index;
      case OutputKind::siteWeight:
        return "siteWeight" + index;
      case OutputKind::siteParameter:
        return "siteParameter" + index + "." + std::to_string(output.subIndex);
      case OutputKind::parameter:
        return program_.parameters[output.index].name;
      case OutputKind::displaced:
        return output.index == 0 ? "displaced P" : "displaced N";
    }
    return {};
  }

  Flow run(const Code& code) {
    for (const Instruction& instruction : code) {
      const Flow flow = step(instruction);
      if (flow != Flow::next) return flow;
    }
    return Flow::next;
  }

  bool truth(VariableId id) const { return values_[id].asInt() != 0; }
  const Floats& floats(VariableId id) const { return std::get<Floats>(values_[id].value); }

  Flow step(const Instruction& i) {
    switch (i.op) {
      case Op::branch:
        return run(i.bodies[truth(i.arguments[0]) ? 0 : 1]);
      case Op::loop:
        return loop(i);
      case Op::scope: {
        const Flow flow = run(i.bodies[0]);
        return flow == Flow::leaves && left_ == i.scopeId ? Flow::next : flow;
      }
      case Op::breakLoop:
        return Flow::breaks;
      case Op::continueLoop:
        return Flow::continues;
      case Op::leave:
        left_ = i.scopeId;
        return Flow::leaves;
      case Op::message:
        message(i);
        return Flow::next;
      case Op::call:
        call(i);
        return Flow::next;
      default:
        compute(i);
        return Flow::next;
    }
  }

  Flow loop(const Instruction& i) {
    for (int round = 0; round < loopBudget; ++round) {
      if (round > 0 || !i.testsLast) {
        run(i.bodies[0]);
        if (!truth(i.arguments[0])) return Flow::next;
      }
      const Flow flow = run(i.bodies[1]);
      if (flow == Flow::breaks) return Flow::next;
      if (flow == Flow::leaves) return flow;
      run(i.bodies[2]);
    }
    result_.messages.emplace_back("budget");
    return Flow::next;
  }

  /// An index in range: clamped, and reported when it was not.
  Constant index(VariableId id, std::int32_t length) {
    const std::int32_t at = values_[id].asInt();
    if (at >= 0 && at < length) return values_[id];
    result_.messages.push_back("index: " + std::to_string(at) + " " + std::to_string(length));
    return Constant::ofInt(at < 0 ? 0 : length - 1);
  }

  void compute(const Instruction& i) {
    const Type& type = program_.variables[i.result].type;
    std::vector<Constant> arguments;
    for (const VariableId id : i.arguments) arguments.push_back(values_[id]);
    const auto lengthOf = [&](const Type& of) { return of.isArray() ? of.arrayLength : of.isTriple() ? 3 : 4; };
    if (i.op == Op::element || i.op == Op::component) arguments[1] = index(i.arguments[1], lengthOf(arguments[0].type));
    if (i.op == Op::matrixElement) arguments[1] = index(i.arguments[1], 4), arguments[2] = index(i.arguments[2], 4);
    if (i.op == Op::setElement || i.op == Op::setComponent) arguments[0] = index(i.arguments[0], lengthOf(type));
    if (i.op == Op::setMatrixElement) arguments[0] = index(i.arguments[0], 4), arguments[1] = index(i.arguments[1], 4);
    std::vector<const Constant*> pointers;
    for (const Constant& argument : arguments) pointers.push_back(&argument);
    if (const auto matrix = matrixResult(i)) {
      values_[i.result] = {type, *matrix};
      return;
    }
    const Constant previous = values_[i.result];
    const auto folded = foldOperation(i.op, type, pointers, &previous);
    ASSERT_TRUE(folded) << "operation " << static_cast<int>(i.op) << " has no value";
    values_[i.result] = {type, folded->value};
  }

  std::optional<Floats> matrixResult(const Instruction& i) const {
    if ((i.op != Op::multiply && i.op != Op::divide) || program_.variables[i.result].type.base != BaseType::matrix)
      return std::nullopt;
    const Floats& a = floats(i.arguments[0]);
    const Floats& b = floats(i.arguments[1]);
    if (i.op == Op::multiply) {
      if (a.size() == 1) return scaled(b, a[0]);
      return b.size() == 1 ? scaled(a, b[0]) : product(a, b);
    }
    if (a.size() == 1) return scaled(inverse(b), a[0]);
    return b.size() == 1 ? scaled(a, b[0] == 0 ? 0.0f : 1 / b[0]) : product(a, inverse(b));
  }

  void call(const Instruction& i) {
    const std::string& symbol = program_.functions[i.function].symbol;
    const auto put = [&](VariableId id, ConstantValue value) {
      values_[id] = {program_.variables[id].type, std::move(value)};
    };
    if (const FunctionUse& function = program_.functions[i.function]; function.host) return hostCall(i, function);
    Floats all;
    for (const VariableId id : i.arguments)
      if (const auto* some = std::get_if<Floats>(&values_[id].value)) all.insert(all.end(), some->begin(), some->end());
    const auto found = floatFunctions().find(symbol);
    if (found != floatFunctions().end()) return put(i.result, Floats{found->second(all)});
    const auto integer = [&](std::size_t k) { return values_[i.arguments[k]].asInt(); };
    if (symbol == "abs_i_i") return put(i.result, Ints{integer(0) < 0 ? -integer(0) : integer(0)});
    if (symbol == "min_i_ii") return put(i.result, Ints{std::min(integer(0), integer(1))});
    if (symbol == "max_i_ii") return put(i.result, Ints{std::max(integer(0), integer(1))});
    if (symbol == "clamp_i_iii") return put(i.result, Ints{std::max(std::min(integer(0), integer(2)), integer(1))});
    if (symbol == "mod_i_ii") {
      const std::int32_t b = integer(1), r = b == 0 ? 0 : integer(0) % b;
      return put(i.result, Ints{r != 0 && (r < 0) != (b < 0) ? r + b : r});
    }
    if (symbol == "isnan_i_f") return put(i.result, Ints{std::isnan(all[0]) ? 1 : 0});
    if (symbol == "isinf_i_f") return put(i.result, Ints{std::isinf(all[0]) ? 1 : 0});
    if (symbol == "isfinite_i_f") return put(i.result, Ints{std::isfinite(all[0]) ? 1 : 0});
    if (symbol == "sincos_x_fff") {
      put(i.arguments[1], Floats{std::sin(all[0])});
      return put(i.arguments[2], Floats{std::cos(all[0])});
    }
    if (symbol == "cross_v_vv")
      return put(i.result, Floats{all[1] * all[5] - all[2] * all[4], all[2] * all[3] - all[0] * all[5],
                                  all[0] * all[4] - all[1] * all[3]});
    if (symbol == "normalize_v_v") {
      const float length = std::sqrt(all[0] * all[0] + all[1] * all[1] + all[2] * all[2]);
      return put(i.result, length > 0 ? Floats{all[0] / length, all[1] / length, all[2] / length} : Floats(3, 0.0f));
    }
    if (symbol.starts_with("transform")) {
      const Floats m = floats(i.arguments[0]), v = floats(i.arguments[1]);
      if (symbol == "transformp_v_mv") return put(i.result, applied(m, v, 1));
      if (symbol == "transformv_v_mv") return put(i.result, applied(m, v, 0));
      Floats transposed = inverse(m);
      for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t c = 0; c < r; ++c) std::swap(transposed[r * 4 + c], transposed[c * 4 + r]);
      return put(i.result, applied(transposed, v, 0));
    }
    if (symbol == "transpose_m_m") {
      Floats m = all;
      for (std::size_t k = 0; k < 16; ++k) m[k] = all[k % 4 * 4 + k / 4];
      return put(i.result, m);
    }
    if (symbol == "determinant_f_m") return put(i.result, Floats{determinant(all)});
    if (symbol == "getmatrix_i_ssm") return spaces(i);
    ADD_FAILURE() << "the interpreter has no function " << symbol;
  }

  void hostCall(const Instruction& i, const FunctionUse& function) {
    std::vector<Constant> arguments;
    for (const VariableId id : i.arguments) arguments.push_back(values_[id]);
    const Type type = i.result == noVariable ? types::none : program_.variables[i.result].type;
    const auto result = evaluateCall(function.symbol, type, arguments, function.outputs);
    ASSERT_TRUE(result) << "the interpreter has no function " << function.symbol;
    if (i.result != noVariable) values_[i.result] = *result;
    for (std::size_t k = 0; k < arguments.size(); ++k)
      if (writesArgument(program_, i, k)) values_[i.arguments[k]] = arguments[k];
  }

  static float determinant(const Floats& m) {
    const auto minor3 = [&](std::size_t skip) {
      std::array<std::size_t, 3> c{};
      std::size_t n = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (k != skip) c[n++] = k;
      const auto at = [&](std::size_t r, std::size_t k) { return static_cast<double>(m[r * 4 + c[k]]); };
      return at(1, 0) * (at(2, 1) * at(3, 2) - at(2, 2) * at(3, 1)) -
             at(1, 1) * (at(2, 0) * at(3, 2) - at(2, 2) * at(3, 0)) +
             at(1, 2) * (at(2, 0) * at(3, 1) - at(2, 1) * at(3, 0));
    };
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += (k % 2 == 0 ? 1 : -1) * static_cast<double>(m[k]) * minor3(k);
    return safe(sum);
  }

  void spaces(const Instruction& i) {
    Floats identity(16, 0.0f);
    for (std::size_t k = 0; k < 4; ++k) identity[k * 5] = 1;
    const auto toCommon = [&](VariableId id) -> std::optional<Floats> {
      const std::string& name = values_[id].asString();
      if (name == "common" || name == "world") return identity;
      const auto found = inputs_.toCommon.find(name);
      if (found != inputs_.toCommon.end()) return Floats(found->second.begin(), found->second.end());
      if (name == "object" || name == "shader") return identity;
      if (!i.quiet) result_.messages.push_back("space: " + name);
      return std::nullopt;
    };
    const auto from = toCommon(i.arguments[0]), to = toCommon(i.arguments[1]);
    if (from && to) values_[i.arguments[2]] = {types::matrix, product(*from, inverse(*to))};
    values_[i.result] = Constant::ofInt(from && to ? 1 : 0);
  }

  void message(const Instruction& i) {
    static const char* const kinds[] = {"print: ", "warning: ", "error: ", "", "", "", "file "};
    const std::string& format = values_[i.arguments[0]].asString();
    std::string text;
    std::size_t next = 1;
    if (i.function == static_cast<std::uint32_t>(MessageKind::file))
      text = values_[i.arguments[next++]].asString() + ": ";
    for (std::size_t k = 0; k < format.size(); ++k) {
      if (format[k] != '%') {
        text += format[k];
        continue;
      }
      if (format[k + 1] == '%') {
        text += format[k++];
        continue;
      }
      const std::size_t end = format.find_first_not_of("-+ #0123456789.", k + 1);
      const std::string piece = format.substr(k, end - k + 1);
      k = end;
      const Constant& value = values_[i.arguments[next++]];
      char buffer[256];
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wformat-nonliteral"
      if (value.type == types::integer) {
        std::snprintf(buffer, sizeof buffer, piece.c_str(), value.asInt());
      } else if (value.type == types::string) {
        std::snprintf(buffer, sizeof buffer, piece.c_str(), value.asString().c_str());
      } else {
        std::snprintf(buffer, sizeof buffer, piece.c_str(), static_cast<double>(value.asFloat()));
      }
#pragma clang diagnostic pop
      text += buffer;
    }
    result_.messages.push_back(kinds[i.function] + text);
  }

  const Program& program_;
  const PointInputs& inputs_;
  std::vector<Constant> values_;
  PointResult result_;
  std::uint32_t left_ = 0;
};

}  // namespace

PointResult interpret(const Program& program, const PointInputs& inputs) { return Interpreter(program, inputs).run(); }

}  // namespace aerosol::lang::testing
