#include <cassert>

#include "core/lang/lowerer.h"

namespace aerosol::lang {

namespace {

int componentNamed(const std::string& name) {
  switch (name[0]) {
    case 'y':
    case 'g':
      return 1;
    case 'z':
    case 'b':
      return 2;
    default:
      return 0;
  }
}

}  // namespace

Value Lowerer::variableValue(const Name& name) {
  const auto bound = bindings_.find(name.declaration);
  assert(bound != bindings_.end());
  return bound->second;
}

Place Lowerer::place(const Expression& expression) {
  if (const auto* index = std::get_if<Index>(&expression.node)) {
    Place base = place(*index->base);
    const Position outer = std::exchange(position_, expression.position);
    // An index is a value of its own: the variable it came from may change before the place is used.
    const VariableId at = copied(lower(*index->index)).single();
    position_ = outer;
    if (base.type.isArray()) {
      base.index = at;
      base.type = base.type.element();
    } else if (base.component != noVariable) {
      base.column = at;
      base.type = types::floating;
    } else {
      base.component = at;
      base.type = base.type == types::matrix ? matrixRow : types::floating;
    }
    return base;
  }
  if (const auto* field = std::get_if<Field>(&expression.node)) {
    Place base = place(*field->base);
    if (base.type.base != BaseType::structure) {
      base.component = constantInt(componentNamed(field->field));
      base.type = types::floating;
      return base;
    }
    std::size_t first = 0;
    for (const StructField& known : base.type.structure->fields) {
      std::vector<Leaf> leaves;
      flatten(known.type, leaves);
      if (known.name == field->field) {
        base.leaves = {base.leaves.begin() + static_cast<std::ptrdiff_t>(first),
                       base.leaves.begin() + static_cast<std::ptrdiff_t>(first + leaves.size())};
        base.type = known.type;
        return base;
      }
      first += leaves.size();
    }
    assert(false);
  }
  Value value = lower(expression);
  return {value.type, std::move(value.leaves), noVariable, noVariable, noVariable};
}

Value Lowerer::load(const Place& place) {
  Value value{place.type, {}};
  for (VariableId leaf : place.leaves) {
    if (place.index != noVariable) leaf = emit(Op::element, typeOf(leaf).element(), {leaf, place.index});
    if (place.column != noVariable) {
      leaf = emit(Op::matrixElement, types::floating, {leaf, place.component, place.column});
    } else if (place.component != noVariable) {
      leaf = emit(Op::component, types::floating, {leaf, place.component});
    }
    value.leaves.push_back(leaf);
  }
  return value;
}

void Lowerer::store(const Place& place, const Value& value) {
  if (failed_) return;
  if (place.isWhole()) {
    assign({place.type, place.leaves}, value);
    return;
  }
  for (std::size_t i = 0; i < place.leaves.size(); ++i) storeLeaf(place, place.leaves[i], value.leaves[i]);
}

void Lowerer::storeLeaf(const Place& place, VariableId leaf, VariableId value) {
  if (!countWork(position_)) return;
  const auto set = [&](Op op, VariableId target, std::vector<VariableId> arguments) {
    Instruction& instruction = append(op);
    instruction.result = target;
    instruction.arguments = std::move(arguments);
  };
  const auto setPart = [&](VariableId target) {
    if (place.column != noVariable) {
      set(Op::setMatrixElement, target, {place.component, place.column, value});
    } else {
      set(Op::setComponent, target, {place.component, value});
    }
  };
  if (place.index == noVariable) {
    setPart(leaf);
    return;
  }
  if (place.component == noVariable) {
    set(Op::setElement, leaf, {place.index, value});
    return;
  }
  const VariableId element = local(typeOf(leaf).element(), "");
  set(Op::element, element, {leaf, place.index});
  setPart(element);
  set(Op::setElement, leaf, {place.index, element});
}

}  // namespace aerosol::lang
