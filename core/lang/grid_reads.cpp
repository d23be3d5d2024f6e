#include "core/lang/grid_reads.h"

#include <algorithm>
#include <map>
#include <optional>

#include "core/lang/analysis.h"
#include "core/lang/code_writer.h"
#include "core/lang/texture_options.h"

namespace aerosol::lang {

namespace {

class Binder {
 public:
  Binder(const Program& program, const GridReadOptions& options) : options_(options), writer_(reads_.program) {
    reads_.program = program;
    writes_.assign(program.variables.size(), 0);
    forEachInstruction(program.body, [&](const Instruction& instruction) {
      forEachWritten(program, instruction, [&](VariableId id) { ++writes_[id]; });
    });
  }

  GridReads bind() && {
    if (!hasQuestions(reads_.program.body)) return {};
    Code body = std::move(reads_.program.body);
    reads_.program.body = rewritten(std::move(body));
    return std::move(reads_);
  }

 private:
  Program& program() { return reads_.program; }

  bool asksGrids(const Instruction& instruction) {
    if (instruction.op != Op::call || instruction.arguments.size() != 2) return false;
    const FunctionUse& function = program().functions[instruction.function];
    if (!function.host || function.symbol != "getattribute") return false;
    const Variable& name = program().variables[instruction.arguments[0]];
    const Variable& value = program().variables[instruction.arguments[1]];
    const bool isKnown = name.storage == Storage::constant ||
                         (name.storage == Storage::parameter && writes_[instruction.arguments[0]] == 0);
    return isKnown && name.type == types::string && (value.type == types::floating || isTriple(value.type));
  }

  static bool isTriple(const Type& type) { return type.isTriple() && !type.isArray(); }

  bool hasQuestions(const Code& code) {
    bool any = false;
    forEachInstruction(code, [&](const Instruction& instruction) { any = any || asksGrids(instruction); });
    return any;
  }

  Code rewritten(Code code) {
    Code out;
    for (Instruction& instruction : code) {
      for (Code& inner : instruction.bodies) inner = rewritten(std::move(inner));
      if (!asksGrids(instruction)) {
        out.push_back(std::move(instruction));
        continue;
      }
      Code* const before = writer_.writeTo(&out);
      writer_.setLocation(instruction.location);
      answer(std::move(instruction));
      writer_.writeTo(before);
    }
    return out;
  }

  void answer(Instruction question) {
    const VariableId value = question.arguments[1], result = question.result;
    const bool isTripleAsked = isTriple(program().variables[value].type);
    const GridRead& read = readOf(question.arguments[0], isTripleAsked);
    const VariableId found = result == noVariable ? noVariable : writer_.add(types::integer, Storage::local, "");
    question.result = result == noVariable ? noVariable : writer_.add(types::integer, Storage::temporary, "");
    const VariableId asked = question.result;
    Code otherwise;
    otherwise.push_back(std::move(question));
    if (found != noVariable) {
      Code* const before = writer_.writeTo(&otherwise);
      writer_.append(Op::assign, found, {asked});
      writer_.writeTo(before);
    }
    const auto choose = [&](bool isVector) {
      Code looked;
      Code* const before = writer_.writeTo(&looked);
      writer_.append(Op::assign, value, {mixed(read, isVector, program().variables[value].type)});
      if (found != noVariable) writer_.append(Op::assign, found, {writer_.constant(Constant::ofInt(1))});
      writer_.writeTo(before);
      Code chosen;
      writer_.writeTo(&chosen);
      const VariableId file = parameterVariable(isVector ? read.first.vector : read.first.scalar);
      const VariableId isGiven =
          writer_.emit(Op::notEqual, types::integer, {file, writer_.constant(Constant::ofString(""))});
      writer_.append(Op::branch, noVariable, {isGiven}).bodies = {std::move(looked), std::move(otherwise)};
      writer_.writeTo(before);
      otherwise = std::move(chosen);
    };
    choose(false);
    if (isTripleAsked) choose(true);
    for (Instruction& instruction : otherwise) append(std::move(instruction));
    if (result != noVariable) writer_.append(Op::assign, result, {found});
  }

  void append(Instruction instruction) {
    Instruction& added = writer_.append(instruction.op, instruction.result, {});
    const std::uint32_t location = added.location;
    added = std::move(instruction);
    added.location = location;
  }

  /// One for each name and kind of value.
  const GridRead& readOf(VariableId name, bool isTripleAsked) {
    for (const GridRead& known : reads_.reads) {
      if (known.name == name && known.isTriple == isTripleAsked) return known;
    }
    GridRead read{name, isTripleAsked, {}, {}};
    const auto files = [&] {
      GridRead::Files each{addParameter(types::string, std::vector<std::string>{""}), 0};
      if (isTripleAsked) each.vector = addParameter(types::string, std::vector<std::string>{""});
      return each;
    };
    read.first = files();
    if (options_.isBlended) read.second = files();
    if (options_.isBlended && reads_.reads.empty()) reads_.blend = addParameter(types::floating, std::vector<float>{0});
    reads_.reads.push_back(read);
    return reads_.reads.back();
  }

  /// Its name is none that a scene can write.
  std::uint32_t addParameter(const Type& type, ConstantValue defaultValue) {
    const auto number = static_cast<std::uint32_t>(program().parameters.size());
    Parameter parameter;
    parameter.name = "grid read " + std::to_string(number);
    parameter.type = type;
    parameter.defaultValue = std::move(defaultValue);
    parameter.variable = writer_.add(type, Storage::parameter, parameter.name);
    program().variables[parameter.variable].parameter = number;
    program().parameters.push_back(std::move(parameter));
    return number;
  }
  VariableId parameterVariable(std::uint32_t parameter) { return program().parameters[parameter].variable; }

  /// The value of one file, or of two in proportion. `type` is a copy: lookups add variables, which moves theirs.
  VariableId mixed(const GridRead& read, bool isVector, Type type) {
    const auto of = [&](const GridRead::Files& files) {
      const VariableId value = lookUp(parameterVariable(isVector ? files.vector : files.scalar), read.name,
                                      isVector ? types::color : types::floating);
      if (!isTriple(type)) return value;
      return writer_.emit(isVector ? Op::assign : Op::toTriple, type, {value});
    };
    const VariableId first = of(read.first);
    if (!options_.isBlended) return first;
    const VariableId second = of(read.second), part = parameterVariable(reads_.blend);
    const VariableId rest = writer_.emit(Op::subtract, types::floating, {writer_.number(1), part});
    return writer_.emit(
        Op::add, type,
        {writer_.emit(Op::multiply, type, {first, rest}), writer_.emit(Op::multiply, type, {second, part})});
  }

  VariableId lookUp(VariableId file, VariableId grid, const Type& type) {
    const auto text = [&](const char* word) { return writer_.constant(Constant::ofString(word)); };
    const VariableId matrix = writer_.add(types::matrix, Storage::temporary, "");
    const std::vector<VariableId> spaces{text("common"), text("object"), matrix};
    std::vector<Type> spaceTypes{types::string, types::string, types::matrix};
    const VariableId isKnown = writer_.add(types::integer, Storage::temporary, "");
    writer_.append(Op::call, isKnown, spaces).function =
        functionOf({symbolOf("getmatrix", types::integer, spaceTypes), true, 1u << 2});
    const VariableId point = writer_.call("transformp", {matrix, global(Global::P, types::point, "P")}, types::point);
    const TextureFunction& function = *findTextureFunction("texture3d");
    std::vector<VariableId> arguments{file, point};
    arguments.resize(function.argumentCount(), writer_.constant(zeroConstant(function.type)));
    arguments.insert(arguments.end(), {text("subimage"), grid});
    if (options_.changesInTime)
      arguments.insert(arguments.end(), {text("time"), global(Global::time, types::floating, "time")});
    const VariableId value = writer_.add(type, Storage::temporary, "");
    writer_.append(Op::call, value, std::move(arguments)).function = functionOf({"texture3d", true, 0, true});
    return value;
  }

  std::uint32_t functionOf(FunctionUse wanted) {
    auto& functions = program().functions;
    const auto isSame = [&](const FunctionUse& use) {
      return use.symbol == wanted.symbol && use.outputs == wanted.outputs && use.host == wanted.host;
    };
    const auto known = std::ranges::find_if(functions, isSame);
    if (known != functions.end()) return static_cast<std::uint32_t>(known - functions.begin());
    functions.push_back(std::move(wanted));
    return static_cast<std::uint32_t>(functions.size() - 1);
  }

  VariableId global(Global which, const Type& type, const char* name) {
    for (VariableId id = 0; id < program().variables.size(); ++id) {
      const Variable& variable = program().variables[id];
      if (variable.storage == Storage::global && variable.global == which) return id;
    }
    const VariableId added = writer_.add(type, Storage::global, name);
    program().variables[added].global = which;
    return added;
  }

  GridReadOptions options_;
  GridReads reads_;
  CodeWriter writer_;
  std::vector<int> writes_;  ///< Of the variables that the program had.
};

}  // namespace

GridReads bindGrids(const Program& program, const GridReadOptions& options) { return Binder(program, options).bind(); }

}  // namespace aerosol::lang
