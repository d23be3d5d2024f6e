// Shader groups as text: `param type name values… ;`, `shader name layer ;`, `connect layer.output layer.input ;`.
#pragma once

#include <string>
#include <vector>

#include "core/app/tools/shade_arguments.h"
#include "core/base/result.h"

namespace aerosol::app {

struct GroupText {
  std::vector<ShadeLayer> layers;
  std::vector<ShadeConnection> connections;
};

/// Errors name line and column of `text` under the name of `file`.
Result<GroupText> parseGroupText(const std::string& text, const std::string& file);

/// The same as text; parses to what it was made of.
std::string printGroupText(const std::vector<ShadeLayer>& layers, const std::vector<ShadeConnection>& connections);

}  // namespace aerosol::app
