#include "core/volume/medium_stack.h"

#include <algorithm>
#include <limits>

namespace aerosol::volume {

namespace {

constexpr std::uint32_t noObject = std::numeric_limits<std::uint32_t>::max();

float iorOf(const Interior* interior) { return interior ? interior->ior : 1.0f; }

}  // namespace

const Medium* mediumOf(const Interior& interior) {
  if (interior.scene) return interior.scene;
  return interior.own ? &*interior.own : nullptr;
}

const MediumStack::Entry* MediumStack::find(std::uint32_t object) const {
  const auto it = std::ranges::find(entries_, object, [](const Entry& entry) { return entry.interior.object; });
  return it == entries_.end() ? nullptr : &*it;
}

const Interior* MediumStack::rulingWithout(std::uint32_t object) const {
  const Interior* best = nullptr;
  for (const Entry& entry : entries_) {
    const Interior& interior = entry.interior;
    if (interior.object == object) continue;
    const bool isBetter =
        !best || !best->priority || (interior.priority && isStronger(*interior.priority, *best->priority));
    if (isBetter && (!best || !best->priority || interior.priority)) best = &interior;
  }
  return best;
}

const Interior* MediumStack::ruling() const { return rulingWithout(noObject); }

const Medium* MediumStack::medium() const {
  const Interior* interior = ruling();
  return interior ? mediumOf(*interior) : nullptr;
}

const Interior* MediumStack::interiorOf(std::uint32_t object) const {
  const Entry* entry = find(object);
  return entry ? &entry->interior : nullptr;
}

float MediumStack::ior() const { return iorOf(ruling()); }

/// Were it entered now.
const Interior* MediumStack::rulingWith(const Interior& entered) const {
  const Interior* const others = ruling();
  if (!others || !others->priority) return &entered;
  return entered.priority && isStronger(*entered.priority, *others->priority) ? &entered : others;
}

Crossing MediumStack::judge(const Interior& interior, bool entering) const {
  const Entry* known = find(interior.object);
  const bool staysInside = known && (entering || known->count > 1);
  const Interior* const here = ruling();
  const Interior* const without = known ? rulingWithout(interior.object) : here;
  // Leaving what was never entered counts as if it had been.
  const Interior* const before = entering || known ? here : rulingWith(interior);
  const Interior* const after = staysInside ? here : entering ? rulingWith(interior) : without;
  Crossing crossing;
  crossing.iorBefore = iorOf(before);
  crossing.iorAfter = iorOf(after);
  crossing.hasIndices = interior.saysIndex || before == after;
  crossing.mediumAfter = after ? mediumOf(*after) : nullptr;
  if (!interior.priority) return crossing;
  const Interior& own = known ? known->interior : interior;
  const bool isHidden = without && without->priority && own.priority && !isStronger(*own.priority, *without->priority);
  crossing.isHit = !isHidden && !staysInside;
  return crossing;
}

void MediumStack::cross(const Interior& interior, bool entering, StackStatistics& statistics) {
  if (!judge(interior, entering).isHit) ++statistics.rejectedHits;
  const auto it =
      std::ranges::find(entries_, interior.object, [](const Entry& entry) { return entry.interior.object; });
  if (entering) {
    if (it == entries_.end()) {
      entries_.push_back({interior, 1});
    } else {
      ++statistics.repeatedEntries;
      ++it->count;
    }
    return;
  }
  if (it == entries_.end()) {
    ++statistics.exitsWithoutEntry;
    return;
  }
  if (--it->count > 0) return;
  // Of merged interiors the first one's medium stays until the last of them is left.
  const auto heir = std::find_if(it + 1, entries_.end(), [&](const Entry& entry) {
    return entry.interior.priority && entry.interior.priority == it->interior.priority;
  });
  if (heir != entries_.end()) {
    Interior merged = std::move(it->interior);
    merged.object = heir->interior.object;
    heir->interior = std::move(merged);
  }
  entries_.erase(it);
}

}  // namespace aerosol::volume
