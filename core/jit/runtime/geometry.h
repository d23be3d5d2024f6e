// Vectors and matrices over any number type: written with the operators, comparisons and functions that every number
// type has, so that ranges follow from the same text.
#pragma once

#include "core/jit/runtime/math_basic.h"
#include "core/jit/runtime/triple.h"

namespace aerosol::jit::runtime {

template <class F>
AEROSOL_INLINE F dot(const Triple<F>& a, const Triple<F>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class F>
AEROSOL_INLINE F lengthSquared(const Triple<F>& v) {
  return square(v.x) + square(v.y) + square(v.z);
}
template <class F>
AEROSOL_INLINE Triple<F> cross(const Triple<F>& a, const Triple<F>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Also where squares would underflow or overflow: such vectors, when any lane has one, are scaled by a power of two.
template <FloatLanes F>
AEROSOL_INLINE F length(const Triple<F>& v) {
  using I = IntOf<F>;
  const F squares = lengthSquared(v);
  const F plain = rawSqrt(squares);
  const I extreme = less(squares, F(1e-30f)) | greater(squares, F(1e37f));
  if (!any(extreme)) [[likely]]
    return plain;
  const I small = less(squares, F(1.0f));
  const F up = select(small, F(1.26765060e+30f), F(7.88860905e-31f));  // 2^100, 2^-100
  const F down = select(small, F(7.88860905e-31f), F(1.26765060e+30f));
  return select(extreme, rawSqrt(lengthSquared(v * up)) * down, plain);
}
template <class F>
AEROSOL_INLINE F distance(const Triple<F>& a, const Triple<F>& b) {
  return length(a - b);
}

/// 0 for a vector of length 0.
template <FloatLanes F>
AEROSOL_INLINE Triple<F> normalize(const Triple<F>& v) {
  using I = IntOf<F>;
  const F squares = lengthSquared(v);
  const I extreme = less(squares, F(1e-30f)) | greater(squares, F(1e37f));
  Triple<F> scaled = v;
  F norm = rawSqrt(squares);
  if (any(extreme)) [[unlikely]] {
    const F up = select(less(squares, F(1.0f)), F(1.26765060e+30f), F(7.88860905e-31f));
    scaled = v * select(extreme, up, F(1.0f));
    norm = rawSqrt(lengthSquared(scaled));
  }
  return {safeDivide(scaled.x, norm), safeDivide(scaled.y, norm), safeDivide(scaled.z, norm)};
}

template <class F>
AEROSOL_INLINE Triple<F> faceforward(const Triple<F>& n, const Triple<F>& i, const Triple<F>& reference) {
  return select(greater(dot(i, reference), F(0.0f)), -n, n);
}

/// i - 2 (n · i) n.
template <class F>
AEROSOL_INLINE Triple<F> reflect(const Triple<F>& i, const Triple<F>& n) {
  return i - n * (F(2.0f) * dot(n, i));
}

/// Refracted direction, eta the index of the side of i over the other one; 0 on total reflection.
template <class F>
AEROSOL_INLINE Triple<F> refract(const Triple<F>& i, const Triple<F>& n, const F& eta) {
  const F cosine = dot(i, n);
  const F k = F(1.0f) - square(eta) * (F(1.0f) - square(cosine));
  const Triple<F> through = i * eta - n * (eta * cosine + sqrt(k));
  const F zero = F(0.0f);
  return select(less(k, zero), Triple<F>{zero, zero, zero}, through);
}

template <class F>
AEROSOL_INLINE Matrix<F> diagonal(const F& value) {
  const F zero = F(0.0f);
  return {{value, zero, zero, zero, zero, value, zero, zero, zero, zero, value, zero, zero, zero, zero, value}};
}

template <class F>
AEROSOL_INLINE Matrix<F> multiply(const Matrix<F>& a, const Matrix<F>& b) {
  Matrix<F> result;
#pragma clang loop unroll(full)
  for (int row = 0; row < 4; ++row) {
#pragma clang loop unroll(full)
    for (int column = 0; column < 4; ++column) {
      result.m[4 * row + column] = a.m[4 * row] * b.m[column] + a.m[4 * row + 1] * b.m[4 + column] +
                                   a.m[4 * row + 2] * b.m[8 + column] + a.m[4 * row + 3] * b.m[12 + column];
    }
  }
  return result;
}

template <class F>
AEROSOL_INLINE Matrix<F> multiply(const Matrix<F>& a, const F& b) {
  Matrix<F> result;
#pragma clang loop unroll(full)
  for (int i = 0; i < 16; ++i) result.m[i] = a.m[i] * b;
  return result;
}

template <class F>
AEROSOL_INLINE Matrix<F> transpose(const Matrix<F>& a) {
  Matrix<F> result;
#pragma clang loop unroll(full)
  for (int row = 0; row < 4; ++row) {
#pragma clang loop unroll(full)
    for (int column = 0; column < 4; ++column) result.m[4 * row + column] = a.m[4 * column + row];
  }
  return result;
}

namespace detail {

/// The 2x2 minors of the upper two and of the lower two rows (Laplace expansion).
template <class F>
struct Minors {
  F upper[6];
  F lower[6];
};

template <class F>
AEROSOL_INLINE Minors<F> minors(const Matrix<F>& a) {
  const F* m = a.m;
  return {{m[0] * m[5] - m[1] * m[4], m[0] * m[6] - m[2] * m[4], m[0] * m[7] - m[3] * m[4], m[1] * m[6] - m[2] * m[5],
           m[1] * m[7] - m[3] * m[5], m[2] * m[7] - m[3] * m[6]},
          {m[8] * m[13] - m[9] * m[12], m[8] * m[14] - m[10] * m[12], m[8] * m[15] - m[11] * m[12],
           m[9] * m[14] - m[10] * m[13], m[9] * m[15] - m[11] * m[13], m[10] * m[15] - m[11] * m[14]}};
}

template <class F>
AEROSOL_INLINE F determinant(const Minors<F>& s) {
  return s.upper[0] * s.lower[5] - s.upper[1] * s.lower[4] + s.upper[2] * s.lower[3] + s.upper[3] * s.lower[2] -
         s.upper[4] * s.lower[1] + s.upper[5] * s.lower[0];
}

/// Product of a row of m (three elements picked) with three minors, signs + - +.
template <class F>
AEROSOL_INLINE F cofactor(const F& a, const F& minorA, const F& b, const F& minorB, const F& c, const F& minorC) {
  return a * minorA - b * minorB + c * minorC;
}

}  // namespace detail

template <class F>
AEROSOL_INLINE F determinant(const Matrix<F>& a) {
  return detail::determinant(detail::minors(a));
}

/// Of a matrix whose last column is 0 0 0 1: the inverse of the upper left 3x3 part by its cofactors, and the
/// translation turned back by it. In this order of operations zeros have the signs that artists know from printed
/// matrices.
template <class F>
struct AffineInverse {
  Matrix<F> matrix;
  F determinant;
};

template <class F>
AEROSOL_INLINE AffineInverse<F> affineInverse(const Matrix<F>& a) {
  const F* m = a.m;
  const F s[9] = {m[5] * m[10] - m[9] * m[6], m[9] * m[2] - m[1] * m[10], m[1] * m[6] - m[5] * m[2],
                  m[8] * m[6] - m[4] * m[10], m[0] * m[10] - m[8] * m[2], m[4] * m[2] - m[0] * m[6],
                  m[4] * m[9] - m[8] * m[5],  m[8] * m[1] - m[0] * m[9],  m[0] * m[5] - m[4] * m[1]};
  const F det = m[0] * s[0] + m[1] * s[3] + m[2] * s[6];
  AffineInverse<F> result{diagonal(F(1.0f)), det};
  F* r = result.matrix.m;
#pragma clang loop unroll(full)
  for (int row = 0; row < 3; ++row) {
#pragma clang loop unroll(full)
    for (int column = 0; column < 3; ++column) r[4 * row + column] = safeDivide(s[3 * row + column], det);
  }
#pragma clang loop unroll(full)
  for (int i = 0; i < 3; ++i) r[12 + i] = -m[12] * r[i] - m[13] * r[4 + i] - m[14] * r[8 + i];
  return result;
}

/// The inverse; the unit matrix where there is none.
template <class F>
AEROSOL_INLINE Matrix<F> inverse(const Matrix<F>& a) {
  const auto minors = detail::minors(a);
  const F* m = a.m;
  const F* u = minors.upper;
  const F* l = minors.lower;
  const F det = detail::determinant(minors);
  const Matrix<F> adjugate = {
      {detail::cofactor(m[5], l[5], m[6], l[4], m[7], l[3]), -detail::cofactor(m[1], l[5], m[2], l[4], m[3], l[3]),
       detail::cofactor(m[13], u[5], m[14], u[4], m[15], u[3]), -detail::cofactor(m[9], u[5], m[10], u[4], m[11], u[3]),
       -detail::cofactor(m[4], l[5], m[6], l[2], m[7], l[1]), detail::cofactor(m[0], l[5], m[2], l[2], m[3], l[1]),
       -detail::cofactor(m[12], u[5], m[14], u[2], m[15], u[1]), detail::cofactor(m[8], u[5], m[10], u[2], m[11], u[1]),
       detail::cofactor(m[4], l[4], m[5], l[2], m[7], l[0]), -detail::cofactor(m[0], l[4], m[1], l[2], m[3], l[0]),
       detail::cofactor(m[12], u[4], m[13], u[2], m[15], u[0]), -detail::cofactor(m[8], u[4], m[9], u[2], m[11], u[0]),
       -detail::cofactor(m[4], l[3], m[5], l[1], m[6], l[0]), detail::cofactor(m[0], l[3], m[1], l[1], m[2], l[0]),
       -detail::cofactor(m[12], u[3], m[13], u[1], m[14], u[0]),
       detail::cofactor(m[8], u[3], m[9], u[1], m[10], u[0])}};
  const auto isAffine = equal(m[3], F(0.0f)) & equal(m[7], F(0.0f)) & equal(m[11], F(0.0f)) & equal(m[15], F(1.0f));
  const AffineInverse<F> affine = affineInverse(a);
  const auto singular = (isAffine & equal(affine.determinant, F(0.0f))) | (~isAffine & equal(det, F(0.0f)));
  const F scale = safeDivide(F(1.0f), det);
  const Matrix<F> unit = diagonal(F(1.0f));
  Matrix<F> result;
  // Adding zero leaves no zero negative.
#pragma clang loop unroll(full)
  for (int i = 0; i < 16; ++i) {
    const F general = adjugate.m[i] * scale + F(0.0f);
    result.m[i] = select(singular, unit.m[i], select(isAffine, affine.matrix.m[i], general));
  }
  return result;
}

/// A direction: (x y z 0) M.
template <class F>
AEROSOL_INLINE Triple<F> transformVector(const Matrix<F>& a, const Triple<F>& v) {
  const F* m = a.m;
  return {v.x * m[0] + v.y * m[4] + v.z * m[8], v.x * m[1] + v.y * m[5] + v.z * m[9],
          v.x * m[2] + v.y * m[6] + v.z * m[10]};
}

/// A position: (x y z 1) M, divided by its fourth coordinate.
template <class F>
AEROSOL_INLINE Triple<F> transformPoint(const Matrix<F>& a, const Triple<F>& p) {
  const F* m = a.m;
  const Triple<F> h = transformVector(a, p) + Triple<F>{m[12], m[13], m[14]};
  const F w = p.x * m[3] + p.y * m[7] + p.z * m[11] + m[15];
  if constexpr (FloatLanes<F>) {
    if (!any(notEqual(w, F(1.0f)))) return h;  // Affine ones: a test instead of three divisions, with the same bits.
  }
  return {safeDivide(h.x, w), safeDivide(h.y, w), safeDivide(h.z, w)};
}

/// A normal: by the transposed inverse.
template <class F>
AEROSOL_INLINE Triple<F> transformNormal(const Matrix<F>& a, const Triple<F>& n) {
  return transformVector(transpose(inverse(a)), n);
}

}  // namespace aerosol::jit::runtime
