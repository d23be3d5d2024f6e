// Simplex noise (Perlin 2001, after Gustavson's formulation) in one to four dimensions with the hash, gradients and
// scales of Open Shading Language. The value is a sum over the corners of the simplex around the point of (r^2 - d^2)^4
// times gradient · offset. The tables of gradients are pairs of bits in constants, the order of the corners comes from
// ranks of the coordinates: there are no look-ups and no branches.
#pragma once

#include "core/jit/runtime/hash.h"
#include "core/jit/runtime/triple.h"

namespace aerosol::jit::runtime {

namespace detail {

template <UintLanes U>
AEROSOL_INLINE U scramble(U a, U b, U c) {
  return hashFinal(a, b, c ^ U(0xdeadbeefu));
}

/// Entry h of a table of 16 numbers -1, 0 or 1 in pairs of bits, the first one lowest.
template <UintLanes U>
AEROSOL_INLINE FloatOf<U> tableEntry(U table, U h) {
  return toFloat(asInt(table << (U(30u) - (h + h))) >> IntOf<U>(30));
}

/// A table for `tableEntry`.
constexpr std::uint32_t packTable(const int (&entries)[16]) {
  std::uint32_t table = 0;
  for (int i = 0; i < 16; ++i) table |= (static_cast<std::uint32_t>(entries[i]) & 3u) << (2 * i);
  return table;
}

inline constexpr std::uint32_t gradient2X = packTable({-1, 1, -1, 1, -1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0});
inline constexpr std::uint32_t gradient2Y = packTable({-1, 0, 0, 1, 1, -1, 1, -1, 0, 0, 0, 0, 0, 0, 0, 0});
inline constexpr std::uint32_t gradient3X = packTable({1, 0, -1, 0, 1, 0, -1, 0, 1, 1, -1, -1, 1, -1, 0, 0});
inline constexpr std::uint32_t gradient3Y = packTable({0, 1, 0, -1, 0, 1, 0, -1, -1, 1, 1, -1, 0, 0, 1, -1});
inline constexpr std::uint32_t gradient3Z = packTable({1, 1, 1, 1, -1, -1, -1, -1, 0, 0, 0, 0, 1, 1, -1, -1});
inline constexpr std::uint32_t gradient4[4][2] = {{packTable({0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, -1, -1, -1, -1}),
                                                   packTable({1, 1, 1, 1, -1, -1, -1, -1, 1, 1, 1, 1, -1, -1, -1, -1})},
                                                  {packTable({1, 1, 1, 1, -1, -1, -1, -1, 0, 0, 0, 0, 0, 0, 0, 0}),
                                                   packTable({1, 1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1})},
                                                  {packTable({1, 1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1}),
                                                   packTable({0, 0, 0, 0, 0, 0, 0, 0, 1, -1, 1, -1, 1, -1, 1, -1})},
                                                  {packTable({1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1}),
                                                   packTable({1, -1, 1, -1, 1, -1, 1, -1, 0, 0, 0, 0, 0, 0, 0, 0})}};

/// t^4, 0 for negative t.
template <FloatLanes F>
AEROSOL_INLINE F cornerWeight(F t) {
  const F inside = select(greaterEqual(t, F(0.0f)), t, F(0.0f));
  const F square = inside * inside;
  return square * square;
}

template <FloatLanes F>
AEROSOL_INLINE IntOf<F> cellOf(F x) {
  return toIntUnchecked(max(min(floor(x), F(2147483520.0f)), F(-2147483648.0f)));
}

/// A mask as 1 or 0.
template <IntLanes I>
AEROSOL_INLINE I asOne(I mask) {
  return mask & I(1);
}

template <FloatLanes F>
AEROSOL_INLINE F simplexCorner(IntOf<F> cell, F x, std::uint32_t seed) {
  using U = UintOf<F>;
  const U h = scramble(asUint(cell), U(seed), U(0u));
  const F magnitude = toFloat(asInt((h & U(7u)) + U(1u)));
  const F g = asFloat(asUint(magnitude) ^ ((h & U(8u)) << U(28u)));
  return cornerWeight(F(1.0f) - x * x) * g * x;
}

template <FloatLanes F>
AEROSOL_INLINE F simplexCorner(IntOf<F> i, IntOf<F> j, F x, F y, std::uint32_t seed) {
  using U = UintOf<F>;
  const U h = scramble(asUint(i), asUint(j), U(seed)) & U(7u);
  const F dot = tableEntry(U(gradient2X), h) * x + tableEntry(U(gradient2Y), h) * y;
  return cornerWeight(F(0.5f) - x * x - y * y) * dot;
}

template <FloatLanes F>
AEROSOL_INLINE F simplexCorner(IntOf<F> i, IntOf<F> j, IntOf<F> k, Triple<F> p, std::uint32_t seed) {
  using U = UintOf<F>;
  const U h = scramble(asUint(i), asUint(j), scramble(asUint(k), U(seed), U(0u))) & U(15u);
  const F dot =
      tableEntry(U(gradient3X), h) * p.x + tableEntry(U(gradient3Y), h) * p.y + tableEntry(U(gradient3Z), h) * p.z;
  return cornerWeight(F(0.5f) - p.x * p.x - p.y * p.y - p.z * p.z) * dot;
}

template <FloatLanes F>
AEROSOL_INLINE F simplexCorner(IntOf<F> i, IntOf<F> j, IntOf<F> k, IntOf<F> l, Triple<F> p, F w, std::uint32_t seed) {
  using U = UintOf<F>;
  const U h = scramble(asUint(i), asUint(j), scramble(asUint(k), asUint(l), U(seed)));
  const auto low = equal(h & U(16u), U(0u));
  const auto entry = [&](int axis) __attribute__((always_inline)) {
    return tableEntry(select(low, U(gradient4[axis][0]), U(gradient4[axis][1])), h & U(15u));
  };
  const F dot = entry(0) * p.x + entry(1) * p.y + entry(2) * p.z + entry(3) * w;
  return cornerWeight(F(0.5f) - p.x * p.x - p.y * p.y - p.z * p.z - w * w) * dot;
}

}  // namespace detail

template <FloatLanes F>
AEROSOL_INLINE F simplexNoise(std::uint32_t seed, F x) {
  using I = IntOf<F>;
  const I i = detail::cellOf(x);
  const F x0 = x - toFloat(i);
  const F n0 = detail::simplexCorner(i, x0, seed);
  const F n1 = detail::simplexCorner(wrapAdd(i, I(1)), x0 - F(1.0f), seed);
  return F(0.36f) * (n0 + n1);
}

template <FloatLanes F>
AEROSOL_INLINE F simplexNoise(std::uint32_t seed, F x, F y) {
  using I = IntOf<F>;
  constexpr float skew = 0.366025403f;    // (sqrt(3) - 1) / 2
  constexpr float unskew = 0.211324865f;  // (3 - sqrt(3)) / 6
  const F s = (x + y) * F(skew);
  const I i = detail::cellOf(x + s);
  const I j = detail::cellOf(y + s);
  const F t = toFloat(wrapAdd(i, j)) * F(unskew);
  const F x0 = x - (toFloat(i) - t);
  const F y0 = y - (toFloat(j) - t);
  const I i1 = detail::asOne(greater(x0, y0));
  const I j1 = I(1) - i1;
  const F n0 = detail::simplexCorner(i, j, x0, y0, seed);
  const F n1 = detail::simplexCorner(wrapAdd(i, i1), wrapAdd(j, j1), x0 - toFloat(i1) + F(unskew),
                                     y0 - toFloat(j1) + F(unskew), seed);
  const F n2 = detail::simplexCorner(wrapAdd(i, I(1)), wrapAdd(j, I(1)), x0 - F(1.0f) + F(2.0f * unskew),
                                     y0 - F(1.0f) + F(2.0f * unskew), seed);
  return F(64.0f) * (n0 + n1 + n2);
}

template <FloatLanes F>
AEROSOL_INLINE F simplexNoise(std::uint32_t seed, Triple<F> p) {
  using I = IntOf<F>;
  constexpr float unskew = 0.166666667f;
  const F s = (p.x + p.y + p.z) * F(0.333333333f);
  const I i = detail::cellOf(p.x + s);
  const I j = detail::cellOf(p.y + s);
  const I k = detail::cellOf(p.z + s);
  const F t = toFloat(wrapAdd(wrapAdd(i, j), k)) * F(unskew);
  const Triple<F> p0 = {p.x - (toFloat(i) - t), p.y - (toFloat(j) - t), p.z - (toFloat(k) - t)};
  // The second corner steps along the largest coordinate, the third along the two largest.
  const I xy = greaterEqual(p0.x, p0.y);
  const I yz = greaterEqual(p0.y, p0.z);
  const I xz = greaterEqual(p0.x, p0.z);
  const I i1 = detail::asOne(xy & xz);
  const I j1 = detail::asOne(~xy & yz);
  const I k1 = I(1) - i1 - j1;
  const I i2 = detail::asOne(xy | xz);
  const I j2 = detail::asOne(~xy | yz);
  const I k2 = I(2) - i2 - j2;
  const auto corner = [&](I di, I dj, I dk, float c) __attribute__((always_inline)) {
    const Triple<F> offset = {p0.x - toFloat(di) + F(c), p0.y - toFloat(dj) + F(c), p0.z - toFloat(dk) + F(c)};
    return detail::simplexCorner(wrapAdd(i, di), wrapAdd(j, dj), wrapAdd(k, dk), offset, seed);
  };
  const F n0 = detail::simplexCorner(i, j, k, p0, seed);
  const F n1 = corner(i1, j1, k1, unskew);
  const F n2 = corner(i2, j2, k2, 2.0f * unskew);
  const F n3 = corner(I(1), I(1), I(1), 3.0f * unskew);
  return F(68.0f) * (n0 + n1 + n2 + n3);
}

template <FloatLanes F>
AEROSOL_INLINE F simplexNoise(std::uint32_t seed, Triple<F> p, F w) {
  using I = IntOf<F>;
  constexpr float unskew = 0.138196601f;  // (5 - sqrt(5)) / 20
  const F s = (p.x + p.y + p.z + w) * F(0.309016994f);
  const I i = detail::cellOf(p.x + s);
  const I j = detail::cellOf(p.y + s);
  const I k = detail::cellOf(p.z + s);
  const I l = detail::cellOf(w + s);
  const F t = toFloat(wrapAdd(wrapAdd(wrapAdd(i, j), k), l)) * F(unskew);
  const Triple<F> p0 = {p.x - (toFloat(i) - t), p.y - (toFloat(j) - t), p.z - (toFloat(k) - t)};
  const F w0 = w - (toFloat(l) - t);
  // Ranks, from 3 for the largest coordinate to 0 for the smallest.
  const I xy = detail::asOne(greater(p0.x, p0.y));
  const I xz = detail::asOne(greater(p0.x, p0.z));
  const I yz = detail::asOne(greater(p0.y, p0.z));
  const I xw = detail::asOne(greater(p0.x, w0));
  const I yw = detail::asOne(greater(p0.y, w0));
  const I zw = detail::asOne(greater(p0.z, w0));
  const I rankX = xy + xz + xw;
  const I rankY = I(1) - xy + yz + yw;
  const I rankZ = I(2) - xz - yz + zw;
  const I rankW = I(3) - xw - yw - zw;
  const auto corner = [&](int steps) __attribute__((always_inline)) {
    const I least = I(4 - steps);
    const I di = detail::asOne(greaterEqual(rankX, least));
    const I dj = detail::asOne(greaterEqual(rankY, least));
    const I dk = detail::asOne(greaterEqual(rankZ, least));
    const I dl = detail::asOne(greaterEqual(rankW, least));
    const F c = F(static_cast<float>(steps) * unskew);
    const Triple<F> offset = {p0.x - toFloat(di) + c, p0.y - toFloat(dj) + c, p0.z - toFloat(dk) + c};
    return detail::simplexCorner(wrapAdd(i, di), wrapAdd(j, dj), wrapAdd(k, dk), wrapAdd(l, dl), offset,
                                 w0 - toFloat(dl) + c, seed);
  };
  const F n0 = detail::simplexCorner(i, j, k, l, p0, w0, seed);
  return F(54.0f) * (n0 + corner(1) + corner(2) + corner(3) + corner(4));
}

// The functions of the language: (x), (x, y), (p) or (p, t). Components of triples are noises of seeds 0, 1 and 2.

template <class... A>
AEROSOL_INLINE auto simplex(A... at) {
  return simplexNoise(0u, at...);
}
template <class... A>
AEROSOL_INLINE auto simplexTriple(A... at) -> Triple<decltype(simplexNoise(0u, at...))> {
  return {simplexNoise(0u, at...), simplexNoise(1u, at...), simplexNoise(2u, at...)};
}
template <class... A>
AEROSOL_INLINE auto unsignedSimplex(A... at) {
  return toUnsigned(simplex(at...));
}
template <class... A>
AEROSOL_INLINE auto unsignedSimplexTriple(A... at) {
  return toUnsigned(simplexTriple(at...));
}

}  // namespace aerosol::jit::runtime
