// The range number type: all values that a quantity may take over a box of points, for W boxes at a time.
//
// A range [lo, hi] holds every value that the wide domain computes for some choice of operands in the operands' ranges,
// and every exact real value: operations are monotone and correctly rounded, and results are moved one float outwards
// (Moore 1966) unless they are exactly 0. Infinite ends count as values. What may be no number is marked beside it:
// `nan` lanes are all ones where the value may be NaN; ends themselves are never NaN. Comparisons give two masks, may
// be true and may be false; a choice that both allow joins its sides.
#pragma once

#include "core/jit/runtime/math_basic.h"

namespace aerosol::jit::runtime {

template <FloatLanes F>
struct Range {
  F lo, hi;
  IntOf<F> nan;

  Range() = default;
  AEROSOL_INLINE explicit Range(float value) : lo(F(value)), hi(F(value)), nan(IntOf<F>(0)) {}
  AEROSOL_INLINE Range(F low, F high, IntOf<F> mayBeNan) : lo(low), hi(high), nan(mayBeNan) {}
};

template <IntLanes I>
struct IntRange {
  I lo, hi;
};

template <class T>
inline constexpr bool isRange = false;
template <FloatLanes F>
inline constexpr bool isRange<Range<F>> = true;
template <IntLanes I>
inline constexpr bool isRange<IntRange<I>> = true;
template <class T>
concept Ranges = isRange<T>;

/// What a condition may be: masks of lanes. At least one is set in every lane.
template <IntLanes I>
struct Truth {
  I mayTrue, mayFalse;
};

namespace detail {

inline constexpr std::int32_t leastInt = -0x7fffffff - 1;
inline constexpr std::int32_t greatestInt = 0x7fffffff;

/// The next float above; infinity stays.
template <FloatLanes F>
AEROSOL_INLINE F nextUp(F x) {
  using I = IntOf<F>;
  const I bits = asInt(x + F(0.0f));  // no -0
  const I next = wrapAdd(bits, (bits >> I(31)) | I(1));
  return select(equal(x, F(infinity)), x, asFloat(next));
}
template <FloatLanes F>
AEROSOL_INLINE F nextDown(F x) {
  return -nextUp(-x);
}

/// One float outwards unless 0, which sums give exactly.
template <FloatLanes F>
AEROSOL_INLINE Range<F> outward(F lo, F hi, IntOf<F> nan) {
  return {select(equal(lo, F(0.0f)), lo, nextDown(lo)), select(equal(hi, F(0.0f)), hi, nextUp(hi)), nan};
}

/// Some floats outwards: `ulps` of relative error and one step more.
template <FloatLanes F>
AEROSOL_INLINE Range<F> widened(F lo, F hi, IntOf<F> nan, float ulps) {
  const F relative = F(ulps * 1.1920929e-07f);
  const F low = select(less(abs(lo), F(infinity)), lo - abs(lo) * relative, lo);
  const F high = select(less(abs(hi), F(infinity)), hi + abs(hi) * relative, hi);
  return {nextDown(low), nextUp(high), nan};
}

template <FloatLanes F>
AEROSOL_INLINE F orLeast(F lo) {
  return select(isNan(lo), F(-infinity), lo);
}
template <FloatLanes F>
AEROSOL_INLINE F orGreatest(F hi) {
  return select(isNan(hi), F(infinity), hi);
}

template <FloatLanes F>
AEROSOL_INLINE F least(F a, F b, F c, F d) {
  return min(min(a, b), min(c, d));
}
template <FloatLanes F>
AEROSOL_INLINE F greatest(F a, F b, F c, F d) {
  return max(max(a, b), max(c, d));
}

template <FloatLanes F>
AEROSOL_INLINE IntOf<F> contains(const Range<F>& a, float value) {
  return lessEqual(a.lo, F(value)) & greaterEqual(a.hi, F(value));
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> mayBeInfinite(const Range<F>& a) {
  return equal(a.lo, F(-infinity)) | equal(a.hi, F(infinity));
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> isPoint(const Range<F>& a) {
  return equal(a.lo, a.hi) & ~a.nan;
}

}  // namespace detail

/// Everything a float may be, NaN where the mask says so.
template <FloatLanes F>
AEROSOL_INLINE Range<F> wholeRange(IntOf<F> nan) {
  return {F(-infinity), F(infinity), nan};
}

// --- choices ---------------------------------------------------------------------------------------------------------

template <FloatLanes F>
AEROSOL_INLINE Range<F> join(const Range<F>& a, const Range<F>& b) {
  return {min(a.lo, b.lo), max(a.hi, b.hi), a.nan | b.nan};
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> join(const IntRange<I>& a, const IntRange<I>& b) {
  return {min(a.lo, b.lo), max(a.hi, b.hi)};
}

/// What both hold of one quantity. (The first where they contradict each other: nothing is there to be bounded.)
template <FloatLanes F>
AEROSOL_INLINE Range<F> meet(const Range<F>& a, const Range<F>& b) {
  const F lo = max(a.lo, b.lo);
  const F hi = min(a.hi, b.hi);
  const auto overlap = lessEqual(lo, hi);
  return {select(overlap, lo, a.lo), select(overlap, hi, a.hi), a.nan};
}

/// By plain mask.
template <IntLanes I, FloatLanes F>
AEROSOL_INLINE Range<F> select(I mask, const Range<F>& a, const Range<F>& b) {
  return {select(mask, a.lo, b.lo), select(mask, a.hi, b.hi), select(mask, a.nan, b.nan)};
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> select(I mask, const IntRange<I>& a, const IntRange<I>& b) {
  return {select(mask, a.lo, b.lo), select(mask, a.hi, b.hi)};
}
/// By condition: both sides joined where it is undecided.
template <IntLanes I, Ranges R>
AEROSOL_INLINE R select(const Truth<I>& truth, const R& a, const R& b) {
  return select(truth.mayTrue & truth.mayFalse, join(a, b), select(truth.mayTrue, a, b));
}

template <IntLanes I>
AEROSOL_INLINE Truth<I> operator&(const Truth<I>& a, const Truth<I>& b) {
  return {a.mayTrue & b.mayTrue, a.mayFalse | b.mayFalse};
}
template <IntLanes I>
AEROSOL_INLINE Truth<I> operator|(const Truth<I>& a, const Truth<I>& b) {
  return {a.mayTrue | b.mayTrue, a.mayFalse & b.mayFalse};
}
template <IntLanes I>
AEROSOL_INLINE Truth<I> operator~(const Truth<I>& a) {
  return {a.mayFalse, a.mayTrue};
}
/// As the int 0 or 1.
template <IntLanes I>
AEROSOL_INLINE IntRange<I> toIntRange(const Truth<I>& a) {
  return {I(1) & ~a.mayFalse, I(1) & a.mayTrue};
}

// --- comparisons -----------------------------------------------------------------------------------------------------

template <FloatLanes F>
AEROSOL_INLINE Truth<IntOf<F>> less(const Range<F>& a, const Range<F>& b) {
  return {less(a.lo, b.hi), greaterEqual(a.hi, b.lo) | a.nan | b.nan};
}
template <FloatLanes F>
AEROSOL_INLINE Truth<IntOf<F>> lessEqual(const Range<F>& a, const Range<F>& b) {
  return {lessEqual(a.lo, b.hi), greater(a.hi, b.lo) | a.nan | b.nan};
}
template <FloatLanes F>
AEROSOL_INLINE Truth<IntOf<F>> equal(const Range<F>& a, const Range<F>& b) {
  return {lessEqual(a.lo, b.hi) & lessEqual(b.lo, a.hi), ~(equal(a.lo, b.hi) & equal(a.hi, b.lo)) | a.nan | b.nan};
}
template <IntLanes I>
AEROSOL_INLINE Truth<I> less(const IntRange<I>& a, const IntRange<I>& b) {
  return {less(a.lo, b.hi), greaterEqual(a.hi, b.lo)};
}
template <IntLanes I>
AEROSOL_INLINE Truth<I> lessEqual(const IntRange<I>& a, const IntRange<I>& b) {
  return {lessEqual(a.lo, b.hi), greater(a.hi, b.lo)};
}
template <IntLanes I>
AEROSOL_INLINE Truth<I> equal(const IntRange<I>& a, const IntRange<I>& b) {
  return {lessEqual(a.lo, b.hi) & lessEqual(b.lo, a.hi), ~(equal(a.lo, b.hi) & equal(a.hi, b.lo))};
}

template <Ranges R>
AEROSOL_INLINE auto greater(const R& a, const R& b) {
  return less(b, a);
}
template <Ranges R>
AEROSOL_INLINE auto greaterEqual(const R& a, const R& b) {
  return lessEqual(b, a);
}
template <Ranges R>
AEROSOL_INLINE auto notEqual(const R& a, const R& b) {
  return ~equal(a, b);
}

// --- arithmetic on floats --------------------------------------------------------------------------------------------

template <FloatLanes F>
AEROSOL_INLINE Range<F> operator-(const Range<F>& a) {
  return {-a.hi, -a.lo, a.nan};
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> operator+(const Range<F>& a, const Range<F>& b) {
  const F lo = a.lo + b.lo;
  const F hi = a.hi + b.hi;
  const auto opposite =
      (equal(a.hi, F(infinity)) & equal(b.lo, F(-infinity))) | (equal(a.lo, F(-infinity)) & equal(b.hi, F(infinity)));
  return detail::outward(detail::orLeast(lo), detail::orGreatest(hi), a.nan | b.nan | opposite);
}
template <FloatLanes F>
AEROSOL_INLINE Range<F> operator-(const Range<F>& a, const Range<F>& b) {
  return a + -b;
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> operator*(const Range<F>& a, const Range<F>& b) {
  using I = IntOf<F>;
  F p[4] = {a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi};
  const I infinite = detail::mayBeInfinite(a) | detail::mayBeInfinite(b);
  I nan = a.nan | b.nan;
  if (any(infinite)) [[unlikely]] {
    // 0 times infinity: 0 as an end, for finite values beside it; NaN as a value.
    nan |=
        (detail::contains(a, 0.0f) & detail::mayBeInfinite(b)) | (detail::contains(b, 0.0f) & detail::mayBeInfinite(a));
    for (F& product : p) product = select(isNan(product), F(0.0f), product);
  }
  const F lo = detail::least(p[0], p[1], p[2], p[3]);
  const F hi = detail::greatest(p[0], p[1], p[2], p[3]);
  // 0 is exact when it comes from a 0 and not from two small numbers.
  const I zeroEnd = equal(a.lo, F(0.0f)) | equal(a.hi, F(0.0f)) | equal(b.lo, F(0.0f)) | equal(b.hi, F(0.0f));
  const I exactLo = equal(lo, F(0.0f)) & zeroEnd;
  const I exactHi = equal(hi, F(0.0f)) & zeroEnd;
  return {select(exactLo, lo, detail::nextDown(lo)), select(exactHi, hi, detail::nextUp(hi)), nan};
}

/// x x, which is never negative.
template <FloatLanes F>
AEROSOL_INLINE Range<F> square(const Range<F>& a) {
  const F low = select(detail::contains(a, 0.0f), F(0.0f), min(abs(a.lo), abs(a.hi)));
  const F high = max(abs(a.lo), abs(a.hi));
  const F lo = low * low;
  const F hi = high * high;
  return {select(equal(lo, F(0.0f)), lo, detail::nextDown(lo)), select(equal(high, F(0.0f)), hi, detail::nextUp(hi)),
          a.nan};
}

/// The language's division: x / 0 is 0.
template <FloatLanes F>
AEROSOL_INLINE Range<F> safeDivide(const Range<F>& a, const Range<F>& b) {
  using I = IntOf<F>;
  const I zero = detail::contains(b, 0.0f);
  const F q[4] = {a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi};
  // Infinite over infinite: an end of 0 for the finite ones beside it, or any sign's infinity by the other corners.
  F clean[4];
  for (int i = 0; i < 4; ++i) clean[i] = select(isNan(q[i]), F(0.0f), q[i]);
  const F lo = detail::least(clean[0], clean[1], clean[2], clean[3]);
  const F hi = detail::greatest(clean[0], clean[1], clean[2], clean[3]);
  const I mayPositive = (greater(a.hi, F(0.0f)) & greater(b.hi, F(0.0f))) | (less(a.lo, F(0.0f)) & less(b.lo, F(0.0f)));
  const I mayNegative = (less(a.lo, F(0.0f)) & greater(b.hi, F(0.0f))) | (greater(a.hi, F(0.0f)) & less(b.lo, F(0.0f)));
  const I nan = a.nan | b.nan | (detail::mayBeInfinite(a) & detail::mayBeInfinite(b));
  const I exactLo = equal(lo, F(0.0f)) & (equal(a.lo, F(0.0f)) | equal(a.hi, F(0.0f)));
  const I exactHi = equal(hi, F(0.0f)) & (equal(a.lo, F(0.0f)) | equal(a.hi, F(0.0f)));
  const Range<F> apart = {select(exactLo, lo, detail::nextDown(lo)), select(exactHi, hi, detail::nextUp(hi)), nan};
  const Range<F> across = {select(mayNegative, F(-infinity), F(0.0f)), select(mayPositive, F(infinity), F(0.0f)), nan};
  return select(zero, across, apart);
}
/// IEEE division where no 0 can be in b; as the language's otherwise.
template <FloatLanes F>
AEROSOL_INLINE Range<F> operator/(const Range<F>& a, const Range<F>& b) {
  return safeDivide(a, b);
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> fma(const Range<F>& a, const Range<F>& b, const Range<F>& c) {
  return a * b + c;
}

}  // namespace aerosol::jit::runtime
