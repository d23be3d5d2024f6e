// The functions of the language over ranges: by monotony, extremes inside, or the whole range of the function. Ends of
// functions that are not correctly rounded are moved outwards by twice their greatest error and more.
#pragma once

#include "core/jit/runtime/math_special.h"
#include "core/jit/runtime/math_trigonometric.h"
#include "core/jit/runtime/range_int.h"

namespace aerosol::jit::runtime {

namespace detail {

inline constexpr float functionUlps = 12.0f;

/// A range within [low, high]; functions never leave their own range.
template <FloatLanes F>
AEROSOL_INLINE Range<F> capped(const Range<F>& a, float low, float high) {
  return {max(a.lo, F(low)), min(a.hi, F(high)), a.nan};
}

/// Hull of the values at the ends (of both arguments' ends), widened.
template <FloatLanes F>
AEROSOL_INLINE Range<F> hull(F a, F b, IntOf<F> nan) {
  return widened(min(a, b), max(a, b), nan, functionUlps);
}
template <FloatLanes F>
AEROSOL_INLINE Range<F> hull(F a, F b, F c, F d, IntOf<F> nan) {
  return widened(least(a, b, c, d), greatest(a, b, c, d), nan, functionUlps);
}

/// Does x / period + shift cross a whole number in [lo, hi]? Undecided counts as yes.
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> crosses(const Range<F>& a, float inversePeriod, float shift) {
  const F lo = fma(a.lo, F(inversePeriod), F(shift));
  const F hi = fma(a.hi, F(inversePeriod), F(shift));
  const F margin = fma(max(abs(lo), abs(hi)), F(4e-7f), F(1e-6f));
  return notEqual(floor(lo - margin), floor(hi + margin));
}

/// Bounds beyond which a range of angles is given up.
inline constexpr float largestAngle = 1e5f;

template <FloatLanes F>
AEROSOL_INLINE IntOf<F> isLargeAngle(const Range<F>& a) {
  return greater(max(abs(a.lo), abs(a.hi)), F(largestAngle));
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> wave(const Range<F>& a, F atLo, F atHi, float maximumShift) {
  using I = IntOf<F>;
  constexpr float inverse = 0.159154943f;  // 1 / (2 pi)
  const I large = isLargeAngle(a);
  const Range<F> ends = capped(hull(atLo, atHi, a.nan | mayBeInfinite(a)), -1.0f, 1.0f);
  const I maximum = crosses(a, inverse, maximumShift) | large;
  const I minimum = crosses(a, inverse, maximumShift + 0.5f) | large;
  return {select(minimum, F(-1.0f), ends.lo), select(maximum, F(1.0f), ends.hi), ends.nan};
}

}  // namespace detail

template <FloatLanes F>
AEROSOL_INLINE void sincos(const Range<F>& x, Range<F>& sine, Range<F>& cosine) {
  const auto large = detail::isLargeAngle(x);
  const auto lo = detail::sineCosine(select(large, F(0.0f), x.lo));
  const auto hi = detail::sineCosine(select(large, F(0.0f), x.hi));
  const Range<F> a = x;
  sine = detail::wave(a, lo.sine, hi.sine, -0.25f);
  cosine = detail::wave(a, lo.cosine, hi.cosine, 0.0f);
}
template <FloatLanes F>
AEROSOL_INLINE Range<F> sin(const Range<F>& x) {
  Range<F> sine, cosine;
  sincos(x, sine, cosine);
  return sine;
}
template <FloatLanes F>
AEROSOL_INLINE Range<F> cos(const Range<F>& x) {
  Range<F> sine, cosine;
  sincos(x, sine, cosine);
  return cosine;
}
template <FloatLanes F>
AEROSOL_INLINE Range<F> tan(const Range<F>& x) {
  const auto large = detail::isLargeAngle(x);
  const auto pole = detail::crosses(x, 0.318309886f, 0.5f) | large;
  const auto nan = x.nan | detail::mayBeInfinite(x);
  const Range<F> ends = detail::hull(tan(select(pole, F(0.0f), x.lo)), tan(select(pole, F(0.0f), x.hi)), nan);
  return select(pole, wholeRange<F>(nan), ends);
}

// Monotone functions of one argument.
#define AEROSOL_MONOTONE(name, low, high)                                          \
  template <FloatLanes F>                                                          \
  AEROSOL_INLINE Range<F> name(const Range<F>& x) {                                \
    return detail::capped(detail::hull(name(x.lo), name(x.hi), x.nan), low, high); \
  }
AEROSOL_MONOTONE(asin, -1.57079637f, 1.57079637f)
AEROSOL_MONOTONE(acos, 0.0f, 3.14159274f)
AEROSOL_MONOTONE(atan, -1.57079637f, 1.57079637f)
AEROSOL_MONOTONE(sinh, -infinity, infinity)
AEROSOL_MONOTONE(tanh, -1.0f, 1.0f)
AEROSOL_MONOTONE(exp, 0.0f, infinity)
AEROSOL_MONOTONE(exp2, 0.0f, infinity)
AEROSOL_MONOTONE(expm1, -1.0f, infinity)
AEROSOL_MONOTONE(log, -infinity, infinity)
AEROSOL_MONOTONE(log2, -infinity, infinity)
AEROSOL_MONOTONE(log10, -infinity, infinity)
AEROSOL_MONOTONE(cbrt, -infinity, infinity)
AEROSOL_MONOTONE(erf, -1.0f, 1.0f)
AEROSOL_MONOTONE(erfc, 0.0f, 2.0f)
#undef AEROSOL_MONOTONE

// Monotone and exact.
#define AEROSOL_MONOTONE_EXACT(name)                \
  template <FloatLanes F>                           \
  AEROSOL_INLINE Range<F> name(const Range<F>& x) { \
    return {name(x.lo), name(x.hi), x.nan};         \
  }
AEROSOL_MONOTONE_EXACT(floor)
AEROSOL_MONOTONE_EXACT(ceil)
AEROSOL_MONOTONE_EXACT(round)
AEROSOL_MONOTONE_EXACT(trunc)
#undef AEROSOL_MONOTONE_EXACT

/// NaN has no sign: 0.
template <FloatLanes F>
AEROSOL_INLINE Range<F> sign(const Range<F>& x) {
  const F lo = sign(x.lo);
  const F hi = sign(x.hi);
  return {select(x.nan, min(lo, F(0.0f)), lo), select(x.nan, max(hi, F(0.0f)), hi), IntOf<F>(0)};
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> abs(const Range<F>& x) {
  const F low = select(detail::contains(x, 0.0f), F(0.0f), min(abs(x.lo), abs(x.hi)));
  return {low, max(abs(x.lo), abs(x.hi)), x.nan};
}
template <FloatLanes F>
AEROSOL_INLINE Range<F> cosh(const Range<F>& x) {
  const Range<F> magnitude = abs(x);
  return detail::capped(detail::hull(cosh(magnitude.lo), cosh(magnitude.hi), x.nan), 1.0f, infinity);
}
template <FloatLanes F>
AEROSOL_INLINE Range<F> logb(const Range<F>& x) {
  const Range<F> magnitude = abs(x);
  return {logb(magnitude.lo), logb(magnitude.hi), x.nan};
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> sqrt(const Range<F>& x) {
  return detail::outward(sqrt(x.lo), sqrt(x.hi), x.nan);
}
/// 0 up to 0, then falling from the value at the least float.
template <FloatLanes F>
AEROSOL_INLINE Range<F> inversesqrt(const Range<F>& x) {
  const auto mayBeZero = lessEqual(x.lo, F(0.0f));
  const F lo = select(mayBeZero, F(0.0f), inversesqrt(x.hi));
  const F hi = select(lessEqual(x.hi, F(0.0f)), F(0.0f), select(mayBeZero, F(2.67137e22f), inversesqrt(x.lo)));
  Range<F> result = detail::outward(lo, hi, x.nan);
  result.hi = select(equal(result.hi, F(0.0f)), result.hi, detail::nextUp(result.hi));
  result.lo = select(equal(result.lo, F(0.0f)), result.lo, detail::nextDown(result.lo));
  return result;
}

/// Where x is surely positive the extremes lie at the corners; where the box crosses the cut or holds the origin, all.
template <FloatLanes F>
AEROSOL_INLINE Range<F> atan2(const Range<F>& y, const Range<F>& x) {
  constexpr float pi = 3.14159274f;
  const auto nan = y.nan | x.nan;
  const auto safe = greater(x.lo, F(0.0f)) | greater(y.lo, F(0.0f)) | less(y.hi, F(0.0f));
  const Range<F> corners = detail::capped(
      detail::hull(atan2(y.lo, x.lo), atan2(y.lo, x.hi), atan2(y.hi, x.lo), atan2(y.hi, x.hi), nan), -pi, pi);
  return select(safe, corners, Range<F>{F(-pi), F(pi), nan});
}

/// Corners for positive x; 0 where x may be 0, 1 where y may be 0, both signs where x may be negative, unless y is one
/// whole number.
template <FloatLanes F>
AEROSOL_INLINE Range<F> pow(const Range<F>& x, const Range<F>& y) {
  using I = IntOf<F>;
  const I nan = x.nan | y.nan;
  const Range<F> base = abs(x);
  Range<F> result =
      detail::capped(detail::hull(pow(base.lo, y.lo), pow(base.lo, y.hi), pow(base.hi, y.lo), pow(base.hi, y.hi), nan),
                     0.0f, largestFloat);
  const I zeroBase = equal(base.lo, F(0.0f));
  result.lo = select(zeroBase, F(0.0f), result.lo);
  result.hi = select(zeroBase & less(y.lo, F(0.0f)) & greater(base.hi, F(0.0f)), F(largestFloat), result.hi);
  const I zeroPower = detail::contains(y, 0.0f);
  result.hi = select(zeroPower, max(result.hi, F(1.0f)), result.hi);
  result.lo = select(zeroPower, min(result.lo, F(1.0f)), result.lo);
  const I negative = less(x.lo, F(0.0f));
  const I whole = equal(y.lo, y.hi) & equal(y.lo, floor(y.lo));
  const F half = y.lo * F(0.5f);
  const I even = whole & equal(half, floor(half));
  const I odd = whole & ~even;
  const Range<F> both = {-result.hi, result.hi, nan};
  // Odd and positive: rising over all x.
  const Range<F> rising = detail::hull(pow(x.lo, y.lo), pow(x.hi, y.lo), nan);
  const I mirrored = lessEqual(x.hi, F(0.0f));
  const Range<F> negated = select(mirrored, Range<F>{-result.hi, -result.lo, nan}, both);
  const Range<F> oddResult = select(greater(y.lo, F(0.0f)), rising, negated);
  return select(negative & ~even, select(odd, oddResult, join(both, Range<F>(0.0f))), result);
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> logBase(const Range<F>& x, const Range<F>& b) {
  return safeDivide(log(x), log(b));
}

// The wide functions take the second operand where either one is NaN.
template <FloatLanes F>
AEROSOL_INLINE Range<F> min(const Range<F>& a, const Range<F>& b) {
  const Range<F> lesser = {min(a.lo, b.lo), min(a.hi, b.hi), b.nan};
  return select(a.nan | b.nan, Range<F>{lesser.lo, b.hi, b.nan}, lesser);
}
template <FloatLanes F>
AEROSOL_INLINE Range<F> max(const Range<F>& a, const Range<F>& b) {
  const Range<F> larger = {max(a.lo, b.lo), max(a.hi, b.hi), b.nan};
  return select(a.nan | b.nan, Range<F>{b.lo, larger.hi, b.nan}, larger);
}

namespace detail {

/// x (1 - a) + y a for one value of a.
template <FloatLanes F>
AEROSOL_INLINE Range<F> mixAt(const Range<F>& x, const Range<F>& y, F a) {
  const Range<F> point = {a, a, IntOf<F>(0)};
  return x * (Range<F>(1.0f) - point) + y * point;
}

}  // namespace detail

/// Linear in a: extremes at its ends. The slack is for the rounding between.
template <FloatLanes F>
AEROSOL_INLINE Range<F> mix(const Range<F>& x, const Range<F>& y, const Range<F>& a) {
  Range<F> result = join(detail::mixAt(x, y, a.lo), detail::mixAt(x, y, a.hi));
  result.nan |= a.nan | detail::mayBeInfinite(x) | detail::mayBeInfinite(y) | detail::mayBeInfinite(a);
  const F factor = max(max(abs(a.lo), abs(a.hi)), F(1.0f));
  const F slack = max(max(abs(x.lo), abs(x.hi)), max(abs(y.lo), abs(y.hi))) * factor * F(5e-7f);
  const auto finite = less(slack, F(infinity));
  return {select(finite, result.lo - slack, F(-infinity)), select(finite, result.hi + slack, F(infinity)), result.nan};
}

/// Rising in x, falling in both edges.
template <FloatLanes F>
AEROSOL_INLINE Range<F> smoothstep(const Range<F>& low, const Range<F>& high, const Range<F>& x) {
  const auto ordered = less(low.hi, high.lo) & ~(low.nan | high.nan | x.nan) &
                       ~(detail::mayBeInfinite(low) | detail::mayBeInfinite(high));
  const Range<F> ends = detail::hull(smoothstep(low.hi, high.hi, x.lo), smoothstep(low.lo, high.lo, x.hi), IntOf<F>(0));
  const auto nan = low.nan | high.nan | x.nan | detail::mayBeInfinite(low) | detail::mayBeInfinite(high);
  return select(ordered, detail::capped(ends, 0.0f, 1.0f), Range<F>{F(0.0f), F(1.0f), nan});
}
template <FloatLanes F>
AEROSOL_INLINE Range<F> linearstep(const Range<F>& low, const Range<F>& high, const Range<F>& x) {
  const auto ordered = less(low.hi, high.lo) & ~(low.nan | high.nan | x.nan) &
                       ~(detail::mayBeInfinite(low) | detail::mayBeInfinite(high));
  const Range<F> ends = detail::hull(linearstep(low.hi, high.hi, x.lo), linearstep(low.lo, high.lo, x.hi), IntOf<F>(0));
  const auto nan = low.nan | high.nan | x.nan | detail::mayBeInfinite(low) | detail::mayBeInfinite(high);
  return select(ordered, detail::capped(ends, 0.0f, 1.0f), Range<F>{F(0.0f), F(1.0f), nan});
}

namespace detail {

/// Is a's quotient by one b the same whole number at both ends, and so between them? Then a remainder rises with a.
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> withinOnePeriod(const Range<F>& b, F quotientAtLo, F quotientAtHi) {
  return equal(b.lo, b.hi) & equal(quotientAtLo, quotientAtHi) & less(abs(quotientAtLo), F(infinity));
}
/// What rounding the quotient and its product with b may add to a remainder of a: also where the quotient is so small
/// that it becomes 0, and a negative a stays what it is.
template <FloatLanes F>
AEROSOL_INLINE F remainderSlack(const Range<F>& a, F largestDivisor) {
  const F largest = max(abs(a.lo), abs(a.hi));
  return select(less(largest, F(1e38f)), largest * F(5e-7f) + largestDivisor * F(1e-44f), F(infinity));
}

}  // namespace detail

/// Sign of a, magnitude below both, but for rounding.
template <FloatLanes F>
AEROSOL_INLINE Range<F> fmod(const Range<F>& a, const Range<F>& b) {
  using I = IntOf<F>;
  const I nan = a.nan | b.nan | detail::mayBeInfinite(a) | detail::mayBeInfinite(b);
  const I within = detail::withinOnePeriod(b, trunc(a.lo / b.lo), trunc(a.hi / b.lo)) & ~nan;
  const F divisor = abs(b).hi;
  const F slack = detail::remainderSlack(a, divisor);
  const Range<F> any = {max(min(a.lo, F(0.0f)), -divisor) - slack, min(max(a.hi, F(0.0f)), divisor) + slack, nan};
  return select(within, Range<F>{fmod(a.lo, b.lo), fmod(a.hi, b.lo), nan}, any);
}
/// Sign of b, magnitude below it, but for rounding; a itself where the quotient is not finite.
template <FloatLanes F>
AEROSOL_INLINE Range<F> mod(const Range<F>& a, const Range<F>& b) {
  using I = IntOf<F>;
  const I nan = a.nan | b.nan | detail::mayBeInfinite(b);
  const I within = detail::withinOnePeriod(b, floor(a.lo / b.lo), floor(a.hi / b.lo)) & ~nan;
  const Range<F> divisor = abs(b);
  const F slack = detail::remainderSlack(a, divisor.hi);
  Range<F> any = {min(b.lo, F(0.0f)) - slack, max(b.hi, F(0.0f)) + slack, nan};
  const F largest = max(abs(a.lo), abs(a.hi));
  any = select(less(largest / divisor.lo, F(infinity)), any, join(any, a));
  any.nan = nan;
  return select(within, Range<F>{mod(a.lo, b.lo), mod(a.hi, b.lo), nan}, any);
}

template <FloatLanes F>
AEROSOL_INLINE IntRange<IntOf<F>> isNotANumber(const Range<F>& x) {
  return {IntOf<F>(0), x.nan & IntOf<F>(1)};
}
template <FloatLanes F>
AEROSOL_INLINE IntRange<IntOf<F>> isInfinite(const Range<F>& x) {
  using I = IntOf<F>;
  const I surely = equal(x.lo, x.hi) & detail::mayBeInfinite(x) & ~x.nan;
  return {surely & I(1), detail::mayBeInfinite(x) & I(1)};
}
template <FloatLanes F>
AEROSOL_INLINE IntRange<IntOf<F>> isFinite(const Range<F>& x) {
  using I = IntOf<F>;
  const I surelyNot = equal(x.lo, x.hi) & detail::mayBeInfinite(x);
  return {~(detail::mayBeInfinite(x) | x.nan) & I(1), ~surelyNot & I(1)};
}

template <IntLanes I>
AEROSOL_INLINE IntRange<I> abs(const IntRange<I>& x) {
  const I crosses = lessEqual(x.lo, I(0)) & greaterEqual(x.hi, I(0));
  const I wraps = equal(x.lo, I(detail::leastInt));
  const I p = abs(x.lo);
  const I q = abs(x.hi);
  const IntRange<I> plain = {select(crosses, I(0), min(p, q)), max(p, q)};
  return select(wraps, wholeIntRange<I>(), plain);
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> min(const IntRange<I>& a, const IntRange<I>& b) {
  return {min(a.lo, b.lo), min(a.hi, b.hi)};
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> max(const IntRange<I>& a, const IntRange<I>& b) {
  return {max(a.lo, b.lo), max(a.hi, b.hi)};
}
/// Sign of b; a itself where 0 <= a < b surely.
template <IntLanes I>
AEROSOL_INLINE IntRange<I> mod(const IntRange<I>& a, const IntRange<I>& b) {
  const I inside = greaterEqual(a.lo, I(0)) & less(a.hi, b.lo);
  const IntRange<I> any = {min(select(less(b.lo, I(0)), wrapAdd(b.lo, I(1)), I(0)), I(0)),
                           max(wrapSub(max(b.hi, I(1)), I(1)), I(0))};
  return select(inside, a, any);
}

}  // namespace aerosol::jit::runtime
