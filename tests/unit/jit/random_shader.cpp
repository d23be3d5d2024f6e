#include "tests/unit/jit/random_shader.h"

#include <array>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "core/lang/builtins.h"

namespace aerosol::jit::test {

namespace {

using lang::Type;
namespace types = lang::types;

constexpr std::array noiseKinds = {"perlin", "snoise", "uperlin", "noise", "cell", "hash", "simplex", "usimplex"};
constexpr std::array periodicKinds = {"perlin", "uperlin", "cell", "hash"};

/// A library function whose arguments are expressions.
struct Callable {
  std::string name;
  std::string firstArgument;  ///< A literal before the others.
  std::vector<Type> parameters;
};

bool isPlain(const Type& type) {
  return !type.closure && !type.isArray() &&
         (type.isNumber() || type.isTriple() || type.base == lang::BaseType::matrix);
}

/// All pure functions of the builtin table that give the type.
std::vector<Callable> functionsGiving(const Type& result) {
  std::vector<Callable> found;
  lang::BuiltinOverloads overloads;
  std::string_view last;
  for (const lang::BuiltinRow& row : lang::builtinTable()) {
    if (!row.pure || last == row.name) continue;
    last = row.name;
    const bool isNoise = last == "noise" || last == "pnoise";
    for (const auto& overload : overloads.find(row.name)) {
      if (!(overload->result == result) || overload->outputs != 0 || overload->arrays != 0 || overload->variadic)
        continue;
      std::span<const Type> parameters = overload->parameters;
      const bool namesKind = isNoise && parameters[0] == types::string;
      if (namesKind) parameters = parameters.subspan(1);
      bool plain = !parameters.empty();
      for (const Type& type : parameters) plain = plain && isPlain(type);
      if (!plain) continue;
      Callable callable{row.name, "", {parameters.begin(), parameters.end()}};
      if (!namesKind) {
        found.push_back(callable);
        continue;
      }
      const std::span<const char* const> kinds =
          last == "noise" ? std::span<const char* const>(noiseKinds) : std::span<const char* const>(periodicKinds);
      for (const char* kind : kinds) {
        callable.firstArgument = std::string("\"") + kind + "\"";
        found.push_back(callable);
      }
    }
  }
  return found;
}

class Writer {
 public:
  explicit Writer(std::uint64_t seed) : random_(seed) {}

  std::string shader() {
    text_.clear();
    function("float", "helper", types::floating);
    function("vector", "turn", types::vector);
    line(
        "shader random(float amount = 0.75, int count = 3, output float a = 0, output float b = 0.5, output color q = "
        "0, output vector w = 0, output int k = 1) {");
    ++indent_;
    floats_ = {"u", "v", "P[0]", "P[1]", "P[2]", "time", "amount", "a", "b", "fs[1]"};
    ints_ = {"count", "k", "is[0]"};
    vectors_ = {"w", "vector(P)", "vs[0]"};
    colors_ = {"q"};
    line("float fs[4] = {u, 1, v, -0.5};");
    line("int is[3] = {1, 2, 3};");
    line("vector vs[2] = {vector(P), vector(u, v, 1)};");
    line("matrix m = matrix(1, u, 0, 0, 0, 1, v, 0, 0.5, 0, 1, 0, 1, 2, 3, 1);");
    callsHelpers_ = true;
    statements(7, 3);
    line("a += " + floating(3) + ";");
    --indent_;
    line("}");
    return text_;
  }

 private:
  int roll(int sides) { return static_cast<int>(random_() % static_cast<std::uint64_t>(sides)); }
  const std::string& pick(const std::vector<std::string>& from) {
    return from[static_cast<std::size_t>(roll(static_cast<int>(from.size())))];
  }
  void line(const std::string& what) { text_ += std::string(static_cast<std::size_t>(indent_) * 2, ' ') + what + "\n"; }

  std::string number() {
    static constexpr std::array literals = {"0.0", "1.0", "-1.0", "0.5", "2.0", "-3.5", "0.1", "10.0", "1e-3", "0.3"};
    return literals[static_cast<std::size_t>(roll(literals.size()))];
  }

  std::string call(const Type& result, int depth) {
    const auto key = static_cast<std::size_t>(result.base);
    if (functions_.size() <= key) functions_.resize(key + 1);
    if (functions_[key].empty()) functions_[key] = functionsGiving(result);
    const std::vector<Callable>& known = functions_[key];
    // By name first, so that functions with many overloads are not met more often.
    const Callable* chosen = &known[static_cast<std::size_t>(roll(static_cast<int>(known.size())))];
    if (chosen->name.find("noise") != std::string::npos && roll(3) > 0)
      chosen = &known[static_cast<std::size_t>(roll(static_cast<int>(known.size())))];
    std::string text = chosen->name + "(" + chosen->firstArgument;
    for (std::size_t i = 0; i < chosen->parameters.size(); ++i) {
      if (i > 0 || !chosen->firstArgument.empty()) text += ", ";
      text += expression(chosen->parameters[i], depth - 1);
    }
    text += ")";
    // Overloads may differ by their result alone.
    return "((" + lang::toString(result) + ")" + text + ")";
  }

  std::string expression(const Type& type, int depth) {
    if (type == types::integer) return integer(depth);
    if (type == types::floating) return floating(depth);
    if (type == types::vector) return triple(depth);
    if (type.base == lang::BaseType::matrix) return matrix(depth);
    if (type == types::color) {
      if (roll(2) == 0) return pick(colors_);
      return "color(" + floating(depth - 1) + ", " + floating(depth - 1) + ", " + floating(depth - 1) + ")";
    }
    return lang::toString(type) + "(" + triple(depth) + ")";
  }

  std::string floating(int depth) {
    if (depth <= 0) return roll(3) > 0 ? pick(floats_) : number();
    switch (roll(11)) {
      case 0:
        return "(" + floating(depth - 1) + " + " + floating(depth - 1) + ")";
      case 1:
        return "(" + floating(depth - 1) + " - " + floating(depth - 1) + ")";
      case 2:
        return "(" + floating(depth - 1) + " * " + floating(depth - 1) + ")";
      case 3:
        return "(" + floating(depth - 1) + " / " + floating(depth - 1) + ")";
      case 4:
        return "(" + condition(depth - 1) + " ? " + floating(depth - 1) + " : " + floating(depth - 1) + ")";
      case 5:
        return pick(vectors_) + "[" + std::to_string(roll(3)) + "]";
      case 6:
        return callsHelpers_ ? "fs[clamp(" + integer(depth - 1) + ", 0, 3)]" : pick(floats_);
      case 7:
        return callsHelpers_ ? "helper(" + floating(depth - 1) + ", " + triple(depth - 1) + ")" : pick(floats_);
      default:
        return call(types::floating, depth);
    }
  }

  std::string integer(int depth) {
    if (depth <= 0) return roll(2) == 0 ? pick(ints_) : std::to_string(roll(9) - 3);
    switch (roll(7)) {
      case 0:
        return "(int)(" + floating(depth - 1) + ")";
      case 1:
        return "(" + condition(depth - 1) + ")";
      case 2:
        return call(types::integer, depth);
      default: {
        static constexpr std::array operators = {"+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>"};
        return "(" + integer(depth - 1) + " " + operators[static_cast<std::size_t>(roll(operators.size()))] + " " +
               integer(depth - 1) + ")";
      }
    }
  }

  std::string triple(int depth) {
    if (depth <= 0) return pick(vectors_);
    switch (roll(7)) {
      case 0:
        return "vector(" + floating(depth - 1) + ", " + floating(depth - 1) + ", " + floating(depth - 1) + ")";
      case 1:
        return "(" + triple(depth - 1) + (roll(2) == 0 ? " + " : " - ") + triple(depth - 1) + ")";
      case 2:
        return "(" + floating(depth - 1) + " * " + triple(depth - 1) + ")";
      case 3:
        return callsHelpers_ ? "turn(" + floating(depth - 1) + ", " + triple(depth - 1) + ")" : pick(vectors_);
      case 4:
        return "vector(transform(" + matrix(depth - 1) + ", point(" + triple(depth - 1) + ")))";
      default:
        return call(types::vector, depth);
    }
  }

  std::string matrix(int depth) {
    if (!callsHelpers_) return "matrix(2)";
    if (depth <= 1 || roll(2) == 0) return "m";
    return roll(2) == 0 ? "(m * " + matrix(depth - 1) + ")" : "transpose(" + matrix(depth - 1) + ")";
  }

  std::string condition(int depth) {
    static constexpr std::array operators = {"<", "<=", ">", ">=", "==", "!="};
    if (depth > 1 && roll(4) == 0)
      return "(" + condition(depth - 1) + (roll(2) == 0 ? " && " : " || ") + condition(depth - 1) + ")";
    if (roll(4) == 0)
      return integer(depth - 1) + " " + operators[static_cast<std::size_t>(roll(6))] + " " + integer(depth - 1);
    return floating(depth - 1) + " " + operators[static_cast<std::size_t>(roll(4))] + " " + floating(depth - 1);
  }

  /// A function of (float x, vector d) with an early return.
  void function(const std::string& type, const std::string& name, const Type& result) {
    line(type + " " + name + "(float x, vector d) {");
    ++indent_;
    floats_ = {"x", "d[0]", "d[1]", "sum"};
    ints_ = {"(int)x", "2"};
    vectors_ = {"d"};
    colors_ = {"color(x)"};
    line("float sum = 0;");
    if (roll(2) == 0) line("if (" + condition(2) + ") return " + expression(result, 2) + ";");
    line("for (int i = 0; i < " + std::to_string(1 + roll(4)) + "; ++i) {");
    ++indent_;
    line("sum += " + floating(2) + ";");
    if (roll(2) == 0) line("if (" + condition(1) + ") return " + expression(result, 1) + ";");
    --indent_;
    line("}");
    line("return " + expression(result, 2) + ";");
    --indent_;
    line("}");
  }

  void statements(int most, int depth) {
    for (int i = 1 + roll(most); i > 0; --i) {
      if (statement(depth)) return;
    }
  }

  /// True when nothing can follow.
  bool statement(int depth) {
    switch (roll(depth > 0 ? 16 : 10)) {
      case 0:
      case 1:
      case 2:
        line((roll(2) == 0 ? "a = " : "b = ") + floating(3) + ";");
        return false;
      case 3:
        line("k = " + integer(2) + ";");
        return false;
      case 4:
        line("w = " + triple(3) + ";");
        return false;
      case 5:
        line("q = " + expression(types::color, 2) + ";");
        return false;
      case 6:
        line("fs[clamp(" + integer(2) + ", 0, 3)] = " + floating(2) + ";");
        return false;
      case 7:
        line("w[" + std::to_string(roll(3)) + "] = " + floating(2) + ";");
        return false;
      case 8:
        line("vs[" + std::to_string(roll(2)) + "] = " + triple(2) + ";");
        return false;
      case 9:
        if (loops_ == 0) return false;
        line(roll(2) == 0 ? "break;" : "continue;");
        return true;
      case 10:
      case 11:
      case 12:
        block("if (" + condition(2) + ")", depth);
        if (roll(2) == 0) block("else", depth);
        return false;
      default:
        loop(depth);
        return false;
    }
  }

  void block(const std::string& head, int depth) {
    line(head + " {");
    ++indent_;
    statements(3, depth - 1);
    --indent_;
    line("}");
  }

  void loop(int depth) {
    const std::string counter = "i" + std::to_string(++counters_);
    const std::string bound = roll(3) == 0 ? "min(" + integer(1) + ", 5)" : std::to_string(1 + roll(5));
    ints_.push_back(counter);
    ++loops_;
    block("for (int " + counter + " = 0; " + counter + " < " + bound + "; ++" + counter + ")", depth);
    --loops_;
    ints_.pop_back();
  }

  std::mt19937_64 random_;
  std::string text_;
  int indent_ = 0;
  int loops_ = 0;
  int counters_ = 0;
  bool callsHelpers_ = false;
  std::vector<std::string> floats_, ints_, vectors_, colors_;
  std::vector<std::vector<Callable>> functions_;  ///< By the base type of their result.
};

}  // namespace

std::string randomShader(std::uint64_t seed) { return Writer(seed).shader(); }

}  // namespace aerosol::jit::test
