// Closures are taken apart at compile time: what a kernel computes are numbers, a tree never exists.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "core/lang/analysis.h"
#include "core/lang/builtins.h"
#include "core/lang/fold.h"
#include "core/lang/lower.h"

namespace aerosol::lang {

namespace {

using Sites = std::set<std::uint32_t>;

/// What a closure variable holds of one site.
struct SiteValue {
  std::vector<VariableId> linear;  ///< Colours that grow with the weight. The last one measures it in means.
  std::vector<VariableId> mean;    ///< Averaged with the measures when two are added.
};

class ClosureExpansion {
 public:
  ClosureExpansion(Program& program, const ReportAt& report) : program_(program), report_(report) {}

  void run() {
    sites_.resize(program_.variables.size());
    while (propagate(program_.body)) {
    }
    values_.resize(program_.variables.size());
    for (VariableId id = 0; id < values_.size(); ++id)
      if (program_.variables[id].type.closure && program_.variables[id].storage != Storage::temporary) declare(id);
    Code body;
    rewrite(program_.body, body);
    addOutputs(body);
    program_.body = std::move(body);
    program_.ci = noVariable;
  }

 private:
  bool isVolume() const { return program_.isVolume(); }
  const std::string& closureOf(std::uint32_t site) const { return program_.closureSites[site].closure; }
  bool scatters(std::uint32_t site) const {
    const std::string& name = closureOf(site);
    return name == "anisotropic_vdf" || name == "medium_vdf" || name == "isotropic" || name == "henyey_greenstein";
  }
  bool emits(std::uint32_t site) const { return closureOf(site) == "emission" || closureOf(site) == "uniform_edf"; }

  /// Which sites may each variable hold? True when something was learned.
  bool propagate(const Code& code) {
    bool changed = false;
    forEachInstruction(code, [&](const Instruction& instruction) {
      if (instruction.result == noVariable || !program_.variables[instruction.result].type.closure) return;
      Sites& sites = sites_[instruction.result];
      const std::size_t before = sites.size();
      if (instruction.op == Op::closureMake) {
        sites.insert(instruction.site);
      } else {
        for (const VariableId argument : instruction.arguments)
          if (program_.variables[argument].type.closure) sites.insert(sites_[argument].begin(), sites_[argument].end());
      }
      changed = changed || sites.size() != before;
    });
    return changed;
  }

  VariableId add(const Type& type, Storage storage, std::string name) {
    Variable variable;
    variable.type = type;
    variable.storage = storage;
    variable.name = std::move(name);
    variable.location = location_;
    program_.variables.push_back(std::move(variable));
    return static_cast<VariableId>(program_.variables.size() - 1);
  }

  VariableId constant(const Constant& value) {
    for (const VariableId known : constants_) {
      const Variable& variable = program_.variables[known];
      if (sameBits({variable.type, variable.value}, value)) return known;
    }
    const VariableId id = add(value.type, Storage::constant, "");
    program_.variables[id].value = value.value;
    constants_.push_back(id);
    return id;
  }
  VariableId number(float value) { return constant(Constant::ofFloat(value)); }
  VariableId grey(float value) { return constant({types::color, std::vector<float>(3, value)}); }

  bool isGrey(VariableId id, float value) const {
    const Variable& variable = program_.variables[id];
    return variable.storage == Storage::constant && variable.type == types::color &&
           sameBits({variable.type, variable.value}, {types::color, std::vector<float>(3, value)});
  }
  bool isMutable(VariableId id) const {
    const Storage storage = program_.variables[id].storage;
    return storage != Storage::constant && storage != Storage::temporary;
  }

  /// Variables of a closure variable that may be written more than once.
  void declare(VariableId id) {
    const std::string name = program_.variables[id].name;
    for (const std::uint32_t site : sites_[id]) {
      SiteValue& value = values_[id][site];
      const auto one = [&](const Type& type, const char* part) {
        return add(type, Storage::local, name + "." + std::to_string(site) + "." + part);
      };
      if (!isVolume()) {
        value.linear.push_back(one(types::color, "weight"));
        const ClosureSite& row = program_.closureSites[site];
        for (std::size_t i = 0; i < row.parameterTypes.size(); ++i)
          value.mean.push_back(one(row.parameterTypes[i], row.parameterNames[i].c_str()));
        continue;
      }
      value.linear.push_back(one(types::color, emits(site) ? "emission" : "sigma_t"));
      if (!scatters(site)) continue;
      value.linear.push_back(one(types::color, "sigma_s"));
      value.mean.push_back(one(types::floating, "g"));
    }
  }

  // Instructions

  Instruction& append(Op op, VariableId result, std::vector<VariableId> arguments) {
    Instruction instruction;
    instruction.op = op;
    instruction.location = location_;
    instruction.result = result;
    instruction.arguments = std::move(arguments);
    out_->push_back(std::move(instruction));
    return out_->back();
  }
  VariableId emit(Op op, const Type& type, std::vector<VariableId> arguments) {
    const VariableId result = add(type, Storage::temporary, "");
    append(op, result, std::move(arguments));
    return result;
  }
  VariableId call(const char* base, std::vector<VariableId> arguments) {
    std::vector<Type> types;
    for (const VariableId id : arguments) types.push_back(program_.variables[id].type);
    const std::string symbol = symbolOf(base, types::floating, types);
    std::uint32_t function = 0;
    while (function < program_.functions.size() && program_.functions[function].symbol != symbol) ++function;
    if (function == program_.functions.size()) program_.functions.push_back({symbol, true, 0});
    const VariableId result = add(types::floating, Storage::temporary, "");
    append(Op::call, result, std::move(arguments)).function = function;
    return result;
  }
  VariableId component(VariableId triple, int index) {
    return emit(Op::component, types::floating, {triple, constant(Constant::ofInt(index))});
  }
  VariableId scaled(VariableId color, VariableId factor) {
    if (isGrey(color, 1) && program_.variables[factor].type.isTriple()) return factor;
    if (isGrey(color, 1)) return emit(Op::toTriple, types::color, {factor});
    return emit(Op::multiply, types::color, {color, factor});
  }
  /// Sum of the components' magnitudes.
  VariableId measure(const SiteValue& value) {
    VariableId sum = noVariable;
    for (int i = 0; i < 3; ++i) {
      const VariableId one = call("abs", {component(value.linear.back(), i)});
      sum = sum == noVariable ? one : emit(Op::add, types::floating, {sum, one});
    }
    return sum;
  }

  // Closure operations

  /// Extinction of a medium that lets `color` through after `depth`: -log(color) / depth; 0 for a depth of 0, and the
  /// colour is kept from 1e-6 to 1, so that black is dense and not infinitely so.
  VariableId mediumExtinction(VariableId depth, VariableId color) {
    std::vector<VariableId> logarithms;
    for (int i = 0; i < 3; ++i)
      logarithms.push_back(call("log", {call("clamp", {component(color, i), number(1e-6f), number(1)})}));
    const VariableId logarithm = emit(Op::makeTriple, types::color, std::move(logarithms));
    const VariableId length = call("max", {depth, number(0)});
    return emit(Op::divide, types::color, {logarithm, emit(Op::negate, types::floating, {length})});
  }

  SiteValue make(const Instruction& instruction) {
    const auto& a = instruction.arguments;
    const std::string& name = closureOf(instruction.site);
    if (!isVolume()) return {{grey(1)}, a};
    if (name == "anisotropic_vdf") return {{a[1], emit(Op::multiply, types::color, {a[0], a[1]})}, {a[2]}};
    if (name == "medium_vdf") {
      const VariableId extinction = mediumExtinction(a[1], a[2]);
      return {{extinction, emit(Op::multiply, types::color, {a[0], extinction})}, {a[3]}};
    }
    if (name == "isotropic") return {{grey(1), grey(1)}, {number(0)}};
    if (name == "henyey_greenstein") return {{grey(1), grey(1)}, {a[0]}};
    if (name == "uniform_edf") return {{a[0]}, {}};
    return {{grey(1)}, {}};  // absorption, emission
  }

  SiteValue sum(const SiteValue& a, const SiteValue& b) {
    SiteValue result;
    const bool sameMeans = a.mean == b.mean;
    if (!sameMeans) {
      const VariableId left = measure(a), right = measure(b);
      const VariableId total = emit(Op::add, types::floating, {left, right});
      const VariableId share = emit(Op::divide, types::floating, {right, total});
      const VariableId rest = emit(Op::subtract, types::floating, {number(1), share});
      for (std::size_t i = 0; i < a.mean.size(); ++i) {
        const Type type = program_.variables[a.mean[i]].type;
        if (type.base == BaseType::integer || type.base == BaseType::string) {
          const VariableId heavier = emit(Op::greater, types::integer, {right, left});
          result.mean.push_back(emit(Op::select, type, {heavier, b.mean[i], a.mean[i]}));
          continue;
        }
        // Written so that a share of 0 or 1 gives either value exactly.
        const VariableId first = emit(Op::multiply, type, {a.mean[i], rest});
        result.mean.push_back(emit(Op::add, type, {first, emit(Op::multiply, type, {b.mean[i], share})}));
      }
    } else {
      result.mean = a.mean;
    }
    for (std::size_t i = 0; i < a.linear.size(); ++i)
      result.linear.push_back(emit(Op::add, types::color, {a.linear[i], b.linear[i]}));
    return result;
  }

  std::map<std::uint32_t, SiteValue> compute(const Instruction& instruction) {
    if (instruction.op == Op::closureMake) return {{instruction.site, make(instruction)}};
    const bool isAdd = instruction.op == Op::closureAdd;
    std::map<std::uint32_t, SiteValue> result = values_[instruction.arguments[0]];
    if (instruction.op == Op::closureScale) {
      for (auto& [site, value] : result)
        for (VariableId& linear : value.linear) linear = scaled(linear, instruction.arguments[1]);
    }
    if (isAdd) {
      for (const auto& [site, value] : values_[instruction.arguments[1]]) {
        const auto present = result.find(site);
        if (present == result.end()) {
          result.emplace(site, value);
        } else {
          present->second = sum(present->second, value);
        }
      }
    }
    return result;
  }

  void define(VariableId target, std::map<std::uint32_t, SiteValue> result) {
    if (program_.variables[target].storage == Storage::temporary) {
      for (auto& [site, value] : result)
        for (auto* parts : {&value.linear, &value.mean})
          for (VariableId& part : *parts)
            if (isMutable(part)) part = emit(Op::assign, program_.variables[part].type, {part});
      values_[target] = std::move(result);
      return;
    }
    for (const std::uint32_t site : sites_[target]) {
      const SiteValue& own = values_[target][site];
      const auto found = result.find(site);
      const auto set = [&](VariableId to, VariableId from) {
        if (to != from) append(Op::assign, to, {from});
      };
      for (std::size_t i = 0; i < own.linear.size(); ++i)
        set(own.linear[i], found == result.end() ? grey(0) : found->second.linear[i]);
      if (found == result.end()) continue;
      for (std::size_t i = 0; i < own.mean.size(); ++i) set(own.mean[i], found->second.mean[i]);
    }
  }

  /// Is the weight of any site not zero?
  void truth(const Instruction& instruction) {
    VariableId any = constant(Constant::ofInt(0));
    for (const auto& [site, value] : values_[instruction.arguments[0]]) {
      for (const VariableId linear : value.linear) {
        const VariableId one = emit(Op::toBool, types::integer, {linear});
        any = emit(Op::logicalOr, types::integer, {any, one});
      }
    }
    append(Op::assign, instruction.result, {any});
  }

  void rewrite(const Code& code, Code& out) {
    Code* const outer = std::exchange(out_, &out);
    for (const Instruction& instruction : code) {
      location_ = instruction.location;
      const bool makesClosure = instruction.result != noVariable && program_.variables[instruction.result].type.closure;
      if (makesClosure) {
        define(instruction.result, compute(instruction));
      } else if (instruction.op == Op::toBool && program_.variables[instruction.arguments[0]].type.closure) {
        truth(instruction);
      } else {
        Instruction copy = instruction;
        for (Code& body : copy.bodies) {
          Code rewritten;
          rewrite(body, rewritten);
          body = std::move(rewritten);
        }
        out.push_back(std::move(copy));
      }
    }
    out_ = outer;
  }

  // Outputs

  void addOutputs(Code& body) {
    out_ = &body;
    location_ = 0;
    if (program_.ci == noVariable) return;
    if (isVolume()) {
      addVolumeOutputs();
    } else {
      for (const auto& [site, value] : values_[program_.ci]) {
        program_.outputs.push_back({OutputKind::siteWeight, site, 0, value.linear[0]});
        for (std::size_t i = 0; i < value.mean.size(); ++i)
          program_.outputs.push_back({OutputKind::siteParameter, site, static_cast<std::uint32_t>(i), value.mean[i]});
      }
    }
  }

  VariableId plus(VariableId sum, VariableId more) {
    return sum == noVariable ? more : emit(Op::add, types::color, {sum, more});
  }

  void addVolumeOutputs() {
    VariableId sigmaT = noVariable, sigmaS = noVariable, emission = noVariable;
    std::vector<const SiteValue*> lobes;
    for (const auto& [site, value] : values_[program_.ci]) {
      if (emits(site)) {
        emission = plus(emission, value.linear[0]);
        continue;
      }
      sigmaT = plus(sigmaT, value.linear[0]);
      if (!scatters(site)) continue;
      sigmaS = plus(sigmaS, value.linear[1]);
      lobes.push_back(&value);
      if (lobes.size() == maximumLobes + 1) {
        report_(program_.closureSites[site].location,
                "this volume adds more than " + std::to_string(maximumLobes) +
                    " scattering closures to Ci (each call in the source counts, with functions inlined)");
      }
    }
    const auto output = [&](OutputKind kind, std::uint32_t index, VariableId variable) {
      program_.outputs.push_back({kind, index, 0, variable == noVariable ? grey(0) : variable});
    };
    output(OutputKind::sigmaT, 0, sigmaT);
    output(OutputKind::sigmaS, 0, sigmaS);
    output(OutputKind::emission, 0, emission);
    for (std::uint32_t i = 0; i < lobes.size(); ++i) {
      output(OutputKind::lobeSigmaS, i, lobes[i]->linear[1]);
      output(OutputKind::lobeAnisotropy, i, lobes[i]->mean[0]);
    }
  }

  Program& program_;
  const ReportAt& report_;
  std::vector<Sites> sites_;                                ///< By variable.
  std::vector<std::map<std::uint32_t, SiteValue>> values_;  ///< By variable: of temporaries, once they are defined.
  std::vector<VariableId> constants_;
  Code* out_ = nullptr;
  std::uint32_t location_ = 0;
};

}  // namespace

void expandClosures(Program& program, const ReportAt& report) { ClosureExpansion(program, report).run(); }

}  // namespace aerosol::lang
