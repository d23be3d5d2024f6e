// Objects as a plan names them: with the place in the scene file.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>

#include "core/base/diagnostic.h"

namespace aerosol::app {

inline std::string at(const SourceLocation& place) {
  return place.file.empty() ? std::string() : fmt::format(" ({}:{}:{})", place.file, place.line, place.column);
}

/// "cumulus (a.xml:3:5), wisps (a.xml:9:5) and 3 more".
class Names {
 public:
  void add(const std::string& name, const SourceLocation& place) {
    if (++count_ <= shown) text_ += fmt::format("{}{}{}", count_ == 1 ? "" : ", ", name, at(place));
  }
  std::size_t count() const { return count_; }
  std::string text() const { return count_ > shown ? fmt::format("{} and {} more", text_, count_ - shown) : text_; }

 private:
  static constexpr std::size_t shown = 2;
  std::size_t count_ = 0;
  std::string text_;
};

}  // namespace aerosol::app
