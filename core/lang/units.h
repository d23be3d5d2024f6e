// The units that transformu converts between.
#pragma once

#include <string_view>

namespace aerosol::lang {

struct Unit {
  std::string_view name;
  double size;  ///< In metres or seconds.
  bool isTime;
};

/// Null when there is none of that name.
const Unit* findUnit(std::string_view name);

/// Factor from one unit of length to another; names of no such unit count as "m".
double unitRatio(std::string_view from, std::string_view to);

}  // namespace aerosol::lang
