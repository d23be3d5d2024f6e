// Rounding, remainders, choice and interpolation. Written over any number type where the comparisons and `select` of
// that type are enough, over lanes where bits or exact steps matter.
#pragma once

#include "core/jit/runtime/wide.h"

namespace aerosol::jit::runtime {

template <FloatLanes F>
AEROSOL_INLINE F square(F x) {
  return x * x;
}

/// 0 for x <= 0.
template <FloatLanes F>
AEROSOL_INLINE F sqrt(F x) {
  return select(lessEqual(x, F(0.0f)), F(0.0f), rawSqrt(x));
}
/// 0 for x <= 0.
template <FloatLanes F>
AEROSOL_INLINE F inversesqrt(F x) {
  return select(lessEqual(x, F(0.0f)), F(0.0f), F(1.0f) / rawSqrt(x));
}
/// a / b, 0 where b is 0.
template <FloatLanes F>
AEROSOL_INLINE F safeDivide(F a, F b) {
  return select(equal(b, F(0.0f)), F(0.0f), a / b);
}

/// 1, 0 or -1.
template <FloatLanes F>
AEROSOL_INLINE F sign(F x) {
  return select(less(x, F(0.0f)), F(-1.0f), select(greater(x, F(0.0f)), F(1.0f), F(0.0f)));
}

/// Halves are rounded away from 0. (The largest float below 1/2 is added, so that nothing just below a half goes up.)
template <FloatLanes F>
AEROSOL_INLINE F round(F x) {
  return trunc(x + copySign(F(0.499999970f), x));
}

namespace detail {

/// What is left of `rest` below the divisor, by steps that each take 23 bits off the quotient: for large quotients.
template <FloatLanes F>
AEROSOL_INLINE F longRemainder(F rest, F divisor) {
  using I = IntOf<F>;
  while (any(greaterEqual(rest, divisor) & notEqual(rest, F(0.0f)))) {
    // A multiple of b by a power of two where the quotient would overflow.
    const float step = 1.2676506002282294e30f;  // 2^100
    F unit = divisor;
    unit = select(greaterEqual(rest, unit * F(step)), unit * F(step), unit);
    unit = select(greaterEqual(rest, unit * F(step)), unit * F(step), unit);
    const F quotient = trunc(rest / unit);
    // The rounded quotient may be too large by half a unit in its last place: then the integer below it is right.
    const F lower = trunc(asFloat(asInt(quotient) - I(1)));
    const F first = fma(-quotient, unit, rest);
    const F next = select(less(first, F(0.0f)), fma(-lower, unit, rest), first);
    rest = select(greaterEqual(rest, divisor), next, rest);
  }
  return rest;
}

}  // namespace detail

/// The exact remainder of a / b truncated, with the sign of a; 0 where b is 0; NaN for an infinite a.
template <FloatLanes F>
AEROSOL_INLINE F fmod(F a, F b) {
  using I = IntOf<F>;
  const F divisor = abs(b);
  const I bad = equal(divisor, F(0.0f)) | ~less(abs(a), F(infinity)) | isNan(b);
  const F dividend = select(bad, F(0.0f), abs(a));
  const F quotient = trunc(dividend / divisor);
  // A quotient that was rounded up is one too large; what is left is then a multiple of b's last place, and exact too.
  const F first = fma(-quotient, divisor, dividend);
  F rest = select(less(first, F(0.0f)), first + divisor, first);
  const I isLarge = (~less(quotient, F(4194304.0f)) | equal(divisor, F(infinity))) & ~bad;
  if (any(isLarge)) [[unlikely]]
    rest = select(isLarge, detail::longRemainder(select(isLarge, dividend, F(0.0f)), divisor), rest);
  const F result = copySign(rest, a);
  const I isNumber = less(abs(a), F(infinity)) & ~isNan(b);
  return select(equal(b, F(0.0f)), F(0.0f), select(isNumber, result, F(notANumber)));
}

/// a - b floor(a / b), exactly: with the sign of b, or 0; a where b is 0.
template <FloatLanes F>
AEROSOL_INLINE F mod(F a, F b) {
  using I = IntOf<F>;
  const F rest = fmod(a, b);
  const I differs = less(asInt(rest) ^ asInt(b), I(0)) & notEqual(rest, F(0.0f));
  return select(equal(b, F(0.0f)), a, select(differs, rest + b, rest));
}
template <IntLanes I>
AEROSOL_INLINE I mod(I a, I b) {
  const I rest = remainder(a, b);
  const I differs = less(rest ^ b, I(0)) & notEqual(rest, I(0));
  return select(differs, wrapAdd(rest, b), rest);
}

template <IntLanes I>
AEROSOL_INLINE I abs(I x) {
  return select(less(x, I(0)), wrapNegate(x), x);
}
template <IntLanes I>
AEROSOL_INLINE I min(I a, I b) {
  return select(less(a, b), a, b);
}
template <IntLanes I>
AEROSOL_INLINE I max(I a, I b) {
  return select(less(b, a), a, b);
}

/// max(min(x, high), low).
template <class T>
AEROSOL_INLINE T clamp(T x, T low, T high) {
  return max(min(x, high), low);
}

/// x (1 - a) + y a.
template <FloatLanes F>
AEROSOL_INLINE F mix(F x, F y, F a) {
  return x * (F(1.0f) - a) + y * a;
}

/// 0 where x < edge, else 1.
template <class F>
AEROSOL_INLINE F step(F edge, F x) {
  return select(less(x, edge), F(0.0f), F(1.0f));
}

/// 0 to 1 between low and high by 3 t^2 - 2 t^3; step(low, x) where high <= low, as what lies below low comes first.
template <FloatLanes F>
AEROSOL_INLINE F smoothstep(F low, F high, F x) {
  const F t = safeDivide(x - low, high - low);
  const F inside = fma(t, F(-2.0f), F(3.0f)) * (t * t);
  return select(less(x, low), F(0.0f), select(greaterEqual(x, high), F(1.0f), inside));
}

/// 0 to 1 between low and high by a line; step(low, x) where they are equal.
template <FloatLanes F>
AEROSOL_INLINE F linearstep(F low, F high, F x) {
  const F t = safeDivide(clamp(x, low, high) - low, high - low);
  return select(equal(low, high), step(low, x), t);
}

template <class F>
AEROSOL_INLINE F degrees(F x) {
  return x * F(57.2957795f);
}
template <class F>
AEROSOL_INLINE F radians(F x) {
  return x * F(0.0174532925f);
}

/// Square root of the sum of squares.
template <class F>
AEROSOL_INLINE F hypot(F x, F y) {
  return sqrt(square(x) + square(y));
}
template <class F>
AEROSOL_INLINE F hypot(F x, F y, F z) {
  return sqrt(square(x) + square(y) + square(z));
}

/// 1 or 0.
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> isInfinite(F x) {
  return equal(abs(x), F(infinity)) & IntOf<F>(1);
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> isFinite(F x) {
  return less(abs(x), F(infinity)) & IntOf<F>(1);
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> isNotANumber(F x) {
  return isNan(x) & IntOf<F>(1);
}

}  // namespace aerosol::jit::runtime
