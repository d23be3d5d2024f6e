// Closures as printf shows them.
#include <string>

#include "core/lang/closure_values.h"
#include "core/lang/closures.h"

namespace aerosol::lang {

namespace {

/// A format string and what it shows, built side by side.
class Text {
 public:
  explicit Text(CodeWriter& writer) : writer_(writer) {}

  void add(const std::string& words) { format_ += words; }
  void show(VariableId value) {
    const Type type = writer_.program().variables[value].type;
    if (type.isTriple()) {
      add("(%g, %g, %g)");
      for (int i = 0; i < 3; ++i) values_.push_back(writer_.component(value, i));
      return;
    }
    add(type.base == BaseType::string ? "\"%s\"" : type.base == BaseType::integer ? "%d" : "%g");
    values_.push_back(value);
  }
  VariableId formatted() {
    std::vector<VariableId> arguments = {writer_.text(format_)};
    arguments.insert(arguments.end(), values_.begin(), values_.end());
    return writer_.callHost("format", arguments, types::string);
  }

 private:
  CodeWriter& writer_;
  std::string format_;
  std::vector<VariableId> values_;
};

bool isZero(const Program& program, VariableId id) {
  const Variable& variable = program.variables[id];
  return variable.storage == Storage::constant &&
         sameBits({variable.type, variable.value}, zeroConstant(variable.type));
}

/// Options that were not given are zero; they are left out.
void addParameters(CodeWriter& writer, Text& text, const ClosureSite& site, const SiteValue& value) {
  const auto rows = findClosures(site.closure);
  std::size_t fixed = 0;
  while (fixed < site.parameterTypes.size()) {
    bool isOption = false;
    for (const ClosureRow* row : rows)
      for (const ClosureParameter& option : closureOptions(*row))
        isOption = isOption || option.name == site.parameterNames[fixed];
    if (isOption) break;
    ++fixed;
  }
  const std::size_t end = site.layers.empty() ? site.parameterTypes.size() : site.layers.front().weight;
  const char* separator = "";
  for (std::size_t i = 0; i < end; ++i) {
    if (i >= fixed && isZero(writer.program(), value.mean[i])) continue;
    text.add(separator);
    if (i >= fixed) text.add("\"" + site.parameterNames[i] + "\", ");
    text.show(value.mean[i]);
    separator = ", ";
  }
}

VariableId surfaceText(CodeWriter& writer, const ClosureSite& site, const SiteValue& value) {
  Text text(writer);
  text.show(value.linear[0]);
  text.add(" * " + site.closure + " (");
  addParameters(writer, text, site, value);
  text.add(")");
  for (const ClosureLayer& layer : site.layers) {
    text.add(" below ");
    text.show(value.mean[layer.weight]);
    text.add(" * " + writer.program().closureSites[layer.top].closure);
  }
  return text.formatted();
}

/// Of a volume's closure the coefficients are left, which another closure of the same effect can show.
VariableId volumeText(CodeWriter& writer, const ClosureSite& site, const SiteValue& value) {
  Text text(writer);
  const bool isMedium = site.closure == "anisotropic_vdf" || site.closure == "medium_vdf";
  const bool isEmission = site.closure == "uniform_edf";
  text.show(isMedium || isEmission ? writer.grey(1) : value.linear[0]);
  text.add(" * " + (isMedium ? "anisotropic_vdf" : site.closure) + " (");
  if (isMedium) {
    text.show(writer.emit(Op::divide, types::color, {value.linear[1], value.linear[0]}));
    text.add(", ");
  }
  if (isMedium || isEmission) text.show(value.linear[0]);
  if (isMedium) text.add(", ");
  if (isMedium || site.closure == "henyey_greenstein") text.show(value.mean[0]);
  text.add(")");
  return text.formatted();
}

}  // namespace

VariableId closureText(CodeWriter& writer, const SiteValues& closures) {
  const VariableId result = writer.add(types::string, Storage::local, "");
  writer.append(Op::assign, result, {writer.text("")});
  for (const auto& [index, value] : closures) {
    const ClosureSite site = writer.program().closureSites[index];
    const VariableId shown = writer.emit(Op::toBool, types::integer, {value.linear[0]});
    Code yes;
    Code* const outer = writer.writeTo(&yes);
    const VariableId text =
        writer.program().isVolume() ? volumeText(writer, site, value) : surfaceText(writer, site, value);
    const VariableId follows = writer.emit(Op::toBool, types::integer, {result});
    const VariableId between =
        writer.emit(Op::select, types::string, {follows, writer.text("\n\t+ "), writer.text("")});
    writer.append(Op::assign, result, {writer.callHost("concat", {result, between, text}, types::string)});
    writer.writeTo(outer);
    Instruction& branch = writer.append(Op::branch, noVariable, {shown});
    branch.bodies.push_back(std::move(yes));
    branch.bodies.emplace_back();
  }
  return writer.emit(Op::assign, types::string, {result});
}

}  // namespace aerosol::lang
