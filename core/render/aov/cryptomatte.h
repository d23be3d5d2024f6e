// Cryptomatte: which things a pixel shows, and how much of it each covers.
//
// Friedman and Jones 2015, "Fully automatic ID mattes with support for motion blur and transparency", in the layout of
// the public specification 1.2: a thing's id is the MurmurHash3 of its name, changed so that its bits are a float that
// every program keeps; a layer holds pairs of id and coverage, the largest first.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aerosol::render {

/// Appleby's MurmurHash3_x86_32.
std::uint32_t murmurHash3(std::string_view bytes, std::uint32_t seed = 0);

/// The id of a name: its hash without the exponents of denormal numbers, infinities and NaN.
std::uint32_t matteId(std::string_view name);

/// A part of a pixel that one thing covers.
struct MatteShare {
  std::uint32_t id = 0;
  double weight = 0;

  friend bool operator==(const MatteShare&, const MatteShare&) = default;
};
/// Ascending by id, each once.
using MatteShares = std::vector<MatteShare>;

void addMatteShare(MatteShares& shares, const MatteShare& added);
MatteShares operator+(const MatteShares& a, const MatteShares& b);

template <class A>
void describe(A& archive, MatteShare& share) {
  archive(share.id, share.weight);
}

/// The names of things in a scene, for a file's manifest.
struct MatteName {
  std::string name;
  std::uint32_t id = 0;

  friend bool operator==(const MatteName&, const MatteName&) = default;
};
template <class A>
void describe(A& archive, MatteName& name) {
  archive(name.name, name.id);
}

/// What stands in a file besides the channels.
struct MatteMetadata {
  std::string key, value;
};
/// `layer` is the name before the numbers of its parts.
std::vector<MatteMetadata> matteMetadata(const std::string& layer, std::span<const MatteName> names);

}  // namespace aerosol::render
