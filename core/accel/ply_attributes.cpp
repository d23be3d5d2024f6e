#include "core/accel/ply_attributes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace aerosol::accel {

namespace {

constexpr std::array<std::string_view, 4> endings = {"xyzw", "rgba", "0123", "1234"};

struct Ending {
  std::string_view stem;
  std::size_t scheme = 0, place = 0;
};

std::vector<Ending> endingsOf(std::string_view name) {
  std::vector<Ending> found;
  if (name.size() < 3 || name[name.size() - 2] != '_') return found;
  for (std::size_t scheme = 0; scheme < endings.size(); ++scheme) {
    const std::size_t place = endings[scheme].find(name.back());
    if (place != std::string_view::npos) found.push_back({name.substr(0, name.size() - 2), scheme, place});
  }
  return found;
}

/// How many properties from `first` on are consecutive channels of one attribute.
std::size_t runLength(const PlyElement& element, std::size_t first, const std::vector<bool>& isTaken, Ending& chosen) {
  std::size_t longest = 1;
  for (const Ending& start : endingsOf(element.properties[first].name)) {
    if (start.place != 0) continue;
    std::size_t length = 1;
    while (length < 4 && first + length < element.properties.size() && !isTaken[first + length]) {
      const std::vector<Ending> next = endingsOf(element.properties[first + length].name);
      const bool goesOn = std::ranges::any_of(
          next, [&](const Ending& e) { return e.stem == start.stem && e.scheme == start.scheme && e.place == length; });
      if (!goesOn) break;
      ++length;
    }
    if (length > longest) {
      longest = length;
      chosen = start;
    }
  }
  return longest;
}

std::string prefixed(std::string_view prefix, std::string_view name) {
  return name.starts_with(prefix) ? std::string(name) : std::string(prefix) + std::string(name);
}

/// The properties of a colour without a name.
std::optional<PlyAttribute> plainColor(const PlyElement& element, std::string_view prefix,
                                       const std::vector<bool>& isTaken) {
  for (const auto& names : {std::array{"red", "green", "blue", "alpha"}, std::array{"r", "g", "b", "a"}}) {
    PlyAttribute color{prefixed(prefix, "color"), {}, true};
    for (const std::string_view name : names) {
      const auto found = std::ranges::find(element.properties, name, &PlyProperty::name);
      const auto index = static_cast<std::size_t>(found - element.properties.begin());
      if (found == element.properties.end() || isTaken[index]) break;
      color.properties.push_back(index);
    }
    if (color.properties.size() >= 3) return color;
  }
  return {};
}

double largestOf(PlyType type) {
  constexpr double sizes[] = {0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF};
  return sizes[static_cast<std::size_t>(type)];
}

double fromSrgb(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }

}  // namespace

std::vector<PlyAttribute> groupPlyAttributes(const PlyElement& element, std::string_view prefix,
                                             const std::vector<bool>& isTaken) {
  std::vector<bool> isUsed = isTaken;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    if (element.properties[i].countType) isUsed[i] = true;
  }
  std::vector<PlyAttribute> attributes;
  if (auto color = plainColor(element, prefix, isUsed)) {
    for (const std::size_t i : color->properties) isUsed[i] = true;
    attributes.push_back(std::move(*color));
  }
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    if (isUsed[i]) continue;
    Ending ending;
    const std::size_t length = runLength(element, i, isUsed, ending);
    const std::string_view name = length > 1 ? ending.stem : std::string_view(element.properties[i].name);
    PlyAttribute attribute{prefixed(prefix, name), {}, length > 2 && endings[ending.scheme] == "rgba"};
    for (std::size_t k = 0; k < length; ++k) {
      attribute.properties.push_back(i + k);
      isUsed[i + k] = true;
    }
    attributes.push_back(std::move(attribute));
  }
  return attributes;
}

PlyAttributeReader::PlyAttributeReader(const PlyElement& element, std::string_view prefix,
                                       const std::vector<bool>& isTaken)
    : channels_(element.properties.size(), -1) {
  for (const PlyAttribute& group : groupPlyAttributes(element, prefix, isTaken)) {
    attributes_.push_back({group.name, static_cast<int>(group.properties.size()), prefix == "face_", {}});
    for (std::size_t k = 0; k < group.properties.size(); ++k) {
      const PlyProperty& property = element.properties[group.properties[k]];
      channels_[group.properties[k]] = static_cast<int>(decoding_.size());
      const bool isScaled = group.isColor && isInteger(property.type);
      decoding_.push_back({isScaled ? 1 / largestOf(property.type) : 1, isScaled && k < 3});
    }
  }
  record_.resize(decoding_.size());
}

void PlyAttributeReader::set(std::size_t property, double value) {
  const auto channel = static_cast<std::size_t>(channels_[property]);
  const double scaled = value * decoding_[channel].scale;
  record_[channel] = static_cast<float>(decoding_[channel].isEncoded ? fromSrgb(scaled) : scaled);
}

void PlyAttributeReader::append(std::size_t copies) {
  const float* from = record_.data();
  for (MeshAttribute& attribute : attributes_) {
    for (std::size_t i = 0; i < copies; ++i) {
      attribute.values.insert(attribute.values.end(), from, from + attribute.channels);
    }
    from += attribute.channels;
  }
}

}  // namespace aerosol::accel
