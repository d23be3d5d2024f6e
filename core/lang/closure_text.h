// Closures as printf and format show them: what is added, one a line, and layers in layers.
#pragma once

#include "core/lang/closure_values.h"
#include "core/lang/expand_layers.h"

namespace aerosol::lang {

class ClosureText {
 public:
  /// `tops`: what may lie on top in each layering.
  ClosureText(CodeWriter& writer, const Layerings& layerings, const std::map<std::uint32_t, Sites>& tops)
      : writer_(writer), layerings_(layerings), tops_(tops) {}

  /// Computes the text of a closure value.
  VariableId of(SiteValues values);

 private:
  VariableId plain(VariableId text, std::uint32_t site, const SiteValue& value);
  VariableId layered(VariableId text, std::uint32_t layering, SiteValues& values);
  std::optional<std::uint32_t> outermost(const SiteValues& values) const;
  VariableId weightOf(const SiteValue& top, VariableId weightInLayer);
  VariableId added(std::vector<VariableId> arguments);
  std::uint32_t function();

  CodeWriter& writer_;
  const Layerings& layerings_;
  const std::map<std::uint32_t, Sites>& tops_;
};

}  // namespace aerosol::lang
