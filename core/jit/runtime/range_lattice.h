// Perlin noise over boxes, in any number of dimensions up to four.
//
// A box is cut into pieces that each lie within one cell of the lattice (at a cell's boundary, or in the middle where
// it is long), two along an axis at most; a longer box has the greatest value of the noise. Within a cell the noise is
// a polynomial: the fades are expanded about the piece's centre, the products gradient · offset are linear, and the
// interpolation is carried out on forms centre + slope · e, |e| <= 1, with a rest for what is of higher order. Beside
// it ranges are interpolated: fades rise and the products have exact ranges, which is better for large pieces. Over all
// pieces together one line is chosen, the mean of theirs, with the distance of the furthest piece from it.
#pragma once

#include "core/jit/runtime/noise_perlin.h"
#include "core/jit/runtime/range.h"

namespace aerosol::jit::runtime::detail {

// Gradients by their components (see `gradient`).
template <FloatLanes F>
AEROSOL_INLINE F signedOne(UintOf<F> h, std::uint32_t bit) {
  return flipSign(F(1.0f), h, bit);
}
template <FloatLanes F>
AEROSOL_INLINE void gradientOf(UintOf<F> h, F (&g)[1]) {
  using U = UintOf<F>;
  g[0] = flipSign(toFloat(asInt((h & U(7u)) + U(1u))), h, 3);
}
template <FloatLanes F>
AEROSOL_INLINE void gradientOf(UintOf<F> h, F (&g)[2]) {
  const auto first = noBits(h, 4);
  const F one = signedOne<F>(h, 0);
  const F two = F(2.0f) * signedOne<F>(h, 1);
  g[0] = select(first, one, two);
  g[1] = select(first, two, one);
}
template <FloatLanes F>
AEROSOL_INLINE void gradientOf(UintOf<F> h, F (&g)[3]) {
  using U = UintOf<F>;
  const F zero = F(0.0f);
  const F u = signedOne<F>(h, 0);
  const F v = signedOne<F>(h, 1);
  const auto uIsX = noBits(h, 8);
  const auto vIsY = noBits(h, 12);
  const auto vIsX = equal(h & U(13u), U(12u));
  g[0] = select(uIsX, u, select(vIsX & ~vIsY, v, zero));
  g[1] = select(uIsX, zero, u) + select(vIsY, v, zero);
  g[2] = select(vIsY | vIsX, zero, v);
}
template <FloatLanes F>
AEROSOL_INLINE void gradientOf(UintOf<F> h, F (&g)[4]) {
  using U = UintOf<F>;
  const F zero = F(0.0f);
  const F u = signedOne<F>(h, 0);
  const F v = signedOne<F>(h, 1);
  const F s = signedOne<F>(h, 2);
  const auto uIsY = equal(h & U(24u), U(24u));
  const auto vIsY = noBits(h, 16);
  const auto sIsZ = noBits(h, 24);
  g[0] = select(uIsY, zero, u);
  g[1] = select(uIsY, u, zero) + select(vIsY, v, zero);
  g[2] = select(vIsY, zero, v) + select(sIsZ, s, zero);
  g[3] = select(sIsZ, zero, s);
}

template <FloatLanes F>
AEROSOL_INLINE UintOf<F> latticeHash(const UintOf<F> (&c)[1]) {
  return hashWords(c[0]);
}
template <FloatLanes F>
AEROSOL_INLINE UintOf<F> latticeHash(const UintOf<F> (&c)[2]) {
  return hashWords(c[0], c[1]);
}
template <FloatLanes F>
AEROSOL_INLINE UintOf<F> latticeHash(const UintOf<F> (&c)[3]) {
  return hashWords(c[0], c[1], c[2]);
}
template <FloatLanes F>
AEROSOL_INLINE UintOf<F> latticeHash(const UintOf<F> (&c)[4]) {
  return hashWords(c[0], c[1], c[2], c[3]);
}

template <FloatLanes F>
struct Bound {
  F lo, hi;
};

/// centre + slope · e, off by `rest` at most, for e in [-1, 1]^N.
template <FloatLanes F, int N>
struct LocalForm {
  F centre;
  F slope[N];
  F rest;
};

template <FloatLanes F>
AEROSOL_INLINE F fadeOf(F t) {
  return t * t * t * fma(t, fma(t, F(6.0f), F(-15.0f)), F(10.0f));
}

/// The fade over t ± half: as a line with its greatest distance, and as a range.
template <FloatLanes F>
struct FadeForm {
  F centre, slope, rest;
  F lo, hi;
};

/// By Taylor's formula, which ends at the fifth order: e^2 and e^4 are in [0, 1], e^3 within 1/4 of 3/4 e, e^5 within
/// 0.331 of 0.67 e.
template <FloatLanes F>
AEROSOL_INLINE FadeForm<F> fadeForm(F t, F half) {
  const F rest = F(1.0f) - t;
  const F product = t * rest;
  const F square = half * half;
  const F first = F(30.0f) * product * product * half;
  const F second = F(30.0f) * product * (rest - t) * square;
  const F third = (F(10.0f) - F(60.0f) * product) * square * half;
  const F fourth = F(15.0f) * (t - rest) * square * square;
  const F fifth = F(6.0f) * square * square * half;
  const F lo = fma(fadeOf(max(t - half, F(0.0f))), F(1.0f - 1e-6f), F(-1e-12f));
  const F hi = fma(fadeOf(min(t + half, F(1.0f))), F(1.0f + 1e-6f), F(1e-12f));
  return {fma(second + fourth, F(0.5f), fadeOf(t)), fma(third, F(0.75f), fma(fifth, F(0.67f), first)),
          F(0.5f) * (abs(second) + abs(fourth)) + F(0.25f) * abs(third) + F(0.331f) * fifth, max(lo, F(0.0f)),
          min(hi, F(1.0f))};
}

/// a + u (b - a), where u depends on the coordinate `axis` alone.
template <FloatLanes F, int N>
AEROSOL_INLINE LocalForm<F, N> interpolate(const LocalForm<F, N>& a, const LocalForm<F, N>& b, const FadeForm<F>& u,
                                           int axis) {
  LocalForm<F, N> result;
  const F centre = b.centre - a.centre;
  F size = abs(centre);
  F others = F(0.0f);
  F own = F(0.0f);
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) {
    const F difference = b.slope[i] - a.slope[i];
    result.slope[i] = fma(u.centre, difference, a.slope[i]);
    size += abs(difference);
    if (i == axis) {
      own = difference;
      result.slope[i] = fma(u.slope, centre, result.slope[i]);
    } else {
      others += abs(difference);
    }
  }
  const F second = F(0.5f) * u.slope * own;
  const F steep = abs(u.slope);
  const F restDifference = b.rest - a.rest;
  result.centre = fma(u.centre, centre, a.centre) + second;
  result.rest = fma(steep, others, abs(second)) + fma(u.rest, size, fma(u.centre, restDifference, a.rest)) +
                (steep + u.rest) * abs(restDifference);
  return result;
}

/// Both ends are linear in the fade, so its ends give the extremes.
template <FloatLanes F>
AEROSOL_INLINE Bound<F> interpolate(const Bound<F>& a, const Bound<F>& b, const FadeForm<F>& u) {
  return {min(interpolate(a.lo, b.lo, u.lo), interpolate(a.lo, b.lo, u.hi)),
          max(interpolate(a.hi, b.hi, u.lo), interpolate(a.hi, b.hi, u.hi))};
}

/// Noise over a box: its range, and centre + slope · (q - middle), off by `rest`, for q in the box.
template <FloatLanes F, int N>
struct BoxNoise {
  F lo, hi;
  F centre;
  F slope[N];
  F rest;
};

/// Axes longer than this, in cells, are cut in the middle when no boundary cuts them.
inline constexpr float longestPiece = 0.4f;
/// What kernels and this text round, with much room.
inline constexpr float latticeSlack = 1.2e-5f;

/// The box of the noise's arguments. `middle` is where its lines are anchored.
template <FloatLanes F, int N>
struct LatticeBox {
  F low[N], high[N];
  F middle[N];
  F cut[N];
  F cell[N];  ///< Of the first piece.
  IntOf<F> isCut[N], crosses[N];
  IntOf<F> known;  ///< Few enough cells, and finite.

  AEROSOL_INLINE explicit LatticeBox(const Range<F> (&q)[N]) {
    known = ~IntOf<F>(0);
#pragma clang loop unroll(full)
    for (int i = 0; i < N; ++i) {
      const auto finite = less(max(abs(q[i].lo), abs(q[i].hi)), F(1e30f));
      low[i] = select(finite, q[i].lo, F(0.0f));
      high[i] = select(finite, q[i].hi, F(0.0f));
      const F width = high[i] - low[i];
      middle[i] = fma(width, F(0.5f), low[i]);
      cell[i] = floor(low[i]);
      const F next = cell[i] + F(1.0f);
      crosses[i] = less(next, high[i]);
      isCut[i] = crosses[i] | greater(width, F(longestPiece));
      cut[i] = select(crosses[i], next, middle[i]);
      known &= finite & lessEqual(high[i], next + F(1.0f));
    }
  }
};

/// One piece: the noise as a line from its own centre, and its range.
template <FloatLanes F, int N>
struct Piece {
  IntOf<F> valid;
  F middle[N], half[N];
  F centre, slope[N], rest;
  F lo, hi;
};

/// The noise of each of C components (bytes of the hash) in one piece. `periods` are what `latticeAxis` takes.
template <int C, FloatLanes F, int N, class P>
AEROSOL_INLINE void evaluatePiece(const LatticeBox<F, N>& box, const P (&periods)[N], int number, float scale,
                                  Piece<F, N> (&pieces)[C]) {
  constexpr int corners = 1 << N;
  F t[N], half[N];
  FadeForm<F> fade[N];
  UintOf<F> cells[N][2];
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) {
    const bool second = (number >> i & 1) != 0;
    const F a = second ? box.cut[i] : box.low[i];
    const F b = second ? box.high[i] : select(box.isCut[i], box.cut[i], box.high[i]);
    const F cell = second ? select(box.crosses[i], box.cell[i] + F(1.0f), box.cell[i]) : box.cell[i];
    const F middle = max(min(fma(b - a, F(0.5f), a), b), a);
    half[i] = select(equal(a, b), F(0.0f), nextUp(max(b - middle, middle - a)));
    t[i] = middle - cell;
    fade[i] = fadeForm(t[i], half[i]);
    const LatticeAxis<F> axis = latticeAxis(cell, periods[i]);
    cells[i][0] = axis.cell[0];
    cells[i][1] = axis.cell[1];
#pragma clang loop unroll(full)
    for (int c = 0; c < C; ++c) {
      pieces[c].middle[i] = middle;
      pieces[c].half[i] = half[i];
    }
  }
  LocalForm<F, N> forms[C][corners];
  Bound<F> bounds[C][corners];
#pragma clang loop unroll(full)
  for (int k = 0; k < corners; ++k) {
    UintOf<F> words[N];
#pragma clang loop unroll(full)
    for (int i = 0; i < N; ++i) words[i] = cells[i][k >> i & 1];
    const UintOf<F> hash = latticeHash<F>(words);
#pragma clang loop unroll(full)
    for (int c = 0; c < C; ++c) {
      F g[N];
      gradientOf<F>(hash >> UintOf<F>(static_cast<std::uint32_t>(8 * c)), g);
      LocalForm<F, N>& form = forms[c][k];
      form.centre = F(0.0f);
      form.rest = F(0.0f);
      F radius = F(0.0f);
#pragma clang loop unroll(full)
      for (int i = 0; i < N; ++i) {
        form.centre = fma(g[i], t[i] - F(static_cast<float>(k >> i & 1)), form.centre);
        form.slope[i] = g[i] * half[i];
        radius += abs(form.slope[i]);
      }
      bounds[c][k] = {form.centre - radius, form.centre + radius};
    }
  }
#pragma clang loop unroll(full)
  for (int c = 0; c < C; ++c) {
#pragma clang loop unroll(full)
    for (int i = 0; i < N; ++i) {
#pragma clang loop unroll(full)
      for (int k = 0; k < corners >> (i + 1); ++k) {
        forms[c][k] = interpolate<F, N>(forms[c][2 * k], forms[c][2 * k + 1], fade[i], i);
        bounds[c][k] = interpolate(bounds[c][2 * k], bounds[c][2 * k + 1], fade[i]);
      }
    }
    Piece<F, N>& piece = pieces[c];
    const LocalForm<F, N>& form = forms[c][0];
    piece.centre = form.centre * F(scale);
    piece.rest = form.rest * F(scale * 1.00001f);
    F radius = piece.rest;
#pragma clang loop unroll(full)
    for (int i = 0; i < N; ++i) {
      const F slope = form.slope[i] * F(scale);
      radius += abs(slope);
      piece.slope[i] = select(greater(half[i], F(0.0f)), slope / half[i], F(0.0f));
    }
    piece.lo = max(piece.centre - radius, bounds[c][0].lo * F(scale));
    piece.hi = min(piece.centre + radius, bounds[c][0].hi * F(scale));
  }
}

/// All pieces together.
template <FloatLanes F, int N>
AEROSOL_INLINE BoxNoise<F, N> combine(const LatticeBox<F, N>& box, const Piece<F, N>* pieces, int stride,
                                      float greatest) {
  constexpr int count = 1 << N;
  BoxNoise<F, N> result;
  F sums[N], total = F(1e-30f);
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) sums[i] = F(0.0f);
  F lo = F(greatest), hi = F(-greatest);
#pragma clang loop unroll(disable)
  for (int p = 0; p < count; ++p) {
    const Piece<F, N>& piece = pieces[p * stride];
    if (!any(piece.valid)) continue;
    lo = select(piece.valid, min(lo, piece.lo), lo);
    hi = select(piece.valid, max(hi, piece.hi), hi);
    F volume = F(1.0f);
#pragma clang loop unroll(full)
    for (int i = 0; i < N; ++i) volume *= piece.half[i] + F(1e-6f);
    volume = select(piece.valid, volume, F(0.0f));
    total += volume;
#pragma clang loop unroll(full)
    for (int i = 0; i < N; ++i) sums[i] = fma(volume, piece.slope[i], sums[i]);
  }
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) result.slope[i] = select(box.known, sums[i] / total, F(0.0f));
  F least = F(infinity), most = F(-infinity);
#pragma clang loop unroll(disable)
  for (int p = 0; p < count; ++p) {
    const Piece<F, N>& piece = pieces[p * stride];
    if (!any(piece.valid)) continue;
    F shift = F(0.0f), radius = piece.rest, reach = F(0.0f);
#pragma clang loop unroll(full)
    for (int i = 0; i < N; ++i) {
      shift = fma(result.slope[i], piece.middle[i] - box.middle[i], shift);
      radius = fma(abs(piece.slope[i] - result.slope[i]), piece.half[i], radius);
      reach = fma(abs(result.slope[i]), piece.half[i], reach);
    }
    const F low = max(piece.centre - radius, piece.lo - reach) - shift;
    const F high = min(piece.centre + radius, piece.hi + reach) - shift;
    least = select(piece.valid, min(least, low), least);
    most = select(piece.valid, max(most, high), most);
  }
  result.lo = select(box.known, max(lo - F(latticeSlack), F(-greatest)), F(-greatest));
  result.hi = select(box.known, min(hi + F(latticeSlack), F(greatest)), F(greatest));
  result.centre = select(box.known, F(0.5f) * (least + most), F(0.0f));
  result.rest = select(box.known, F(0.5f) * (most - least) + F(latticeSlack), F(greatest));
  return result;
}

template <int C, FloatLanes F, int N, class P>
AEROSOL_INLINE void boxNoise(const LatticeBox<F, N>& box, const P (&periods)[N], float scale, float greatest,
                             BoxNoise<F, N> (&results)[C]) {
  constexpr int count = 1 << N;
  Piece<F, N> pieces[count][C];
#pragma clang loop unroll(disable)
  for (int p = 0; p < count; ++p) {
    IntOf<F> valid = box.known;
#pragma clang loop unroll(full)
    for (int i = 0; i < N; ++i) valid &= (p >> i & 1) != 0 ? box.isCut[i] : ~IntOf<F>(0);
#pragma clang loop unroll(full)
    for (int c = 0; c < C; ++c) pieces[p][c].valid = valid;
    if (any(valid)) evaluatePiece<C>(box, periods, p, scale, pieces[p]);
  }
#pragma clang loop unroll(full)
  for (int c = 0; c < C; ++c) results[c] = combine<F, N>(box, &pieces[0][c], C, greatest);
}

}  // namespace aerosol::jit::runtime::detail
