// Where in a group's program the code of each layer stands.
#pragma once

#include <functional>
#include <set>
#include <vector>

#include "core/lang/program.h"

namespace aerosol::lang {

/// Whether an instruction, its bodies aside, is looked for; `skip`: neither it nor what is in its bodies.
enum class Match : std::uint8_t { no, yes, skip };
using Matcher = std::function<Match(const Instruction&)>;

/// Inserts `added` at the innermost place outside of loops that control passes before everything that matches. False
/// when nothing does. Blocks deeper than `maximumDepth` are not entered.
bool insertBeforeAll(Code& code, const Matcher& matches, Code added, int maximumDepth);

/// One layer's code before it has a place.
struct LayerCode {
  Code code;
  bool isMovable = true;    ///< Nothing can tell when it is run, nor whether.
  bool alwaysRuns = false;  ///< In the order of the layers, and after what it reads.
};

inline constexpr std::uint32_t noLayer = 0xffffffffu;

/// Joins layers: each that has to be, or that another needs, is run before its first use and at most once.
///
/// A layer that is movable has one place: before all of its uses, in the innermost block that holds them. Uses within
/// another layer count where that layer stands; layers are placed from the last to the first, each into the code of
/// the nearest layer through which all of its uses are reached (its dominator in the graph of connections), so that no
/// step looks at the whole program. Other layers are run exactly when something first reads them, behind a flag where
/// control may come by more than once.
class LayerPlacement {
 public:
  /// `producers` tells for every variable of the program which layer's run sets it (`noLayer`: none). Connections lead
  /// to higher numbers.
  LayerPlacement(Program& program, std::vector<LayerCode> layers, std::vector<std::uint32_t> producers);

  Code run();

 private:
  enum class State : std::uint8_t { no, maybe, yes };  ///< Has the layer been run?
  using Index = std::uint32_t;

  void findReads();
  void findHosts();
  Index commonHost(Index a, Index b) const;
  void place(Index layer);
  bool readsDirectly(const Instruction& instruction) const;
  bool uses(const Instruction& instruction) const;

  State walk(Index layer, Code& code, State state, int depth);
  State walkLayer(Index layer, State state, int depth);
  State ensure(Index layer, Code& code, std::size_t& at, State state, int depth);
  void placeExactly(Index layer);

  static bool isMarker(const Instruction& instruction);
  Instruction marker(Index layer) const;
  void expand(const Code& code, std::vector<VariableId>* renamed, Code& out);
  VariableId one();

  Program& program_;
  std::vector<LayerCode> layers_;  ///< One more than the group has: the last holds the whole.
  std::vector<Index> producers_;
  std::vector<std::set<Index>> reads_, users_;  ///< By layer: layers.
  std::vector<Index> hosts_;
  std::vector<int> hostDepth_;   ///< Number of hosts around a layer.
  std::vector<int> blockDepth_;  ///< Number of blocks around its code.
  std::vector<std::size_t> sizes_, copies_;
  std::vector<int> expanded_;
  Index top_ = 0;
  VariableId one_ = noVariable;  ///< The constant 1, once there is a flag to set.

  // While one layer is placed
  Index current_ = 0;
  std::vector<bool> leadsToUse_;  ///< By layer: it, or one that it hosts, reads the current one.
  std::vector<State> exits_;      ///< By layer that was walked.
  std::vector<bool> walked_;
  bool isTrial_ = false, needsFlag_ = false;
  std::size_t sites_ = 0;
  int deepest_ = 0;
  VariableId hasRun_ = noVariable;
};

}  // namespace aerosol::lang
