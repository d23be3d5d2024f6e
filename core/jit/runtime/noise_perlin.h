// Gradient noise (Perlin 2002) in one to four dimensions with the hash, gradients and scales of Open Shading Language.
//
// The value is a multilinear interpolation, by the quintic fade 6t^5 - 15t^4 + 10t^3, of the products gradient · offset
// at the corners of the lattice cell. Interpolation is a fused multiply-add on the difference; so values agree with
// those of OSL up to rounding. All corners are computed in one straight line, for the compiler to share the parts of
// their hashes that do not depend on all coordinates.
#pragma once

#include "core/jit/runtime/hash.h"
#include "core/jit/runtime/processor.h"
#include "core/jit/runtime/triple.h"

namespace aerosol::jit::runtime {

namespace detail {

/// One coordinate: the lattice cell (both ends, as hash words), the offsets from both ends, and the fade.
template <FloatLanes F>
struct LatticeAxis {
  UintOf<F> cell[2];
  F offset[2];
  F fade;
};

/// The lattice without period. Coordinates beyond the ints have no fraction, and noise 0.
struct Aperiodic {};

/// A lattice that repeats after floor(period) cells, at least 1.
template <FloatLanes F>
struct Period {
  F length;
};

/// Whole numbers below this in magnitude are taken modulo a period in one step.
inline constexpr float nearCells = 4194304.0f;

/// a modulo b for whole numbers, |a| <= 2^31, 1 <= b < 2^31: exact, in [0, b).
template <FloatLanes F>
AEROSOL_INLINE F wholeModulo(F a, F b) {
  F r = fma(-floor(a / b), b, a);
  r = fma(-floor(r / b), b, r);
  r = select(less(r, F(0.0f)), r + b, r);
  return select(greaterEqual(r, b), r - b, r);
}

/// The same for |a| < `nearCells` and b no greater, by the reciprocal of b, which uniform periods compute once:
/// (a + 1/2) / b is at least 1 / (2b) from a whole number, and the product is off by less than that, |a| 2^-23 / b.
template <FloatLanes F>
AEROSOL_INLINE F nearModulo(F a, F b, F reciprocal) {
  return fma(-floor(fma(a, reciprocal, F(0.5f) * reciprocal)), b, a);
}

template <FloatLanes F>
AEROSOL_INLINE LatticeAxis<F> latticeAxis(F x, Aperiodic) {
  using U = UintOf<F>;
  const F low = floor(x);
  const F t = x - low;
  const U cell = asUint(convertTruncating(low));
  return {{cell, cell + U(1u)}, {t, t - F(1.0f)}, t * t * t * fma(t, fma(t, F(6.0f), F(-15.0f)), F(10.0f))};
}

template <FloatLanes F>
AEROSOL_INLINE LatticeAxis<F> latticeAxis(F x, Period<F> period) {
  using U = UintOf<F>;
  LatticeAxis<F> axis = latticeAxis(x, Aperiodic{});
  const F length = max(min(floor(period.length), F(2147483520.0f)), F(1.0f));
  const F low = floor(x);
  F index = nearModulo(low, length, F(1.0f) / length);
  const F limit = select(lessEqual(length, F(nearCells)), F(nearCells), F(0.0f));
  const IntOf<F> isFar = ~less(abs(low), limit);
  if (any(isFar)) [[unlikely]] {
    const F held = max(min(low, F(2147483520.0f)), F(-2147483648.0f));
    index = select(isFar, wholeModulo(held, length), index);
  }
  axis.cell[0] = asUint(convertTruncating(index));
  const U next = axis.cell[0] + U(1u);
  axis.cell[1] = select(equal(next, asUint(convertTruncating(length))), U(0u), next);
  return axis;
}

template <FloatLanes F>
AEROSOL_INLINE F interpolate(F a, F b, F t) {
  return fma(t, b - a, a);
}

/// x with its sign flipped where the bit of h is set.
template <FloatLanes F>
AEROSOL_INLINE F flipSign(F x, UintOf<F> h, std::uint32_t bit) {
  using U = UintOf<F>;
  return asFloat(asUint(x) ^ ((h << U(31u - bit)) & U(0x80000000u)));
}
template <UintLanes U>
AEROSOL_INLINE IntOf<U> noBits(U h, std::uint32_t bits) {
  return equal(h & U(bits), U(0u));
}

/// `select` on bits for a single lane, which would otherwise become a jump that is predicted wrongly half of the time.
template <FloatLanes F>
AEROSOL_INLINE F pick(IntOf<F> mask, F a, F b) {
  if constexpr (widthOf<F> == 1) {
    return asFloat(asInt(b) ^ ((asInt(a) ^ asInt(b)) & mask));
  } else {
    return select(mask, a, b);
  }
}

/// Gradient · offset. The gradients: ±1 … ±8; (±1, ±2) and (±2, ±1); the midpoints of a cube's edges, four of them
/// twice; the midpoints of a hypercube's edges.
template <FloatLanes F>
AEROSOL_INLINE F gradient(UintOf<F> h, F x) {
  using U = UintOf<F>;
  const F g = toFloat(asInt((h & U(7u)) + U(1u)));
  return flipSign(g, h, 3) * x;
}
template <FloatLanes F>
AEROSOL_INLINE F gradient(UintOf<F> h, F x, F y) {
  const auto first = noBits(h, 4);
  const F u = pick(first, x, y);
  const F v = pick(first, y, x);
  return fma(flipSign(v, h, 1), F(2.0f), flipSign(u, h, 0));
}
template <FloatLanes F>
AEROSOL_INLINE F gradient(UintOf<F> h, F x, F y, F z) {
  if constexpr (hasTablePermute<F>) {
    if (processorHasAvx512()) {
      using Table = Wide<float, 16>;
      const Table gx = {1, -1, 1, -1, 1, -1, 1, -1, 0, 0, 0, 0, 1, 0, -1, 0};
      const Table gy = {1, 1, -1, -1, 0, 0, 0, 0, 1, -1, 1, -1, 1, -1, 1, -1};
      const Table gz = {0, 0, 0, 0, 1, 1, -1, -1, 1, 1, -1, -1, 0, 1, 0, -1};
      // One factor is 0 and the others ±1: rounded once, like the sum below.
      return fma(permute16(gz, h), z, fma(permute16(gy, h), y, permute16(gx, h) * x));
    }
  }
  using U = UintOf<F>;
  const F u = pick(noBits(h, 8), x, y);
  const F v = pick(noBits(h, 12), y, pick(equal(h & U(13u), U(12u)), x, z));
  return flipSign(u, h, 0) + flipSign(v, h, 1);
}
template <FloatLanes F>
AEROSOL_INLINE F gradient(UintOf<F> h, F x, F y, F z, F w) {
  using U = UintOf<F>;
  const auto low = noBits(h, 24);    // h < 8
  const auto lower = noBits(h, 16);  // h < 16
  const auto top = equal(h & U(24u), U(24u));
  const F u = pick(top, y, x);
  const F v = pick(lower, y, z);
  const F s = pick(low, z, w);
  return flipSign(u, h, 0) + flipSign(v, h, 1) + flipSign(s, h, 2);
}

// The interpolations over the corners' hashes. `shift` picks the bits of the hash: one byte a component of the result.

/// -0 becomes 0, so that ways that differ in the signs of zeros give the same bits.
template <FloatLanes F>
AEROSOL_INLINE F scaled(F value, float scale) {
  return fma(value, F(scale), F(0.0f));
}

template <FloatLanes F>
struct Lattice1 {
  LatticeAxis<F> x;
  UintOf<F> hash[2];

  template <class P>
  AEROSOL_INLINE Lattice1(F px, P periodX)
      : x(latticeAxis(px, periodX)), hash{hashWords(x.cell[0]), hashWords(x.cell[1])} {}

  AEROSOL_INLINE F value(std::uint32_t shift) const {
    const auto at = [&](int i)
                        __attribute__((always_inline)) { return gradient(hash[i] >> UintOf<F>(shift), x.offset[i]); };
    return scaled(interpolate(at(0), at(1), x.fade), 0.25f);
  }
};

template <FloatLanes F>
struct Lattice2 {
  LatticeAxis<F> x, y;
  UintOf<F> hash[2][2];

  template <class P>
  AEROSOL_INLINE Lattice2(F px, F py, P periodX, P periodY)
      : x(latticeAxis(px, periodX)),
        y(latticeAxis(py, periodY)),
        hash{{hashWords(x.cell[0], y.cell[0]), hashWords(x.cell[0], y.cell[1])},
             {hashWords(x.cell[1], y.cell[0]), hashWords(x.cell[1], y.cell[1])}} {}

  AEROSOL_INLINE F value(std::uint32_t shift) const {
    const auto at = [&](int i, int j) __attribute__((always_inline)) {
      return gradient(hash[i][j] >> UintOf<F>(shift), x.offset[i], y.offset[j]);
    };
    const F low = interpolate(at(0, 0), at(1, 0), x.fade);
    const F high = interpolate(at(0, 1), at(1, 1), x.fade);
    return scaled(interpolate(low, high, y.fade), 0.6616f);
  }
};

template <FloatLanes F>
struct Lattice3 {
  LatticeAxis<F> x, y, z;
  UintOf<F> hash[2][2][2];

  template <class P>
  AEROSOL_INLINE Lattice3(F px, F py, F pz, P periodX, P periodY, P periodZ)
      : x(latticeAxis(px, periodX)),
        y(latticeAxis(py, periodY)),
        z(latticeAxis(pz, periodZ)),
        hash{{{corner(0, 0, 0), corner(0, 0, 1)}, {corner(0, 1, 0), corner(0, 1, 1)}},
             {{corner(1, 0, 0), corner(1, 0, 1)}, {corner(1, 1, 0), corner(1, 1, 1)}}} {}

  AEROSOL_INLINE UintOf<F> corner(int i, int j, int k) const { return hashWords(x.cell[i], y.cell[j], z.cell[k]); }

  AEROSOL_INLINE F value(std::uint32_t shift) const {
    const auto at = [&](int i, int j, int k) __attribute__((always_inline)) {
      return gradient(hash[i][j][k] >> UintOf<F>(shift), x.offset[i], y.offset[j], z.offset[k]);
    };
    const auto plane = [&](int k) __attribute__((always_inline)) {
      const F low = interpolate(at(0, 0, k), at(1, 0, k), x.fade);
      const F high = interpolate(at(0, 1, k), at(1, 1, k), x.fade);
      return interpolate(low, high, y.fade);
    };
    return scaled(interpolate(plane(0), plane(1), z.fade), 0.982f);
  }
};

template <FloatLanes F>
struct Lattice4 {
  LatticeAxis<F> x, y, z, w;
  UintOf<F> hash[2][2][2][2];

  template <class P>
  AEROSOL_INLINE Lattice4(F px, F py, F pz, F pw, P periodX, P periodY, P periodZ, P periodW)
      : x(latticeAxis(px, periodX)),
        y(latticeAxis(py, periodY)),
        z(latticeAxis(pz, periodZ)),
        w(latticeAxis(pw, periodW)),
        hash{{{{corner(0, 0, 0, 0), corner(0, 0, 0, 1)}, {corner(0, 0, 1, 0), corner(0, 0, 1, 1)}},
              {{corner(0, 1, 0, 0), corner(0, 1, 0, 1)}, {corner(0, 1, 1, 0), corner(0, 1, 1, 1)}}},
             {{{corner(1, 0, 0, 0), corner(1, 0, 0, 1)}, {corner(1, 0, 1, 0), corner(1, 0, 1, 1)}},
              {{corner(1, 1, 0, 0), corner(1, 1, 0, 1)}, {corner(1, 1, 1, 0), corner(1, 1, 1, 1)}}}} {}

  AEROSOL_INLINE UintOf<F> corner(int i, int j, int k, int l) const {
    return hashWords(x.cell[i], y.cell[j], z.cell[k], w.cell[l]);
  }

  AEROSOL_INLINE F value(std::uint32_t shift) const {
    const auto at = [&](int i, int j, int k, int l) __attribute__((always_inline)) {
      return gradient(hash[i][j][k][l] >> UintOf<F>(shift), x.offset[i], y.offset[j], z.offset[k], w.offset[l]);
    };
    const auto plane = [&](int k, int l) __attribute__((always_inline)) {
      const F low = interpolate(at(0, 0, k, l), at(1, 0, k, l), x.fade);
      const F high = interpolate(at(0, 1, k, l), at(1, 1, k, l), x.fade);
      return interpolate(low, high, y.fade);
    };
    const auto cube = [&](int l)
                          __attribute__((always_inline)) { return interpolate(plane(0, l), plane(1, l), z.fade); };
    return scaled(interpolate(cube(0), cube(1), w.fade), 0.8344f);
  }
};

template <class L>
AEROSOL_INLINE auto tripleOf(const L& lattice) -> Triple<decltype(lattice.value(0))> {
  return {lattice.value(0), lattice.value(8), lattice.value(16)};
}

}  // namespace detail

/// Signed Perlin noise: a lattice per call, for a float (`floatPerlin`) or triple (`triplePerlin`) result.
template <FloatLanes F>
AEROSOL_INLINE auto perlinLattice(F x) {
  constexpr detail::Aperiodic none;
  return detail::Lattice1<F>(x, none);
}
template <FloatLanes F>
AEROSOL_INLINE auto perlinLattice(F x, F y) {
  constexpr detail::Aperiodic none;
  return detail::Lattice2<F>(x, y, none, none);
}
template <FloatLanes F>
AEROSOL_INLINE auto perlinLattice(Triple<F> p) {
  constexpr detail::Aperiodic none;
  return detail::Lattice3<F>(p.x, p.y, p.z, none, none, none);
}
template <FloatLanes F>
AEROSOL_INLINE auto perlinLattice(Triple<F> p, F w) {
  constexpr detail::Aperiodic none;
  return detail::Lattice4<F>(p.x, p.y, p.z, w, none, none, none, none);
}
template <FloatLanes F>
AEROSOL_INLINE auto periodicPerlinLattice(F x, F period) {
  return detail::Lattice1<F>(x, detail::Period<F>{period});
}
template <FloatLanes F>
AEROSOL_INLINE auto periodicPerlinLattice(F x, F y, F periodX, F periodY) {
  return detail::Lattice2<F>(x, y, detail::Period<F>{periodX}, detail::Period<F>{periodY});
}
template <FloatLanes F>
AEROSOL_INLINE auto periodicPerlinLattice(Triple<F> p, Triple<F> period) {
  return detail::Lattice3<F>(p.x, p.y, p.z, detail::Period<F>{period.x}, detail::Period<F>{period.y},
                             detail::Period<F>{period.z});
}
template <FloatLanes F>
AEROSOL_INLINE auto periodicPerlinLattice(Triple<F> p, F w, Triple<F> period, F periodW) {
  return detail::Lattice4<F>(p.x, p.y, p.z, w, detail::Period<F>{period.x}, detail::Period<F>{period.y},
                             detail::Period<F>{period.z}, detail::Period<F>{periodW});
}

// The functions of the language. Each takes (x), (x, y), (p) or (p, t); the periodic ones the periods after that.

template <class F, class... More>
AEROSOL_INLINE auto perlin(F first, More... more) {
  return perlinLattice(first, more...).value(0);
}
template <class F, class... More>
AEROSOL_INLINE auto perlinTriple(F first, More... more) {
  return detail::tripleOf(perlinLattice(first, more...));
}
template <class F, class... More>
AEROSOL_INLINE auto periodicPerlin(F first, More... more) {
  return periodicPerlinLattice(first, more...).value(0);
}
template <class F, class... More>
AEROSOL_INLINE auto periodicPerlinTriple(F first, More... more) {
  return detail::tripleOf(periodicPerlinLattice(first, more...));
}
template <class F, class... More>
AEROSOL_INLINE auto unsignedPerlin(F first, More... more) {
  return toUnsigned(perlin(first, more...));
}
template <class F, class... More>
AEROSOL_INLINE auto unsignedPerlinTriple(F first, More... more) {
  return toUnsigned(perlinTriple(first, more...));
}
template <class F, class... More>
AEROSOL_INLINE auto periodicUnsignedPerlin(F first, More... more) {
  return toUnsigned(periodicPerlin(first, more...));
}
template <class F, class... More>
AEROSOL_INLINE auto periodicUnsignedPerlinTriple(F first, More... more) {
  return toUnsigned(periodicPerlinTriple(first, more...));
}

}  // namespace aerosol::jit::runtime
