// Random numbers as a function of what they are for: no state, so no order of execution can change them.
#pragma once

#include <bit>
#include <cstdint>

namespace aerosol {

/// A bijection of 64 bits in which every input bit flips every output bit with probability 1/2: the finaliser of
/// SplitMix64 (Steele, Lea, Flood 2014, with the constants of Stafford's variant 13).
constexpr std::uint64_t mixBits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// The hash of a sequence that began with what `hash` stands for and goes on with `value`. Not commutative.
constexpr std::uint64_t combineHashes(std::uint64_t hash, std::uint64_t value) {
  return mixBits(std::rotl(hash, 25) * 0x9fb21c651e98df25u + mixBits(value + 0x9e3779b97f4a7c15u));
}

/// The upper 24 bits as a number in [0, 1).
constexpr float unitFloat(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }
constexpr float unitFloat(std::uint64_t bits) { return static_cast<float>(bits >> 40) * 0x1p-24f; }

/// The key of all random numbers of one pixel, `x` and `y` counted on the whole film (not in the crop).
constexpr std::uint64_t pixelKey(std::uint64_t seed, int x, int y) {
  const auto place = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32) | static_cast<std::uint32_t>(x);
  return combineHashes(mixBits(seed + 0x2545f4914f6cdd1du), place);
}

/// 64 random bits for one dimension of one sample of a pixel.
constexpr std::uint64_t randomBits(std::uint64_t key, std::uint32_t sample, std::uint32_t dimension) {
  return combineHashes(key, (static_cast<std::uint64_t>(sample) << 32) | dimension);
}

/// A number in [0, 1) with 24 random bits.
constexpr float randomFloat(std::uint64_t key, std::uint32_t sample, std::uint32_t dimension) {
  return unitFloat(randomBits(key, sample, dimension));
}

}  // namespace aerosol
