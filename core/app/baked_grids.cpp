#include "core/app/baked_grids.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <filesystem>

namespace aerosol::app {

namespace {

/// Differences that rounding explains.
constexpr float tolerance = 1e-4f;

bool isGray(const float* c) {
  return std::fabs(c[0] - c[1]) <= tolerance * std::fabs(c[0]) && std::fabs(c[0] - c[2]) <= tolerance * std::fabs(c[0]);
}

grid::NewGrid emptyGrid(const char* name, int channels, double voxelSize) {
  grid::NewGrid grid;
  grid.name = name;
  grid.channels = channels;
  for (std::size_t i = 0; i < 3; ++i) grid.indexToFile[5 * i] = voxelSize;
  grid.indexToFile[15] = 1;
  return grid;
}

}  // namespace

BakedKinds findKinds(const std::vector<render::BakedBlock>& blocks) {
  BakedKinds kinds;
  std::array<bool, 3> isKnown{};
  for (const render::BakedBlock& block : blocks) {
    for (std::size_t i = 0; i < block.extinction.size(); ++i) {
      const std::size_t c = i % 3;
      kinds.isChromatic = kinds.isChromatic || (c == 0 && !isGray(&block.extinction[i]));
      kinds.hasEmission = kinds.hasEmission || block.emission[i] != 0;
      if (!(block.extinction[i] > 0)) continue;
      const float albedo = block.scattering[i] / block.extinction[i];
      float& known = kinds.albedo[static_cast<int>(c)];
      if (!isKnown[c]) known = albedo;
      isKnown[c] = true;
      kinds.hasAlbedo = kinds.hasAlbedo || std::fabs(albedo - known) > tolerance;
    }
  }
  return kinds;
}

std::string BakedKinds::description() const {
  return std::string("density") + (hasAlbedo ? ", albedo" : "") + (hasEmission ? ", emission" : "");
}

std::vector<grid::NewGrid> emptyGrids(const BakedKinds& kinds, double voxelSize,
                                      const std::optional<grid::NewFrustum>& frustum) {
  std::vector<grid::NewGrid> grids;
  grids.push_back(emptyGrid("density", kinds.isChromatic ? 3 : 1, voxelSize));
  grids.back().isFog = true;
  if (kinds.hasAlbedo) grids.push_back(emptyGrid("albedo", 3, voxelSize));
  if (kinds.hasEmission) grids.push_back(emptyGrid("emission", 3, voxelSize));
  for (grid::NewGrid& grid : grids) grid.frustum = frustum;
  return grids;
}

std::vector<float> valuesOf(const render::BakedBlock& block, const grid::NewGrid& grid, std::size_t time) {
  constexpr std::size_t numbers = 3 * 512;
  const auto part = [&](const std::vector<float>& all) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(time * numbers);
    return std::vector<float>(begin, begin + static_cast<std::ptrdiff_t>(numbers));
  };
  if (grid.name == "emission") return part(block.emission);
  std::vector<float> extinction = part(block.extinction);
  if (grid.name == "albedo") {
    std::vector<float> albedo = part(block.scattering);
    for (std::size_t i = 0; i < numbers; ++i) albedo[i] = extinction[i] > 0 ? albedo[i] / extinction[i] : 0.0f;
    return albedo;
  }
  if (grid.channels == 3) return extinction;
  std::vector<float> gray;
  for (std::size_t i = 0; i < numbers; i += 3) gray.push_back(extinction[i]);
  return gray;
}

std::string sceneText(const BakedKinds& kinds, const render::BakeCounts& counts, const std::string& file, bool moving) {
  std::string text = fmt::format("<medium type=\"baked\"><string name=\"filename\" value=\"{}\"/>",
                                 std::filesystem::path(file).filename().string());
  if (kinds.isChromatic) text += "<integer name=\"chromatic\" value=\"1\"/>";
  if (kinds.hasAlbedo) {
    text += "<string name=\"albedo_grid\" value=\"albedo\"/>";
  } else {
    text +=
        fmt::format("<rgb name=\"albedo\" value=\"{}, {}, {}\"/>", kinds.albedo[0], kinds.albedo[1], kinds.albedo[2]);
  }
  if (kinds.hasEmission) text += "<string name=\"emission_grid\" value=\"emission\"/>";
  if (moving) text += "<integer name=\"moving\" value=\"1\"/>";
  text += fmt::format("<float name=\"g\" value=\"{}\"/></medium>", counts.anisotropy);
  if (!counts.sameAnisotropy) text += "  (g differs from place to place: this is its mean)";
  return text;
}

std::string frameName(const std::string& pattern, std::size_t number) {
  const std::size_t percent = pattern.find('%');
  if (percent != std::string::npos) {
    std::size_t end = percent + 1;
    while (end < pattern.size() && std::isdigit(static_cast<unsigned char>(pattern[end]))) ++end;
    if (end < pattern.size() && pattern[end] == 'd') {
      const std::string digits = pattern.substr(percent + 1, end - percent - 1);
      const std::size_t width = digits.empty() ? 1 : static_cast<std::size_t>(std::min(std::stoul(digits), 20ul));
      return pattern.substr(0, percent) + fmt::format("{:0{}}", number, width) + pattern.substr(end + 1);
    }
  }
  const std::filesystem::path path(pattern);
  return (path.parent_path() / fmt::format("{}.{:04}{}", path.stem().string(), number, path.extension().string()))
      .string();
}

}  // namespace aerosol::app
