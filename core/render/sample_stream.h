// The random numbers of one path.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/random.h"
#include "core/base/sobol.h"
#include "core/render/scrambles.h"

namespace aerosol::render {

enum class SamplerKind : std::uint8_t {
  independent,  ///< Hashes.
  sobol         ///< Owen-scrambled Sobol' points in the first dimensions, hashes afterwards; see scrambles.h.
};

/// Numbers that depend on (seed, pixel, sample index, position in the stream) alone. Each call of `next1D` or `next2D`
/// takes one slot; samples of one pixel and one scramble are stratified against each other slot by slot. A small value:
/// copy it freely.
class SampleStream {
 public:
  /// Slots from here on are independent: stratification of so high dimensions gains nothing.
  static constexpr std::uint32_t stratifiedSlots = 64;

  SampleStream() = default;
  /// `x` and `y` count pixels of the whole film, also where only a crop is rendered.
  SampleStream(SamplerKind kind, std::uint64_t seed, int x, int y, std::uint32_t sample)
      : key_(pixelKey(seed, x, y)), sample_(sample), kind_(kind) {}

  /// In [0, 1).
  float next1D() {
    const std::uint32_t slot = slot_++;
    if (isStratified(slot)) return unitFloat(scrambledSobol1D(indexInScramble(sample_), patternKey(slot)));
    return unitFloat(randomBits(key_, sample_, slot));
  }
  /// In [0, 1)².
  std::array<float, 2> next2D() {
    const std::uint32_t slot = slot_++;
    if (isStratified(slot)) {
      const std::array<std::uint32_t, 2> point = scrambledSobol2D(indexInScramble(sample_), patternKey(slot));
      return {unitFloat(point[0]), unitFloat(point[1])};
    }
    const std::uint64_t bits = randomBits(key_, sample_, slot);
    return {unitFloat(bits), unitFloat(static_cast<std::uint32_t>(bits))};
  }
  /// In [0, 1): a number of its own that takes no slot. Stratified as they are.
  float time() const {
    constexpr std::uint32_t place = hashStart - 1;
    if (kind_ == SamplerKind::sobol) return unitFloat(scrambledSobol1D(indexInScramble(sample_), patternKey(place)));
    return unitFloat(randomBits(key_, sample_, place));
  }
  /// The same as `next1D`, for what asks for a plain source of numbers.
  float next() { return next1D(); }

  /// 64 bits of a second, unstratified stream with its own counter: it takes no slots.
  std::uint64_t nextHashBits() { return randomBits(key_, sample_, hashStart + hashes_++); }
  /// In [0, 1), from the second stream: for loops of unknown length, such as null collisions.
  float nextHash() { return unitFloat(nextHashBits()); }

  /// A stream of its own for what is drawn beside the path, which changes none of the path's numbers.
  SampleStream branch(std::uint64_t number) const {
    SampleStream other = *this;
    other.key_ = combineHashes(key_, number);
    other.slot_ = other.hashes_ = 0;
    return other;
  }

  /// Goes on with the given slot, so that an event (a bounce, say) has its numbers whatever was drawn before. Going
  /// back repeats numbers.
  void skipTo(std::uint32_t slot) { slot_ = slot; }
  std::uint32_t slot() const { return slot_; }
  std::uint32_t sampleIndex() const { return sample_; }
  /// Of the seed and the pixel.
  std::uint64_t key() const { return key_; }

 private:
  static constexpr std::uint32_t hashStart = 1u << 31;

  bool isStratified(std::uint32_t slot) const { return kind_ == SamplerKind::sobol && slot < stratifiedSlots; }
  std::uint64_t patternKey(std::uint32_t slot) const {
    return combineHashes(key_, ~(std::uint64_t{scrambleOf(sample_)} << 32 | slot));
  }

  std::uint64_t key_ = 0;
  std::uint32_t sample_ = 0;
  std::uint32_t slot_ = 0;
  std::uint32_t hashes_ = 0;
  SamplerKind kind_ = SamplerKind::independent;
};

static_assert(sizeof(SampleStream) <= 32);

/// Which numbers a whole image uses.
struct SamplerSettings {
  SamplerKind kind = SamplerKind::sobol;
  std::uint64_t seed = 0;

  /// The stream of one sample of a pixel; see SampleStream.
  SampleStream stream(int x, int y, std::uint32_t sample) const { return {kind, seed, x, y, sample}; }
};

/// The second stream as a plain source of numbers, for loops of unknown length (null collisions). Each hash gives two.
class HashSource {
 public:
  explicit HashSource(SampleStream& stream) : stream_(&stream) {}
  float next() {
    if (hasSecond_) {
      hasSecond_ = false;
      return unitFloat(second_);
    }
    const std::uint64_t bits = stream_->nextHashBits();
    second_ = static_cast<std::uint32_t>(bits);
    hasSecond_ = true;
    return unitFloat(bits);
  }

 private:
  SampleStream* stream_;
  std::uint32_t second_ = 0;
  bool hasSecond_ = false;
};

}  // namespace aerosol::render
