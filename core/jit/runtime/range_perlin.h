// Perlin noise over boxes, bounded in three ways, all of them guaranteed, of which the narrowest counts: by its
// greatest value; by its value at the box's centre and the greatest slopes (mean value theorem; the noise is smooth
// across cells); and, for a box inside one lattice cell, by evaluating the interpolation over ranges: the fades rise,
// the products gradient · offset are linear, so both have exact ranges. Greatest values and slopes are the maxima over
// all gradients at all corners, with up to one per cent added.
#pragma once

#include "core/jit/runtime/noise_perlin.h"
#include "core/jit/runtime/range.h"

namespace aerosol::jit::runtime {

namespace detail {

/// The sum |gradient_i| r_i for offsets within r of their centre: `gradient` without signs.
template <FloatLanes F>
AEROSOL_INLINE F gradientRadius(UintOf<F> h, F rx) {
  using U = UintOf<F>;
  return toFloat(asInt((h & U(7u)) + U(1u))) * rx;
}
template <FloatLanes F>
AEROSOL_INLINE F gradientRadius(UintOf<F> h, F rx, F ry) {
  const auto first = noBits(h, 4);
  return select(first, rx, ry) + F(2.0f) * select(first, ry, rx);
}
template <FloatLanes F>
AEROSOL_INLINE F gradientRadius(UintOf<F> h, F rx, F ry, F rz) {
  using U = UintOf<F>;
  return select(noBits(h, 8), rx, ry) + select(noBits(h, 12), ry, select(equal(h & U(13u), U(12u)), rx, rz));
}
template <FloatLanes F>
AEROSOL_INLINE F gradientRadius(UintOf<F> h, F rx, F ry, F rz, F rw) {
  using U = UintOf<F>;
  return select(equal(h & U(24u), U(24u)), ry, rx) + select(noBits(h, 16), ry, rz) + select(noBits(h, 24), rz, rw);
}

/// A box's extent along one axis of a lattice laid at its centre.
template <FloatLanes F>
struct BoxAxis {
  F centre, half;
  F fadeLo, fadeHi;
  IntOf<F> inCell;
};

template <FloatLanes F>
AEROSOL_INLINE F fadeOf(F t) {
  return t * t * t * fma(t, fma(t, F(6.0f), F(-15.0f)), F(10.0f));
}

template <FloatLanes F>
AEROSOL_INLINE BoxAxis<F> boxAxis(const Range<F>& x) {
  const auto finite = less(abs(x.lo), F(1e30f)) & less(abs(x.hi), F(1e30f));
  const F lo = select(finite, x.lo, F(0.0f));
  const F hi = select(finite, x.hi, F(0.0f));
  const F middle = fma(hi - lo, F(0.5f), lo);
  const F centre = max(min(middle, hi), lo);
  const F reach = nextUp(max(hi - centre, centre - lo));
  const F half = select(finite, select(equal(lo, hi), F(0.0f), reach), F(infinity));
  const F cell = floor(centre);
  const F t0 = lo - cell;
  const F t1 = hi - cell;
  const auto inCell = finite & greaterEqual(t0, F(0.0f)) & lessEqual(t1, F(1.0f));
  const F fadeLo = max(fma(fadeOf(max(t0, F(0.0f))), F(1.0f - 1e-6f), F(-1e-12f)), F(0.0f));
  const F fadeHi = min(fma(fadeOf(min(t1, F(1.0f))), F(1.0f + 1e-6f), F(1e-12f)), F(1.0f));
  return {centre, half, select(inCell, fadeLo, F(0.0f)), select(inCell, fadeHi, F(1.0f)), inCell};
}

template <FloatLanes F>
struct Bound {
  F lo, hi;
};

/// Both ends are linear in the fade, so its ends give the extremes.
template <FloatLanes F>
AEROSOL_INLINE Bound<F> interpolate(const Bound<F>& a, const Bound<F>& b, const BoxAxis<F>& axis) {
  return {min(interpolate(a.lo, b.lo, axis.fadeLo), interpolate(a.lo, b.lo, axis.fadeHi)),
          max(interpolate(a.hi, b.hi, axis.fadeLo), interpolate(a.hi, b.hi, axis.fadeHi))};
}

template <FloatLanes F>
AEROSOL_INLINE Bound<F> around(F centre, F radius) {
  return {centre - radius, centre + radius};
}

/// The narrowest of the bounds. `centre` is the noise at the box's centre, `reach` the greatest change over the box,
/// `cell` the bound inside one cell (unscaled).
template <FloatLanes F>
AEROSOL_INLINE Range<F> narrowest(F centre, F reach, const Bound<F>& cell, IntOf<F> inCell, float scale, float greatest,
                                  IntOf<F> nan) {
  constexpr float slack = 4e-6f;
  F lo = max(centre - reach - F(slack), F(-greatest));
  F hi = min(centre + reach + F(slack), F(greatest));
  lo = select(inCell, max(lo, cell.lo * F(scale) - F(slack)), lo);
  hi = select(inCell, min(hi, cell.hi * F(scale) + F(slack)), hi);
  return {lo, hi, nan};
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> boundOf(const Lattice1<F>& n, const BoxAxis<F>& x, std::uint32_t shift, IntOf<F> nan) {
  const auto at = [&](int i) __attribute__((always_inline)) {
    const auto h = n.hash[i] >> UintOf<F>(shift);
    return around(gradient(h, n.x.offset[i]), gradientRadius(h, x.half));
  };
  const Bound<F> cell = interpolate(at(0), at(1), x);
  return narrowest(n.value(shift), F(2.73f) * x.half, cell, x.inCell, 0.25f, 1.001f, nan);
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> boundOf(const Lattice2<F>& n, const BoxAxis<F>& x, const BoxAxis<F>& y, std::uint32_t shift,
                                IntOf<F> nan) {
  const auto at = [&](int i, int j) __attribute__((always_inline)) {
    const auto h = n.hash[i][j] >> UintOf<F>(shift);
    return around(gradient(h, n.x.offset[i], n.y.offset[j]), gradientRadius(h, x.half, y.half));
  };
  const Bound<F> cell = interpolate(interpolate(at(0, 0), at(1, 0), x), interpolate(at(0, 1), at(1, 1), x), y);
  return narrowest(n.value(shift), F(3.1f) * (x.half + y.half), cell, x.inCell & y.inCell, 0.6616f, 1.001f, nan);
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> boundOf(const Lattice3<F>& n, const BoxAxis<F>& x, const BoxAxis<F>& y, const BoxAxis<F>& z,
                                std::uint32_t shift, IntOf<F> nan) {
  const auto at = [&](int i, int j, int k) __attribute__((always_inline)) {
    const auto h = n.hash[i][j][k] >> UintOf<F>(shift);
    return around(gradient(h, n.x.offset[i], n.y.offset[j], n.z.offset[k]), gradientRadius(h, x.half, y.half, z.half));
  };
  const auto plane = [&](int k) __attribute__((always_inline)) {
    return interpolate(interpolate(at(0, 0, k), at(1, 0, k), x), interpolate(at(0, 1, k), at(1, 1, k), x), y);
  };
  const Bound<F> cell = interpolate(plane(0), plane(1), z);
  return narrowest(n.value(shift), F(3.72f) * (x.half + y.half + z.half), cell, x.inCell & y.inCell & z.inCell, 0.982f,
                   1.0185f, nan);
}

template <FloatLanes F>
AEROSOL_INLINE Range<F> boundOf(const Lattice4<F>& n, const BoxAxis<F>& x, const BoxAxis<F>& y, const BoxAxis<F>& z,
                                const BoxAxis<F>& w, std::uint32_t shift, IntOf<F> nan) {
  const auto at = [&](int i, int j, int k, int l) __attribute__((always_inline)) {
    const auto h = n.hash[i][j][k][l] >> UintOf<F>(shift);
    return around(gradient(h, n.x.offset[i], n.y.offset[j], n.z.offset[k], n.w.offset[l]),
                  gradientRadius(h, x.half, y.half, z.half, w.half));
  };
  const auto plane = [&](int k, int l) __attribute__((always_inline)) {
    return interpolate(interpolate(at(0, 0, k, l), at(1, 0, k, l), x), interpolate(at(0, 1, k, l), at(1, 1, k, l), x),
                       y);
  };
  const auto cube = [&](int l) __attribute__((always_inline)) { return interpolate(plane(0, l), plane(1, l), z); };
  const Bound<F> cell = interpolate(cube(0), cube(1), w);
  return narrowest(n.value(shift), F(4.75f) * (x.half + y.half + z.half + w.half), cell,
                   x.inCell & y.inCell & z.inCell & w.inCell, 0.8344f, 1.29f, nan);
}

template <FloatLanes F>
AEROSOL_INLINE IntOf<F> mayMiss(const Range<F>& x) {
  return x.nan | mayBeInfinite(x);
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> mayMiss(const Triple<Range<F>>& p) {
  return mayMiss(p.x) | mayMiss(p.y) | mayMiss(p.z);
}

/// A single value for periods: over a range of periods only the greatest value bounds the noise.
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> isPoint(const Triple<Range<F>>& p) {
  return isPoint(p.x) & isPoint(p.y) & isPoint(p.z);
}
template <FloatLanes F>
AEROSOL_INLINE Range<F> orWhole(IntOf<F> usable, const Range<F>& bound, float greatest) {
  return select(usable, bound, Range<F>{F(-greatest), F(greatest), bound.nan});
}

template <FloatLanes F>
AEROSOL_INLINE Triple<F> centreOf(const BoxAxis<F>& x, const BoxAxis<F>& y, const BoxAxis<F>& z) {
  return {x.centre, y.centre, z.centre};
}

template <class B>
AEROSOL_INLINE auto tripleOfBounds(const B& bound) -> Triple<decltype(bound(0u))> {
  return {bound(0u), bound(8u), bound(16u)};
}

}  // namespace detail

// For each arity a function of the shift that picks the component.

template <FloatLanes F>
AEROSOL_INLINE auto perlinBounds(const Range<F>& x) {
  const auto ax = detail::boxAxis(x);
  const auto nan = detail::mayMiss(x);
  const auto lattice = perlinLattice(ax.centre);
  return [=](std::uint32_t shift) __attribute__((always_inline)) { return detail::boundOf(lattice, ax, shift, nan); };
}
template <FloatLanes F>
AEROSOL_INLINE auto perlinBounds(const Range<F>& x, const Range<F>& y) {
  const auto ax = detail::boxAxis(x);
  const auto ay = detail::boxAxis(y);
  const auto nan = detail::mayMiss(x) | detail::mayMiss(y);
  const auto lattice = perlinLattice(ax.centre, ay.centre);
  return [=](std::uint32_t shift)
             __attribute__((always_inline)) { return detail::boundOf(lattice, ax, ay, shift, nan); };
}
template <FloatLanes F>
AEROSOL_INLINE auto perlinBounds(const Triple<Range<F>>& p) {
  const auto ax = detail::boxAxis(p.x);
  const auto ay = detail::boxAxis(p.y);
  const auto az = detail::boxAxis(p.z);
  const auto nan = detail::mayMiss(p);
  const auto lattice = perlinLattice(detail::centreOf(ax, ay, az));
  return [=](std::uint32_t shift)
             __attribute__((always_inline)) { return detail::boundOf(lattice, ax, ay, az, shift, nan); };
}
template <FloatLanes F>
AEROSOL_INLINE auto perlinBounds(const Triple<Range<F>>& p, const Range<F>& w) {
  const auto ax = detail::boxAxis(p.x);
  const auto ay = detail::boxAxis(p.y);
  const auto az = detail::boxAxis(p.z);
  const auto aw = detail::boxAxis(w);
  const auto nan = detail::mayMiss(p) | detail::mayMiss(w);
  const auto lattice = perlinLattice(detail::centreOf(ax, ay, az), aw.centre);
  return [=](std::uint32_t shift)
             __attribute__((always_inline)) { return detail::boundOf(lattice, ax, ay, az, aw, shift, nan); };
}
template <FloatLanes F>
AEROSOL_INLINE auto periodicPerlinBounds(const Range<F>& x, const Range<F>& px) {
  const auto ax = detail::boxAxis(x);
  const auto nan = detail::mayMiss(x);
  const auto usable = detail::isPoint(px);
  const auto lattice = periodicPerlinLattice(ax.centre, px.lo);
  return [=](std::uint32_t shift) __attribute__((always_inline)) {
    return detail::orWhole(usable, detail::boundOf(lattice, ax, shift, nan), 1.001f);
  };
}
template <FloatLanes F>
AEROSOL_INLINE auto periodicPerlinBounds(const Range<F>& x, const Range<F>& y, const Range<F>& px, const Range<F>& py) {
  const auto ax = detail::boxAxis(x);
  const auto ay = detail::boxAxis(y);
  const auto nan = detail::mayMiss(x) | detail::mayMiss(y);
  const auto usable = detail::isPoint(px) & detail::isPoint(py);
  const auto lattice = periodicPerlinLattice(ax.centre, ay.centre, px.lo, py.lo);
  return [=](std::uint32_t shift) __attribute__((always_inline)) {
    return detail::orWhole(usable, detail::boundOf(lattice, ax, ay, shift, nan), 1.001f);
  };
}
template <FloatLanes F>
AEROSOL_INLINE auto periodicPerlinBounds(const Triple<Range<F>>& p, const Triple<Range<F>>& pp) {
  const auto ax = detail::boxAxis(p.x);
  const auto ay = detail::boxAxis(p.y);
  const auto az = detail::boxAxis(p.z);
  const auto nan = detail::mayMiss(p);
  const auto usable = detail::isPoint(pp);
  const auto lattice = periodicPerlinLattice(detail::centreOf(ax, ay, az), Triple<F>{pp.x.lo, pp.y.lo, pp.z.lo});
  return [=](std::uint32_t shift) __attribute__((always_inline)) {
    return detail::orWhole(usable, detail::boundOf(lattice, ax, ay, az, shift, nan), 1.0185f);
  };
}
template <FloatLanes F>
AEROSOL_INLINE auto periodicPerlinBounds(const Triple<Range<F>>& p, const Range<F>& w, const Triple<Range<F>>& pp,
                                         const Range<F>& pw) {
  const auto ax = detail::boxAxis(p.x);
  const auto ay = detail::boxAxis(p.y);
  const auto az = detail::boxAxis(p.z);
  const auto aw = detail::boxAxis(w);
  const auto nan = detail::mayMiss(p) | detail::mayMiss(w);
  const auto usable = detail::isPoint(pp) & detail::isPoint(pw);
  const auto lattice =
      periodicPerlinLattice(detail::centreOf(ax, ay, az), aw.centre, Triple<F>{pp.x.lo, pp.y.lo, pp.z.lo}, pw.lo);
  return [=](std::uint32_t shift) __attribute__((always_inline)) {
    return detail::orWhole(usable, detail::boundOf(lattice, ax, ay, az, aw, shift, nan), 1.29f);
  };
}

template <class T>
struct IsRangeArgument : std::false_type {};
template <FloatLanes F>
struct IsRangeArgument<Range<F>> : std::true_type {};
template <FloatLanes F>
struct IsRangeArgument<Triple<Range<F>>> : std::true_type {};
template <class T>
concept RangeArgument = IsRangeArgument<T>::value;

template <RangeArgument F, class... More>
AEROSOL_INLINE auto perlin(F first, More... more) {
  return perlinBounds(first, more...)(0u);
}
template <RangeArgument F, class... More>
AEROSOL_INLINE auto perlinTriple(F first, More... more) {
  return detail::tripleOfBounds(perlinBounds(first, more...));
}
template <RangeArgument F, class... More>
AEROSOL_INLINE auto periodicPerlin(F first, More... more) {
  return periodicPerlinBounds(first, more...)(0u);
}
template <RangeArgument F, class... More>
AEROSOL_INLINE auto periodicPerlinTriple(F first, More... more) {
  return detail::tripleOfBounds(periodicPerlinBounds(first, more...));
}

}  // namespace aerosol::jit::runtime
