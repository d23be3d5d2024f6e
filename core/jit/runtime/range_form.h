// Ranges with a first-order form: the numbers of the range domain.
//
// A range forgets where in the box a value is taken, so a sum of octaves is bounded by the sum of their extremes
// although no point has them all. A form remembers (affine arithmetic: Comba and Stolfi 1993). For every point of the
// box, with coordinates e in [-1, 1] along its three axes, a value that is a number lies within `rest` of
//
//   centre + slope · e .
//
// Sums keep slopes exactly; a product keeps them and adds what is of second order to the rest; other functions are
// replaced by a line over the range of their argument and the greatest distance from it. Where a form says less than
// the range alone it becomes the range (`collapse`); the range is cut to what the form allows. So every function that
// has a rule for ranges has one for forms: a form is a range, and a range becomes a form without slopes.
//
// What the kernel rounds and what is rounded here goes into the rest: `roundOff` times the sum of all magnitudes, eight
// times what one operation needs. Forms that may leave the magnitudes below 1e30 collapse.
#pragma once

#include "core/jit/runtime/range_functions.h"

namespace aerosol::jit::runtime {

namespace detail {

inline constexpr float roundOff = 4.76837158e-07f;  // 2^-21
inline constexpr float largestForm = 1e30f;
/// Products that underflow are off by less.
inline constexpr float underflow = 1e-40f;

template <FloatLanes F>
struct Ends {
  F centre, half;
};

/// The middle of a range, and a half width that reaches both ends; infinite where an end is (nearly).
template <FloatLanes F>
AEROSOL_INLINE Ends<F> middleOf(const Range<F>& range) {
  const auto finite = less(max(abs(range.lo), abs(range.hi)), F(largestForm));
  const F centre = select(finite, fma(range.hi - range.lo, F(0.5f), range.lo), F(0.0f));
  const F reach = nextUp(max(range.hi - centre, centre - range.lo));
  return {centre, select(finite, select(equal(range.lo, range.hi), F(0.0f), reach), F(infinity))};
}

}  // namespace detail

template <FloatLanes F>
struct Form : Range<F> {
  F centre;
  F slope[3];
  F rest;

  Form() = default;
  AEROSOL_INLINE explicit Form(float value)
      : Range<F>(value), centre(F(value)), slope{F(0.0f), F(0.0f), F(0.0f)}, rest(F(0.0f)) {}
  /// Without slopes.
  AEROSOL_INLINE Form(const Range<F>& range) : Range<F>(range), slope{F(0.0f), F(0.0f), F(0.0f)} {
    const auto ends = detail::middleOf(range);
    centre = ends.centre;
    rest = ends.half;
  }
  AEROSOL_INLINE Form(const Range<F>& range, F c, F x, F y, F z, F r)
      : Range<F>(range), centre(c), slope{x, y, z}, rest(r) {}

  AEROSOL_INLINE const Range<F>& range() const { return *this; }
  AEROSOL_INLINE F slopes() const { return abs(slope[0]) + abs(slope[1]) + abs(slope[2]); }
};

template <FloatLanes F>
inline constexpr bool isRange<Form<F>> = true;

namespace detail {

/// A form of what lies in the range and also keeps to the line: each cuts the other, and the line is dropped where it
/// is of no use (or no number).
template <FloatLanes F>
AEROSOL_INLINE Form<F> tightened(const Range<F>& range, F centre, F x, F y, F z, F distance) {
  // Halves and products of denormal floats are rounded to 0.
  const F rest = distance + F(underflow);
  const Form<F> line = {range, centre, x, y, z, rest};
  const F radius = fma(line.slopes() + rest, F(1.0f + 4.0f * roundOff), abs(centre) * F(roundOff));
  const auto usable = less(abs(centre) + radius, F(largestForm));
  const F lo = select(usable, max(range.lo, centre - radius), range.lo);
  const F hi = select(usable, min(range.hi, centre + radius), range.hi);
  const auto overlap = lessEqual(lo, hi);
  const Range<F> cut = {select(overlap, lo, range.lo), select(overlap, hi, range.hi), range.nan};
  const Form<F> plain = cut;
  const auto keep = usable & less(rest, F(0.9f) * plain.rest);
  return {cut,
          select(keep, centre, plain.centre),
          select(keep, x, F(0.0f)),
          select(keep, y, F(0.0f)),
          select(keep, z, F(0.0f)),
          select(keep, rest, plain.rest)};
}

/// f(x) where f(t) - factor · t is known to lie within `distance` of `offset` for all t in the range of x. `error`
/// bounds what the kernel's f is off by.
template <FloatLanes F>
AEROSOL_INLINE Form<F> linearised(const Range<F>& range, const Form<F>& x, F factor, F offset, F distance, F error) {
  const F centre = factor * x.centre;
  const F magnitude = abs(centre) + abs(factor) * (x.slopes() + x.rest) + abs(offset) + distance + error;
  const F rest = fma(abs(factor), x.rest, distance + error) + fma(magnitude, F(roundOff), F(underflow));
  return tightened(range, centre + offset, factor * x.slope[0], factor * x.slope[1], factor * x.slope[2], rest);
}

/// The same from the two ends of f(t) - factor · t.
template <FloatLanes F>
AEROSOL_INLINE Form<F> linearisedWithin(const Range<F>& range, const Form<F>& x, F factor, F least, F greatest,
                                        F error) {
  return linearised(range, x, factor, F(0.5f) * (least + greatest), F(0.5f) * (greatest - least),
                    fma(abs(least) + abs(greatest), F(roundOff), error));
}

template <FloatLanes F>
AEROSOL_INLINE F invalidUnless(IntOf<F> valid, F x) {
  return select(valid, x, F(infinity));
}

/// 12 units in the last place of the largest value, as the ends of ranges are widened by.
template <FloatLanes F>
AEROSOL_INLINE F functionError(const Range<F>& range) {
  return max(abs(range.lo), abs(range.hi)) * F(functionUlps * 1.2e-07f);
}

template <FloatLanes F>
AEROSOL_INLINE IntOf<F> isExact(const Form<F>& x, float value) {
  return equal(x.lo, F(value)) & equal(x.hi, F(value)) & ~x.nan;
}

}  // namespace detail

template <FloatLanes F>
AEROSOL_INLINE const Range<F>& rangeOf(const Range<F>& x) {
  return x;
}
template <FloatLanes F>
AEROSOL_INLINE const Range<F>& rangeOf(const Form<F>& x) {
  return x;
}
template <FloatLanes F>
AEROSOL_INLINE Triple<Range<F>> rangeOf(const Triple<Form<F>>& p) {
  return {p.x, p.y, p.z};
}
template <FloatLanes F>
AEROSOL_INLINE Form<F> formOf(const Range<F>& x) {
  return x;
}
template <FloatLanes F>
AEROSOL_INLINE Triple<Form<F>> formOf(const Triple<Range<F>>& p) {
  return {p.x, p.y, p.z};
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> formOf(const IntRange<I>& x) {
  return x;
}

// --- choices ---------------------------------------------------------------------------------------------------------

template <IntLanes I, FloatLanes F>
AEROSOL_INLINE Form<F> select(I mask, const Form<F>& a, const Form<F>& b) {
  return {select(mask, a.range(), b.range()),   select(mask, a.centre, b.centre),
          select(mask, a.slope[0], b.slope[0]), select(mask, a.slope[1], b.slope[1]),
          select(mask, a.slope[2], b.slope[2]), select(mask, a.rest, b.rest)};
}

/// Either one: the mean of both lines, as far from it as each is.
template <FloatLanes F>
AEROSOL_INLINE Form<F> join(const Form<F>& a, const Form<F>& b) {
  F apart = abs(a.centre - b.centre);
  F magnitude = abs(a.centre) + abs(b.centre) + max(a.rest, b.rest);
  F slope[3];
  for (int i = 0; i < 3; ++i) {
    slope[i] = F(0.5f) * (a.slope[i] + b.slope[i]);
    apart += abs(a.slope[i] - b.slope[i]);
    magnitude += abs(a.slope[i]) + abs(b.slope[i]);
  }
  const F rest = max(a.rest, b.rest) + F(0.5f) * apart + magnitude * F(detail::roundOff);
  return detail::tightened(join(a.range(), b.range()), F(0.5f) * (a.centre + b.centre), slope[0], slope[1], slope[2],
                           rest);
}
template <FloatLanes F>
AEROSOL_INLINE Form<F> meet(const Form<F>& a, const Form<F>& b) {
  return detail::tightened(meet(a.range(), b.range()), a.centre, a.slope[0], a.slope[1], a.slope[2], a.rest);
}

// --- arithmetic ------------------------------------------------------------------------------------------------------

template <FloatLanes F>
AEROSOL_INLINE Form<F> operator-(const Form<F>& a) {
  return {-a.range(), -a.centre, -a.slope[0], -a.slope[1], -a.slope[2], a.rest};
}

template <FloatLanes F>
AEROSOL_INLINE Form<F> operator+(const Form<F>& a, const Form<F>& b) {
  const F rests = a.rest + b.rest;
  const F magnitude = abs(a.centre) + abs(b.centre) + a.slopes() + b.slopes() + rests;
  const Form<F> sum =
      detail::tightened(a.range() + b.range(), a.centre + b.centre, a.slope[0] + b.slope[0], a.slope[1] + b.slope[1],
                        a.slope[2] + b.slope[2], fma(magnitude, F(detail::roundOff), rests));
  // Nothing is rounded when 0 is added.
  return select(detail::isExact(a, 0.0f), b, select(detail::isExact(b, 0.0f), a, sum));
}
template <FloatLanes F>
AEROSOL_INLINE Form<F> operator-(const Form<F>& a, const Form<F>& b) {
  return a + -b;
}

namespace detail {

/// e_i e_j of two different axes is in [-1, 1], e_i e_i in [0, 1].
template <FloatLanes F>
AEROSOL_INLINE Form<F> product(const Range<F>& range, const Form<F>& a, const Form<F>& b) {
  const F xx = F(0.5f) * a.slope[0] * b.slope[0];
  const F yy = F(0.5f) * a.slope[1] * b.slope[1];
  const F zz = F(0.5f) * a.slope[2] * b.slope[2];
  const F xy = fma(a.slope[0], b.slope[1], a.slope[1] * b.slope[0]);
  const F yz = fma(a.slope[1], b.slope[2], a.slope[2] * b.slope[1]);
  const F zx = fma(a.slope[2], b.slope[0], a.slope[0] * b.slope[2]);
  const F second = abs(xx) + abs(yy) + abs(zz) + abs(xy) + abs(yz) + abs(zx);
  const F sizeA = abs(a.centre) + a.slopes();
  const F sizeB = abs(b.centre) + b.slopes();
  const F rests = fma(a.rest, sizeB, b.rest * (sizeA + a.rest));
  const F magnitude = (sizeA + a.rest) * (sizeB + b.rest);
  const F rest = second + rests + fma(magnitude, F(roundOff), F(underflow));
  const auto slope = [&](int i)
                         __attribute__((always_inline)) { return fma(a.centre, b.slope[i], b.centre * a.slope[i]); };
  return tightened(range, fma(a.centre, b.centre, xx + yy + zz), slope(0), slope(1), slope(2), rest);
}

/// 1 / x. The line through both ends, which the curve leaves most at the ends' geometric mean.
template <FloatLanes F>
AEROSOL_INLINE Form<F> reciprocal(const Form<F>& x) {
  const auto positive = greater(x.lo, F(1e-18f)) & less(x.hi, F(1e18f));
  const auto negative = less(x.hi, F(-1e-18f)) & greater(x.lo, F(-1e18f));
  const F atLo = F(1.0f) / x.lo;
  const F atHi = F(1.0f) / x.hi;
  const F factor = -atLo * atHi;
  const F ends = atLo + atHi;
  const F root = rawSqrt(atLo * atHi);
  const F inside = F(2.0f) * select(negative, -root, root);
  const auto valid = positive | negative;
  const Range<F> range = {select(valid, nextDown(min(atLo, atHi)), F(-infinity)),
                          select(valid, nextUp(max(atLo, atHi)), F(infinity)), x.nan};
  return linearisedWithin(range, x, factor, min(ends, inside), max(ends, inside),
                          invalidUnless(valid, F(4.0f) * abs(ends) * F(roundOff)));
}

}  // namespace detail

template <FloatLanes F>
AEROSOL_INLINE Form<F> operator*(const Form<F>& a, const Form<F>& b) {
  return detail::product(a.range() * b.range(), a, b);
}
template <FloatLanes F>
AEROSOL_INLINE Form<F> square(const Form<F>& a) {
  return detail::product(square(a.range()), a, a);
}

template <FloatLanes F>
AEROSOL_INLINE Form<F> safeDivide(const Form<F>& a, const Form<F>& b) {
  const Form<F> result = detail::product(safeDivide(a.range(), b.range()), a, detail::reciprocal(b));
  return select(detail::isExact(b, 1.0f), a, result);
}
template <FloatLanes F>
AEROSOL_INLINE Form<F> operator/(const Form<F>& a, const Form<F>& b) {
  return safeDivide(a, b);
}
template <FloatLanes F>
AEROSOL_INLINE Form<F> fma(const Form<F>& a, const Form<F>& b, const Form<F>& c) {
  return a * b + c;
}

// --- functions -------------------------------------------------------------------------------------------------------

/// |x| over a range with both signs: above its chord by nothing at the ends, below it most at 0.
template <FloatLanes F>
AEROSOL_INLINE Form<F> abs(const Form<F>& x) {
  const F width = x.hi - x.lo;
  const F chord = select(greater(width, F(0.0f)), (x.hi + x.lo) / width, F(1.0f));
  const F factor = select(greaterEqual(x.lo, F(0.0f)), F(1.0f), select(lessEqual(x.hi, F(0.0f)), F(-1.0f), chord));
  const F greatest = max(max(-(F(1.0f) + factor) * x.lo, (F(1.0f) - factor) * x.hi), F(0.0f));
  return detail::linearisedWithin(abs(x.range()), x, factor, F(0.0f), greatest, F(0.0f));
}

namespace detail {

/// b + max(a - b, 0), and max(a - b, 0) by its chord over the range of the difference.
template <FloatLanes F>
AEROSOL_INLINE Form<F> larger(const Range<F>& range, const Form<F>& a, const Form<F>& b) {
  const Form<F> difference = a - b;
  const F width = difference.hi - difference.lo;
  const F chord = select(greater(width, F(0.0f)), difference.hi / width, F(1.0f));
  const auto surely = greaterEqual(difference.lo, F(0.0f));
  const auto never = lessEqual(difference.hi, F(0.0f));
  const F factor = select(surely, F(1.0f), select(never, F(0.0f), chord));
  const F other = F(1.0f) - factor;
  const F greatest = max(max(other * difference.hi, -factor * difference.lo), F(0.0f));
  const auto line = [&](F atA, F atB) __attribute__((always_inline)) { return fma(factor, atA, other * atB); };
  const F centre = line(a.centre, b.centre);
  const F magnitude = abs(a.centre) + abs(b.centre) + a.slopes() + b.slopes() + a.rest + b.rest + greatest;
  const F half = F(0.5f) * greatest;
  const F rest = line(a.rest, b.rest) + half + magnitude * F(2.0f * roundOff);
  const Form<F> result = tightened(range, centre + half, line(a.slope[0], b.slope[0]), line(a.slope[1], b.slope[1]),
                                   line(a.slope[2], b.slope[2]), rest);
  return select(a.nan | b.nan, Form<F>(range), result);
}

}  // namespace detail

template <FloatLanes F>
AEROSOL_INLINE Form<F> max(const Form<F>& a, const Form<F>& b) {
  return detail::larger(max(a.range(), b.range()), a, b);
}
template <FloatLanes F>
AEROSOL_INLINE Form<F> min(const Form<F>& a, const Form<F>& b) {
  return -detail::larger(-min(a.range(), b.range()), -a, -b);
}

/// The chord of the root, which the curve leaves most where the root is half the sum of its ends.
template <FloatLanes F>
AEROSOL_INLINE Form<F> sqrt(const Form<F>& x) {
  const F atLo = sqrt(x.lo);
  const F atHi = sqrt(x.hi);
  const F sum = atLo + atHi;
  const auto valid = greaterEqual(x.lo, F(0.0f)) & greater(x.hi, F(1e-25f)) & less(x.hi, F(1e30f));
  const F factor = F(1.0f) / select(valid, sum, F(1.0f));
  return detail::linearisedWithin(sqrt(x.range()), x, factor, atLo * atHi * factor, F(0.25f) * sum,
                                  detail::invalidUnless(valid, F(4.0f * detail::roundOff) * sum));
}

namespace detail {

/// The tangent at the middle of a range, for a function whose second derivative is nowhere above `curvature`.
template <FloatLanes F>
AEROSOL_INLINE Form<F> byTangent(const Range<F>& range, const Form<F>& x, F value, F derivative, float curvature,
                                 IntOf<F> valid) {
  const auto middle = middleOf(x.range());
  const F distance = F(0.5f * curvature) * middle.half * middle.half;
  const F offset = fma(-derivative, middle.centre, value);
  const F error = (abs(value) + abs(derivative) * (abs(middle.centre) + middle.half) + F(1e-3f)) * F(8.0f * roundOff) +
                  functionError(range);
  return linearised(range, x, derivative, offset, distance, invalidUnless(valid, error));
}

}  // namespace detail

template <FloatLanes F>
AEROSOL_INLINE void sincos(const Form<F>& x, Form<F>& sine, Form<F>& cosine) {
  const Form<F> argument = x;
  Range<F> sines, cosines;
  sincos(argument.range(), sines, cosines);
  const auto middle = detail::middleOf(argument.range());
  const auto valid = less(middle.half, F(1.5f)) & less(abs(middle.centre), F(1e4f));
  const auto at = detail::sineCosine(select(valid, middle.centre, F(0.0f)));
  sine = detail::byTangent(sines, argument, at.sine, at.cosine, 1.0f, valid);
  cosine = detail::byTangent(cosines, argument, at.cosine, -at.sine, 1.0f, valid);
}
template <FloatLanes F>
AEROSOL_INLINE Form<F> sin(const Form<F>& x) {
  Form<F> sine, cosine;
  sincos(x, sine, cosine);
  return sine;
}
template <FloatLanes F>
AEROSOL_INLINE Form<F> cos(const Form<F>& x) {
  Form<F> sine, cosine;
  sincos(x, sine, cosine);
  return cosine;
}

/// Convex: above its tangent at the middle, below its chord's larger end.
template <FloatLanes F>
AEROSOL_INLINE Form<F> exp(const Form<F>& x) {
  const auto middle = detail::middleOf(x.range());
  const auto valid = less(middle.half, F(4.0f)) & less(abs(middle.centre), F(40.0f));
  const F at = select(valid, middle.centre, F(0.0f));
  const F factor = exp(at);
  const F greatest = max(fma(-factor, x.lo, exp(x.lo)), fma(-factor, x.hi, exp(x.hi)));
  const F least = factor * (F(1.0f) - at);
  const Range<F> range = exp(x.range());
  const F error = (range.hi + factor * (F(1.0f) + abs(at) + middle.half)) * F(8.0f * detail::roundOff);
  return detail::linearisedWithin(range, x, factor, min(least, greatest), greatest,
                                  detail::invalidUnless(valid, error));
}

/// Concave: below its tangent at the middle, above its lesser end.
template <FloatLanes F>
AEROSOL_INLINE Form<F> log(const Form<F>& x) {
  const auto middle = detail::middleOf(x.range());
  const auto valid = greater(x.lo, F(1e-18f)) & less(x.hi, F(1e18f));
  const F at = select(valid, middle.centre, F(1.0f));
  const F factor = F(1.0f) / at;
  const Range<F> range = log(x.range());
  const F greatest = log(at) - F(1.0f);
  const F least = min(fma(-factor, x.lo, log(x.lo)), fma(-factor, x.hi, log(x.hi)));
  const F error = (abs(range.lo) + abs(range.hi) + F(2.0f) + x.hi * factor) * F(8.0f * detail::roundOff);
  return detail::linearisedWithin(range, x, factor, least, max(greatest, least), detail::invalidUnless(valid, error));
}

template <FloatLanes F>
AEROSOL_INLINE Form<F> mix(const Form<F>& x, const Form<F>& y, const Form<F>& a) {
  const Form<F> sum = x * (Form<F>(1.0f) - a) + y * a;
  return detail::tightened(mix(x.range(), y.range(), a.range()), sum.centre, sum.slope[0], sum.slope[1], sum.slope[2],
                           sum.rest);
}

/// The cubic of the clamped parameter has a second derivative within 6, and none outside of the ramp.
template <FloatLanes F>
AEROSOL_INLINE Form<F> smoothstep(const Form<F>& low, const Form<F>& high, const Form<F>& x) {
  const Form<F> t = (x - low) / (high - low);
  const auto middle = detail::middleOf(t.range());
  const auto valid = less(low.hi, high.lo) & less(middle.half, F(2.0f)) & ~(low.nan | high.nan | x.nan);
  const F at = min(max(middle.centre, F(0.0f)), F(1.0f));
  return detail::byTangent(smoothstep(low.range(), high.range(), x.range()), t, at * at * fma(at, F(-2.0f), F(3.0f)),
                           F(6.0f) * at * (F(1.0f) - at), 6.0f, valid);
}

template <FloatLanes F>
AEROSOL_INLINE Form<F> length(const Triple<Form<F>>& v) {
  const Form<F> squares = lengthSquared(v);
  const Range<F> range = length(rangeOf(v));
  const Form<F> root = sqrt(squares);
  const auto valid = greater(squares.lo, F(1e-25f)) & less(squares.hi, F(1e30f));
  return detail::tightened(range, root.centre, root.slope[0], root.slope[1], root.slope[2],
                           detail::invalidUnless(valid, fma(abs(root.centre), F(4.0f * detail::roundOff), root.rest)));
}

template <FloatLanes F>
AEROSOL_INLINE Triple<Form<F>> normalize(const Triple<Form<F>>& v) {
  const Triple<Range<F>> range = normalize(rangeOf(v));
  const Form<F> inverse = detail::reciprocal(length(v));
  const auto valid = greater(inverse.hi, F(0.0f)) & less(inverse.hi, F(1e12f));
  const auto along = [&](const Form<F>& x, const Range<F>& bound) __attribute__((always_inline)) {
    const Form<F> quotient = detail::product(bound, x, inverse);
    return select(valid, quotient, Form<F>(bound));
  };
  return {along(v.x, range.x), along(v.y, range.y), along(v.z, range.z)};
}

// Matrices are bounded by their elements' ranges alone: what is transformed keeps its slopes.

namespace detail {

template <class To, class From>
AEROSOL_INLINE Matrix<To> elementwise(const Matrix<From>& a) {
  Matrix<To> result;
#pragma clang loop unroll(full)
  for (int i = 0; i < 16; ++i) result.m[i] = a.m[i];
  return result;
}

}  // namespace detail

template <FloatLanes F>
AEROSOL_INLINE Form<F> determinant(const Matrix<Form<F>>& a) {
  return determinant(detail::elementwise<Range<F>>(a));
}
template <FloatLanes F>
AEROSOL_INLINE Matrix<Form<F>> inverse(const Matrix<Form<F>>& a) {
  return detail::elementwise<Form<F>>(inverse(detail::elementwise<Range<F>>(a)));
}
template <FloatLanes F>
AEROSOL_INLINE Matrix<Form<F>> multiply(const Matrix<Form<F>>& a, const Matrix<Form<F>>& b) {
  return detail::elementwise<Form<F>>(multiply(detail::elementwise<Range<F>>(a), detail::elementwise<Range<F>>(b)));
}
template <FloatLanes F>
AEROSOL_INLINE Matrix<Form<F>> multiply(const Matrix<Form<F>>& a, const Form<F>& b) {
  return detail::elementwise<Form<F>>(multiply(detail::elementwise<Range<F>>(a), b.range()));
}

}  // namespace aerosol::jit::runtime
