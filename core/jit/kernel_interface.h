// What a host must know of a kernel to call it and to read what it leaves. It travels with the code in the cache.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/lang/abi.h"
#include "core/lang/host_site.h"
#include "core/lang/program.h"

namespace aerosol::jit {

/// The kind of number that a kernel computes with.
enum class Domain : std::uint8_t {
  wide,   ///< One value a point.
  range,  ///< Bounds [lo, hi] over a box of points.
};

/// What one pointer of `AerosolKernelArguments::outputs` holds.
enum class OutputPart : std::uint8_t {
  value,     ///< wide domain, and strings in the range domain
  low,       ///< range domain
  high,      ///< range domain
  mayBeNan,  ///< range domain, floats only: uint32, all bits set where some point of the box may give NaN
  unknown,   ///< range domain, strings only: uint64, all bits set where the string is not one known one
};

/// One pointer of `AerosolKernelArguments::outputs`, in their order.
struct OutputComponent {
  lang::OutputKind kind{};
  std::uint32_t index = 0;                         ///< As in lang::Output.
  std::uint32_t subIndex = 0;                      ///< As in lang::Output.
  std::uint32_t component = 0;                     ///< Of a triple, matrix or array (element after element).
  lang::BaseType type = lang::BaseType::floating;  ///< floating, integer or string
  OutputPart part = OutputPart::value;

  bool operator==(const OutputComponent&) const = default;
};

/// A parameter that the kernel reads from the instance's block. A block holds every parameter that was not folded,
/// whether this variant reads it or not, so all variants with the same folded parameters share blocks.
struct InstanceField {
  std::uint32_t parameter = 0;  ///< Index into the program's parameters.
  bool isSetFlag = false;       ///< An int32 that is 1 when the instance gives the parameter a value.
  std::uint32_t offset =
      0;  ///< Bytes from the block's start. Components follow one another, 4 bytes (strings: 8) each.
  lang::Type type;

  bool operator==(const InstanceField&) const = default;
};

/// What a record's `kind` and `site` mean.
struct MessageSite {
  std::uint32_t kind = AEROSOL_MESSAGE_PRINT;  ///< AEROSOL_MESSAGE_… or AEROSOL_REPORT_…
  SourceLocation location;
  std::string format;                 ///< Messages: the format string. Index reports: the name of the array.
  std::vector<lang::Type> arguments;  ///< A record's values are their components, one after the other.

  bool operator==(const MessageSite&) const = default;
};

struct KernelInterface {
  Domain domain = Domain::wide;
  int width = 1;
  /// Bit i: pointer i of `AerosolKernelArguments::globals` is read. (Range kernels take two pointers a component, low
  /// then high; bit i stands for pointers 2i and 2i+1.)
  std::uint64_t globalsRead = 0;
  bool readsInstances = false;     ///< `instances` must be given.
  bool readsInstanceData = false;  ///< `instanceData` must be given.
  bool asksHostForSpaces = false;  ///< Calls spaceToWorld or worldToSpace.
  std::uint32_t instanceStride = sizeof(AerosolInstanceHeader);
  std::vector<InstanceField> fields;
  std::vector<OutputComponent> outputs;
  std::vector<MessageSite> sites;
  std::vector<lang::HostSite> hostSites;         ///< Of the calls of host functions.
  bool dependsOnHost = false;                    ///< Some result may depend on what the host knows of a point.
  bool hasDeclaredRanges = false;                ///< Of boxes: bounds rest on what plugins say, not on proofs alone.
  std::map<std::uint64_t, std::string> strings;  ///< Text of every string constant, by hash.
  std::vector<lang::ClosureSite> closureSites;
  /// Instructions that one point runs, estimated from the program text alone. Loops of unknown length count 8 times.
  double staticCost = 0;

  /// Is any component of this global read?
  bool reads(lang::Global global) const;
  /// Do all points of an instance give the same results?
  bool isConstant() const { return globalsRead == 0 && !dependsOnHost; }
};

/// Index of the first pointer of a global in `AerosolKernelArguments::globals`, and how many components it has.
/// (Ci has none.)
int globalPointer(lang::Global global);
int globalComponents(lang::Global global);
inline constexpr int globalPointerCount = 54;
/// Range kernels take two pointers a component, low then high, and after those of the globals three more components: P
/// in the instance's object space, exactly as the kernel's own transform of P rounds it (all floats where the caller
/// knows nothing). Then come, for x, y and z of P, the parts of a line over the box: centre, three slopes, rest. With
/// some coordinates e in [-1, 1] of a point of the box, each component of P is within rest of centre + slope · e; a
/// rest of infinity says nothing.
inline constexpr std::size_t rangeLineStart = 2 * (globalPointerCount + 3);
inline constexpr std::size_t rangeLineParts = 5;
inline constexpr std::size_t rangeInputCount = rangeLineStart + 3 * rangeLineParts;

/// As bytes, for the cache. `deserialise` gives nothing when the bytes are not a whole interface.
std::string serialise(const KernelInterface& interface);
std::optional<KernelInterface> deserialiseInterface(std::string_view bytes);

}  // namespace aerosol::jit
