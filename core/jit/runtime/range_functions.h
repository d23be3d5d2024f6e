// Everything over ranges. What is not defined here for ranges comes from templates over any number type (geometry.h).
#pragma once

#include "core/jit/runtime/geometry.h"
#include "core/jit/runtime/range_math.h"
#include "core/jit/runtime/range_noise.h"

namespace aerosol::jit::runtime {

template <FloatLanes F>
AEROSOL_INLINE Range<F> length(const Triple<Range<F>>& v) {
  const Range<F> root = sqrt(lengthSquared(v));
  const Range<F> wider = detail::widened(root.lo, root.hi, root.nan, 4.0f);
  return {max(wider.lo, F(0.0f)), wider.hi, wider.nan};
}

namespace detail {

/// x / |v| for one end of x: rising in x, and the other squares at the end that makes it extreme.
template <FloatLanes F>
AEROSOL_INLINE F directionEnd(F x, F othersLo, F othersHi, IntOf<F> outwards) {
  const F others = select(outwards, othersLo, othersHi);
  return select(equal(x, F(0.0f)), F(0.0f), x / rawSqrt(fma(x, x, others)));
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> directionComponent(const Range<F>& x, const Range<F>& ySquare, const Range<F>& zSquare) {
  using I = IntOf<F>;
  const F least = ySquare.lo + zSquare.lo;
  const F most = ySquare.hi + zSquare.hi;
  // Ends next to 0, whose squares underflow, are moved outwards.
  const F tiny = F(1e-15f);
  const I tinyLo = less(abs(x.lo), tiny);
  const I tinyHi = less(abs(x.hi), tiny);
  const F low = select(tinyLo, select(less(x.lo, F(0.0f)), -tiny, F(0.0f)), x.lo);
  const F high = select(tinyHi, select(greater(x.hi, F(0.0f)), tiny, F(0.0f)), x.hi);
  const F lo = directionEnd(low, least, most, less(low, F(0.0f)));
  const F hi = directionEnd(high, least, most, greater(high, F(0.0f)));
  const Range<F> ends = widened(lo, hi, I(0), 16.0f);
  // Where squares leave the normal floats the quotient says nothing.
  const I trusted = less(max(abs(x.lo), abs(x.hi)), F(1e18f)) & less(most, F(1e37f)) &
                    (greater(least, F(1e-30f)) | equal(least, F(0.0f)));
  const F limit = F(1.000001f);
  const F anyLo = select(less(x.lo, F(0.0f)), -limit, F(0.0f));
  const F anyHi = select(greater(x.hi, F(0.0f)), limit, F(0.0f));
  return {select(trusted, max(ends.lo, -limit), anyLo), select(trusted, min(ends.hi, limit), anyHi), x.nan};
}

}  // namespace detail

template <FloatLanes F>
AEROSOL_INLINE Triple<Range<F>> normalize(const Triple<Range<F>>& v) {
  const Range<F> x2 = square(v.x);
  const Range<F> y2 = square(v.y);
  const Range<F> z2 = square(v.z);
  const auto nan = detail::mayMiss(v);
  Triple<Range<F>> result = {detail::directionComponent(v.x, y2, z2), detail::directionComponent(v.y, x2, z2),
                             detail::directionComponent(v.z, x2, y2)};
  result.x.nan = nan;
  result.y.nan = nan;
  result.z.nan = nan;
  return result;
}

}  // namespace aerosol::jit::runtime
