#include "tests/unit/jit/random_program.h"

#include <random>
#include <vector>

#include "tests/unit/jit/program_builder.h"

namespace aerosol::jit::test {

namespace types = lang::types;

namespace {

class Dice {
 public:
  Dice(std::uint64_t seed, const RandomProgramOptions& options) : random_(seed), options_(options) {}

  std::shared_ptr<const Program> program() {
    floats_ = {b_.global(Global::u), b_.global(Global::v)};
    triples_ = {b_.global(Global::P)};
    b_.parameter("amount", types::floating, std::vector<float>{0.75f});
    floats_.push_back(b_.program().parameters[0].variable);
    b_.parameter("count", types::integer, std::vector<std::int32_t>{3});
    ints_.push_back(b_.program().parameters[1].variable);
    writableFloats_ = {b_.local(types::floating, "a"), b_.local(types::floating, "b"), b_.local(types::floating, "c")};
    writableInts_ = {b_.local(types::integer, "i"), b_.local(types::integer, "j")};
    writableTriples_ = {b_.local(types::color, "q")};
    floatArray_ = b_.local(types::floating.arrayOf(5), "fs");
    tripleArray_ = b_.local(types::color.arrayOf(3), "cs");
    floats_.insert(floats_.end(), writableFloats_.begin(), writableFloats_.end());
    ints_.insert(ints_.end(), writableInts_.begin(), writableInts_.end());
    triples_.insert(triples_.end(), writableTriples_.begin(), writableTriples_.end());
    statements(options_.statements, options_.depth);
    for (const VariableId id : writableFloats_) b_.output(id);
    for (const VariableId id : writableInts_) b_.output(id);
    for (const VariableId id : writableTriples_) b_.output(id);
    b_.output(floatArray_);
    return b_.build();
  }

 private:
  int roll(int sides) { return std::uniform_int_distribution<int>(0, sides - 1)(random_); }
  VariableId pick(const std::vector<VariableId>& from) {
    return from[static_cast<std::size_t>(roll(static_cast<int>(from.size())))];
  }

  VariableId floating(int depth = 2) {
    const int die = depth == 0 ? roll(3) : roll(9);
    switch (die) {
      case 0:
      case 1:
        return pick(floats_);
      case 2:
        return b_.floating(static_cast<float>(roll(17) - 8) / 4.0f);
      case 3:
        return b_.emit(Op::component, types::floating,
                       {pick(triples_), options_.integers ? integer(depth - 1) : b_.integer(roll(3))});
      case 4:
        if (!options_.arrays) return pick(floats_);
        return b_.emit(Op::element, types::floating, {floatArray_, integer(depth - 1)});
      case 5:
        return b_.call(roll(2)   ? "floor_f_f"
                       : roll(2) ? "sqrt_f_f"
                                 : "abs_f_f",
                       types::floating, {floating(depth - 1)});
      case 6:
        return b_.emit(Op::select, types::floating, {condition(depth - 1), floating(depth - 1), floating(depth - 1)});
      default: {
        static constexpr Op ops[] = {Op::add, Op::subtract, Op::multiply, Op::divide};
        return b_.emit(ops[roll(4)], types::floating, {floating(depth - 1), floating(depth - 1)});
      }
    }
  }

  VariableId integer(int depth = 2) {
    if (depth <= 0 || !options_.integers) return roll(2) ? pick(ints_) : b_.integer(roll(9) - 2);
    switch (roll(5)) {
      case 0:
        return pick(ints_);
      case 1:
        return b_.integer(roll(4) == 0 ? -2147483647 - 1 : roll(9) - 3);
      case 2:
        return b_.emit(Op::toInt, types::integer, {floating(depth - 1)});
      case 3:
        return b_.emit(roll(2) ? Op::negate : Op::bitNot, types::integer, {integer(depth - 1)});
      default: {
        static constexpr Op ops[] = {Op::add,    Op::subtract, Op::multiply, Op::divide,    Op::modulo,
                                     Op::bitAnd, Op::bitOr,    Op::bitXor,   Op::shiftLeft, Op::shiftRight};
        return b_.emit(ops[roll(10)], types::integer, {integer(depth - 1), integer(depth - 1)});
      }
    }
  }

  VariableId triple(int depth = 2) {
    switch (roll(4)) {
      case 0:
        return pick(triples_);
      case 1:
        return b_.emit(Op::makeTriple, types::color, {floating(depth - 1), floating(depth - 1), floating(depth - 1)});
      case 2:
        if (!options_.arrays) return pick(triples_);
        return b_.emit(Op::element, types::color, {tripleArray_, integer(depth - 1)});
      default:
        return b_.emit(roll(2) ? Op::multiply : Op::divide, types::color, {pick(triples_), floating(depth - 1)});
    }
  }

  VariableId condition(int depth = 2) {
    static constexpr Op ops[] = {Op::less, Op::lessEqual, Op::greater, Op::greaterEqual, Op::equal, Op::notEqual};
    if (roll(6) == 0) return b_.emit(Op::logicalNot, types::integer, {condition(depth)});
    if (depth > 0 && roll(5) == 0) {
      return b_.emit(roll(2) ? Op::logicalAnd : Op::logicalOr, types::integer,
                     {condition(depth - 1), condition(depth - 1)});
    }
    if (roll(3) == 0) return b_.emit(ops[roll(6)], types::integer, {integer(depth - 1), integer(depth - 1)});
    return b_.emit(ops[roll(4)], types::integer, {floating(depth - 1), floating(depth - 1)});
  }

  void statements(int count, int depth) {
    for (int i = roll(count) + 1; i > 0; --i) {
      b_.line(++line_);
      if (statement(depth)) return;
    }
  }

  /// True when nothing can follow.
  bool statement(int depth) {
    const int die = roll(depth > 0 ? 20 : 9);
    switch (die) {
      case 0:
      case 1:
      case 2:
        b_.assign(pick(writableFloats_), floating());
        return false;
      case 3:
        b_.emitTo(pick(writableInts_), Op::add, {integer(), integer()});
        return false;
      case 4:
        b_.assign(pick(writableTriples_), triple());
        return false;
      case 5:
        b_.emitTo(pick(writableTriples_), Op::setComponent, {integer(), floating()});
        return false;
      case 6:
        if (options_.arrays) b_.emitTo(floatArray_, Op::setElement, {integer(), floating()});
        return false;
      case 7:
        if (options_.arrays) b_.emitTo(tripleArray_, Op::setElement, {integer(), triple()});
        return false;
      case 8:
        return exit();
      case 9:
      case 10:
        if (options_.messages) {
          b_.message(lang::MessageKind::warning, "%g %d", {pick(floats_), pick(ints_)});
        }
        return false;
      case 11:
      case 12: {
        b_.scope([&](std::uint32_t id) {
          openScopes_.push_back(id);
          statements(options_.statements, depth - 1);
          openScopes_.pop_back();
        });
        return false;
      }
      case 13:
      case 14:
      case 15:
        loop(depth);
        return false;
      default: {
        const VariableId chosen = condition();
        b_.branch(
            chosen, [&] { statements(options_.statements / 2, depth - 1); },
            [&] {
              if (roll(2)) statements(options_.statements / 2, depth - 1);
            });
        return false;
      }
    }
  }

  bool exit() {
    if (!openScopes_.empty() && roll(3) == 0) {
      b_.leave(openScopes_[static_cast<std::size_t>(roll(static_cast<int>(openScopes_.size())))]);
      return true;
    }
    if (loops_ == 0) return false;
    roll(2) ? b_.breakLoop() : b_.continueLoop();
    return true;
  }

  void loop(int depth) {
    const VariableId counter = b_.local(types::integer, "k");
    const bool testsLast = roll(4) == 0;
    const int kind = roll(4);
    b_.assign(counter, b_.integer(0));
    const auto test = [&] {
      if (kind == 0) return b_.emit(Op::less, types::integer, {counter, b_.integer(roll(5))});
      if (kind == 1) return b_.emit(Op::less, types::integer, {counter, integer(1)});
      if (kind == 2) return b_.emit(Op::less, types::integer, {floating(1), floating(1)});
      return condition(1);
    };
    b_.loop(
        test,
        [&] {
          ints_.push_back(counter);
          ++loops_;
          statements(options_.statements / 2, depth - 1);
          --loops_;
          ints_.pop_back();
        },
        [&] { b_.emitTo(counter, Op::add, {counter, b_.integer(1)}); }, testsLast);
  }

  ProgramBuilder b_;
  std::mt19937_64 random_;
  RandomProgramOptions options_;
  std::vector<VariableId> floats_, ints_, triples_, writableFloats_, writableInts_, writableTriples_;
  VariableId floatArray_ = 0, tripleArray_ = 0;
  std::vector<std::uint32_t> openScopes_;
  int loops_ = 0;
  int line_ = 1;
};

}  // namespace

std::shared_ptr<const Program> randomProgram(std::uint64_t seed, const RandomProgramOptions& options) {
  return Dice(seed, options).program();
}

}  // namespace aerosol::jit::test
