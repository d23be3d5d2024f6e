#include "core/app/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>

#include "core/scene/value.h"

namespace aerosol::app {

namespace {

constexpr std::size_t maximumFrames = 1000000;

/// A whole number at the front of the text, which it is taken from.
std::optional<int> takeNumber(std::string_view& text) {
  std::size_t length = !text.empty() && text[0] == '-' ? 1 : 0;
  while (length < text.size() && text[length] >= '0' && text[length] <= '9') ++length;
  scene::TextError error;
  const auto number = scene::parseInteger(text.substr(0, length), error);
  text.remove_prefix(length);
  return number;
}

bool takeCharacter(std::string_view& text, char character) {
  if (text.empty() || text[0] != character) return false;
  text.remove_prefix(1);
  return true;
}

struct FramePlace {
  std::size_t begin = 0, end = 0;
  std::size_t digits = 0;
};

std::optional<FramePlace> findPlace(const std::string& name) {
  for (std::size_t begin = name.find('%'); begin != std::string::npos; begin = name.find('%', begin + 1)) {
    FramePlace place{begin, begin + 1, 0};
    while (place.end < name.size() && name[place.end] >= '0' && name[place.end] <= '9') {
      place.digits = std::min<std::size_t>(10 * place.digits + static_cast<std::size_t>(name[place.end] - '0'), 99);
      ++place.end;
    }
    if (place.end < name.size() && name[place.end] == 'd') {
      ++place.end;
      return place;
    }
  }
  return {};
}

}  // namespace

std::optional<std::vector<int>> parseFrames(std::string_view text) {
  std::vector<int> frames;
  std::set<int> seen;
  do {
    const auto first = takeNumber(text);
    if (!first) return {};
    std::int64_t last = *first, step = 1;
    if (takeCharacter(text, '-')) {
      const auto end = takeNumber(text);
      if (!end || *end < *first) return {};
      last = *end;
      if (takeCharacter(text, 'x')) {
        const auto every = takeNumber(text);
        if (!every || *every < 1) return {};
        step = *every;
      }
    }
    for (std::int64_t frame = *first; frame <= last; frame += step) {
      if (!seen.insert(static_cast<int>(frame)).second) continue;
      if (frames.size() == maximumFrames) return {};
      frames.push_back(static_cast<int>(frame));
    }
  } while (takeCharacter(text, ','));
  if (!text.empty()) return {};
  return frames;
}

bool hasFramePlace(const std::string& name) { return findPlace(name).has_value(); }

std::string nameOfFrame(const std::string& name, int frame) {
  const auto place = findPlace(name);
  if (!place) return name;
  return name.substr(0, place->begin) + fmt::format("{:0{}}", frame, place->digits) + name.substr(place->end);
}

}  // namespace aerosol::app
