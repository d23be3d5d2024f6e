// Which surface-defined medium a path is in: a stack of the interiors it has entered, and the rules of priority.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/volume/medium.h"

namespace aerosol::volume {

/// What lies inside a surface, as its material says at a point: exclusive, where additive primitives are not.
struct Interior {
  std::uint32_t object = 0;       ///< The surface; its crossings are counted by it.
  std::optional<int> priority;    ///< None: off. Every crossing of the surface is a hit.
  float ior = 1;                  ///< Index of refraction.
  bool saysIndex = false;         ///< A closure told it; else the surface's own closures say how light is bent.
  const Medium* scene = nullptr;  ///< A medium of the scene; null: `own` if it is set, else empty space.
  std::optional<Medium> own;      ///< A medium that the material's closure describes.
  bool clipsVolumes = false;      ///< Where this interior rules there are no volume primitives either.
};

/// Which of two overlapping media rules (the talk: "higher wins"; others have it the other way round).
enum class PriorityOrder : std::uint8_t { higherWins, lowerWins };

/// Counts of what closed, consistently oriented surfaces never do.
struct StackStatistics {
  std::uint64_t exitsWithoutEntry = 0;
  std::uint64_t repeatedEntries = 0;
  std::uint64_t rejectedHits = 0;     ///< Crossings that a medium of higher or equal priority hides.
  std::uint64_t coincidentFaces = 0;  ///< Faces crossed together with another one in the same place.

  StackStatistics& operator+=(const StackStatistics& other) {
    exitsWithoutEntry += other.exitsWithoutEntry;
    repeatedEntries += other.repeatedEntries;
    rejectedHits += other.rejectedHits;
    coincidentFaces += other.coincidentFaces;
    return *this;
  }
};

/// What a crossing means.
struct Crossing {
  bool isHit = true;  ///< False: the surface is inside something stronger; the ray goes on as if it were not there.
  float iorBefore = 1, iorAfter = 1;
  bool hasIndices = true;               ///< These count; false: the surface's closures have their own.
  const Medium* mediumAfter = nullptr;  ///< Behind it; null in empty space. In the stack, or in the interior judged.
};

/// The interiors around a point of a path. After Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced
/// Images", with these rules for what that paper leaves open:
/// - the interior of the highest priority rules; of equal ones the one entered first, until its last exit, so that
///   equal priorities merge into one interior without a surface between them;
/// - a surface without priority is always hit; it supplies medium and index where no prioritised interior is active,
///   the one entered last if there are several. Where another one stays in force on both sides it bends nothing.
///   (What is inside of two of them depends on the way there, so light may be caught between three for ever;
///   priorities say what is where);
/// - entering what one is inside of already counts up, and as many exits lead out;
/// - leaving what was never entered changes nothing; the crossing is judged as if it had been entered.
class MediumStack {
 public:
  explicit MediumStack(PriorityOrder order = PriorityOrder::higherWins) : order_(order) {}

  void clear() { entries_.clear(); }
  bool empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }

  /// What would crossing this surface mean? `interior` is what its material says there.
  Crossing judge(const Interior& interior, bool entering) const;
  /// Crosses it.
  void cross(const Interior& interior, bool entering, StackStatistics& statistics);

  /// The interior that rules here; null outside of all.
  const Interior* ruling() const;
  /// Its medium; null in empty space.
  const Medium* medium() const;
  float ior() const;
  /// Whether there are no volume primitives here.
  bool clipsVolumes() const {
    const Interior* interior = ruling();
    return interior && interior->clipsVolumes;
  }
  /// The interior of a surface that was entered; null when it was not.
  const Interior* interiorOf(std::uint32_t object) const;

 private:
  struct Entry {
    Interior interior;
    std::uint32_t count = 1;
  };

  bool isStronger(int a, int b) const { return order_ == PriorityOrder::higherWins ? a > b : a < b; }
  const Interior* rulingWithout(std::uint32_t object) const;
  const Interior* rulingWith(const Interior& entered) const;
  const Entry* find(std::uint32_t object) const;

  PriorityOrder order_;
  std::vector<Entry> entries_;  ///< In the order of entering.
};

/// The medium of an interior; null when empty.
const Medium* mediumOf(const Interior& interior);

}  // namespace aerosol::volume
