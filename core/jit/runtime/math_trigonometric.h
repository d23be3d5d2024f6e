// Trigonometric functions of lanes. Arguments below 2^17 in magnitude are reduced by pi/2 in three floats with fused
// multiply-adds (Cody and Waite 1980). Larger ones, when any lane has one, are reduced by the product with just those
// bits of 2/pi that matter (Payne and Hanek 1983), in integers. So all finite arguments keep the accuracy of small
// ones; infinite ones give NaN.
#pragma once

#include "core/jit/runtime/processor.h"

namespace aerosol::jit::runtime {

namespace detail {

/// x = remainder + quadrant pi/2, remainder in about [-pi/4, pi/4]. Quadrants count modulo 4.
template <FloatLanes F>
struct ReducedAngle {
  F remainder;
  IntOf<F> quadrant;
};

inline constexpr float largestSimpleAngle = 131072.0f;

/// For 2^17 <= |x| < infinity. With x = m 2^(e - 23), m an integer, only the digits of 2/pi from bit e - 25 on count
/// modulo 4 (earlier ones give whole turns), and 96 of them are enough for a float's nearest approach to a multiple.
template <FloatLanes F>
AEROSOL_INLINE ReducedAngle<F> reduceLargeAngle(F x) {
  using I = IntOf<F>;
  using U = UintOf<F>;
  using Long = Wide<std::uint64_t, widthOf<F>>;
  using SignedLong = Wide<std::int64_t, widthOf<F>>;
  // 2/pi in 32-bit digits after the point, with one zero digit before so that the first bit is never negative.
  constexpr std::uint32_t digits[8] = {0u,          0xa2f9836eu, 0x4e441529u, 0xfc2757d1u,
                                       0xf534ddc0u, 0xdb629599u, 0x3c439041u, 0xfe5163abu};
  const U bits = asUint(abs(x));
  const U mantissa = (bits & U(0x7fffffu)) | U(0x800000u);
  const I exponent = asInt(bits >> U(23u)) - I(127);
  const I start = exponent + I(7);  // e - 25 + 32, in [24, 134]
  const I word = start >> I(5);
  const U shift = asUint(start & I(31));
  const auto digit = [&](int offset) __attribute__((always_inline)) {
    U value = U(digits[offset]);
    value = select(equal(word, I(1)), U(digits[offset + 1]), value);
    value = select(equal(word, I(2)), U(digits[offset + 2]), value);
    value = select(equal(word, I(3)), U(digits[offset + 3]), value);
    return select(greater(word, I(3)), U(digits[offset + 4]), value);
  };
  const U d0 = digit(0);
  const U d1 = digit(1);
  const U d2 = digit(2);
  const U d3 = digit(3);
  const auto window = [&](U high, U low) __attribute__((always_inline)) {
    return (high << shift) | ((low >> U(1u)) >> (U(31u) - shift));
  };
  const auto toLong = [](U value) __attribute__((always_inline)) {
    if constexpr (widthOf<F> == 1) {
      return static_cast<std::uint64_t>(value);
    } else {
      return __builtin_convertvector(value, Long);
    }
  };
  const Long m = toLong(mantissa);
  const Long turns = ((m * toLong(window(d0, d1))) << Long(32u)) + m * toLong(window(d1, d2)) +
                     ((m * toLong(window(d2, d3))) >> Long(32u));
  const Long nearest = (turns + (Long(1u) << Long(61u))) >> Long(62u);
  const SignedLong rest = __builtin_bit_cast(SignedLong, turns - (nearest << Long(62u)));
  F remainder;
  I quadrant;
  if constexpr (widthOf<F> == 1) {
    remainder = static_cast<float>(rest);
    quadrant = static_cast<std::int32_t>(nearest);
  } else {
    remainder = __builtin_convertvector(rest, F);
    quadrant = __builtin_convertvector(nearest, I);
  }
  const float unit = 1.0f / 4611686018427387904.0f;  // 2^-62
  remainder = fma(remainder, F(1.57079637f * unit), remainder * F(-4.37113883e-08f * unit));
  const I negative = less(x, F(0.0f));
  return {select(negative, -remainder, remainder), select(negative, -quadrant, quadrant)};
}

template <FloatLanes F>
AEROSOL_INLINE ReducedAngle<F> reduceAngle(F x) {
  using I = IntOf<F>;
  const I simple = less(abs(x), F(largestSimpleAngle));
  const F n = roundEven(x * F(0.636619747f));
  F r = fma(-n, F(1.57079637f), x);
  r = fma(-n, F(-4.37113883e-08f), r);
  r = fma(-n, F(-1.71512451e-15f), r);
  ReducedAngle<F> reduced{r, convertTruncating(n)};
  if (any(~simple)) [[unlikely]] {
    const I finite = less(abs(x), F(infinity));
    const auto large = reduceLargeAngle(select(finite & ~simple, x, F(largestSimpleAngle)));
    reduced.remainder = select(simple, reduced.remainder, select(finite, large.remainder, F(notANumber)));
    reduced.quadrant = select(simple, reduced.quadrant, large.quadrant);
  }
  return reduced;
}

template <FloatLanes F>
AEROSOL_INLINE F sinePolynomial(F r, F z) {
  F p = F(-0.000195108412f);
  p = fma(p, z, F(0.00833213143f));
  p = fma(p, z, F(-0.166666538f));
  return fma(r * z, p, r);
}
template <FloatLanes F>
AEROSOL_INLINE F cosinePolynomial(F z) {
  F p = F(2.44312087e-05f);
  p = fma(p, z, F(-0.0013887306f));
  p = fma(p, z, F(0.0416666456f));
  return fma(z * z, p, fma(z, F(-0.5f), F(1.0f)));
}

/// The sine (shift 0) or cosine (shift 1) from both polynomials.
template <FloatLanes F>
AEROSOL_INLINE F pickQuadrant(F sine, F cosine, IntOf<F> quadrant) {
  using I = IntOf<F>;
  const F value = select(equal(quadrant & I(1), I(0)), sine, cosine);
  return asFloat(asInt(value) ^ shiftLeft(quadrant & I(2), 30));
}

template <FloatLanes F>
struct SineCosine {
  F sine;
  F cosine;
};

template <FloatLanes F>
AEROSOL_INLINE SineCosine<F> sineCosine(F x) {
  const auto a = reduceAngle(x);
  const F z = a.remainder * a.remainder;
  const F s = sinePolynomial(a.remainder, z);
  const F c = cosinePolynomial(z);
  return {pickQuadrant(s, c, a.quadrant), pickQuadrant(s, c, a.quadrant + IntOf<F>(1))};
}

/// (arcsin(s) - s) / s for s in [0, 1/2] with z = s s.
template <FloatLanes F>
AEROSOL_INLINE F arcSineTail(F z) {
  F p = F(0.0375651084f);
  p = fma(p, z, F(0.0144026624f));
  p = fma(p, z, F(0.0318176001f));
  p = fma(p, z, F(0.0445157215f));
  p = fma(p, z, F(0.0750051066f));
  p = fma(p, z, F(0.166666597f));
  return p * z;
}

/// arctan(n / d) for 0 <= n <= d: in [0, pi/4]; 0 where both are 0.
template <FloatLanes F>
AEROSOL_INLINE F arcTangentOfRatio(F n, F d) {
  using I = IntOf<F>;
  const I both = equal(n, F(infinity));
  n = select(both, F(1.0f), n);
  d = select(both, F(1.0f), d);
  const F scale = select(greater(d, F(1e38f)), F(0.25f), F(1.0f));
  n = n * scale;
  d = d * scale;
  const I upper = greater(n, d * F(0.414213562f));
  const F numerator = select(upper, n - d, n);
  const F denominator = select(upper, n + d, d);
  const F t = select(equal(denominator, F(0.0f)), F(0.0f), numerator / denominator);
  const F z = t * t;
  F p = F(-0.0607885532f);
  p = fma(p, z, F(0.105942756f));
  p = fma(p, z, F(-0.142436281f));
  p = fma(p, z, F(0.199984789f));
  p = fma(p, z, F(-0.333333164f));
  const F tail = fma(t * z, p, select(upper, F(-2.18556941e-08f), F(0.0f)));
  return select(upper, F(0.785398185f), F(0.0f)) + (t + tail);
}

}  // namespace detail

template <FloatLanes F>
AEROSOL_INLINE F sin(F x) {
  return detail::sineCosine(x).sine;
}
template <FloatLanes F>
AEROSOL_INLINE F cos(F x) {
  return detail::sineCosine(x).cosine;
}
template <FloatLanes F>
AEROSOL_INLINE void sincos(F x, F& sine, F& cosine) {
  const auto both = detail::sineCosine(x);
  sine = both.sine;
  cosine = both.cosine;
}
template <FloatLanes F>
AEROSOL_INLINE F tan(F x) {
  using I = IntOf<F>;
  const auto a = detail::reduceAngle(x);
  const F z = a.remainder * a.remainder;
  const F s = detail::sinePolynomial(a.remainder, z);
  const F c = detail::cosinePolynomial(z);
  const I odd = notEqual(a.quadrant & I(1), I(0));
  return select(odd, -c, s) / select(odd, s, c);
}

/// Arc sine of x clamped to [-1, 1].
template <FloatLanes F>
AEROSOL_INLINE F asin(F x) {
  const F a = min(abs(x), F(1.0f));
  const IntOf<F> large = greater(a, F(0.5f));
  const F z = select(large, fma(a, F(-0.5f), F(0.5f)), a * a);
  const F s = select(large, rawSqrt(z), a);
  const F tail = s * detail::arcSineTail(z);
  const F fromEnd = fma(s, F(-2.0f), F(1.57079637f)) + fma(tail, F(-2.0f), F(-4.37113883e-08f));
  return select(isNan(x), x, copySign(select(large, fromEnd, s + tail), x));
}

/// Arc cosine of x clamped to [-1, 1].
template <FloatLanes F>
AEROSOL_INLINE F acos(F x) {
  using I = IntOf<F>;
  const F a = min(abs(x), F(1.0f));
  const I large = greater(a, F(0.5f));
  const I negative = less(x, F(0.0f));
  const F z = select(large, fma(a, F(-0.5f), F(0.5f)), a * a);
  const F s = select(large, rawSqrt(z), a);
  const F tail = s * detail::arcSineTail(z);
  const F twice = (s + tail) * F(2.0f);
  const F end = select(negative, F(3.14159274f) - (twice - F(-8.74227766e-08f)), twice);
  const F signedS = select(negative, s, -s);
  const F signedTail = select(negative, tail, -tail);
  const F middle = F(1.57079637f) + (signedS + (signedTail + F(-4.37113883e-08f)));
  return select(isNan(x), x, select(large, end, middle));
}

template <FloatLanes F>
AEROSOL_INLINE F atan(F x) {
  const F a = abs(x);
  const IntOf<F> large = greater(a, F(1.0f));
  const F angle = detail::arcTangentOfRatio(select(large, F(1.0f), a), select(large, a, F(1.0f)));
  const F whole = select(large, F(1.57079637f) - (angle - F(-4.37113883e-08f)), angle);
  return select(isNan(x), x, copySign(whole, x));
}

/// Angle of the point (x, y); 0 or pi, with the sign of y, where y is 0.
template <FloatLanes F>
AEROSOL_INLINE F atan2(F y, F x) {
  const F ax = abs(x);
  const F ay = abs(y);
  const IntOf<F> steep = greater(ay, ax);
  F angle = detail::arcTangentOfRatio(select(steep, ax, ay), select(steep, ay, ax));
  angle = select(steep, F(1.57079637f) - (angle - F(-4.37113883e-08f)), angle);
  angle = select(less(asInt(x), IntOf<F>(0)), F(3.14159274f) - (angle - F(-8.74227766e-08f)), angle);
  return select(isNan(x) | isNan(y), F(notANumber), copySign(angle, y));
}

}  // namespace aerosol::jit::runtime
