#include "core/render/aov/cryptomatte.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace aerosol::render {

std::uint32_t murmurHash3(std::string_view bytes, std::uint32_t seed) {
  const auto mixed = [](std::uint32_t k) { return std::rotl(k * 0xcc9e2d51u, 15) * 0x1b873593u; };
  const auto byteAt = [&](std::size_t i) { return std::uint32_t{static_cast<unsigned char>(bytes[i])}; };
  std::uint32_t hash = seed;
  const std::size_t whole = bytes.size() / 4 * 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    hash ^= mixed(byteAt(i) | byteAt(i + 1) << 8 | byteAt(i + 2) << 16 | byteAt(i + 3) << 24);
    hash = std::rotl(hash, 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t rest = 0;
  for (std::size_t i = bytes.size(); i-- > whole;) rest = rest << 8 | byteAt(i);
  if (whole < bytes.size()) hash ^= mixed(rest);
  hash ^= static_cast<std::uint32_t>(bytes.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

std::uint32_t matteId(std::string_view name) {
  const std::uint32_t hash = murmurHash3(name), exponent = hash >> 23 & 255u;
  return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

void addMatteShare(MatteShares& shares, const MatteShare& added) {
  const auto at = std::lower_bound(shares.begin(), shares.end(), added.id,
                                   [](const MatteShare& share, std::uint32_t id) { return share.id < id; });
  if (at != shares.end() && at->id == added.id) {
    at->weight += added.weight;
  } else {
    shares.insert(at, added);
  }
}

MatteShares operator+(const MatteShares& a, const MatteShares& b) {
  MatteShares sum = a;
  for (const MatteShare& share : b) addMatteShare(sum, share);
  return sum;
}

namespace {

std::string quoted(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20) {
      json += fmt::format("\\u{:04x}", static_cast<int>(c));
    } else {
      if (c == '"' || c == '\\') json += '\\';
      json += c;
    }
  }
  return json + "\"";
}

}  // namespace

std::vector<MatteMetadata> matteMetadata(const std::string& layer, std::span<const MatteName> names) {
  const std::string prefix = fmt::format("cryptomatte/{}/", fmt::format("{:08x}", murmurHash3(layer)).substr(0, 7));
  std::string manifest;
  for (const MatteName& name : names)
    manifest += fmt::format("{}{}:\"{:08x}\"", manifest.empty() ? "" : ",", quoted(name.name), name.id);
  return {{prefix + "name", layer},
          {prefix + "hash", "MurmurHash3_32"},
          {prefix + "conversion", "uint32_to_float32"},
          {prefix + "manifest", "{" + manifest + "}"}};
}

}  // namespace aerosol::render
