// Cube root and error functions of lanes.
#pragma once

#include "core/jit/runtime/math_exponential.h"

namespace aerosol::jit::runtime {

/// Cube root, of the sign of x: a third of the exponent as first guess (Kahan), two steps of Halley, one of Newton with
/// the exact residual.
template <FloatLanes F>
AEROSOL_INLINE F cbrt(F x) {
  using I = IntOf<F>;
  const F magnitude = abs(x);
  const I tiny = less(magnitude, F(smallestNormal));
  const I huge = greater(magnitude, F(1e37f));
  const F scale = select(tiny, F(16777216.0f), select(huge, F(5.96046448e-08f), F(1.0f)));  // 2^24, 2^-24
  const F a = magnitude * scale;
  const I guess = toIntUnchecked(toFloat(asInt(a)) * F(0.333333333f)) + I(0x2a5137a0);
  F y = asFloat(guess);
  for (int step = 0; step < 2; ++step) {
    const F cube = y * y * y;
    y = y * ((cube + (a + a)) / ((cube + cube) + a));
  }
  const F square = y * y;
  const F squareLow = fma(y, y, -square);
  const F residual = fma(square, y, -a) + squareLow * y;
  y = y - residual / (square * F(3.0f));
  y = y * select(tiny, F(0.00390625f), select(huge, F(256.0f), F(1.0f)));
  const I plain = greater(magnitude, F(0.0f)) & less(magnitude, F(infinity));
  return select(plain, copySign(y, x), x);
}

namespace detail {

/// erf(x) for |x| <= 1.
template <FloatLanes F>
AEROSOL_INLINE F errorFunctionSmall(F x) {
  const F z = x * x;
  F p = F(7.85384545e-05f);
  p = fma(p, z, F(-0.000801018847f));
  p = fma(p, z, F(0.00518832728f));
  p = fma(p, z, F(-0.026853811f));
  p = fma(p, z, F(0.112835854f));
  p = fma(p, z, F(-0.37612626f));
  p = fma(p, z, F(0.128379113f));
  return fma(x, p, x);
}

/// erfc(x) for x >= 0.45, as e^(-x x) times a polynomial in 1 / (1 + x/2); the square in two floats.
template <FloatLanes F>
AEROSOL_INLINE F complementaryErrorLarge(F x) {
  const F a = min(x, F(10.2f));
  const F divisor = fma(a, F(0.5f), F(1.0f));
  const F divisorLow = fma(a, F(0.5f), F(1.0f) - divisor);
  const F t = F(1.0f) / divisor;
  const F tError = fma(-t, divisorLow, fma(-t, divisor, F(1.0f)));  // relative
  F p = F(0.0611626804f);
  p = fma(p, t, F(-0.321430057f));
  p = fma(p, t, F(0.674846232f));
  p = fma(p, t, F(-0.669773698f));
  p = fma(p, t, F(0.291372597f));
  p = fma(p, t, F(-0.135815263f));
  p = fma(p, t, F(0.117555305f));
  p = fma(p, t, F(0.170451283f));
  p = fma(p, t, F(0.247486249f));
  p = fma(p, t, F(0.282052517f));
  p = fma(p, t, F(0.282095999f));
  const F square = a * a;
  const F squareLow = fma(a, a, -square);
  const auto e = splitExponential(-square);
  const F tail = p * t;
  return scaleByPowerOfTwo(e.mantissa * fma(tail, tError - squareLow, tail), e.exponent);
}

}  // namespace detail

/// Error function.
template <FloatLanes F>
AEROSOL_INLINE F erf(F x) {
  const F a = abs(x);
  const F large = copySign(F(1.0f) - detail::complementaryErrorLarge(max(a, F(1.0f))), x);
  return select(less(a, F(1.0f)), detail::errorFunctionSmall(x), select(isNan(x), x, large));
}

/// 1 - erf(x).
template <FloatLanes F>
AEROSOL_INLINE F erfc(F x) {
  const F a = abs(x);
  const F large = detail::complementaryErrorLarge(max(a, F(0.45f)));
  const F small = F(1.0f) - detail::errorFunctionSmall(min(max(x, F(-1.0f)), F(0.45f)));
  const F result = select(less(a, F(0.45f)), small, select(less(x, F(0.0f)), F(2.0f) - large, large));
  return select(isNan(x), x, result);
}

}  // namespace aerosol::jit::runtime
