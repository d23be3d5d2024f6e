// Which values are equal in all points that run them together, and where control flow parts those points.
#pragma once

#include <functional>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/lang/program.h"

namespace aerosol::lang {

inline bool isExit(Op op) { return op == Op::breakLoop || op == Op::continueLoop || op == Op::leave; }
inline bool isControl(Op op) { return op == Op::branch || op == Op::loop || op == Op::scope; }

/// Does the instruction write `arguments[index]` besides its result?
bool writesArgument(const Program& program, const Instruction& instruction, std::size_t index);

/// Uniformity of a program's code over a group of points that run it in step.
///
/// A variable is uniform when all points of the group that can read it see one value. It stays uniform under control
/// flow that parts the points as long as none of the parted points reads it later: every variable has a home, the
/// innermost block (or loop with the writes before it) outside of which its value is of no interest. Only what parts
/// points between the home and a write makes the variable varying, or makes the write keep the old value of the points
/// that are absent. (In spirit: Karrenberg and Hack 2011, "Whole-function vectorization"; here on structured code, with
/// early exits.)
class Uniformity {
 public:
  struct Inputs {
    std::function<bool(VariableId)> startsVarying;       ///< Globals, and parameters that differ between instances.
    std::function<bool(const Instruction&)> callVaries;  ///< Calls that vary although no argument does.
  };
  Uniformity(const Program& program, const Code& code, const Inputs& inputs);

  bool isVarying(VariableId variable) const { return varying_[variable]; }
  /// A branch, or a loop, at which points part.
  bool isVarying(const Instruction& control) const { return varyingControl_.contains(&control); }
  /// An exit that some points of the group take and others, still to be run, do not. Otherwise it is a jump of all.
  bool isMasked(const Instruction& exit) const { return maskedExits_.contains(&exit); }
  /// Must a write keep the old values of absent points?
  bool needsBlend(const Instruction& write, VariableId variable) const { return blends_.contains({&write, variable}); }
  /// Do all points of the group that reach the loop run it the same number of times in all?
  bool countsAlike(const Instruction& loop) const { return !unlikeLoops_.contains(&loop); }
  /// How often the variable is written, setting parts included.
  unsigned writeCount(VariableId variable) const { return writeCounts_[variable]; }

 private:
  struct Construct {
    const Instruction* instruction;
    bool parts = false;            ///< A branch or loop at which points part.
    bool pendingEnd = false;       ///< Some points wait at its end (break, leave).
    bool pendingContinue = false;  ///< Some points wait at the loop's step.
  };
  /// Where all that a variable is used for takes place.
  struct Home {
    std::size_t depth = 0;  ///< Number of constructs around it; 0: the whole program.
    bool isLoop = false;    ///< The loop at that depth, which carries the variable from round to round.
  };
  /// What is known of a variable in one block.
  struct Accesses {
    unsigned count = 0;
    bool startsWithWrite = false;           ///< The first access is a write of the whole variable by the block itself.
    const Instruction* onlyLoop = nullptr;  ///< All accesses but such writes before it are within this loop.
    bool usedOutsideLoop = false;
  };
  using BlockAccesses = std::unordered_map<VariableId, Accesses>;

  void countAccesses(const Code& code);
  BlockAccesses findHomes(const Code& code, std::size_t depth);
  BlockAccesses findHomesInBodies(const Instruction& control, std::size_t depth);
  void settle(VariableId variable, Home home);
  void walk(const Code& code);
  void walkControl(const Instruction& instruction);
  void walkExit(const Instruction& instruction);
  void write(const Instruction& instruction, VariableId variable, bool valueVaries);
  bool resultVaries(const Instruction& instruction) const;
  bool isParted(Home home) const;
  void markVarying(VariableId variable);
  template <class Set, class Key>
  void insert(Set& set, const Key& key) {
    if (set.insert(key).second) changed_ = true;
  }

  const Program& program_;
  const Inputs& inputs_;
  std::vector<unsigned> accessCounts_;
  std::vector<unsigned> writeCounts_;
  std::vector<Home> homes_;
  std::vector<bool> varying_;
  std::unordered_set<const Instruction*> varyingControl_, maskedExits_, unlikeLoops_;
  std::set<std::pair<const Instruction*, VariableId>> blends_;
  /// For every loop the constructs outside of it to whose ends masked exits inside lead.
  std::unordered_map<const Instruction*, std::unordered_set<const Instruction*>> exitsThrough_;
  std::vector<Construct> constructs_;
  bool changed_ = false;
};

}  // namespace aerosol::lang
