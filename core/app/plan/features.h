// What the renderer can do, row by row, and the effects of the plan that belong to each.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace aerosol::app {

struct Feature {
  std::string_view row;   ///< "S5".
  std::string_view name;  ///< For people.
};
std::span<const Feature> features();

/// The rows that an effect belongs to, such as "S3 S4"; empty for what is no effect.
std::string_view rowsOfEffect(std::string_view effect);

/// The table of all rows with their effects, and of all effects with what leaving them out means: `aerosol help
/// effects`.
std::string effectsPage();

}  // namespace aerosol::app
