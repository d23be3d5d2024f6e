// Perlin noise over ranges (range_lattice.h), plain and periodic. Periods that are no single values leave the greatest
// value of the noise alone.
#pragma once

#include "core/jit/runtime/range_lattice.h"

namespace aerosol::jit::runtime {

namespace detail {

/// Scales of `Lattice1` … `Lattice4`, and bounds on all values. Those of the values are proven by a test that bounds
/// the sum over the corners with the worst gradient at each.
inline constexpr float perlinScale[5] = {0, 0.25f, 0.6616f, 0.982f, 0.8344f};
inline constexpr float perlinGreatest[5] = {0, 1.001f, 1.001f, 1.0185f, 1.29f};

template <FloatLanes F>
AEROSOL_INLINE IntOf<F> mayMiss(const Range<F>& x) {
  return x.nan | mayBeInfinite(x);
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> mayMiss(const Triple<Range<F>>& p) {
  return mayMiss(p.x) | mayMiss(p.y) | mayMiss(p.z);
}

/// The coordinates of a call, one after the other. T is a range, or what is derived from one.
template <class T, int N>
struct Coordinates {
  T q[N];
};
template <class T>
AEROSOL_INLINE Coordinates<T, 1> coordinates(const T& x) {
  return {{x}};
}
template <class T>
AEROSOL_INLINE Coordinates<T, 2> coordinates(const T& x, const T& y) {
  return {{x, y}};
}
template <class T>
AEROSOL_INLINE Coordinates<T, 3> coordinates(const Triple<T>& p) {
  return {{p.x, p.y, p.z}};
}
template <class T>
AEROSOL_INLINE Coordinates<T, 4> coordinates(const Triple<T>& p, const T& w) {
  return {{p.x, p.y, p.z, w}};
}

/// C noises over a box, the box, and where they may be NaN.
template <FloatLanes F, int N, int C>
struct NoiseOverBox {
  BoxNoise<F, N> noise[C];
  F middle[N];
  IntOf<F> nan;
};

template <int C, FloatLanes F, int N, class P>
AEROSOL_INLINE NoiseOverBox<F, N, C> noiseOver(const Range<F> (&q)[N], const P (&periods)[N], IntOf<F> usable) {
  NoiseOverBox<F, N, C> result;
  LatticeBox<F, N> box(q);
  box.known &= usable;
  boxNoise<C>(box, periods, perlinScale[N], perlinGreatest[N], result.noise);
  result.nan = IntOf<F>(0);
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) {
    result.nan |= mayMiss(q[i]);
    result.middle[i] = box.middle[i];
  }
  return result;
}
template <int C, FloatLanes F, int N>
AEROSOL_INLINE auto noiseOver(const Range<F> (&q)[N]) {
  const Aperiodic none[N] = {};
  return noiseOver<C>(q, none, ~IntOf<F>(0));
}
template <int C, FloatLanes F, int N>
AEROSOL_INLINE auto noiseOver(const Range<F> (&q)[N], const Range<F> (&p)[N]) {
  Period<F> periods[N];
  IntOf<F> usable = ~IntOf<F>(0);
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) {
    usable &= isPoint(p[i]);
    periods[i] = {select(isPoint(p[i]), p[i].lo, F(1.0f))};
  }
  return noiseOver<C>(q, periods, usable);
}

template <FloatLanes F, int N, int C>
AEROSOL_INLINE Range<F> rangeOf(const NoiseOverBox<F, N, C>& over, int component) {
  return {over.noise[component].lo, over.noise[component].hi, over.nan};
}
template <FloatLanes F, int N>
AEROSOL_INLINE Triple<Range<F>> rangesOf(const NoiseOverBox<F, N, 3>& over) {
  return {rangeOf(over, 0), rangeOf(over, 1), rangeOf(over, 2)};
}

}  // namespace detail

template <class T>
struct IsRangeArgument : std::false_type {};
template <FloatLanes F>
struct IsRangeArgument<Range<F>> : std::true_type {};
template <FloatLanes F>
struct IsRangeArgument<Triple<Range<F>>> : std::true_type {};
template <class T>
concept RangeArgument = IsRangeArgument<T>::value;

template <RangeArgument A, class... B>
AEROSOL_INLINE auto perlin(A first, B... more) {
  return detail::rangeOf(detail::noiseOver<1>(detail::coordinates(first, more...).q), 0);
}
template <RangeArgument A, class... B>
AEROSOL_INLINE auto perlinTriple(A first, B... more) {
  return detail::rangesOf(detail::noiseOver<3>(detail::coordinates(first, more...).q));
}
template <RangeArgument A>
AEROSOL_INLINE auto periodicPerlin(A x, A px) {
  return detail::rangeOf(detail::noiseOver<1>(detail::coordinates(x).q, detail::coordinates(px).q), 0);
}
template <RangeArgument A, RangeArgument B>
AEROSOL_INLINE auto periodicPerlin(A x, B y, A px, B py) {
  return detail::rangeOf(detail::noiseOver<1>(detail::coordinates(x, y).q, detail::coordinates(px, py).q), 0);
}
template <RangeArgument A>
AEROSOL_INLINE auto periodicPerlinTriple(A x, A px) {
  return detail::rangesOf(detail::noiseOver<3>(detail::coordinates(x).q, detail::coordinates(px).q));
}
template <RangeArgument A, RangeArgument B>
AEROSOL_INLINE auto periodicPerlinTriple(A x, B y, A px, B py) {
  return detail::rangesOf(detail::noiseOver<3>(detail::coordinates(x, y).q, detail::coordinates(px, py).q));
}

}  // namespace aerosol::jit::runtime
