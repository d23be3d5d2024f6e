#include <algorithm>
#include <array>
#include <set>

#include "core/lang/checker.h"
#include "core/lang/overload.h"
#include "core/lang/root_expression.h"
#include "core/lang/texture_options.h"

namespace aerosol::lang {

namespace {

/// Lets calls be chosen anew, for another type that is expected of them.
void forgetTypes(Expression& expression) {
  const auto forgetAll = [&](auto&... parts) {
    (forgetTypes(*parts), ...);
    expression.type = types::none;
  };
  auto& node = expression.node;
  if (auto* unary = std::get_if<Unary>(&node)) forgetAll(unary->operand);
  if (auto* binary = std::get_if<Binary>(&node)) forgetAll(binary->left, binary->right);
  if (auto* choice = std::get_if<Conditional>(&node)) forgetAll(choice->yes, choice->no);
  if (auto* comma = std::get_if<Comma>(&node)) forgetAll(comma->second);
  if (auto* call = std::get_if<Call>(&node)) {
    for (ExpressionPtr& argument : call->arguments) forgetTypes(*argument);
    expression.type = types::none;
  }
}

/// Whether any value may be a closure, too.
bool takesClosures(const BuiltinRow& row) {
  return std::string_view(row.name) == "setmessage" || std::string_view(row.name) == "getmessage";
}

}  // namespace

Type Checker::checkArguments(const Expression& call, std::vector<ExpressionPtr>& arguments, std::vector<Type>& types,
                             const Type& expected) {
  Type worst = types::none;
  for (const ExpressionPtr& argument : arguments) {
    Type type = types::none;
    if (auto* list = std::get_if<InitializerList>(&argument->node)) {
      // Its type follows from the parameter; what stands inside can be checked now.
      if (isPoisoned(checkArguments(call, list->elements, types, types::none))) worst = poisoned;
      types.resize(types.size() - list->elements.size());
    } else {
      type = check(*argument, expected);
      if (type == types::none) {
        error(argument->position, "this argument is void: there is no value");
        type = argument->type = poisoned;
      }
      if (isPoisoned(type)) worst = poisoned;
    }
    types.push_back(type);
  }
  return worst;
}

void Checker::addCandidate(std::vector<Candidate>& candidates, Candidate candidate) const {
  // The innermost declaration wins over others with the same signature, and any of the author's over a built-in one.
  for (const Candidate& other : candidates)
    if (other.function && other.parameters == candidate.parameters && other.result == candidate.result) return;
  candidates.push_back(std::move(candidate));
}

void Checker::gatherCandidates(std::string_view name, Position position, std::vector<Candidate>& candidates) {
  for (std::size_t i = scopes_.size(); i-- > 0;) {
    const auto found = scopes_[i].functions.find(name);
    if (found == scopes_[i].functions.end()) continue;
    for (const FunctionDeclaration* function : found->second) {
      if (function->position > position) continue;
      Candidate candidate;
      candidate.function = function;
      candidate.result = function->type;
      for (const auto& parameter : function->parameters) candidate.parameters.push_back(parameter->type);
      candidate.variadic = isDeclaredClosure(*function);  // Options behind the parameters are the renderer's matter.
      addCandidate(candidates, std::move(candidate));
    }
  }
  for (const auto& overload : result_->builtins.find(name)) {
    Candidate candidate;
    candidate.builtin = overload.get();
    candidate.result = overload->result;
    candidate.parameters = overload->parameters;
    candidate.variadic = overload->variadic;
    candidate.arrays = overload->arrays;
    candidate.any = overload->any;
    addCandidate(candidates, std::move(candidate));
  }
  for (const ClosureRow* row : findClosures(name)) {
    Candidate candidate;
    candidate.closure = row;
    candidate.result = types::closure;
    for (const ClosureParameter& parameter : closureParameters(*row)) candidate.parameters.push_back(parameter.type);
    candidate.variadic = true;  // Options of other renderers are known by name alone.
    addCandidate(candidates, std::move(candidate));
  }
}

bool Checker::listFits(const Expression& list, const Type& type) const {
  const auto& elements = std::get<InitializerList>(list.node).elements;
  const auto fits = [&](const Expression& element, const Type& wanted) {
    if (std::holds_alternative<InitializerList>(element.node)) return listFits(element, wanted);
    return isAssignable(wanted, element.type);
  };
  const auto all = [&](const Type& wanted) {
    return std::all_of(elements.begin(), elements.end(), [&](const auto& element) { return fits(*element, wanted); });
  };
  if (type.isArray())
    return !elements.empty() && (type.arrayLength < 0 || static_cast<int>(elements.size()) <= type.arrayLength) &&
           all(type.element());
  if (type.base == BaseType::structure) {
    const auto& fields = type.structure->fields;
    if (elements.size() != fields.size()) return false;
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (!fits(*elements[i], fields[i].type)) return false;
    return true;
  }
  if (type.isTriple()) return (elements.size() == 3 || elements.size() == 1) && all(types::floating);
  if (type == types::matrix) return (elements.size() == 16 || elements.size() == 1) && all(types::floating);
  return elements.size() == 1 && all(type);
}

int Checker::scoreCandidate(const Candidate& candidate, const std::vector<ExpressionPtr>& arguments,
                            const std::vector<Type>& types) const {
  const std::size_t count = candidate.parameters.size();
  if (types.size() < count || (types.size() > count && !candidate.variadic)) return -1;
  int score = 0;
  for (std::size_t i = 0; i < types.size(); ++i) {
    int one = 0;
    if (i >= count) {
      one = 1;
    } else if ((candidate.arrays >> i & 1u) != 0) {
      one = types[i].isArray() ? 1 : 0;
    } else if ((candidate.any >> i & 1u) != 0) {
      const bool mayBeClosure = candidate.builtin && takesClosures(*candidate.builtin->row);
      const bool isValue = (!types[i].closure || mayBeClosure) && types[i].base != BaseType::structure &&
                           types[i].base != BaseType::none;
      one = isValue ? 1 : 0;
    } else if (std::holds_alternative<InitializerList>(arguments[i]->node)) {
      one = listFits(*arguments[i], candidate.parameters[i]) ? 23 : 0;
    } else {
      one = matchScore(candidate.parameters[i], types[i]);
      if (candidate.parameters[i] == types::closure && isZeroLiteral(*arguments[i])) one = 23;
    }
    if (one == 0) return -1;
    score += one;
  }
  return score;
}

const Checker::Candidate* Checker::choose(std::vector<Candidate>& candidates,
                                          const std::vector<ExpressionPtr>& arguments, const std::vector<Type>& types,
                                          const Type& expected, Position position, std::string_view name,
                                          bool complain) {
  int best = -1;
  for (Candidate& candidate : candidates) {
    candidate.score = scoreCandidate(candidate, arguments, types);
    candidate.resultScore = expected == types::none ? 0 : matchScore(expected, candidate.result);
    best = std::max(best, candidate.score);
  }
  if (best < 0) {
    if (!complain) return nullptr;
    std::string call = std::string(name) + "(";
    for (std::size_t i = 0; i < types.size(); ++i)
      call += (i > 0 ? ", " : "") + (types[i] == types::none ? "{...}" : toString(types[i]));
    std::vector<std::string> notes;
    for (const Candidate& candidate : candidates) notes.push_back("candidate: " + describe(candidate));
    error(position, "no function matches the call " + call + ")", std::move(notes));
    return nullptr;
  }
  // Arguments first, then the result asked for, then OSL's precedence of result types.
  const Candidate* chosen = nullptr;
  bool ambiguous = false;
  const auto isBetter = [&](const Candidate& a, const Candidate& b) {
    if (a.resultScore != b.resultScore) return a.resultScore > b.resultScore;
    return resultRank(a.result) < resultRank(b.result);
  };
  for (const Candidate& candidate : candidates) {
    if (candidate.score != best) continue;
    if (!chosen || isBetter(candidate, *chosen)) {
      ambiguous = chosen && candidate.function && chosen->resultScore == candidate.resultScore;
      chosen = &candidate;
    } else if (candidate.function && chosen->function && chosen->resultScore == candidate.resultScore) {
      ambiguous = true;
    }
  }
  if (ambiguous && complain && chosen->function) {
    std::vector<std::string> notes = {"chosen: " + describe(*chosen)};
    for (const Candidate& candidate : candidates)
      if (candidate.score == best && &candidate != chosen) notes.push_back("candidate: " + describe(candidate));
    warning(position, "the call of '" + std::string(name) + "' is ambiguous", std::move(notes));
  }
  return chosen;
}

std::string Checker::describe(const Candidate& candidate) const {
  if (candidate.builtin) return toString(*candidate.builtin);
  if (candidate.closure) return toString(*candidate.closure);
  std::string text = toString(candidate.result) + " " + candidate.function->name + "(";
  const char* separator = "";
  for (const auto& parameter : candidate.function->parameters) {
    text += separator;
    if (parameter->isOutput) text += "output ";
    text += toString(parameter->type);
    if (!parameter->name.empty()) text += " " + parameter->name;
    separator = ", ";
  }
  text += ")";
  if (!sourceMap_.isInPrelude(candidate.function->position)) text += " at " + where(candidate.function->position);
  return text;
}

Type Checker::checkCall(Expression& expression, Call& call, const Type& expected) {
  std::vector<Candidate> candidates;
  gatherCandidates(call.name, expression.position, candidates);
  std::vector<Type> types;
  if (candidates.empty()) {
    if (const StructType* structure = findStruct(call.name, expression.position))
      return checkStructConstructor(expression, call.arguments, *structure, expression.position);
    unknownFunction(expression.position, call.name);
    checkArguments(expression, call.arguments, types, types::none);
    return poisoned;
  }
  if (isPoisoned(checkArguments(expression, call.arguments, types, expected))) return poisoned;
  if (!(expected == types::none) &&
      !choose(candidates, call.arguments, types, expected, expression.position, call.name, false)) {
    // What is expected of the call does not suit its arguments: these decide for themselves.
    for (ExpressionPtr& argument : call.arguments) forgetTypes(*argument);
    types.clear();
    if (isPoisoned(checkArguments(expression, call.arguments, types, types::none))) return poisoned;
  }
  const Candidate* chosen = choose(candidates, call.arguments, types, expected, expression.position, call.name, true);
  if (!chosen) return poisoned;
  bindArguments(*chosen, call.arguments, expression.position);
  call.function = chosen->function;
  call.builtin = chosen->builtin;
  call.closure = chosen->closure;
  if (call.function) useFunction(*call.function, expression.position);
  if (call.builtin) checkBuiltin(expression, call);
  if (call.builtin && findTextureFunction(call.name)) checkTextureOptions(call);
  if (call.builtin && (call.name == "pointcloud_search" || call.name == "pointcloud_get")) checkPointOutputs(call);
  if (call.closure) return checkClosureCall(expression, call, *call.closure);
  return chosen->result;
}

bool Checker::isLiteral(const Expression& expression) {
  return std::holds_alternative<IntLiteral>(expression.node) || std::holds_alternative<FloatLiteral>(expression.node) ||
         std::holds_alternative<StringLiteral>(expression.node);
}

/// A function that writes one of its inputs writes the variable that is passed for it.
void Checker::markWritten(const VariableDeclaration& formal, const Expression& argument) {
  if (!formal.isAssigned) return;
  const Expression* const root = &rootOf(argument);
  const auto* name = std::get_if<Name>(&root->node);
  if (name && name->declaration && !name->declaration->isGlobal) name->declaration->isAssigned = true;
}

void Checker::bindArguments(const Candidate& candidate, std::vector<ExpressionPtr>& arguments, Position) {
  for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
    Expression& argument = *arguments[i];
    const Type& formal = candidate.parameters[i];
    if (std::holds_alternative<InitializerList>(argument.node)) checkInitializer(argument, formal, "this argument");
    const bool isOutput = candidate.function ? candidate.function->parameters[i]->isOutput
                                             : candidate.builtin && (candidate.builtin->outputs >> i & 1u) != 0;
    if (!isOutput) {
      if (candidate.function) markWritten(*candidate.function->parameters[i], argument);
      continue;
    }
    const bool isPlace = std::holds_alternative<Name>(rootOf(argument).node);
    if (candidate.function && !isPlace && !(strict_ && isLiteral(argument))) {
      advise(argument.position, "this argument is an output of the function: what it writes is lost");
    } else if (!checkWritable(argument)) {
      continue;
    }
    const bool sameKind = formal == types::none || argument.type.element() == formal.element() ||
                          (argument.type.isTriple() && formal.isTriple());
    if (!sameKind && !isPoisoned(argument.type)) {
      error(argument.position,
            "an output argument must be a variable of type " + toString(formal) + ", not " + toString(argument.type));
    }
  }
}

void Checker::useFunction(const FunctionDeclaration& function, Position position) {
  const auto defined = result_->definitions.find(&function);
  const FunctionDeclaration& body = defined == result_->definitions.end() ? function : *defined->second;
  const auto state = functionStates_.find(&body);
  if (state != functionStates_.end()) {
    if (state->second == State::checking) {
      error(position, "function '" + function.name + "' calls itself: shaders cannot recurse",
            {"it is defined here: " + where(function.position)});
    }
    if (state->second == State::withoutReturn) {
      error(position, "function '" + function.name + "' has no 'return' to give it a value",
            {"it is defined here: " + where(body.position)});
    }
    return;
  }
  if (!body.body || !sourceMap_.isInPrelude(body.position)) return;
  // Functions of the standard library are checked when they are first called, in the scope of the file. What is wrong
  // there is wrong with the call.
  const Position outerCall = libraryCall_;
  if (!sourceMap_.isInPrelude(position)) libraryCall_ = position;
  std::vector<Scope> outer;
  while (scopes_.size() > 1) {
    outer.push_back(std::move(scopes_.back()));
    scopes_.pop_back();
  }
  checkBody(const_cast<FunctionDeclaration&>(body));
  libraryCall_ = outerCall;
  while (!outer.empty()) {
    scopes_.push_back(std::move(outer.back()));
    outer.pop_back();
  }
}

Type Checker::checkClosureCall(Expression& expression, Call& call, const ClosureRow& row) {
  const bool isVolume = shaderKind_ == "volume", isSurface = shaderKind_ == "surface" || shaderKind_ == "light";
  if ((isVolume && !row.volume) || (isSurface && !row.surface)) {
    std::vector<std::string> names;
    for (const ClosureRow& other : closureTable())
      if (isVolume ? other.volume : other.surface) names.emplace_back(other.name);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    std::string note = "closures of " + shaderKind_ + " shaders:";
    for (const std::string& name : names) note += " " + name;
    warning(expression.position,
            std::string("closure '") + row.name + "' has no meaning in " + shaderKind_ + " shaders", {note});
  }
  if (shaderKind_ == "displacement") warning(expression.position, "closures have no meaning in displacement shaders");
  const std::vector<ClosureParameter> options = closureOptions(row);
  for (std::size_t i = closureParameters(row).size(); i < call.arguments.size(); i += 2) {
    const Expression& key = *call.arguments[i];
    const auto* literal = std::get_if<StringLiteral>(&key.node);
    const auto option = std::find_if(options.begin(), options.end(),
                                     [&](const auto& known) { return literal && known.name == literal->value; });
    if (option == options.end()) {
      std::string note = "the options are:";
      for (const ClosureParameter& known : options) note += " \"" + known.name + "\"";
      if (!literal) {
        error(key.position, std::string("the name of an option of closure '") + row.name + "' must be a literal string",
              {note});
        return poisoned;
      }
      advise(key.position, std::string("unknown option of closure '") + row.name + "' is ignored", {note});
    }
    if (i + 1 >= call.arguments.size()) {
      error(key.position, "option \"" + literal->value + "\" has no value");
      return poisoned;
    }
    if (option == options.end()) continue;
    requireAssignable(option->type, *call.arguments[i + 1], "the value of option \"" + option->name + "\"");
  }
  return types::closure;
}

void Checker::unknownFunction(Position position, std::string_view name) {
  std::vector<std::string> names = builtinNames();
  for (std::string& closure : closureNames()) names.push_back(std::move(closure));
  for (const Scope& scope : scopes_)
    for (const auto& [known, unused] : scope.functions) names.push_back(known);
  for (const Scope& scope : scopes_)
    for (const auto& [known, unused] : scope.structs) names.push_back(known);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  const std::string note = didYouMean(name, names);
  error(position, "unknown function '" + std::string(name) + "'",
        note.empty() ? std::vector<std::string>{} : std::vector<std::string>{note});
}

const FunctionDeclaration* Checker::findOverload(std::string_view name, std::vector<Expression*> operands,
                                                 Position position, const Type& expected, Type& result) {
  std::vector<Candidate> candidates;
  gatherCandidates(name, position, candidates);
  if (candidates.empty()) return nullptr;
  const Candidate* chosen = nullptr;
  for (Candidate& candidate : candidates) {
    if (candidate.parameters.size() != operands.size()) continue;
    candidate.score = 0;
    for (std::size_t i = 0; i < operands.size(); ++i) {
      const int one = matchScore(candidate.parameters[i], operands[i]->type);
      if (one == 0) {
        candidate.score = -1;
        break;
      }
      candidate.score += one;
    }
    candidate.resultScore = expected == types::none ? 0 : matchScore(expected, candidate.result);
    if (candidate.score < 0) continue;
    if (!chosen || candidate.score > chosen->score ||
        (candidate.score == chosen->score && candidate.resultScore > chosen->resultScore))
      chosen = &candidate;
  }
  // Operators on the language's own types keep their meaning unless the operands fit the author's function exactly.
  const bool hasStructure = std::any_of(operands.begin(), operands.end(), [](const Expression* operand) {
    return operand->type.base == BaseType::structure;
  });
  if (!chosen || (!hasStructure && chosen->score != 100 * static_cast<int>(operands.size()))) return nullptr;
  useFunction(*chosen->function, position);
  result = chosen->result;
  return chosen->function;
}

}  // namespace aerosol::lang
