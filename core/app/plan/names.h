// Objects as a plan names them: with the place in the scene file.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/base/diagnostic.h"

namespace aerosol::app {

inline std::string at(const SourceLocation& place) {
  return place.file.empty() ? std::string() : fmt::format(" ({}:{}:{})", place.file, place.line, place.column);
}

/// "cumulus (a.xml:3:5), wisps (a.xml:9:5), twice, and 3 more". What several objects refer to stands there once.
class Names {
 public:
  void add(const std::string& name, const SourceLocation& place) {
    ++count_;
    std::string text = name + at(place);
    const auto known = std::find_if(names_.begin(), names_.end(), [&](const auto& each) { return each.first == text; });
    if (known != names_.end()) {
      ++known->second;
    } else if (names_.size() < shown) {
      names_.emplace_back(std::move(text), 1);
    } else {
      ++others_;
    }
  }
  std::size_t count() const { return count_; }
  std::string text() const {
    std::string text;
    for (const auto& [name, times] : names_) {
      if (!text.empty()) text += ", ";
      text += name;
      if (times > 1) text += times == 2 ? ", twice" : fmt::format(", {} times", times);
    }
    return others_ == 0 ? text : fmt::format("{} and {} more", text, others_);
  }

 private:
  static constexpr std::size_t shown = 2;
  std::size_t count_ = 0, others_ = 0;
  std::vector<std::pair<std::string, std::size_t>> names_;
};

}  // namespace aerosol::app
