// Ranges of ints: arithmetic, bits and conversions. Where a result may wrap it is every int.
#pragma once

#include "core/jit/runtime/range.h"

namespace aerosol::jit::runtime {

template <IntLanes I>
AEROSOL_INLINE IntRange<I> wholeIntRange() {
  return {I(detail::leastInt), I(detail::greatestInt)};
}

namespace detail {

/// Ends are computed in 64 bits.
template <IntLanes I>
using LongOf = Wide<std::int64_t, widthOf<I>>;

template <IntLanes I>
AEROSOL_INLINE LongOf<I> toLong(I a) {
  if constexpr (widthOf<I> == 1) {
    return a;
  } else {
    return __builtin_convertvector(a, LongOf<I>);
  }
}
template <IntLanes I>
AEROSOL_INLINE I toShort(LongOf<I> a) {
  if constexpr (widthOf<I> == 1) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(a)));
  } else {
    return __builtin_convertvector(a, I);
  }
}
template <IntLanes I>
AEROSOL_INLINE I fits(LongOf<I> a) {
  return equal(toShort<I>((a - toLong(toShort<I>(a))) >> LongOf<I>(32)), I(0)) &
         equal(toShort<I>(a - toLong(toShort<I>(a))), I(0));
}
template <IntLanes I>
AEROSOL_INLINE LongOf<I> lesser(LongOf<I> a, LongOf<I> b) {
  return __builtin_elementwise_min(a, b);
}
template <IntLanes I>
AEROSOL_INLINE LongOf<I> larger(LongOf<I> a, LongOf<I> b) {
  return __builtin_elementwise_max(a, b);
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> fromLong(LongOf<I> lo, LongOf<I> hi) {
  return select(fits<I>(lo) & fits<I>(hi), IntRange<I>{toShort<I>(lo), toShort<I>(hi)}, wholeIntRange<I>());
}

}  // namespace detail

template <IntLanes I>
AEROSOL_INLINE IntRange<I> operator+(const IntRange<I>& a, const IntRange<I>& b) {
  using detail::toLong;
  return detail::fromLong<I>(toLong(a.lo) + toLong(b.lo), toLong(a.hi) + toLong(b.hi));
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> operator-(const IntRange<I>& a, const IntRange<I>& b) {
  using detail::toLong;
  return detail::fromLong<I>(toLong(a.lo) - toLong(b.hi), toLong(a.hi) - toLong(b.lo));
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> operator-(const IntRange<I>& a) {
  return IntRange<I>{I(0), I(0)} - a;
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> operator*(const IntRange<I>& a, const IntRange<I>& b) {
  using detail::toLong;
  const auto p = toLong(a.lo) * toLong(b.lo);
  const auto q = toLong(a.lo) * toLong(b.hi);
  const auto r = toLong(a.hi) * toLong(b.lo);
  const auto s = toLong(a.hi) * toLong(b.hi);
  return detail::fromLong<I>(detail::lesser<I>(detail::lesser<I>(p, q), detail::lesser<I>(r, s)),
                             detail::larger<I>(detail::larger<I>(p, q), detail::larger<I>(r, s)));
}

/// a / b truncated, 0 where b is 0: the magnitude never grows, the extremes lie at the ends of a and at the ends of b
/// or its values next to 0.
template <IntLanes I>
AEROSOL_INLINE IntRange<I> divide(const IntRange<I>& a, const IntRange<I>& b) {
  const I wraps = equal(a.lo, I(detail::leastInt)) & lessEqual(b.lo, I(-1)) & greaterEqual(b.hi, I(-1));
  const I zero = lessEqual(b.lo, I(0)) & greaterEqual(b.hi, I(0));
  IntRange<I> result = {I(detail::greatestInt), I(detail::leastInt)};
  const auto add = [&](I divisor, I valid) __attribute__((always_inline)) {
    const I p = divide(a.lo, divisor);
    const I q = divide(a.hi, divisor);
    result.lo = select(valid, min(result.lo, min(p, q)), result.lo);
    result.hi = select(valid, max(result.hi, max(p, q)), result.hi);
  };
  add(b.lo, I(-1));
  add(b.hi, I(-1));
  add(I(1), lessEqual(b.lo, I(1)) & greaterEqual(b.hi, I(1)));
  add(I(-1), lessEqual(b.lo, I(-1)) & greaterEqual(b.hi, I(-1)));
  result.lo = select(zero, min(result.lo, I(0)), result.lo);
  result.hi = select(zero, max(result.hi, I(0)), result.hi);
  return select(wraps, wholeIntRange<I>(), result);
}

/// a % b with the sign of a, 0 where b is 0.
template <IntLanes I>
AEROSOL_INLINE IntRange<I> remainder(const IntRange<I>& a, const IntRange<I>& b) {
  // |a % b| < |b| and <= |a|; a itself where every |b| is greater.
  const I bMagnitude = max(select(equal(b.lo, I(detail::leastInt)), I(detail::greatestInt), abs(b.lo)), abs(b.hi));
  const I limit = max(wrapSub(bMagnitude, I(1)), I(0));
  const I fullLimit = select(equal(b.lo, I(detail::leastInt)), I(detail::greatestInt), limit);
  const I negativeLimit = wrapNegate(fullLimit);
  return {select(less(a.lo, I(0)), max(a.lo, negativeLimit), I(0)),
          select(greater(a.hi, I(0)), min(a.hi, fullLimit), I(0))};
}

// --- bits: exact for single values, and where the sign bits are known to be clear a bound by size
// ---------------------

namespace detail {

template <IntLanes I>
AEROSOL_INLINE I isPoint(const IntRange<I>& a) {
  return equal(a.lo, a.hi);
}
/// All ones below and including the highest set bit of a non-negative number.
template <IntLanes I>
AEROSOL_INLINE I filled(I a) {
  a |= a >> I(1);
  a |= a >> I(2);
  a |= a >> I(4);
  a |= a >> I(8);
  return a | (a >> I(16));
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> exactOr(I exact, I value, const IntRange<I>& otherwise) {
  return select(exact, IntRange<I>{value, value}, otherwise);
}

}  // namespace detail

template <IntLanes I>
AEROSOL_INLINE IntRange<I> bitAnd(const IntRange<I>& a, const IntRange<I>& b) {
  const I aClear = greaterEqual(a.lo, I(0));
  const I bClear = greaterEqual(b.lo, I(0));
  IntRange<I> bound = wholeIntRange<I>();
  bound = select(aClear, IntRange<I>{I(0), a.hi}, bound);
  bound = select(bClear, IntRange<I>{I(0), select(aClear, min(a.hi, b.hi), b.hi)}, bound);
  return detail::exactOr(detail::isPoint(a) & detail::isPoint(b), a.lo & b.lo, bound);
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> bitOr(const IntRange<I>& a, const IntRange<I>& b) {
  const I clear = greaterEqual(a.lo, I(0)) & greaterEqual(b.lo, I(0));
  const IntRange<I> bound = {max(a.lo, b.lo), detail::filled(a.hi | b.hi)};
  return detail::exactOr(detail::isPoint(a) & detail::isPoint(b), a.lo | b.lo,
                         select(clear, bound, wholeIntRange<I>()));
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> bitXor(const IntRange<I>& a, const IntRange<I>& b) {
  const I clear = greaterEqual(a.lo, I(0)) & greaterEqual(b.lo, I(0));
  const IntRange<I> bound = {I(0), detail::filled(a.hi | b.hi)};
  return detail::exactOr(detail::isPoint(a) & detail::isPoint(b), a.lo ^ b.lo,
                         select(clear, bound, wholeIntRange<I>()));
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> bitShiftLeft(const IntRange<I>& a, const IntRange<I>& b) {
  const I count = b.lo & I(31);
  const I value = asInt(asUint(a.lo) << asUint(count));
  const I high = asInt(asUint(a.hi) << asUint(count));
  // Rising where no bit is lost at either end.
  const I kept = equal(value >> count, a.lo) & equal(high >> count, a.hi);
  const IntRange<I> bound = select(kept & detail::isPoint(b), IntRange<I>{value, high}, wholeIntRange<I>());
  return detail::exactOr(detail::isPoint(a) & detail::isPoint(b), value, bound);
}
template <IntLanes I>
AEROSOL_INLINE IntRange<I> bitShiftRight(const IntRange<I>& a, const IntRange<I>& b) {
  const I count = b.lo & I(31);
  // By an unknown count: between the number and 0 or -1.
  const IntRange<I> any = {min(a.lo, I(0)), max(a.hi, I(0))};
  const IntRange<I> wider = {any.lo, max(any.hi, select(less(a.lo, I(0)), I(-1), any.hi))};
  return select(detail::isPoint(b), IntRange<I>{a.lo >> count, a.hi >> count}, wider);
}

// --- conversions -----------------------------------------------------------------------------------------------------

template <IntLanes I>
AEROSOL_INLINE Range<FloatOf<I>> toFloat(const IntRange<I>& a) {
  return {toFloat(a.lo), toFloat(a.hi), I(0)};
}
/// Saturating; NaN is 0.
template <FloatLanes F>
AEROSOL_INLINE IntRange<IntOf<F>> toInt(const Range<F>& a) {
  using I = IntOf<F>;
  const I lo = toInt(a.lo);
  const I hi = toInt(a.hi);
  return {select(a.nan, min(lo, I(0)), lo), select(a.nan, max(hi, I(0)), hi)};
}

}  // namespace aerosol::jit::runtime
