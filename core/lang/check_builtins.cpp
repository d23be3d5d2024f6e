// Arguments of built-in functions that their signatures leave open: names of kinds, options, any number of values.
#include <algorithm>
#include <array>

#include "core/lang/checker.h"
#include "core/lang/overload.h"

namespace aerosol::lang {

namespace {

struct NoiseName {
  std::string_view name;
  bool periodic;
};
constexpr std::array<NoiseName, 11> noiseNames = {{{"perlin", true},
                                                   {"snoise", true},
                                                   {"uperlin", true},
                                                   {"noise", true},
                                                   {"cell", true},
                                                   {"hash", true},
                                                   {"simplex", false},
                                                   {"usimplex", false},
                                                   {"gabor", true},
                                                   {"null", true},
                                                   {"unull", true}}};

struct NoiseOption {
  std::string_view name;
  Type type;
};
constexpr std::array<NoiseOption, 5> noiseOptions = {{{"anisotropic", types::integer},
                                                      {"direction", types::vector},
                                                      {"bandwidth", types::floating},
                                                      {"impulses", types::floating},
                                                      {"do_filter", types::integer}}};

}  // namespace

void Checker::checkBuiltin(const Expression& expression, Call& call) {
  const std::string_view name = call.builtin->row->name;
  const bool isFileFormat = name == "fprintf";
  if (isFileFormat || name == "printf" || name == "error" || name == "warning" || name == "format") {
    const Expression& format = *call.arguments[isFileFormat ? 1 : 0];
    if (strict_ && !std::holds_alternative<StringLiteral>(format.node))
      warning(expression.position, std::string(name) + "() uses a format that is not a constant");
  }
  if (name == "noise" || name == "pnoise") checkNoise(expression, call);
  if (name == "spline" || name == "splineinverse") checkSpline(expression, call);
}

void Checker::checkNoise(const Expression& expression, Call& call) {
  if (!(call.builtin->parameters[0] == types::string)) return;
  const bool isPeriodic = call.name == "pnoise";
  if (const auto* literal = std::get_if<StringLiteral>(&call.arguments[0]->node)) {
    std::string note = "the kinds are:";
    bool isKnown = false;
    for (const NoiseName& known : noiseNames) {
      if (isPeriodic && !known.periodic) continue;
      note += " \"" + std::string(known.name) + "\"";
      isKnown = isKnown || known.name == literal->value;
    }
    if (!isKnown) {
      advise(call.arguments[0]->position,
             std::string("unknown kind of ") + (isPeriodic ? "periodic noise" : "noise") + " \"" + literal->value +
                 "\": it is 0 everywhere",
             {note});
    }
  }
  checkNoiseOptions(call, call.builtin->parameters.size());
  const bool isTriple = call.builtin->result.isTriple();
  call.function =
      libraryFunction(isTriple ? "aerosol_gabor_triple" : "aerosol_gabor", isTriple ? 9 : 10, expression.position);
}

void Checker::checkNoiseOptions(const Call& call, std::size_t first) {
  for (std::size_t i = first; i < call.arguments.size(); i += 2) {
    const Expression& key = *call.arguments[i];
    const auto* literal = std::get_if<StringLiteral>(&key.node);
    if (!literal) {
      error(key.position, "the name of an option of noise must be a literal string");
      return;
    }
    if (i + 1 >= call.arguments.size()) {
      error(key.position, "option \"" + literal->value + "\" has no value");
      return;
    }
    const auto* option = std::find_if(noiseOptions.begin(), noiseOptions.end(),
                                      [&](const NoiseOption& known) { return known.name == literal->value; });
    if (option == noiseOptions.end()) {
      std::string note = "the options are:";
      for (const NoiseOption& known : noiseOptions) note += " \"" + std::string(known.name) + "\"";
      advise(key.position, "unknown option \"" + literal->value + "\" of noise is ignored", {note});
      continue;
    }
    const Expression& value = *call.arguments[i + 1];
    if (!isPoisoned(value.type) && !isAssignable(option->type, value.type)) {
      advise(value.position, "option \"" + literal->value + "\" is of type " + toString(option->type) + ", not " +
                                 toString(value.type) + ": it is ignored");
    }
  }
}

void Checker::checkSpline(const Expression& expression, Call& call) {
  const Type knot = call.builtin->parameters[2];
  for (std::size_t i = 2; i < call.arguments.size(); ++i) requireAssignable(knot, *call.arguments[i], "this knot");
  call.function = libraryFunction(call.name, 4, expression.position, knot.arrayOf(Type::unsized));
}

}  // namespace aerosol::lang
