// Simplex noise (Perlin 2001, after Gustavson's formulation) in one to four dimensions with the hash, gradients and
// scales of Open Shading Language. The value is a sum over the corners of the simplex around the point of (r^2 - d^2)^4
// times gradient · offset. The tables of gradients are pairs of bits in constants, the order of the corners comes from
// ranks of the coordinates: there are no look-ups and no branches.
#pragma once

#include "core/jit/runtime/hash.h"
#include "core/jit/runtime/jet.h"
#include "core/jit/runtime/processor.h"
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
  const F inside = max(t, F(0.0f));
  const F square = inside * inside;
  return square * square;
}

/// A mask as 1 or 0.
template <IntLanes I>
AEROSOL_INLINE I asOne(I mask) {
  return mask & I(1);
}

/// ±1 to ±8.
template <FloatLanes F>
AEROSOL_INLINE F simplexGradient(IntOf<F> cell, std::uint32_t seed) {
  using U = UintOf<F>;
  const U h = scramble(asUint(cell), U(seed), U(0u));
  const F magnitude = toFloat(asInt((h & U(7u)) + U(1u)));
  return asFloat(asUint(magnitude) ^ ((h & U(8u)) << U(28u)));
}

template <FloatLanes F>
AEROSOL_INLINE F simplexCorner(IntOf<F> cell, F x, std::uint32_t seed) {
  return cornerWeight(F(1.0f) - x * x) * simplexGradient<F>(cell, seed) * x;
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

/// What is summed over the corners: the value alone.
struct SimplexValue {
  template <class... A>
  AEROSOL_INLINE static auto corner(A... at) {
    return simplexCorner(at...);
  }
};

/// The value with its partial derivatives by the coordinates: of t^4 (g · p), with t = r^2 - p · p, they are
/// t^4 g - 8 t^3 (g · p) p.
struct SimplexJet {
  template <FloatLanes F, int N>
  AEROSOL_INLINE static Jet<F, N> jet(F value, F t, const F (&gradient)[N], const F (&offset)[N]) {
    const F inside = select(greaterEqual(t, F(0.0f)), t, F(0.0f));
    const F cube = inside * inside * inside;
    F dot = gradient[0] * offset[0];
#pragma clang loop unroll(full)
    for (int i = 1; i < N; ++i) dot += gradient[i] * offset[i];
    const F slope = F(-8.0f) * cube * dot;
    Jet<F, N> result;
    result.value = value;
#pragma clang loop unroll(full)
    for (int i = 0; i < N; ++i) result.partial[i] = fma(slope, offset[i], cube * inside * gradient[i]);
    return result;
  }

  template <FloatLanes F>
  AEROSOL_INLINE static Jet<F, 1> corner(IntOf<F> cell, F x, std::uint32_t seed) {
    const F gradient[1] = {simplexGradient<F>(cell, seed)};
    const F offset[1] = {x};
    return jet(simplexCorner(cell, x, seed), F(1.0f) - x * x, gradient, offset);
  }
  template <FloatLanes F>
  AEROSOL_INLINE static Jet<F, 2> corner(IntOf<F> i, IntOf<F> j, F x, F y, std::uint32_t seed) {
    using U = UintOf<F>;
    const U h = scramble(asUint(i), asUint(j), U(seed)) & U(7u);
    const F gradient[2] = {tableEntry(U(gradient2X), h), tableEntry(U(gradient2Y), h)};
    const F offset[2] = {x, y};
    return jet(simplexCorner(i, j, x, y, seed), F(0.5f) - x * x - y * y, gradient, offset);
  }
  template <FloatLanes F>
  AEROSOL_INLINE static Jet<F, 3> corner(IntOf<F> i, IntOf<F> j, IntOf<F> k, Triple<F> p, std::uint32_t seed) {
    using U = UintOf<F>;
    const U h = scramble(asUint(i), asUint(j), scramble(asUint(k), U(seed), U(0u))) & U(15u);
    const F gradient[3] = {tableEntry(U(gradient3X), h), tableEntry(U(gradient3Y), h), tableEntry(U(gradient3Z), h)};
    const F offset[3] = {p.x, p.y, p.z};
    return jet(simplexCorner(i, j, k, p, seed), F(0.5f) - p.x * p.x - p.y * p.y - p.z * p.z, gradient, offset);
  }
  template <FloatLanes F>
  AEROSOL_INLINE static Jet<F, 4> corner(IntOf<F> i, IntOf<F> j, IntOf<F> k, IntOf<F> l, Triple<F> p, F w,
                                         std::uint32_t seed) {
    using U = UintOf<F>;
    const U h = scramble(asUint(i), asUint(j), scramble(asUint(k), asUint(l), U(seed)));
    const auto low = equal(h & U(16u), U(0u));
    const auto entry = [&](int axis) __attribute__((always_inline)) {
      return tableEntry(select(low, U(gradient4[axis][0]), U(gradient4[axis][1])), h & U(15u));
    };
    const F gradient[4] = {entry(0), entry(1), entry(2), entry(3)};
    const F offset[4] = {p.x, p.y, p.z, w};
    return jet(simplexCorner(i, j, k, l, p, w, seed), F(0.5f) - p.x * p.x - p.y * p.y - p.z * p.z - w * w, gradient,
               offset);
  }
};

/// The sum over the corners of the simplex around the point.
template <class Kernel, FloatLanes F>
AEROSOL_INLINE auto simplexSum(std::uint32_t seed, F x) {
  using I = IntOf<F>;
  const I i = floorToInt(x);
  const F x0 = x - toFloat(i);
  const auto n0 = Kernel::corner(i, x0, seed);
  const auto n1 = Kernel::corner(wrapAdd(i, I(1)), x0 - F(1.0f), seed);
  return F(0.36f) * (n0 + n1);
}

template <class Kernel, FloatLanes F>
AEROSOL_INLINE auto simplexSum(std::uint32_t seed, F x, F y) {
  using I = IntOf<F>;
  constexpr float skew = 0.366025403f;    // (sqrt(3) - 1) / 2
  constexpr float unskew = 0.211324865f;  // (3 - sqrt(3)) / 6
  const F s = (x + y) * F(skew);
  const I i = floorToInt(x + s);
  const I j = floorToInt(y + s);
  const F t = toFloat(wrapAdd(i, j)) * F(unskew);
  const F x0 = x - (toFloat(i) - t);
  const F y0 = y - (toFloat(j) - t);
  const I i1 = asOne(greater(x0, y0));
  const I j1 = I(1) - i1;
  const auto n0 = Kernel::corner(i, j, x0, y0, seed);
  const auto n1 =
      Kernel::corner(wrapAdd(i, i1), wrapAdd(j, j1), x0 - toFloat(i1) + F(unskew), y0 - toFloat(j1) + F(unskew), seed);
  const auto n2 = Kernel::corner(wrapAdd(i, I(1)), wrapAdd(j, I(1)), x0 - F(1.0f) + F(2.0f * unskew),
                                 y0 - F(1.0f) + F(2.0f * unskew), seed);
  return F(64.0f) * (n0 + n1 + n2);
}

template <class Kernel, FloatLanes F>
AEROSOL_INLINE auto simplexSum(std::uint32_t seed, Triple<F> p) {
  using I = IntOf<F>;
  constexpr float unskew = 0.166666667f;
  const F s = (p.x + p.y + p.z) * F(0.333333333f);
  const I i = floorToInt(p.x + s);
  const I j = floorToInt(p.y + s);
  const I k = floorToInt(p.z + s);
  const F t = toFloat(wrapAdd(wrapAdd(i, j), k)) * F(unskew);
  const Triple<F> p0 = {p.x - (toFloat(i) - t), p.y - (toFloat(j) - t), p.z - (toFloat(k) - t)};
  // The second corner steps along the largest coordinate, the third along the two largest.
  const I xy = greaterEqual(p0.x, p0.y);
  const I yz = greaterEqual(p0.y, p0.z);
  const I xz = greaterEqual(p0.x, p0.z);
  const I i1 = asOne(xy & xz);
  const I j1 = asOne(~xy & yz);
  const I k1 = I(1) - i1 - j1;
  const I i2 = asOne(xy | xz);
  const I j2 = asOne(~xy | yz);
  const I k2 = I(2) - i2 - j2;
  const auto corner = [&](I di, I dj, I dk, float c) __attribute__((always_inline)) {
    const Triple<F> offset = {p0.x - toFloat(di) + F(c), p0.y - toFloat(dj) + F(c), p0.z - toFloat(dk) + F(c)};
    return Kernel::corner(wrapAdd(i, di), wrapAdd(j, dj), wrapAdd(k, dk), offset, seed);
  };
  const auto n0 = Kernel::corner(i, j, k, p0, seed);
  const auto n1 = corner(i1, j1, k1, unskew);
  const auto n2 = corner(i2, j2, k2, 2.0f * unskew);
  const auto n3 = corner(I(1), I(1), I(1), 3.0f * unskew);
  return F(68.0f) * (n0 + n1 + n2 + n3);
}

template <class Kernel, FloatLanes F>
AEROSOL_INLINE auto simplexSum(std::uint32_t seed, Triple<F> p, F w) {
  using I = IntOf<F>;
  constexpr float unskew = 0.138196601f;  // (5 - sqrt(5)) / 20
  const F s = (p.x + p.y + p.z + w) * F(0.309016994f);
  const I i = floorToInt(p.x + s);
  const I j = floorToInt(p.y + s);
  const I k = floorToInt(p.z + s);
  const I l = floorToInt(w + s);
  const F t = toFloat(wrapAdd(wrapAdd(wrapAdd(i, j), k), l)) * F(unskew);
  const Triple<F> p0 = {p.x - (toFloat(i) - t), p.y - (toFloat(j) - t), p.z - (toFloat(k) - t)};
  const F w0 = w - (toFloat(l) - t);
  // Ranks, from 3 for the largest coordinate to 0 for the smallest.
  const I xy = asOne(greater(p0.x, p0.y));
  const I xz = asOne(greater(p0.x, p0.z));
  const I yz = asOne(greater(p0.y, p0.z));
  const I xw = asOne(greater(p0.x, w0));
  const I yw = asOne(greater(p0.y, w0));
  const I zw = asOne(greater(p0.z, w0));
  const I rankX = xy + xz + xw;
  const I rankY = I(1) - xy + yz + yw;
  const I rankZ = I(2) - xz - yz + zw;
  const I rankW = I(3) - xw - yw - zw;
  const auto corner = [&](int steps) __attribute__((always_inline)) {
    const I least = I(4 - steps);
    const I di = asOne(greaterEqual(rankX, least));
    const I dj = asOne(greaterEqual(rankY, least));
    const I dk = asOne(greaterEqual(rankZ, least));
    const I dl = asOne(greaterEqual(rankW, least));
    const F c = F(static_cast<float>(steps) * unskew);
    const Triple<F> offset = {p0.x - toFloat(di) + c, p0.y - toFloat(dj) + c, p0.z - toFloat(dk) + c};
    return Kernel::corner(wrapAdd(i, di), wrapAdd(j, dj), wrapAdd(k, dk), wrapAdd(l, dl), offset, w0 - toFloat(dl) + c,
                          seed);
  };
  const auto n0 = Kernel::corner(i, j, k, l, p0, w0, seed);
  return F(54.0f) * (n0 + corner(1) + corner(2) + corner(3) + corner(4));
}

}  // namespace detail

template <class... A>
  requires requires(A... at) { detail::simplexSum<detail::SimplexValue>(0u, at...); }
AEROSOL_INLINE auto simplexNoise(std::uint32_t seed, A... at) {
  return detail::simplexSum<detail::SimplexValue>(seed, at...);
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
