#include "core/lang/shader_interface.h"

#include <algorithm>
#include <utility>

#include "core/lang/array_lengths.h"
#include "core/lang/check.h"
#include "core/lang/compiled_file.h"
#include "core/lang/lower.h"

namespace aerosol::lang {

namespace {

ParameterInterface interfaceOf(const Parameter& parameter) {
  ParameterInterface result;
  result.name = parameter.name;
  result.type = parameter.type;
  result.isOutput = parameter.isOutput;
  if (parameter.hasConstantDefault && !parameter.type.closure) result.defaultValue = parameter.defaultValue;
  result.metadata = parameter.metadata;
  return result;
}

/// Whether oslc writes the value of this initial expression into its compiled files; others are left to the shader.
bool isImmediate(const Expression& expression) {
  const auto& node = expression.node;
  const auto areImmediate = [](const std::vector<ExpressionPtr>& parts) {
    return std::ranges::all_of(parts, [](const ExpressionPtr& part) { return isImmediate(*part); });
  };
  if (std::holds_alternative<IntLiteral>(node) || std::holds_alternative<FloatLiteral>(node) ||
      std::holds_alternative<StringLiteral>(node))
    return true;
  if (const auto* unary = std::get_if<Unary>(&node))
    return unary->op == UnaryOp::minus && expression.type.isNumber() && isImmediate(*unary->operand);
  if (const auto* binary = std::get_if<Binary>(&node))
    return expression.type == types::integer && isImmediate(*binary->left) && isImmediate(*binary->right);
  if (const auto* list = std::get_if<InitializerList>(&node)) return areImmediate(list->elements);
  const auto* construct = std::get_if<Construct>(&node);
  const bool makesNumbers =
      construct && !construct->isCast && (expression.type.isTriple() || expression.type == types::matrix);
  return makesNumbers && !(construct->arguments.front()->type == types::string) && areImmediate(construct->arguments);
}

/// Parameters that are structures, and structures within them, stand before their fields. Metadata belong to the whole.
class Collector {
 public:
  explicit Collector(const Program& program) : program_(program) {}

  void add(const std::string& name, const Type& type, bool isOutput) {
    if (type.base != BaseType::structure) {
      const auto found = std::ranges::find(program_.parameters, name, &Parameter::name);
      if (found != program_.parameters.end()) {
        parameters_.push_back(interfaceOf(*found));
      } else {
        parameters_.push_back({.name = name, .type = type, .isOutput = isOutput});  // A closure.
      }
      return;
    }
    ParameterInterface whole{.name = name, .type = {BaseType::structure, false, type.arrayLength, nullptr}};
    whole.isOutput = isOutput;
    whole.structName = type.structure->name;
    for (const StructField& field : type.structure->fields) whole.fields.push_back(field.name);
    parameters_.push_back(std::move(whole));
    for (const StructField& field : type.structure->fields)
      add(name + "." + field.name, type.isArray() ? field.type.arrayOf(type.arrayLength) : field.type, isOutput);
  }

  std::vector<ParameterInterface> take() { return std::move(parameters_); }

 private:
  const Program& program_;
  std::vector<ParameterInterface> parameters_;
};

/// Leaves the default only of parameters, and of fields, whose initial expressions are immediate.
void forgetComputed(const Expression& initial, const std::string& name, const Type& type,
                    std::vector<ParameterInterface>& parameters) {
  const auto* list = std::get_if<InitializerList>(&initial.node);
  if (type.base == BaseType::structure && list && !type.isArray()) {
    const auto& fields = type.structure->fields;
    for (std::size_t i = 0; i < std::min(fields.size(), list->elements.size()); ++i)
      forgetComputed(*list->elements[i], name + "." + fields[i].name, fields[i].type, parameters);
    return;
  }
  if (isImmediate(initial)) return;
  for (ParameterInterface& parameter : parameters)
    if (parameter.name == name || parameter.name.starts_with(name + ".")) parameter.defaultValue.reset();
}

}  // namespace

Result<ShaderInterface> readShaderInterface(const std::filesystem::path& path, const CompileOptions& options) {
  auto parsed = parseShaderFile(path, options);
  if (!parsed) return parsed.errors();
  Diagnostics diagnostics;
  const auto checked = check(parsed->file, *parsed->sourceMap, diagnostics);
  if (diagnostics.hasErrors()) return diagnostics;
  const auto lowered = lower(*checked, *parsed->sourceMap, diagnostics);
  if (!lowered) return diagnostics;
  const Program& program = lowered->layer;
  Collector collector(program);
  for (const auto& declaration : checked->shader->parameters)
    collector.add(declaration->name, declaration->type, declaration->isOutput);
  ShaderInterface interface{program.kind, program.name, program.metadata, collector.take()};
  for (const auto& declaration : checked->shader->parameters) {
    forgetComputed(*declaration->initializer, declaration->name, declaration->type, interface.parameters);
    if (!isUnsized(*declaration)) continue;
    for (ParameterInterface& parameter : interface.parameters)
      if (parameter.name == declaration->name) parameter.type.arrayLength = Type::unsized;
  }
  return interface;
}

}  // namespace aerosol::lang
