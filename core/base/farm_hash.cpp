#include "core/base/farm_hash.h"

#include <bit>
#include <cstring>
#include <utility>

// Each range of lengths has a function of its own; the constants, rotations and their order are the published ones.
namespace aerosol {

namespace {

using Word = std::uint64_t;

constexpr Word k0 = 0xc3a5c85c97cb3127u;
constexpr Word k1 = 0xb492b66fbe98f273u;
constexpr Word k2 = 0x9ae16a3b2f90404fu;
constexpr std::size_t block = 64;

struct Pair {
  Word first = 0, second = 0;
};

Word right(Word x, int bits) { return std::rotr(x, bits); }
Word shifted(Word x) { return x ^ (x >> 47); }

/// Little endian words of a text.
class Bytes {
 public:
  explicit Bytes(std::string_view text) : data_(text.data()), size_(text.size()) {}
  Word at(std::size_t i) const { return read<Word>(i); }
  Word halfAt(std::size_t i) const { return read<std::uint32_t>(i); }
  Word fromEnd(std::size_t i) const { return at(size_ - i); }
  Word byte(std::size_t i) const { return static_cast<unsigned char>(data_[i]); }
  std::size_t size() const { return size_; }
  /// The factor of short texts.
  Word factor() const { return k2 + 2 * size_; }

 private:
  template <class T>
  Word read(std::size_t i) const {
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, data_ + i, sizeof value);
    return value;
  }

  const char* data_;
  std::size_t size_;
};

Word mix(Word u, Word v, Word factor) {
  const Word a = shifted((u ^ v) * factor);
  return shifted((v ^ a) * factor) * factor;
}

Word upTo16(const Bytes& s) {
  const std::size_t n = s.size();
  if (n >= 8) {
    const Word a = s.at(0) + k2, b = s.fromEnd(8), factor = s.factor();
    return mix(right(b, 37) * factor + a, (right(a, 25) + b) * factor, factor);
  }
  if (n >= 4) return mix(n + (s.halfAt(0) << 3), s.halfAt(n - 4), s.factor());
  if (n == 0) return k2;
  const Word y = s.byte(0) + (s.byte(n >> 1) << 8), z = n + (s.byte(n - 1) << 2);
  return shifted(y * k2 ^ z * k0) * k2;
}

/// The two sums of 32 bytes, of which the middle may overlap.
Pair sums(const Bytes& s, std::size_t begin, std::size_t length, Word factor) {
  const Word a = s.at(begin) * k1, b = s.at(begin + 8);
  const Word c = s.at(begin + length - 8) * factor, d = s.at(begin + length - 16) * k2;
  return {right(a + b, 43) + right(c, 30) + d, a + right(b + k2, 18) + c};
}

Word upTo32(const Bytes& s) {
  const Pair sum = sums(s, 0, s.size(), s.factor());
  return mix(sum.first, sum.second, s.factor());
}

Word piece(const Bytes& s, std::size_t begin, Word factor, Pair seeds = {}) {
  const Pair sum = sums(s, begin, 32, factor);
  const Word u = sum.first + seeds.first, v = sum.second + seeds.second;
  return shifted((v ^ shifted((u ^ v) * factor)) * factor);
}

Word upTo64(const Bytes& s) {
  const Word first = k2 - 30, last = first + 2 * s.size();
  return (piece(s, s.size() - 32, last) * last + piece(s, 0, first)) * last;
}

Word upTo96(const Bytes& s) {
  const Word first = k2 - 114, last = first + 2 * s.size();
  const Word a = piece(s, 0, first), b = piece(s, 32, last);
  return (piece(s, s.size() - 32, last, {a, b}) * 9 + (a >> 17) + (b >> 21)) * last;
}

Pair weak(const Bytes& s, std::size_t i, Word a, Word b) {
  const Word z = s.at(i + 24);
  a += s.at(i);
  b = right(b + a + z, 21);
  const Word c = a;
  a += s.at(i + 8) + s.at(i + 16);
  return {a + z, b + right(a, 44) + c};
}

Word upTo256(const Bytes& s) {
  const std::size_t n = s.size(), end = (n - 1) / block * block, rest = (n - 1) % block;
  constexpr Word seed = 81;
  Word x = seed * k2 + s.at(0), y = seed * k1 + 113, z = shifted(y * k2 + 113) * k2;
  Pair v, w;
  const auto turn = [&](std::size_t i, Word factor, Word ofW, Word ofV) {
    x = right(x + y + v.first + s.at(i + 8), 37) * factor;
    y = right(y + v.second + s.at(i + 48), 42) * factor;
    x ^= w.second * ofW;
    y += v.first * ofV + s.at(i + 40);
    z = right(z + w.first, 33) * factor;
    v = weak(s, i, v.second * factor, x + w.first);
    w = weak(s, i + 32, z + w.second, y + s.at(i + 16));
    std::swap(z, x);
  };
  for (std::size_t i = 0; i < end; i += block) turn(i, k1, 1, 1);
  const Word factor = k1 + ((z & 0xff) << 1);
  w.first += rest;
  v.first += w.first;
  w.first += v.first;
  turn(n - block, factor, 9, 9);
  return mix(mix(v.first, w.first, factor) + shifted(y) * k0 + z, mix(v.second, w.second, factor) + x, factor);
}

/// The state of texts above 256 bytes.
struct Long {
  Word u, x, y, z, factor;
  Pair v, w;

  explicit Long(Word seed) : x(seed * k2), y(113), z(shifted(y * k2) * k2), v{seed, 0} {
    u = seed - z;
    factor = k2 + (u & 0x82);
  }

  void take(const Bytes& s, std::size_t i) {
    const Word a0 = s.at(i), a1 = s.at(i + 8), a2 = s.at(i + 16), a3 = s.at(i + 24);
    const Word a4 = s.at(i + 32), a5 = s.at(i + 40), a6 = s.at(i + 48), a7 = s.at(i + 56);
    x = right(x + a0 + a1, 26) * 9;
    y = right(y + a2, 29);
    v = {right(v.first + a4, 33), right(v.second + a5 + a1, 30)};
    w = {((w.first + a6) ^ x) * 9, w.second + a7};
    z = right((z + a3) * factor, 32) + w.second;
    w.second += z;
    z *= 9;
    std::swap(u, y);
    z += a0 + a6;
    v = {v.first + a2, v.second + a3};
    w = {w.first + a4, w.second + a5 + a6};
    x += a1;
    y += a7 + v.first;
    v.first += x - y;
    v.second += w.first;
    w.first += v.second;
    w.second += x - y;
    x += w.second;
    w.second = right(w.second, 34);
    std::swap(u, z);
  }

  Word end(const Bytes& s) {
    const std::size_t i = s.size() - block;
    u *= 9;
    v = {right(v.first, 20), right(v.second, 28)};
    w.first += (s.size() - 1) % block;
    u += y;
    y += u;
    x = right(y - x + v.first + s.at(i + 8), 37) * factor;
    y = right(y ^ v.second ^ s.at(i + 48), 42) * factor;
    x ^= w.second * 9;
    y += v.first + s.at(i + 40);
    z = right(z + w.first, 33) * factor;
    v = weak(s, i, v.second * factor, x + w.first);
    w = weak(s, i + 32, z + w.second, y + s.at(i + 16));
    const Word a = mix(v.first + x, w.first ^ y, factor) + z - u;
    const Word b = turned(v.second + y, w.second + z, 30) ^ x;
    return turned(a, b, 31);
  }

  static Word turned(Word p, Word q, int bits) {
    const Word a = shifted((p ^ q) * k2);
    return right((q ^ a) * k2, bits) * k2;
  }
};

}  // namespace

std::uint64_t farmHash(std::string_view text) {
  const Bytes s(text);
  if (s.size() <= 16) return upTo16(s);
  if (s.size() <= 32) return upTo32(s);
  if (s.size() <= 64) return upTo64(s);
  if (s.size() <= 96) return upTo96(s);
  if (s.size() <= 256) return upTo256(s);
  Long state(81);
  for (std::size_t i = 0; i < (s.size() - 1) / block * block; i += block) state.take(s, i);
  return state.end(s);
}

}  // namespace aerosol
