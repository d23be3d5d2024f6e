// Closures below others: every site that a layering may put below something becomes a site of its own.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/lang/lower.h"

namespace aerosol::lang {

using Sites = std::set<std::uint32_t>;

class Layerings {
 public:
  Layerings(Program& program, const ReportAt& report) : program_(program), report_(report) {}

  /// What `site` is below the tops of a layering: made at the first call. Nothing when that goes on without end (a
  /// layering whose base is its own result, in a loop), which is reported.
  std::optional<std::uint32_t> below(std::uint32_t site, std::uint32_t layering, std::uint32_t location);
  /// What a site below others is of, and its layering.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> origin(std::uint32_t site) const {
    const auto known = origins_.find(site);
    return known == origins_.end() ? std::nullopt : std::optional(known->second);
  }
  /// Once the tops of each layering are known: gives the sites below them their layers and parameters.
  void finish(const std::map<std::uint32_t, Sites>& tops);

 private:
  Program& program_;
  const ReportAt& report_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known_;    ///< By site and layering.
  std::map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> origins_;  ///< The other way round.
  bool failed_ = false;
};

}  // namespace aerosol::lang
