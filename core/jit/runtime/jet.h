// A number with its partial derivatives by N coordinates.
#pragma once

#include "core/jit/runtime/triple.h"
#include "core/jit/runtime/wide.h"

namespace aerosol::jit::runtime {

template <class F, int N>
struct Jet {
  F value;
  F partial[N];
};

template <class F, int N>
AEROSOL_INLINE Jet<F, N> operator+(const Jet<F, N>& a, const Jet<F, N>& b) {
  Jet<F, N> sum;
  sum.value = a.value + b.value;
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) sum.partial[i] = a.partial[i] + b.partial[i];
  return sum;
}
template <class F, int N>
AEROSOL_INLINE Jet<F, N> operator*(const F& a, const Jet<F, N>& b) {
  Jet<F, N> product;
  product.value = a * b.value;
#pragma clang loop unroll(full)
  for (int i = 0; i < N; ++i) product.partial[i] = a * b.partial[i];
  return product;
}

/// A noise in [-1, 1] as one in [0, 1].
template <class F, int N>
AEROSOL_INLINE Jet<F, N> toUnsigned(const Jet<F, N>& jet) {
  Jet<F, N> result = F(0.5f) * jet;
  result.value = toUnsigned(jet.value);
  return result;
}
template <class F, int N>
AEROSOL_INLINE Triple<Jet<F, N>> toUnsigned(const Triple<Jet<F, N>>& jets) {
  return {toUnsigned(jets.x), toUnsigned(jets.y), toUnsigned(jets.z)};
}

}  // namespace aerosol::jit::runtime
