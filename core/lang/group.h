// Shader groups: layers whose outputs feed the parameters of later layers, merged into one program.
//
// Everything that works on programs (slicing, folding, code generation in every domain) works on the merged program
// as it is: a layer is a stretch of its code.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/lang/analysis.h"
#include "core/lang/program.h"

namespace aerosol::lang {

/// A value for a parameter, as the author of a group gives it. Its type may be any that converts.
struct GivenValue {
  std::string parameter;  ///< A parameter, or a field of one that is a structure: `s.a`.
  Type type;
  ConstantValue value;  ///< Of that type.
  SourceLocation location;
  std::vector<MetadataValue> hints = {};  ///< Go before the parameter's metadata of the same name.
};

struct GroupLayer {
  std::string name;                        ///< Unique in the group.
  std::shared_ptr<const Program> program;  ///< As `CompiledSource::layer`: not yet complete.
  std::vector<GivenValue> values;          ///< Of several for one parameter the last one counts.
  SourceLocation location;
};

/// `connect sourceLayer.source layer.parameter`. Both ends name a parameter, or a part of one: a field `s.a`, an
/// element `a[2]`, a component `c[0]`, `c.r`, `p.x`, or these after one another `s.a[2].x`.
struct Connection {
  std::string sourceLayer;
  std::string source;  ///< Also `Ci` of a surface or volume, which then is that layer's own, not the group's.
  std::string layer;
  std::string parameter;
  SourceLocation sourceLocation;
  SourceLocation location;
};

/// A group. Connections lead from earlier layers to later ones.
struct Group {
  std::string name;
  std::vector<GroupLayer> layers;
  std::vector<Connection> connections;
  std::vector<std::string> entryLayers;  ///< What is run, in the order of the layers. None: the last layer.
  /// Parameters `layer.parameter` (or `parameter`: of the last layer that has it) that become outputs of the program,
  /// besides the output parameters of the entry layers. Their layers are always run.
  std::vector<std::string> outputs;
};

struct GroupOptions {
  bool lazyLayers = true;            ///< Otherwise all layers are run, in order.
  bool lazyGlobals = true;           ///< Otherwise layers that write globals are always run.
  bool lazyUnconnected = true;       ///< Otherwise layers of which no output is connected are always run.
  bool mergeInstances = true;        ///< Layers that are alike become one.
  bool userDataIsConnected = false;  ///< For `isconnected`, of parameters that read user data.
  /// Values have to be of the parameter's type, triples of any kind for one another; what is not is left out with a
  /// warning, unknown parameters too. Otherwise both are errors, and values are converted as assignments do it.
  bool exactTypes = false;
};

inline constexpr std::size_t maximumLayers = 4000;

/// Stands for the index of a parameter where a layer's `Ci` is the source of a connection.
inline constexpr std::uint32_t ciParameter = 0xfffffffe;

/// A part of a parameter: of an array an element, of a triple (or of an element that is one) a component.
struct Part {
  std::uint32_t parameter = 0;  ///< Index into the parameters of the layer's program.
  int element = -1;             ///< -1: the whole.
  int component = -1;

  bool isWhole() const { return element < 0 && component < 0; }
};

/// A connection of leaves.
struct Link {
  std::uint32_t sourceLayer = 0;
  Part source;
  std::uint32_t layer = 0;
  Part target;
  SourceLocation location;
};

/// A group whose names were looked up. Its layers are those that are left when instances are merged.
struct ResolvedGroup {
  struct Layer {
    std::string name;
    std::shared_ptr<const Program> program;
    std::uint32_t firstParameter = 0;  ///< Of the merged program. Closures are no parameters there.
    bool isEntry = false;
    bool alwaysRuns = false;
    std::vector<std::uint32_t> asked;  ///< Parameters of the layer that are outputs of the group.
    std::map<std::uint32_t, std::vector<MetadataValue>> hints;  ///< By parameter of the layer.
  };
  std::string name;
  std::vector<Layer> layers;
  std::vector<Link> links;  ///< Sorted by target layer.
  ParameterValues values;   ///< Of the merged program's parameters, by index.
  Diagnostics warnings;
  bool userDataIsConnected = false;  ///< GroupOptions
  /// Groups with equal keys have equal merged programs (as long as the layers' programs live); values do not count.
  std::string key;
};

/// Looks up all names, checks types, merges instances. All errors are found, at the places given in the group.
Result<ResolvedGroup> resolve(const Group& group, const GroupOptions& options = {});

/// One program that computes what the group does. Its parameters are those of all layers, as `layer.parameter`; those
/// that are connected have no effect. It is complete (see `complete` in lower.h) and sliced to its outputs.
///
/// A layer is run at most once a point, when something first reads one of its outputs. Where that is not one place in
/// the code, a layer without effects is run before all of them; a layer that leaves messages or writes globals is
/// guarded by a flag and has its code at each of them.
Result<std::shared_ptr<const Program>> merge(const ResolvedGroup& group);

}  // namespace aerosol::lang
