#include "core/lang/usage.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/lang/builtins.h"
#include "core/lang/root_expression.h"

namespace aerosol::lang {

namespace {

using Variables = std::unordered_set<const VariableDeclaration*>;

/// The variable that an index, a field or a name picks from; null for other expressions.
const VariableDeclaration* rootVariable(const Expression& expression) {
  const Expression* const root = &rootOf(expression);
  const auto* name = std::get_if<Name>(&root->node);
  return name ? name->declaration : nullptr;
}

bool alwaysJumps(const Statement& statement) {
  if (std::holds_alternative<Return>(statement.node) || std::holds_alternative<Jump>(statement.node)) return true;
  if (const auto* block = std::get_if<Block>(&statement.node))
    return !block->statements.empty() && block->statements.back() && alwaysJumps(*block->statements.back());
  if (const auto* branch = std::get_if<If>(&statement.node))
    return branch->yes && branch->no && alwaysJumps(*branch->yes) && alwaysJumps(*branch->no);
  return false;
}

/// One walk in the order of evaluation. `assigned_` holds what may have been set on some path to where the walk is.
class Usage {
 public:
  Usage(const SourceMap& sourceMap, Diagnostics& diagnostics, bool advice)
      : sourceMap_(sourceMap), diagnostics_(diagnostics), advice_(advice) {}

  void run(const SourceFile& file) {
    for (const auto& declaration : file.declarations) {
      if (const auto* function = std::get_if<std::unique_ptr<FunctionDeclaration>>(&declaration)) {
        if (!sourceMap_.isInPrelude((*function)->position)) body((*function)->body);
      } else if (const auto* shader = std::get_if<std::unique_ptr<ShaderDeclaration>>(&declaration)) {
        for (const auto& parameter : (*shader)->parameters) read(parameter->initializer);
        body((*shader)->body);
      }
    }
    for (const VariableDeclaration* variable : locals_) {
      if (!advice_ || reads_.contains(variable) || !sourceMap_.isInMainFile(variable->position)) continue;
      const char* what = writes_.contains(variable) ? "' is set but never read" : "' is never used";
      warn(variable->position, "variable '" + variable->name + what);
    }
    report();
  }

 private:
  void body(const StatementPtr& statement) {
    if (!statement) return;
    assigned_.clear();
    uninitialized_.clear();
    walk(*statement);
  }

  // Statements

  void walk(const StatementPtr& statement) {
    if (statement) walk(*statement);
  }

  void walk(const Statement& statement) {
    if (const auto* expression = std::get_if<ExpressionStatement>(&statement.node)) {
      if (expression->expression) evaluate(*expression->expression);
    } else if (const auto* declaration = std::get_if<DeclarationStatement>(&statement.node)) {
      for (const auto& variable : declaration->variables) declare(*variable);
    } else if (const auto* block = std::get_if<Block>(&statement.node)) {
      walkBlock(*block);
    } else if (const auto* branch = std::get_if<If>(&statement.node)) {
      read(branch->condition);
      either([&] { walk(branch->yes); }, [&] { walk(branch->no); });
    } else if (const auto* loop = std::get_if<Loop>(&statement.node)) {
      walkLoop(*loop);
    } else if (const auto* leave = std::get_if<Return>(&statement.node)) {
      if (leave->value) valueOf(*leave->value);
    } else if (const auto* local = std::get_if<LocalFunction>(&statement.node)) {
      // Where it is called from is not followed: what it reads may have been set by then.
      const Variables outer = std::exchange(uninitialized_, {});
      walk(local->function->body);
      uninitialized_.insert(outer.begin(), outer.end());
    }
  }

  void walkBlock(const Block& block) {
    bool reported = false;
    for (std::size_t i = 0; i < block.statements.size(); ++i) {
      const StatementPtr& statement = block.statements[i];
      if (!statement) continue;
      walk(*statement);
      const bool isLast = i + 1 == block.statements.size();
      if (isLast || reported || !block.statements[i + 1] || !alwaysJumps(*statement)) continue;
      if (advice_) warn(block.statements[i + 1]->position, "this statement is never reached");
      reported = true;
    }
  }

  void walkLoop(const Loop& loop) {
    walk(loop.initial);
    // A later round of the loop finds what an earlier one has set.
    if (!onlyGathers_) gatherAssigned(loop);
    if (!loop.testsLast) read(loop.condition);
    walk(loop.body);
    if (loop.step) evaluate(*loop.step);
    if (loop.testsLast) read(loop.condition);
  }

  void gatherAssigned(const Loop& loop) {
    const bool outer = std::exchange(onlyGathers_, true);
    if (loop.condition) valueOf(*loop.condition);
    walk(loop.body);
    if (loop.step) evaluate(*loop.step);
    onlyGathers_ = outer;
  }

  void declare(const VariableDeclaration& variable) {
    if (variable.initializer) {
      initial(*variable.initializer);
    } else {
      uninitialized_.insert(&variable);
      assigned_.erase(&variable);
    }
    if (!onlyGathers_ && !sourceMap_.isInPrelude(variable.position)) locals_.push_back(&variable);
  }

  template <class Yes, class No>
  void either(Yes&& yes, No&& no) {
    const Variables before = assigned_;
    yes();
    Variables after = std::exchange(assigned_, before);
    no();
    assigned_.insert(after.begin(), after.end());
  }

  // Expressions

  void read(const ExpressionPtr& expression) {
    if (expression) valueOf(*expression);
  }

  /// An initial or an assigned value.
  void initial(const Expression& expression) {
    if (const auto* comma = std::get_if<Comma>(&expression.node); comma && !hasEffect(*comma->first)) {
      warn(expression.position, "the comma drops the value before it: this is one value, not a list",
           {"a vector or a colour is written vector(x, y, z), color(r, g, b) or {x, y, z}"});
      reportedCommas_.insert(&expression);
    }
    valueOf(expression);
  }

  /// An expression whose value nobody asks for: setting a variable is not reading it.
  void evaluate(const Expression& expression) {
    if (const auto* assign = std::get_if<Assign>(&expression.node)) {
      this->assign(*assign);
    } else if (const auto* comma = std::get_if<Comma>(&expression.node)) {
      evaluate(*comma->first);
      evaluate(*comma->second);
    } else {
      valueOf(expression);
    }
  }

  void valueOf(const Expression& expression) {
    const auto& node = expression.node;
    if (const auto* name = std::get_if<Name>(&node)) {
      use(name->declaration, expression.position);
    } else if (const auto* unary = std::get_if<Unary>(&node)) {
      valueOf(*unary->operand);
      if (unary->op >= UnaryOp::preIncrement) set(rootVariable(*unary->operand));
    } else if (const auto* binary = std::get_if<Binary>(&node)) {
      valueOf(*binary->left);
      if (binary->op == BinaryOp::logicalAnd || binary->op == BinaryOp::logicalOr) {
        either([&] { valueOf(*binary->right); }, [] {});
      } else {
        valueOf(*binary->right);
      }
    } else if (const auto* assign = std::get_if<Assign>(&node)) {
      this->assign(*assign);
    } else if (const auto* conditional = std::get_if<Conditional>(&node)) {
      valueOf(*conditional->condition);
      either([&] { valueOf(*conditional->yes); }, [&] { valueOf(*conditional->no); });
    } else if (const auto* index = std::get_if<Index>(&node)) {
      valueOf(*index->base);
      valueOf(*index->index);
    } else if (const auto* field = std::get_if<Field>(&node)) {
      valueOf(*field->base);
    } else if (const auto* call = std::get_if<Call>(&node)) {
      this->call(*call);
    } else if (const auto* construct = std::get_if<Construct>(&node)) {
      for (const ExpressionPtr& argument : construct->arguments) valueOf(*argument);
    } else if (const auto* list = std::get_if<InitializerList>(&node)) {
      for (const ExpressionPtr& element : list->elements) valueOf(*element);
    } else if (const auto* comma = std::get_if<Comma>(&node)) {
      if (!reportedCommas_.contains(&expression) && !hasEffect(*comma->first))
        warn(expression.position, "the comma drops the value before it");
      evaluate(*comma->first);
      valueOf(*comma->second);
    }
  }

  void assign(const Assign& assign) {
    if (assign.compound) valueOf(*assign.target);
    indicesOf(*assign.target);
    initial(*assign.value);
    set(rootVariable(*assign.target));
  }

  /// The indices within what is written.
  void indicesOf(const Expression& target) {
    if (const auto* index = std::get_if<Index>(&target.node)) {
      indicesOf(*index->base);
      valueOf(*index->index);
    } else if (const auto* field = std::get_if<Field>(&target.node)) {
      indicesOf(*field->base);
    }
  }

  void call(const Call& call) {
    // The value of an option behind its name may be a variable that is written.
    const auto isOption = [&](std::size_t i) {
      return call.builtin && i >= call.builtin->parameters.size() && i > 0 &&
             std::holds_alternative<StringLiteral>(call.arguments[i - 1]->node);
    };
    const auto isOutput = [&](std::size_t i) {
      if (isOption(i)) return true;
      if (call.builtin) return i < 32 && (call.builtin->outputs >> i & 1u) != 0;
      if (!call.function || i >= call.function->parameters.size()) return false;
      const VariableDeclaration& formal = *call.function->parameters[i];
      return formal.isOutput || formal.isAssigned;
    };
    std::vector<const VariableDeclaration*> written;
    for (std::size_t i = 0; i < call.arguments.size(); ++i) {
      const Expression& argument = *call.arguments[i];
      const VariableDeclaration* root = isOutput(i) ? rootVariable(argument) : nullptr;
      if (!root) {
        valueOf(argument);
        continue;
      }
      indicesOf(argument);
      reads_.insert(root);  // What a function sets may be wanted for the others that it sets.
      written.push_back(root);
    }
    for (const VariableDeclaration* variable : written) set(variable);
  }

  static bool hasEffect(const Expression& expression) {
    const auto& node = expression.node;
    if (const auto* unary = std::get_if<Unary>(&node)) return unary->op >= UnaryOp::preIncrement;
    if (const auto* comma = std::get_if<Comma>(&node)) return hasEffect(*comma->first) || hasEffect(*comma->second);
    return std::holds_alternative<Assign>(node) || std::holds_alternative<Call>(node);
  }

  // Variables

  void use(const VariableDeclaration* variable, Position position) {
    if (!variable || onlyGathers_) return;
    reads_.insert(variable);
    if (!uninitialized_.contains(variable) || assigned_.contains(variable)) return;
    if (advice_)
      warn(position, "'" + variable->name + "' is read before anything is assigned to it", {"its value is zero here"});
    uninitialized_.erase(variable);
  }

  void set(const VariableDeclaration* variable) {
    if (!variable) return;
    assigned_.insert(variable);
    writes_.insert(variable);
  }

  void warn(Position position, std::string message, std::vector<std::string> notes = {}) {
    if (onlyGathers_ || sourceMap_.warningsSuppressed(position) || sourceMap_.isInPrelude(position)) return;
    warnings_.emplace_back(position, sourceMap_.warning(position, std::move(message), std::move(notes)));
  }

  void report() {
    std::multimap<Position, Diagnostic> sorted(warnings_.begin(), warnings_.end());
    for (auto& [position, warning] : sorted) diagnostics_.add(std::move(warning));
  }

  const SourceMap& sourceMap_;
  Diagnostics& diagnostics_;
  std::vector<const VariableDeclaration*> locals_;
  Variables reads_, writes_;
  Variables assigned_, uninitialized_;
  std::unordered_set<const Expression*> reportedCommas_;
  bool advice_;
  bool onlyGathers_ = false;  ///< Only what is assigned is of interest.
  std::vector<std::pair<Position, Diagnostic>> warnings_;
};

}  // namespace

void warnAboutUsage(const SourceFile& file, const SourceMap& sourceMap, Diagnostics& diagnostics, bool advice) {
  Usage(sourceMap, diagnostics, advice).run(file);
}

}  // namespace aerosol::lang
