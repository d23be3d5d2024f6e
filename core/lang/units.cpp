#include "core/lang/units.h"

#include <array>

namespace aerosol::lang {

namespace {

constexpr std::array<Unit, 8> units = {{
    {"mm", 0.001, false},
    {"cm", 0.01, false},
    {"m", 1, false},
    {"km", 1000, false},
    {"in", 0.0254, false},
    {"ft", 0.3048, false},
    {"mi", 1609.344, false},
    {"s", 1, true},
}};

}  // namespace

const Unit* findUnit(std::string_view name) {
  for (const Unit& unit : units)
    if (unit.name == name) return &unit;
  return nullptr;
}

double unitRatio(std::string_view from, std::string_view to) {
  const Unit* const a = findUnit(from);
  const Unit* const b = findUnit(to);
  return (a ? a->size : 1.0) / (b ? b->size : 1.0);
}

}  // namespace aerosol::lang
