// Triples (points, vectors, normals, colours) and 4x4 matrices over any number type.
#pragma once

#include "core/jit/runtime/wide.h"

namespace aerosol::jit::runtime {

template <class F>
struct Triple {
  F x, y, z;
};

template <class F>
AEROSOL_INLINE Triple<F> operator+(const Triple<F>& a, const Triple<F>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class F>
AEROSOL_INLINE Triple<F> operator-(const Triple<F>& a, const Triple<F>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class F>
AEROSOL_INLINE Triple<F> operator-(const Triple<F>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class F>
AEROSOL_INLINE Triple<F> operator*(const Triple<F>& a, const F& b) {
  return {a.x * b, a.y * b, a.z * b};
}
template <class M, class F>
AEROSOL_INLINE Triple<F> select(const M& mask, const Triple<F>& a, const Triple<F>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

/// A noise in [-1, 1] as one in [0, 1].
template <class F>
AEROSOL_INLINE F toUnsigned(const F& value) {
  return F(0.5f) * (value + F(1.0f));
}
/// The same bits at once: halving is exact.
template <FloatLanes F>
AEROSOL_INLINE F toUnsigned(const F& value) {
  return fma(F(0.5f), value, F(0.5f));
}
template <class F>
AEROSOL_INLINE Triple<F> toUnsigned(const Triple<F>& value) {
  return {toUnsigned(value.x), toUnsigned(value.y), toUnsigned(value.z)};
}

/// Row-major, for row vectors: a point is transformed as (x y z 1) M, translation stands in elements 12 to 14.
template <class F>
struct Matrix {
  F m[16];
};

}  // namespace aerosol::jit::runtime
