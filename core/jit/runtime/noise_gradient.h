// Perlin noise with its partial derivatives: the product and chain rules applied to the interpolation of
// noise_perlin.h, step by step. The value is computed by the same operations and has the same bits.
#pragma once

#include "core/jit/runtime/jet.h"
#include "core/jit/runtime/noise_perlin.h"
#include "core/jit/runtime/noise_simplex.h"

namespace aerosol::jit::runtime {

namespace detail {

/// Derivative of the fade: 30 t^2 (t - 1)^2.
template <FloatLanes F>
AEROSOL_INLINE F fadeSlope(const LatticeAxis<F>& axis) {
  const F product = axis.offset[0] * axis.offset[1];
  return F(30.0f) * (product * product);
}

template <FloatLanes F, int N>
AEROSOL_INLINE Jet<F, N> interpolate(const Jet<F, N>& a, const Jet<F, N>& b, const LatticeAxis<F>& axis, int number) {
  Jet<F, N> result;
  result.value = interpolate(a.value, b.value, axis.fade);
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) {
    const F partial = interpolate(a.partial[i], b.partial[i], axis.fade);
    result.partial[i] = i == number ? fma(fadeSlope(axis), b.value - a.value, partial) : partial;
  }
  return result;
}

template <FloatLanes F, int N>
AEROSOL_INLINE Jet<F, N> scaled(const Jet<F, N>& jet, float scale) {
  Jet<F, N> result = F(scale) * jet;
  result.value = scaled(jet.value, scale);
  return result;
}

template <FloatLanes F>
AEROSOL_INLINE F where(IntOf<F> mask, F x) {
  return asFloat(asInt(x) & mask);
}
/// Of two numbers that are nowhere both set.
template <FloatLanes F>
AEROSOL_INLINE F either(F a, F b) {
  return asFloat(asInt(a) | asInt(b));
}

// A corner's contribution: gradient · offset, and the gradient (see `gradient`).

template <FloatLanes F>
AEROSOL_INLINE Jet<F, 1> cornerJet(UintOf<F> h, F x) {
  using U = UintOf<F>;
  return {gradient(h, x), {flipSign(toFloat(asInt((h & U(7u)) + U(1u))), h, 3)}};
}
template <FloatLanes F>
AEROSOL_INLINE Jet<F, 2> cornerJet(UintOf<F> h, F x, F y) {
  const auto first = noBits(h, 4);
  const F u = flipSign(F(1.0f), h, 0);
  const F v = flipSign(F(2.0f), h, 1);
  return {gradient(h, x, y), {pick(first, u, v), pick(first, v, u)}};
}
template <FloatLanes F>
AEROSOL_INLINE Jet<F, 3> cornerJet(UintOf<F> h, F x, F y, F z) {
  if constexpr (hasTablePermute<F>) {
    if (processorHasAvx512()) {
      using Table = Wide<float, 16>;
      const Table gx = {1, -1, 1, -1, 1, -1, 1, -1, 0, 0, 0, 0, 1, 0, -1, 0};
      const Table gy = {1, 1, -1, -1, 0, 0, 0, 0, 1, -1, 1, -1, 1, -1, 1, -1};
      const Table gz = {0, 0, 0, 0, 1, 1, -1, -1, 1, 1, -1, -1, 0, 1, 0, -1};
      return {gradient(h, x, y, z), {permute16(gx, h), permute16(gy, h), permute16(gz, h)}};
    }
  }
  using U = UintOf<F>;
  const auto uIsX = noBits(h, 8);
  const auto vIsY = noBits(h, 12);
  const auto vIsX = equal(h & U(13u), U(12u));
  const F u = flipSign(F(1.0f), h, 0);
  const F v = flipSign(F(1.0f), h, 1);
  return {gradient(h, x, y, z),
          {either(where(uIsX, u), where(vIsX, v)), either(where(~uIsX, u), where(vIsY, v)), where(~(vIsX | vIsY), v)}};
}
template <FloatLanes F>
AEROSOL_INLINE Jet<F, 4> cornerJet(UintOf<F> h, F x, F y, F z, F w) {
  using U = UintOf<F>;
  const auto low = noBits(h, 24);
  const auto lower = noBits(h, 16);
  const auto top = equal(h & U(24u), U(24u));
  const F u = flipSign(F(1.0f), h, 0);
  const F v = flipSign(F(1.0f), h, 1);
  const F s = flipSign(F(1.0f), h, 2);
  return {gradient(h, x, y, z, w),
          {where(~top, u), either(where(top, u), where(lower, v)), either(where(~lower, v), where(low, s)),
           where(~low, s)}};
}

template <FloatLanes F>
AEROSOL_INLINE Jet<F, 1> jetOf(const Lattice1<F>& l, std::uint32_t shift) {
  const auto at = [&](int i) __attribute__((always_inline)) {
    return cornerJet(l.hash[i] >> UintOf<F>(shift), l.x.offset[i]);
  };
  return scaled(interpolate(at(0), at(1), l.x, 0), 0.25f);
}

template <FloatLanes F>
AEROSOL_INLINE Jet<F, 2> jetOf(const Lattice2<F>& l, std::uint32_t shift) {
  const auto at = [&](int i, int j) __attribute__((always_inline)) {
    return cornerJet(l.hash[i][j] >> UintOf<F>(shift), l.x.offset[i], l.y.offset[j]);
  };
  const auto low = interpolate(at(0, 0), at(1, 0), l.x, 0);
  const auto high = interpolate(at(0, 1), at(1, 1), l.x, 0);
  return scaled(interpolate(low, high, l.y, 1), 0.6616f);
}

template <FloatLanes F>
AEROSOL_INLINE Jet<F, 3> jetOf(const Lattice3<F>& l, std::uint32_t shift) {
  const auto at = [&](int i, int j, int k) __attribute__((always_inline)) {
    return cornerJet(l.hash[i][j][k] >> UintOf<F>(shift), l.x.offset[i], l.y.offset[j], l.z.offset[k]);
  };
  const auto plane = [&](int k) __attribute__((always_inline)) {
    const auto low = interpolate(at(0, 0, k), at(1, 0, k), l.x, 0);
    const auto high = interpolate(at(0, 1, k), at(1, 1, k), l.x, 0);
    return interpolate(low, high, l.y, 1);
  };
  return scaled(interpolate(plane(0), plane(1), l.z, 2), 0.982f);
}

template <FloatLanes F>
AEROSOL_INLINE Jet<F, 4> jetOf(const Lattice4<F>& lattice, std::uint32_t shift) {
  const auto at = [&](int i, int j, int k, int l) __attribute__((always_inline)) {
    return cornerJet(lattice.hash[i][j][k][l] >> UintOf<F>(shift), lattice.x.offset[i], lattice.y.offset[j],
                     lattice.z.offset[k], lattice.w.offset[l]);
  };
  const auto plane = [&](int k, int l) __attribute__((always_inline)) {
    const auto low = interpolate(at(0, 0, k, l), at(1, 0, k, l), lattice.x, 0);
    const auto high = interpolate(at(0, 1, k, l), at(1, 1, k, l), lattice.x, 0);
    return interpolate(low, high, lattice.y, 1);
  };
  const auto cube = [&](int l)
                        __attribute__((always_inline)) { return interpolate(plane(0, l), plane(1, l), lattice.z, 2); };
  return scaled(interpolate(cube(0), cube(1), lattice.w, 3), 0.8344f);
}

template <class L>
AEROSOL_INLINE auto tripleOfJets(const L& lattice) -> Triple<decltype(jetOf(lattice, 0u))> {
  return {jetOf(lattice, 0u), jetOf(lattice, 8u), jetOf(lattice, 16u)};
}

}  // namespace detail

// Value and partial derivatives of the functions of the language, with their arguments.

template <class F, class... More>
AEROSOL_INLINE auto perlinJet(F first, More... more) {
  return detail::jetOf(perlinLattice(first, more...), 0u);
}
template <class F, class... More>
AEROSOL_INLINE auto perlinTripleJet(F first, More... more) {
  return detail::tripleOfJets(perlinLattice(first, more...));
}
template <class F, class... More>
AEROSOL_INLINE auto periodicPerlinJet(F first, More... more) {
  return detail::jetOf(periodicPerlinLattice(first, more...), 0u);
}
template <class F, class... More>
AEROSOL_INLINE auto periodicPerlinTripleJet(F first, More... more) {
  return detail::tripleOfJets(periodicPerlinLattice(first, more...));
}
template <class F, class... More>
AEROSOL_INLINE auto simplexJet(F first, More... more) {
  return detail::simplexSum<detail::SimplexJet>(0u, first, more...);
}
template <class F, class... More>
AEROSOL_INLINE auto simplexTripleJet(F first, More... more) {
  using detail::SimplexJet;
  using J = decltype(simplexJet(first, more...));
  return Triple<J>{detail::simplexSum<SimplexJet>(0u, first, more...),
                   detail::simplexSum<SimplexJet>(1u, first, more...),
                   detail::simplexSum<SimplexJet>(2u, first, more...)};
}

#define AEROSOL_UNSIGNED_JET(unsignedName, name)                       \
  template <class F, class... More>                                    \
  AEROSOL_INLINE auto unsignedName##Jet(F first, More... more) {       \
    return toUnsigned(name##Jet(first, more...));                      \
  }                                                                    \
  template <class F, class... More>                                    \
  AEROSOL_INLINE auto unsignedName##TripleJet(F first, More... more) { \
    return toUnsigned(name##TripleJet(first, more...));                \
  }
AEROSOL_UNSIGNED_JET(unsignedPerlin, perlin)
AEROSOL_UNSIGNED_JET(periodicUnsignedPerlin, periodicPerlin)
AEROSOL_UNSIGNED_JET(unsignedSimplex, simplex)
#undef AEROSOL_UNSIGNED_JET

/// Writes value and partial derivatives to where they are wanted.
template <class F, int N, class... G>
AEROSOL_INLINE void put(const Jet<F, N>& jet, F* value, G*... partials) {
  static_assert(sizeof...(G) == N);
  *value = jet.value;
  int i = 0;
  ((*partials = jet.partial[i++]), ...);
}
template <class F, int N, class... G>
AEROSOL_INLINE void putTriple(const Triple<Jet<F, N>>& jets, Triple<F>* value, G*... partials) {
  static_assert(sizeof...(G) == N);
  *value = {jets.x.value, jets.y.value, jets.z.value};
  int i = 0;
  ((*partials = Triple<F>{jets.x.partial[i], jets.y.partial[i], jets.z.partial[i]}, ++i), ...);
}

}  // namespace aerosol::jit::runtime
