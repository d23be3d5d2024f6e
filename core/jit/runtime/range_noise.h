// Noise without a rule for boxes. Cell noise is exact inside one cell; hash noise, simplex noise and the periodic forms
// of cell and hash noise are exact for single points. Otherwise each has its whole range.
#pragma once

#include "core/jit/runtime/noise_cell.h"
#include "core/jit/runtime/noise_simplex.h"
#include "core/jit/runtime/range_int.h"
#include "core/jit/runtime/range_perlin.h"

namespace aerosol::jit::runtime {

namespace detail {

// What is exact for some boxes and otherwise has its whole range.

/// The lower ends.
template <FloatLanes F>
AEROSOL_INLINE F lowerEnd(const Range<F>& x) {
  return x.lo;
}
template <FloatLanes F>
AEROSOL_INLINE Triple<F> lowerEnd(const Triple<Range<F>>& p) {
  return {p.x.lo, p.y.lo, p.z.lo};
}
/// One value of known bits (0 has two).
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> knownBits(const Range<F>& x) {
  return isPoint(x) & notEqual(x.lo, F(0.0f));
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> knownBits(const Triple<Range<F>>& p) {
  return knownBits(p.x) & knownBits(p.y) & knownBits(p.z);
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> knownCell(const Range<F>& x) {
  return equal(floor(x.lo), floor(x.hi)) & ~x.nan;
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> knownCell(const Triple<Range<F>>& p) {
  return knownCell(p.x) & knownCell(p.y) & knownCell(p.z);
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> exactOr(IntOf<F> known, F value, float low, float high) {
  return {select(known, value, F(low)), select(known, value, F(high)), IntOf<F>(0)};
}
template <FloatLanes F>
AEROSOL_INLINE Triple<Range<F>> exactOr(IntOf<F> known, const Triple<F>& value, float low, float high) {
  return {exactOr(known, value.x, low, high), exactOr(known, value.y, low, high), exactOr(known, value.z, low, high)};
}

/// Greatest magnitudes of simplex noise in 1 to 4 dimensions: proven by a test with offsets that are off by 1e-3.
/// Beyond 2^10, where they may be rounded more coarsely, all corners may add what one alone can give.
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> isFar(const Range<F>& x) {
  return ~(less(abs(x.lo), F(1024.0f)) & less(abs(x.hi), F(1024.0f)));
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> isFar(const Triple<Range<F>>& p) {
  return isFar(p.x) | isFar(p.y) | isFar(p.z);
}
/// Coordinates whose sums may overflow: the weights of corners are 0 then, and 0 times infinity is no number.
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> mayOverflow(const Range<F>& x) {
  return ~(less(abs(x.lo), F(1e37f)) & less(abs(x.hi), F(1e37f))) | x.nan;
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> mayOverflow(const Triple<Range<F>>& p) {
  return mayOverflow(p.x) | mayOverflow(p.y) | mayOverflow(p.z);
}
template <FloatLanes F>
AEROSOL_INLINE F greatestSimplex(IntOf<F> far) {
  return select(far, F(5.0f), F(0.93f));
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> simplexRange(IntOf<F> known, F value, IntOf<F> far, IntOf<F> nan) {
  const F greatest = greatestSimplex<F>(far);
  return {select(known, value, -greatest), select(known, value, greatest), nan};
}
template <FloatLanes F>
AEROSOL_INLINE Triple<Range<F>> simplexRange(IntOf<F> known, const Triple<F>& value, IntOf<F> far, IntOf<F> nan) {
  return {simplexRange(known, value.x, far, nan), simplexRange(known, value.y, far, nan),
          simplexRange(known, value.z, far, nan)};
}

}  // namespace detail

template <RangeArgument A, RangeArgument... B>
AEROSOL_INLINE auto cellNoise(A a, B... b) {
  return detail::exactOr((detail::knownCell(a) & ... & detail::knownCell(b)),
                         cellNoise(detail::lowerEnd(a), detail::lowerEnd(b)...), 0.0f, 1.0f);
}
template <RangeArgument A, RangeArgument... B>
AEROSOL_INLINE auto cellNoiseTriple(A a, B... b) {
  return detail::exactOr((detail::knownCell(a) & ... & detail::knownCell(b)),
                         cellNoiseTriple(detail::lowerEnd(a), detail::lowerEnd(b)...), 0.0f, 1.0f);
}

#define AEROSOL_EXACT_FOR_POINTS(name)                                                     \
  template <RangeArgument A, RangeArgument... B>                                           \
  AEROSOL_INLINE auto name(A a, B... b) {                                                  \
    return detail::exactOr((detail::knownBits(a) & ... & detail::knownBits(b)),            \
                           name(detail::lowerEnd(a), detail::lowerEnd(b)...), 0.0f, 1.0f); \
  }
AEROSOL_EXACT_FOR_POINTS(hashNoise)
AEROSOL_EXACT_FOR_POINTS(hashNoiseTriple)
#undef AEROSOL_EXACT_FOR_POINTS
#define AEROSOL_EXACT_FOR_POINTS(name)                                                                           \
  template <RangeArgument A>                                                                                     \
  AEROSOL_INLINE auto name(A a, A pa) {                                                                          \
    return detail::exactOr(detail::knownBits(a) & detail::knownBits(pa),                                         \
                           name(detail::lowerEnd(a), detail::lowerEnd(pa)), 0.0f, 1.0f);                         \
  }                                                                                                              \
  template <RangeArgument A, RangeArgument B>                                                                    \
  AEROSOL_INLINE auto name(A a, B b, A pa, B pb) {                                                               \
    return detail::exactOr(                                                                                      \
        detail::knownBits(a) & detail::knownBits(b) & detail::knownBits(pa) & detail::knownBits(pb),             \
        name(detail::lowerEnd(a), detail::lowerEnd(b), detail::lowerEnd(pa), detail::lowerEnd(pb)), 0.0f, 1.0f); \
  }
AEROSOL_EXACT_FOR_POINTS(periodicCellNoise)
AEROSOL_EXACT_FOR_POINTS(periodicCellNoiseTriple)
AEROSOL_EXACT_FOR_POINTS(periodicHashNoise)
AEROSOL_EXACT_FOR_POINTS(periodicHashNoiseTriple)
#undef AEROSOL_EXACT_FOR_POINTS

template <RangeArgument A, RangeArgument... B>
AEROSOL_INLINE auto simplex(A a, B... b) {
  return detail::simplexRange(
      (detail::knownBits(a) & ... & detail::knownBits(b)), simplex(detail::lowerEnd(a), detail::lowerEnd(b)...),
      (detail::isFar(a) | ... | detail::isFar(b)), (detail::mayOverflow(a) | ... | detail::mayOverflow(b)));
}
template <RangeArgument A, RangeArgument... B>
AEROSOL_INLINE auto simplexTriple(A a, B... b) {
  return detail::simplexRange(
      (detail::knownBits(a) & ... & detail::knownBits(b)), simplexTriple(detail::lowerEnd(a), detail::lowerEnd(b)...),
      (detail::isFar(a) | ... | detail::isFar(b)), (detail::mayOverflow(a) | ... | detail::mayOverflow(b)));
}
namespace detail {

template <class T>
struct LanesOf;
template <FloatLanes F>
struct LanesOf<Range<F>> {
  using type = F;
};
template <FloatLanes F>
struct LanesOf<Triple<Range<F>>> {
  using type = F;
};

}  // namespace detail

/// The int hash: exact for single points.
template <RangeArgument A, RangeArgument... B>
AEROSOL_INLINE auto hashInt(A a, B... b) {
  using I = IntOf<typename detail::LanesOf<A>::type>;
  const I known = (detail::knownBits(a) & ... & detail::knownBits(b));
  const I value = hashInt(detail::lowerEnd(a), detail::lowerEnd(b)...);
  return select(known, IntRange<I>{value, value}, wholeIntRange<I>());
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> hashInt(const IntRange<I>& a) {
  const I value = hashInt(a.lo);
  return select(equal(a.lo, a.hi), IntRange<I>{value, value}, wholeIntRange<I>());
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> hashInt(const IntRange<I>& a, const IntRange<I>& b, const IntRange<I>& c,
                                   const IntRange<I>& d) {
  const I value = hashInt(a.lo, b.lo, c.lo, d.lo);
  const I known = equal(a.lo, a.hi) & equal(b.lo, b.hi) & equal(c.lo, c.hi) & equal(d.lo, d.hi);
  return select(known, IntRange<I>{value, value}, wholeIntRange<I>());
}

}  // namespace aerosol::jit::runtime
