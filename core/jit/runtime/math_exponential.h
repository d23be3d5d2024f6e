// Exponentials, logarithms and powers of lanes, without tables: Cody–Waite reduction and minimax polynomials (Remez
// fits of this project). Domain errors follow Open Shading Language: logarithms see arguments clamped to the normal
// floats, powers that are undefined give 0.
#pragma once

#include "core/jit/runtime/processor.h"

namespace aerosol::jit::runtime {

namespace detail {

/// 2^n for n in [-126, 127].
template <IntLanes I>
AEROSOL_INLINE FloatOf<I> powerOfTwo(I n) {
  return asFloat(shiftLeft(n + I(127), 23));
}

/// p 2^n for n in [-252, 254], rounded once where the result is denormal.
template <FloatLanes F>
AEROSOL_INLINE F scaleByPowerOfTwo(F p, IntOf<F> n) {
  using I = IntOf<F>;
  const I half = n >> I(1);
  return p * powerOfTwo(half) * powerOfTwo(n - half);
}

/// The same where n is a whole float: one instruction where the processor has it, with the same bits.
template <FloatLanes F>
AEROSOL_INLINE F scaleByPowerOfTwo(F p, F n) {
#if defined(AEROSOL_RUNTIME_AVX512_ATTRIBUTES)
  if constexpr (widthOf<F> == 16) {
    if (processorHasAvx512()) {
      typedef float V __attribute__((vector_size(64)));
      return __builtin_bit_cast(
          F, __builtin_ia32_scalefps512_mask(__builtin_bit_cast(V, p), __builtin_bit_cast(V, n), V{}, 0xffff, 4));
    }
  }
#endif
  return scaleByPowerOfTwo(p, convertTruncating(n));
}

/// e^x = m 2^n with m in about [0.7, 1.42], for |x| < 1000.
template <FloatLanes F>
struct Exponential {
  F mantissa;
  F exponent;
};

template <FloatLanes F>
AEROSOL_INLINE Exponential<F> splitExponential(F x) {
  const F n = roundEven(x * F(1.44269502f));
  F r = fma(-n, F(0.693147182f), x);
  r = fma(-n, F(-1.90465421e-09f), r);
  F p = F(0.00139414263f);
  p = fma(p, r, F(0.00836335495f));
  p = fma(p, r, F(0.0416663736f));
  p = fma(p, r, F(0.166665763f));
  p = fma(p, r, F(0.5f));
  p = fma(r * r, p, r) + F(1.0f);
  return {p, n};
}

/// 2^x - 1 over x in [-0.505, 0.505], times x.
template <FloatLanes F>
AEROSOL_INLINE F exp2Fraction(F r) {
  F p = F(0.000154710971f);
  p = fma(p, r, F(0.00133920205f));
  p = fma(p, r, F(0.00961802714f));
  p = fma(p, r, F(0.0555035509f));
  p = fma(p, r, F(0.240226507f));
  p = fma(p, r, F(0.693147182f));
  return fma(p, r, F(1.0f));
}

/// x = (1 + f) 2^e with 1 + f in [sqrt(1/2), sqrt(2)); x positive, finite and normal.
template <FloatLanes F>
struct Decomposed {
  F fraction;
  F exponent;
};

template <FloatLanes F>
AEROSOL_INLINE Decomposed<F> decompose(F x) {
  using I = IntOf<F>;
  const I bits = asInt(x) - I(0x3f3504f3);
  const I e = bits >> I(23);
  const F m = asFloat(asInt(x) - shiftLeft(e, 23));
  return {m - F(1.0f), toFloat(e)};
}

/// log(1 + f) - f for f in [sqrt(1/2) - 1, sqrt(2) - 1].
template <FloatLanes F>
AEROSOL_INLINE F logarithmTail(F f) {
  F p = F(0.0733244941f);
  p = fma(p, f, F(-0.116598822f));
  p = fma(p, f, F(0.116346709f));
  p = fma(p, f, F(-0.123967081f));
  p = fma(p, f, F(0.142511562f));
  p = fma(p, f, F(-0.166691512f));
  p = fma(p, f, F(0.200006887f));
  p = fma(p, f, F(-0.249999806f));
  p = fma(p, f, F(0.333333313f));
  const F square = f * f;
  return fma(square * f, p, F(-0.5f) * square);
}

/// To the range where logarithms are defined; NaN stays.
template <FloatLanes F>
AEROSOL_INLINE F clampToNormal(F x) {
  const F low = select(less(x, F(smallestNormal)), F(smallestNormal), x);
  return select(greater(low, F(largestFloat)), F(largestFloat), low);
}

/// log(x) / log(b), where scale = 1 / log(b) as a sum of two floats and unit = log(2) / log(b) as a sum of two.
template <FloatLanes F>
AEROSOL_INLINE F scaledLogarithm(F x, float scale, float scaleLow, float unit, float unitLow) {
  const F clamped = clampToNormal(x);
  const Decomposed<F> d = decompose(clamped);
  const F f = d.fraction;
  F low = logarithmTail(f) * F(scale);
  low = fma(f, F(scaleLow), low);
  low = fma(d.exponent, F(unitLow), low);
  // The larger one of the two main terms first, so that its rounding is the last but one.
  const F main = d.exponent * F(unit);
  const F high = fma(f, F(scale), main);
  const F error = fma(f, F(scale), main - high);
  const F result = high + (low + error);
  return select(isNan(x), x, result);
}

}  // namespace detail

/// e^x. Overflows to infinity. (The order of what is clamped lets NaN through.)
template <FloatLanes F>
AEROSOL_INLINE F exp(F x) {
  const auto e = detail::splitExponential(max(F(-104.0f), min(F(89.0f), x)));
  return detail::scaleByPowerOfTwo(e.mantissa, e.exponent);
}

/// 2^x. Overflows to infinity.
template <FloatLanes F>
AEROSOL_INLINE F exp2(F x) {
  const F clamped = max(F(-151.0f), min(F(129.0f), x));
  const F n = roundEven(clamped);
  return detail::scaleByPowerOfTwo(detail::exp2Fraction(clamped - n), n);
}

/// e^x - 1, accurate near 0.
template <FloatLanes F>
AEROSOL_INLINE F expm1(F x) {
  const F clamped = max(min(x, F(89.0f)), F(-30.0f));
  const F n = roundEven(clamped * F(1.44269502f));
  F r = fma(-n, F(0.693147182f), clamped);
  r = fma(-n, F(-1.90465421e-09f), r);
  F p = F(0.000199080081f);
  p = fma(p, r, F(0.00139339117f));
  p = fma(p, r, F(0.00833328534f));
  p = fma(p, r, F(0.041666463f));
  p = fma(p, r, F(0.166666672f));
  p = fma(p, r, F(0.5f));
  p = fma(r * r, p, r);
  // 2^n (1 + p) - 1, with half the power for 2^128.
  const F half = detail::powerOfTwo(toIntUnchecked(n) - IntOf<F>(1));
  const F result = fma(p, half, half - F(0.5f)) * F(2.0f);
  return select(isNan(x) | equal(x, F(0.0f)), x, result);
}

/// Natural logarithm of x clamped to the positive normal floats.
template <FloatLanes F>
AEROSOL_INLINE F log(F x) {
  return detail::scaledLogarithm(x, 1.0f, 0.0f, 0.693147182f, -1.90465421e-09f);
}

/// Logarithm to base 2 of x clamped to the positive normal floats.
template <FloatLanes F>
AEROSOL_INLINE F log2(F x) {
  return detail::scaledLogarithm(x, 1.44269502f, 1.92596303e-08f, 1.0f, 0.0f);
}

/// Logarithm to base 10 of x clamped to the positive normal floats.
template <FloatLanes F>
AEROSOL_INLINE F log10(F x) {
  return detail::scaledLogarithm(x, 0.434294492f, -1.010305e-08f, 0.30103001f, -1.43209888e-08f);
}

/// The exponent of x, floor(log2(|x|)), where x is taken to the normal floats: -126 for 0, 127 for an infinite one.
template <FloatLanes F>
AEROSOL_INLINE F logb(F x) {
  using I = IntOf<F>;
  const F magnitude = min(max(abs(x), F(smallestNormal)), F(largestFloat));
  return select(isNan(x), x, toFloat((asInt(magnitude) >> I(23)) - I(127)));
}

/// x^y by the language's rules: x^0 = 1; 0^y = 0 for y other than 0; 0 for x < 0 with y no integer; never infinite: the
/// result is clamped to the finite floats. The logarithm is kept in two floats (relative error below 2^-30), so that
/// large exponents cost no accuracy.
template <FloatLanes F>
AEROSOL_INLINE F pow(F x, F y) {
  using I = IntOf<F>;
  const F magnitude = abs(x);
  const I tiny = less(magnitude, F(smallestNormal));
  const F normal = min(select(tiny, magnitude * F(16777216.0f), magnitude), F(largestFloat));
  const auto d = detail::decompose(normal);
  const F e = d.exponent - select(tiny, F(24.0f), F(0.0f));
  // log2(1 + f) = 2 / ln 2 * atanh(s), s = f / (2 + f), as sHigh + sLow.
  const F f = d.fraction;
  const F divisor = f + F(2.0f);
  const F divisorLow = f - (divisor - F(2.0f));
  const F sHigh = f / divisor;
  const F sLow = fma(-sHigh, divisorLow, fma(-sHigh, divisor, f)) / divisor;
  const F z = sHigh * sHigh;
  F q = F(0.117981635f);
  q = fma(q, z, F(0.142683014f));
  q = fma(q, z, F(0.200001732f));
  q = fma(q, z, F(0.333333313f));
  const F low = fma(sHigh * z, q, sLow);
  const F arctangent = sHigh + low;
  const F arctangentLow = (sHigh - arctangent) + low;
  const F scale = F(2.88539004f);
  const F product = arctangent * scale;
  const F productLow = fma(arctangent, scale, -product) + fma(arctangentLow, scale, arctangent * F(3.85192607e-08f));
  const F logarithm = e + product;
  const F logarithmLow = (product - (logarithm - e)) + productLow;
  // 2^(y logarithm)
  const F finiteY = max(min(y, F(largestFloat)), F(-largestFloat));
  const F exactY = fma(finiteY, logarithm, F(0.0f));
  const F t = max(min(exactY, F(300.0f)), F(-300.0f));
  const F n = max(min(roundEven(t), F(160.0f)), F(-160.0f));
  const F tLow = fma(finiteY, logarithm, -exactY) + finiteY * logarithmLow;
  const I inRange = less(abs(exactY), F(155.0f));
  const F r = (t - n) + select(inRange, tLow, F(0.0f));
  const F p = detail::exp2Fraction(max(min(r, F(0.51f)), F(-0.51f)));
  F result = min(detail::scaleByPowerOfTwo(p, n), F(largestFloat));
  // Signs and the undefined.
  const I isInteger = equal(y, floor(y));
  const F halfY = y * F(0.5f);
  const I isOdd = isInteger & notEqual(halfY, floor(halfY));
  const I negative = less(x, F(0.0f));
  result = select(negative & isOdd, -result, result);
  result = select(negative & ~isInteger, F(0.0f), result);
  const F endless = select(greater(y, F(0.0f)), F(largestFloat), F(0.0f));
  result = select(equal(magnitude, F(infinity)), select(negative & isOdd, -endless, endless), result);
  result = select(equal(x, F(0.0f)), F(0.0f), result);
  result = select(isNan(x) | isNan(y), F(notANumber), result);
  return select(equal(y, F(0.0f)), F(1.0f), result);
}

/// Logarithm to base b: log(x) / log(b), 0 for base 1.
template <FloatLanes F>
AEROSOL_INLINE F logBase(F x, F b) {
  const F divisor = log(b);
  return select(equal(divisor, F(0.0f)), F(0.0f), log(x) / divisor);
}

/// Hyperbolic sine.
template <FloatLanes F>
AEROSOL_INLINE F sinh(F x) {
  const F magnitude = abs(x);
  const F z = x * x;
  F p = F(2.81743928e-06f);
  p = fma(p, z, F(0.000198360663f));
  p = fma(p, z, F(0.00833335053f));
  p = fma(p, z, F(0.166666672f));
  const F small = fma(x * z, p, x);
  const auto e = detail::splitExponential(min(magnitude, F(90.0f)));
  const F half = detail::scaleByPowerOfTwo(e.mantissa, e.exponent - F(1.0f));
  const F large = copySign(half - F(0.25f) / half, x);
  return select(less(magnitude, F(1.0f)), small, select(isNan(x), x, large));
}

/// Hyperbolic cosine.
template <FloatLanes F>
AEROSOL_INLINE F cosh(F x) {
  const auto e = detail::splitExponential(min(abs(x), F(90.0f)));
  const F half = detail::scaleByPowerOfTwo(e.mantissa, e.exponent - F(1.0f));
  return select(isNan(x), x, half + F(0.25f) / half);
}

/// Hyperbolic tangent.
template <FloatLanes F>
AEROSOL_INLINE F tanh(F x) {
  const F magnitude = abs(x);
  const F z = x * x;
  F p = F(0.00214753789f);
  p = fma(p, z, F(-0.00818267372f));
  p = fma(p, z, F(0.0217029657f));
  p = fma(p, z, F(-0.0539472029f));
  p = fma(p, z, F(0.133332103f));
  p = fma(p, z, F(-0.333333313f));
  const F small = fma(x * z, p, x);
  const auto e = detail::splitExponential(min(magnitude, F(20.0f)) * F(2.0f));
  const F power = detail::scaleByPowerOfTwo(e.mantissa, e.exponent);
  const F large = copySign(F(1.0f) - F(2.0f) / (power + F(1.0f)), x);
  return select(less(magnitude, F(0.625f)), small, select(isNan(x), x, large));
}

}  // namespace aerosol::jit::runtime
