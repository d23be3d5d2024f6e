// Noise over forms: Perlin noise with its slopes, all others by their ranges.
#pragma once

#include "core/jit/runtime/range_form.h"

namespace aerosol::jit::runtime {

template <class T>
struct IsFormArgument : std::false_type {};
template <FloatLanes F>
struct IsFormArgument<Form<F>> : std::true_type {};
template <FloatLanes F>
struct IsFormArgument<Triple<Form<F>>> : std::true_type {};
template <class T>
concept FormArgument = IsFormArgument<T>::value;

namespace detail {

template <FloatLanes F, int N>
AEROSOL_INLINE Coordinates<Range<F>, N> rangesOf(const Coordinates<Form<F>, N>& forms) {
  Coordinates<Range<F>, N> result;
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) result.q[i] = forms.q[i];
  return result;
}

/// The noise's line over its arguments' lines.
template <FloatLanes F, int N, int C>
AEROSOL_INLINE Form<F> composed(const NoiseOverBox<F, N, C>& over, int component, const Form<F> (&q)[N]) {
  const BoxNoise<F, N>& noise = over.noise[component];
  F centre = noise.centre, rest = noise.rest, magnitude = abs(noise.centre);
  F slope[3] = {F(0.0f), F(0.0f), F(0.0f)};
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) {
    const F steep = abs(noise.slope[i]);
    centre = fma(noise.slope[i], q[i].centre - over.middle[i], centre);
    rest = fma(steep, q[i].rest, rest);
    magnitude = fma(steep, abs(q[i].centre) + abs(over.middle[i]) + q[i].slopes() + q[i].rest, magnitude);
#pragma clang loop unroll(full)
    for (int k = 0; k < 3; ++k) slope[k] = fma(noise.slope[i], q[i].slope[k], slope[k]);
  }
  return tightened(rangeOf(over, component), centre, slope[0], slope[1], slope[2], fma(magnitude, F(roundOff), rest));
}
template <FloatLanes F, int N>
AEROSOL_INLINE Form<F> resultOf(const NoiseOverBox<F, N, 1>& over, const Form<F> (&q)[N]) {
  return composed(over, 0, q);
}
template <FloatLanes F, int N>
AEROSOL_INLINE Triple<Form<F>> resultOf(const NoiseOverBox<F, N, 3>& over, const Form<F> (&q)[N]) {
  return {composed(over, 0, q), composed(over, 1, q), composed(over, 2, q)};
}

template <int C, class Q>
AEROSOL_INLINE auto formNoise(const Q& q) {
  return resultOf(noiseOver<C>(rangesOf(q).q), q.q);
}
template <int C, class Q>
AEROSOL_INLINE auto formNoise(const Q& q, const Q& periods) {
  return resultOf(noiseOver<C>(rangesOf(q).q, rangesOf(periods).q), q.q);
}

}  // namespace detail

template <FormArgument A, class... B>
AEROSOL_INLINE auto perlin(A first, B... more) {
  return detail::formNoise<1>(detail::coordinates(first, more...));
}
template <FormArgument A, class... B>
AEROSOL_INLINE auto perlinTriple(A first, B... more) {
  return detail::formNoise<3>(detail::coordinates(first, more...));
}
template <FormArgument A>
AEROSOL_INLINE auto periodicPerlin(A x, A px) {
  return detail::formNoise<1>(detail::coordinates(x), detail::coordinates(px));
}
template <FormArgument A, FormArgument B>
AEROSOL_INLINE auto periodicPerlin(A x, B y, A px, B py) {
  return detail::formNoise<1>(detail::coordinates(x, y), detail::coordinates(px, py));
}
template <FormArgument A>
AEROSOL_INLINE auto periodicPerlinTriple(A x, A px) {
  return detail::formNoise<3>(detail::coordinates(x), detail::coordinates(px));
}
template <FormArgument A, FormArgument B>
AEROSOL_INLINE auto periodicPerlinTriple(A x, B y, A px, B py) {
  return detail::formNoise<3>(detail::coordinates(x, y), detail::coordinates(px, py));
}

#define AEROSOL_BY_RANGES(name)                            \
  template <FormArgument A, FormArgument... B>             \
  AEROSOL_INLINE auto name(A first, B... more) {           \
    return formOf(name(rangeOf(first), rangeOf(more)...)); \
  }
AEROSOL_BY_RANGES(cellNoise)
AEROSOL_BY_RANGES(cellNoiseTriple)
AEROSOL_BY_RANGES(hashNoise)
AEROSOL_BY_RANGES(hashNoiseTriple)
AEROSOL_BY_RANGES(simplex)
AEROSOL_BY_RANGES(simplexTriple)
AEROSOL_BY_RANGES(hashInt)
#undef AEROSOL_BY_RANGES
#define AEROSOL_PERIODIC_BY_RANGES(name)                                   \
  template <FormArgument A>                                                \
  AEROSOL_INLINE auto name(A x, A px) {                                    \
    return formOf(name(rangeOf(x), rangeOf(px)));                          \
  }                                                                        \
  template <FormArgument A, FormArgument B>                                \
  AEROSOL_INLINE auto name(A x, B y, A px, B py) {                         \
    return formOf(name(rangeOf(x), rangeOf(y), rangeOf(px), rangeOf(py))); \
  }
AEROSOL_PERIODIC_BY_RANGES(periodicCellNoise)
AEROSOL_PERIODIC_BY_RANGES(periodicCellNoiseTriple)
AEROSOL_PERIODIC_BY_RANGES(periodicHashNoise)
AEROSOL_PERIODIC_BY_RANGES(periodicHashNoiseTriple)
#undef AEROSOL_PERIODIC_BY_RANGES

}  // namespace aerosol::jit::runtime
