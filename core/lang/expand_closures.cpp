// Closures are taken apart at compile time: what a kernel computes are numbers, a tree never exists.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "core/lang/analysis.h"
#include "core/lang/closure_flow.h"
#include "core/lang/closure_text.h"
#include "core/lang/closure_values.h"
#include "core/lang/closures.h"
#include "core/lang/fold.h"
#include "core/lang/lower.h"
#include "core/lang/reached_sites.h"

namespace aerosol::lang {

namespace {

class ClosureExpansion : CodeWriter {
 public:
  ClosureExpansion(Program& program, const ReportAt& report)
      : CodeWriter(program), program_(program), report_(report), layers_(program, report), flow_(program, layers_) {}

  void run() {
    flow_.run();
    layers_.finish(flow_.tops());
    values_.resize(program_.variables.size());
    for (VariableId id = 0; id < values_.size(); ++id)
      if (program_.variables[id].type.closure && program_.variables[id].storage != Storage::temporary) declare(id);
    Code body;
    rewrite(program_.body, body);
    if (program_.ci != noVariable) {
      SiteValues result;
      for (const std::uint32_t site : flow_.atEnd(program_.ci)) result.insert(*values_[program_.ci].find(site));
      writeTo(&body);
      setLocation(0);
      addClosureOutputs(*this, result, report_);
    }
    if (!isVolume()) dropUnheldSites(program_);
    program_.body = std::move(body);
    program_.ci = noVariable;
  }

 private:
  bool isVolume() const { return program_.isVolume(); }
  const std::string& closureOf(std::uint32_t site) const { return program_.closureSites[site].closure; }
  bool scatters(std::uint32_t site) const { return isScattering(closureOf(site)); }
  bool emits(std::uint32_t site) const { return isEmitting(closureOf(site)); }

  /// What an instruction's argument holds there.
  SiteValues held(const Instruction& instruction, std::size_t argument) const {
    SiteValues result;
    for (const std::uint32_t site : flow_.at(instruction, argument)) {
      const auto& values = values_[instruction.arguments[argument]];
      if (const auto known = values.find(site); known != values.end()) result.insert(*known);
    }
    return result;
  }

  /// Variables of a closure variable that may be written more than once.
  void declare(VariableId id) {
    const std::string name = program_.variables[id].name;
    for (const std::uint32_t site : flow_.anywhere(id)) {
      SiteValue& value = values_[id][site];
      const int length = program_.variables[id].type.arrayLength;
      const auto one = [&](const Type& type, const char* part) {
        return add(type.arrayOf(length), Storage::local, name + "." + std::to_string(site) + "." + part);
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

  SiteValues compute(const Instruction& instruction) {
    if (instruction.op == Op::closureMake) return {{instruction.site, make(instruction)}};
    if (instruction.op == Op::element) return elementOf(instruction);
    const bool isAdd = instruction.op == Op::closureAdd || instruction.op == Op::closureLayer;
    SiteValues result = held(instruction, 0);
    if (instruction.op == Op::closureScale) {
      for (auto& [site, value] : result)
        for (VariableId& linear : value.linear) linear = scaled(linear, instruction.arguments[1]);
    }
    if (isAdd) {
      const auto more = held(instruction, 1);
      for (const auto& [site, value] : instruction.op == Op::closureAdd ? more : putBelow(more, instruction)) {
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

  /// The closures of `base` as they are below those of the instruction's first argument.
  SiteValues putBelow(const SiteValues& base, const Instruction& instruction) {
    const auto present = held(instruction, 0);
    SiteValues result;
    for (const auto& [site, value] : base) {
      SiteValue below = value;
      for (const std::uint32_t top : flow_.tops().at(instruction.site)) {
        const auto found = present.find(top);
        below.mean.push_back(found == present.end() ? grey(0) : found->second.linear[0]);
      }
      // The variable that gets the result may hold these now, and parts move from one site to another.
      for (auto* parts : {&below.linear, &below.mean})
        for (VariableId& part : *parts) part = kept(part);
      if (const auto moved = layers_.below(site, instruction.site, instruction.location))
        result.emplace(*moved, std::move(below));
    }
    return result;
  }

  /// The index for each part of a closure in an array: the first time as it is (out of range it is reported), then one
  /// that needs no report.
  class PartIndex {
   public:
    PartIndex(ClosureExpansion& expansion, VariableId index, int length)
        : expansion_(expansion), index_(index), length_(length) {}
    VariableId next() {
      const VariableId result = index_;
      if (isFirst_ && expansion_.program_.variables[index_].storage != Storage::constant) {
        const auto number = [&](int value) { return expansion_.constant(Constant::ofInt(value)); };
        index_ = expansion_.call("clamp", {index_, number(0), number(length_ - 1)}, types::integer);
      }
      isFirst_ = false;
      return result;
    }

   private:
    ClosureExpansion& expansion_;
    VariableId index_;
    int length_;
    bool isFirst_ = true;
  };

  SiteValues elementOf(const Instruction& instruction) {
    const VariableId array = instruction.arguments[0];
    PartIndex index(*this, instruction.arguments[1], program_.variables[array].type.arrayLength);
    SiteValues result = held(instruction, 0);
    for (auto& [site, value] : result)
      for (auto* parts : {&value.linear, &value.mean})
        for (VariableId& part : *parts)
          part = emit(Op::element, program_.variables[part].type.element(), {part, index.next()});
    return result;
  }

  void setElementOf(const Instruction& instruction) {
    const VariableId array = instruction.result;
    PartIndex index(*this, instruction.arguments[0], program_.variables[array].type.arrayLength);
    const auto given = held(instruction, 1);
    for (const auto& [site, own] : values_[array]) {
      const auto found = given.find(site);
      for (std::size_t i = 0; i < own.linear.size(); ++i) {
        const VariableId value = found == given.end() ? grey(0) : found->second.linear[i];
        append(Op::setElement, own.linear[i], {index.next(), value});
      }
      if (found == given.end()) continue;
      for (std::size_t i = 0; i < own.mean.size(); ++i)
        append(Op::setElement, own.mean[i], {index.next(), found->second.mean[i]});
    }
  }

  void define(VariableId target, SiteValues result) {
    if (program_.variables[target].storage == Storage::temporary) {
      for (auto& [site, value] : result)
        for (auto* parts : {&value.linear, &value.mean})
          for (VariableId& part : *parts) part = kept(part);
      values_[target] = std::move(result);
      return;
    }
    for (const std::uint32_t site : flow_.anywhere(target)) {
      const SiteValue& own = values_[target][site];
      const auto found = result.find(site);
      const auto set = [&](VariableId to, VariableId from) {
        if (to != from) append(Op::assign, to, {from});
      };
      for (std::size_t i = 0; i < own.linear.size(); ++i)
        set(own.linear[i], found == result.end() ? zeroOf(own.linear[i]) : found->second.linear[i]);
      if (found == result.end()) continue;
      for (std::size_t i = 0; i < own.mean.size(); ++i) set(own.mean[i], found->second.mean[i]);
    }
  }

  /// Is the weight of any site not zero?
  void truth(const Instruction& instruction) {
    VariableId any = constant(Constant::ofInt(0));
    for (const auto& [site, value] : held(instruction, 0)) {
      for (const VariableId linear : value.linear) {
        const VariableId one = emit(Op::toBool, types::integer, {linear});
        any = emit(Op::logicalOr, types::integer, {any, one});
      }
    }
    append(Op::assign, instruction.result, {any});
  }

  void rewrite(const Code& code, Code& out) {
    Code* const outer = writeTo(&out);
    for (const Instruction& instruction : code) {
      setLocation(instruction.location);
      const bool makesClosure = instruction.result != noVariable && program_.variables[instruction.result].type.closure;
      if (makesClosure && instruction.op == Op::setElement) {
        setElementOf(instruction);
      } else if (makesClosure) {
        define(instruction.result, compute(instruction));
      } else if (instruction.op == Op::toBool && program_.variables[instruction.arguments[0]].type.closure) {
        truth(instruction);
      } else {
        Instruction copy = instruction;
        for (std::size_t i = 0; i < copy.arguments.size(); ++i) {
          const VariableId argument = copy.arguments[i];
          if (argument != noVariable && program_.variables[argument].type.closure)
            copy.arguments[i] = ClosureText(*this, layers_, flow_.tops()).of(held(instruction, i));
        }
        for (std::size_t i = 0; i < copy.bodies.size(); ++i) {
          Code rewritten;
          rewrite(instruction.bodies[i], rewritten);
          copy.bodies[i] = std::move(rewritten);
        }
        out.push_back(std::move(copy));
      }
    }
    writeTo(outer);
  }

  Program& program_;
  const ReportAt& report_;
  std::vector<SiteValues> values_;  ///< By variable: of temporaries, once they are defined.
  Layerings layers_;
  ClosureFlow flow_;
};

}  // namespace

void expandClosures(Program& program, const ReportAt& report) { ClosureExpansion(program, report).run(); }

}  // namespace aerosol::lang
