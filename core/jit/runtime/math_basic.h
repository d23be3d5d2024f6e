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

// Remainders are the language's formulas, each step rounded, and not the exact ones: of 0.5 by 0.1, which is a little
// above a tenth, 0 is left.

/// a - b trunc(a / b); 0 where b is 0 or the quotient is beyond all floats.
template <FloatLanes F>
AEROSOL_INLINE F fmod(F a, F b) {
  const F quotient = a / b;
  const auto none = equal(b, F(0.0f)) | (equal(abs(quotient), F(infinity)) & less(abs(a), F(infinity)));
  return select(none, F(0.0f), a - b * trunc(quotient));
}

/// a - b floor(a / b); a where the quotient is not finite, as a division that fails gives 0.
template <FloatLanes F>
AEROSOL_INLINE F mod(F a, F b) {
  const F quotient = a / b;
  return a - b * select(less(abs(quotient), F(infinity)), floor(quotient), F(0.0f));
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
