#include "core/render/volume_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace aerosol::render {

void VolumeLook::apply(volume::Coefficients& c) const {
  const float d = maximum(c.sigmaT);
  const float factor = factorAt(d);
  Color scattered = color * factor;
  if (!colorRamp.empty()) scattered *= colorRamp.at(d);
  c.sigmaT = c.sigmaT * factor;
  if (scattersAll) {
    c.sigmaS = c.sigmaT;
    c.lobes[0] = {c.sigmaS, 0};
    c.lobeCount = 1;
    c.emission = Color();
    return;
  }
  c.sigmaS *= scattered;
  for (std::uint32_t i = 0; i < c.lobeCount; ++i) c.lobes[i].sigmaS *= scattered;
  c.emission = c.emission * emission;
}

float VolumeLook::factorAt(float extinction) const {
  return densityRamp.empty() ? density : density * densityRamp.at(extinction);
}

float VolumeLook::largestFactor() const {
  float largest = densityRamp.empty() ? 1.0f : 0.0f;
  for (const auto& key : densityRamp.keys()) largest = std::max(largest, key.value);
  return density * largest;
}

void VolumeLook::apply(volume::BoxKnowledge& k) const {
  volume::BoundRanges& r = k.ranges;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  float least = factorAt(r.extinctionLow), most = least;
  const auto include = [&](float factor) {
    least = std::min(least, factor);
    most = std::max(most, factor);
  };
  if (!densityRamp.empty()) {
    include(factorAt(r.extinctionHigh));
    for (const auto& key : densityRamp.keys()) {
      if (key.place > r.extinctionLow && key.place < r.extinctionHigh) include(density * key.value);
    }
  }
  const auto scaled = [](float value, float factor, float outwards) {
    const float product = value == 0 || factor == 0 ? 0 : value * factor;
    return product == 0 ? 0 : std::nextafter(product, outwards);
  };
  // The steps in float may end a few roundings above.
  const float up = 1 + 0x1p-20f;
  r.extinctionLow = scaled(r.extinctionLow, least / up, 0);
  r.extinctionHigh = scaled(r.extinctionHigh, most * up, infinity);
  r.scatteringHigh = scaled(r.scatteringHigh, most * up, infinity);
  r.emissionLow = scaled(r.emissionLow, emission, -infinity);
  r.emissionHigh = scaled(r.emissionHigh, emission, infinity);
  if (!scattersAll) return;
  r.scatteringHigh = r.extinctionHigh;
  r.emissionLow = r.emissionHigh = 0;
}

namespace {

/// The numbers of a text, separated by blanks or commas; false when there is something else.
bool readNumbers(std::string_view text, std::vector<float>& numbers) {
  while (true) {
    const std::size_t begin = text.find_first_not_of(" \t\n\r,");
    if (begin == std::string_view::npos) return true;
    text.remove_prefix(begin);
    float value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || !std::isfinite(value)) return false;
    numbers.push_back(value);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (!text.empty() && std::string_view(" \t\n\r,").find(text.front()) == std::string_view::npos) return false;
  }
}

/// "place: value; place: value …" with `components` numbers a value.
std::optional<std::vector<std::vector<float>>> readKeys(std::string_view text, std::size_t components) {
  std::vector<std::vector<float>> keys;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(';'), text.size());
    const std::string_view key = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t colon = key.find(':');
    std::vector<float> place, value;
    if (colon == std::string_view::npos || !readNumbers(key.substr(0, colon), place) ||
        !readNumbers(key.substr(colon + 1), value)) {
      return {};
    }
    if (value.size() == 1) value.resize(components, value[0]);
    if (place.size() != 1 || value.size() != components) return {};
    if (!keys.empty() && !(place[0] > keys.back()[0])) return {};
    if (std::ranges::any_of(value, [](float v) { return v < 0; })) return {};
    value.insert(value.begin(), place[0]);
    keys.push_back(std::move(value));
  }
  return keys;
}

Diagnostic rampError(const scene::Volume& volume, const char* name, const char* example) {
  return {Severity::error,
          volume.origin.of(name),
          fmt::format("'{}' is no ramp", name),
          {},
          {fmt::format("write ascending places with values that are not negative, such as \"{}\"", example)}};
}

}  // namespace

Result<std::optional<VolumeLook>> lookOf(const scene::Volume& volume) {
  const scene::VolumeControls& controls = volume.controls;
  VolumeLook look{.density = controls.density, .color = controls.color, .emission = controls.emission};
  const auto densities = readKeys(controls.densityRamp, 1), colors = readKeys(controls.colorRamp, 3);
  if (!densities) return rampError(volume, "density_ramp", "0: 0; 2: 0.5; 10: 1");
  if (!colors) return rampError(volume, "color_ramp", "0: 1 0.9 0.8; 10: 0.4 0.3 0.2");
  std::vector<Ramp<float>::Key> densityKeys;
  for (const auto& key : *densities) densityKeys.push_back({key[0], key[1]});
  std::vector<Ramp<Color>::Key> colorKeys;
  for (const auto& key : *colors) colorKeys.push_back({key[0], Color(key[1], key[2], key[3])});
  look.densityRamp = Ramp<float>(std::move(densityKeys));
  look.colorRamp = Ramp<Color>(std::move(colorKeys));
  const bool changes = look.density != 1 || !(look.color == Color(1.0f)) || look.emission != 1 ||
                       !look.densityRamp.empty() || !look.colorRamp.empty();
  if (!changes) return std::optional<VolumeLook>();
  return std::optional(std::move(look));
}

}  // namespace aerosol::render
