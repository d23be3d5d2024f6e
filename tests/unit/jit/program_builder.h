// Programs written by hand, without the front end.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/lang/program.h"

namespace aerosol::jit::test {

using lang::Code;
using lang::ConstantValue;
using lang::Global;
using lang::Instruction;
using lang::Op;
using lang::Program;
using lang::Storage;
using lang::Type;
using lang::VariableId;

class ProgramBuilder {
 public:
  ProgramBuilder() {
    program_.kind = "shader";
    program_.name = "test";
    program_.locations.push_back({"test.osl", 1, 1});
    codes_.push_back(&program_.body);
  }

  std::shared_ptr<const Program> build() { return std::make_shared<const Program>(program_); }
  const Program& program() const { return program_; }

  VariableId integer(std::int32_t x) { return constant(lang::types::integer, std::vector<std::int32_t>{x}); }
  VariableId floating(float x) { return constant(lang::types::floating, std::vector<float>{x}); }
  VariableId triple(float x, float y, float z) { return constant(lang::types::color, std::vector<float>{x, y, z}); }
  VariableId text(const std::string& x) { return constant(lang::types::string, std::vector<std::string>{x}); }
  VariableId constant(const Type& type, ConstantValue value) {
    const VariableId id = add("", type, Storage::constant);
    program_.variables[id].value = std::move(value);
    return id;
  }
  VariableId global(Global global) {
    static constexpr std::pair<Global, const char*> names[] = {
        {Global::P, "P"}, {Global::u, "u"}, {Global::v, "v"}, {Global::time, "time"}, {Global::N, "N"}};
    const char* name = "global";
    for (const auto& [known, text] : names) {
      if (known == global) name = text;
    }
    const bool isFloat =
        global == Global::u || global == Global::v || global == Global::time || global == Global::dtime;
    const VariableId id = add(name, isFloat ? lang::types::floating : lang::types::point, Storage::global);
    program_.variables[id].global = global;
    return id;
  }
  VariableId local(const Type& type, const std::string& name = "x") { return add(name, type, Storage::local); }

  VariableId parameter(const std::string& name, const Type& type, ConstantValue value, bool isOutput = false) {
    lang::Parameter parameter;
    parameter.name = name;
    parameter.type = type;
    parameter.isOutput = isOutput;
    parameter.defaultValue = std::move(value);
    parameter.variable = add(name, type, Storage::parameter);
    program_.variables[parameter.variable].parameter = static_cast<std::uint32_t>(program_.parameters.size());
    program_.parameters.push_back(std::move(parameter));
    return program_.parameters.back().variable;
  }
  /// A parameter whose default the body computes where this int is 0.
  VariableId isSetFlag(VariableId parameter) {
    lang::Parameter& entry = program_.parameters[program_.variables[parameter].parameter];
    entry.hasConstantDefault = false;
    const std::uint32_t index = program_.variables[parameter].parameter;
    entry.isSet = add("is set", lang::types::integer, Storage::parameter);
    program_.variables[entry.isSet].parameter = index;
    return entry.isSet;
  }
  /// The variable's final value is delivered.
  void output(VariableId variable) {
    lang::Output output;
    output.kind = lang::OutputKind::siteParameter;
    output.index = static_cast<std::uint32_t>(program_.outputs.size());
    output.variable = variable;
    program_.outputs.push_back(output);
  }

  VariableId emit(Op op, const Type& type, std::vector<VariableId> arguments) {
    const VariableId result = add("", type, Storage::temporary);
    append(op, result, std::move(arguments));
    return result;
  }
  void emitTo(VariableId result, Op op, std::vector<VariableId> arguments) { append(op, result, std::move(arguments)); }
  void assign(VariableId to, VariableId from) { emitTo(to, Op::assign, {from}); }

  VariableId call(const std::string& symbol, const Type& type, std::vector<VariableId> arguments,
                  std::uint32_t outputs = 0) {
    const VariableId result = type == lang::types::none ? lang::noVariable : add("", type, Storage::temporary);
    callTo(result, symbol, std::move(arguments), outputs);
    return result;
  }
  void callTo(VariableId result, const std::string& symbol, std::vector<VariableId> arguments,
              std::uint32_t outputs = 0) {
    Instruction& instruction = append(Op::call, result, std::move(arguments));
    instruction.function = static_cast<std::uint32_t>(program_.functions.size());
    program_.functions.push_back({symbol, true, outputs});
  }
  void message(lang::MessageKind kind, const std::string& format, std::vector<VariableId> arguments) {
    arguments.insert(arguments.begin(), text(format));
    append(Op::message, lang::noVariable, std::move(arguments)).function = static_cast<std::uint32_t>(kind);
  }

  void branch(VariableId condition, const std::function<void()>& yes, const std::function<void()>& no = [] {}) {
    Instruction instruction = control(Op::branch);
    instruction.arguments = {condition};
    instruction.bodies = {collect(yes), collect(no)};
    codes_.back()->push_back(std::move(instruction));
  }
  void loop(
      const std::function<VariableId()>& test, const std::function<void()>& body,
      const std::function<void()>& step = [] {}, bool testsLast = false) {
    Instruction instruction = control(Op::loop);
    instruction.testsLast = testsLast;
    instruction.bodies.resize(3);
    instruction.bodies[0] = collect([&] { instruction.arguments = {test()}; });
    instruction.bodies[1] = collect(body);
    instruction.bodies[2] = collect(step);
    codes_.back()->push_back(std::move(instruction));
  }
  /// for (counter = 0; counter < count; ++counter)
  void repeat(VariableId counter, VariableId count, const std::function<void()>& body) {
    assign(counter, integer(0));
    loop([&] { return emit(Op::less, lang::types::integer, {counter, count}); }, body,
         [&] { emitTo(counter, Op::add, {counter, integer(1)}); });
  }
  void scope(const std::function<void(std::uint32_t)>& body) {
    Instruction instruction = control(Op::scope);
    instruction.scopeId = scopes_++;
    const std::uint32_t id = instruction.scopeId;
    instruction.bodies = {collect([&] { body(id); })};
    codes_.back()->push_back(std::move(instruction));
  }
  void leave(std::uint32_t scope) { append(Op::leave, lang::noVariable, {}).scopeId = scope; }
  void breakLoop() { append(Op::breakLoop, lang::noVariable, {}); }
  void continueLoop() { append(Op::continueLoop, lang::noVariable, {}); }

  /// Later instructions stand on this line.
  void line(int number) {
    program_.locations.push_back({"test.osl", number, 1});
    location_ = static_cast<std::uint32_t>(program_.locations.size() - 1);
  }

  const Type& typeOf(VariableId id) const { return program_.variables[id].type; }

 private:
  VariableId add(const std::string& name, const Type& type, Storage storage) {
    lang::Variable variable;
    variable.name = name;
    variable.type = type;
    variable.storage = storage;
    variable.location = location_;
    program_.variables.push_back(std::move(variable));
    return static_cast<VariableId>(program_.variables.size() - 1);
  }
  Instruction control(Op op) {
    Instruction instruction;
    instruction.op = op;
    instruction.location = location_;
    return instruction;
  }
  Instruction& append(Op op, VariableId result, std::vector<VariableId> arguments) {
    Instruction instruction = control(op);
    instruction.result = result;
    instruction.arguments = std::move(arguments);
    codes_.back()->push_back(std::move(instruction));
    return codes_.back()->back();
  }
  Code collect(const std::function<void()>& emitBody) {
    Code code;
    codes_.push_back(&code);
    emitBody();
    codes_.pop_back();
    return code;
  }

  Program program_;
  std::vector<Code*> codes_;
  std::uint32_t location_ = 0;
  std::uint32_t scopes_ = 0;
};

}  // namespace aerosol::jit::test
