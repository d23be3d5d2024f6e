// What closures are made of once they are taken apart.
#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

#include "core/lang/code_writer.h"
#include "core/lang/lower.h"

namespace aerosol::lang {

/// What a closure variable holds of one site.
struct SiteValue {
  std::vector<VariableId> linear;  ///< Colours that grow with the weight. The last one measures it in means.
  std::vector<VariableId> mean;    ///< Averaged with the measures when two are added.
};

using SiteValues = std::map<std::uint32_t, SiteValue>;  ///< By site.

/// Kinds of closures of volumes; the others absorb.
bool isScattering(std::string_view closure);
bool isEmitting(std::string_view closure);

/// Computes the outputs of a shader whose Ci holds `result`.
void addClosureOutputs(CodeWriter& writer, const SiteValues& result, const ReportAt& report);

}  // namespace aerosol::lang
