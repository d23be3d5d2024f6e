// Elementary functions of vectors of floats, to about the last bit but two: Cody and Waite's range reduction and the
// polynomials of Moshier's Cephes library (1992).
#pragma once

#include "tests/bench/reference_functions.h"

namespace aerosol::bench {
namespace {

template <int W>
struct VectorMath {
  using L = Lanes<W>;
  using Float = typename L::Float;
  using Int = typename L::Int;

  static Float exp(Float x) {
    const Float clamped = __builtin_elementwise_max(x, Float(-87.0f));
    const Float n = __builtin_elementwise_roundeven(clamped * Float(1.44269504f));
    const Float r = L::fma(n, Float(2.12194440e-4f), L::fma(n, Float(-0.693359375f), clamped));
    Float p = L::fma(Float(1.9875691500e-4f), r, Float(1.3981999507e-3f));
    p = L::fma(p, r, Float(8.3334519073e-3f));
    p = L::fma(p, r, Float(4.1665795894e-2f));
    p = L::fma(p, r, Float(1.6666665459e-1f));
    p = L::fma(p, r, Float(5.0000001201e-1f));
    p = L::fma(p, r * r, r + Float(1.0f));
    const Int scale = (__builtin_convertvector(n, Int) + Int(127)) << Int(23);
    return p * __builtin_bit_cast(Float, scale);
  }

  static void sincos(Float x, Float& sine, Float& cosine) {
    const Float q = __builtin_elementwise_roundeven(x * Float(0.636619772f));
    Float r = L::fma(q, Float(-1.5703125f), x);
    r = L::fma(q, Float(-4.837512969970703125e-4f), r);
    r = L::fma(q, Float(-7.54978995489188216e-8f), r);
    const Float square = r * r;
    Float s = L::fma(Float(-1.9515295891e-4f), square, Float(8.3321608736e-3f));
    s = L::fma(s, square, Float(-1.6666654611e-1f));
    s = L::fma(s * square, r, r);
    Float c = L::fma(Float(2.443315711809948e-5f), square, Float(-1.388731625493765e-3f));
    c = L::fma(c, square, Float(4.166664568298827e-2f));
    c = L::fma(c * square, square, L::fma(square, Float(-0.5f), Float(1.0f)));
    const Int quadrant = __builtin_convertvector(q, Int);
    const Int odd = (quadrant & Int(1)) != Int(0);
    sine = flip(L::choose(odd, c, s), quadrant);
    cosine = flip(L::choose(odd, s, c), quadrant + Int(1));
  }
  static Float sin(Float x) {
    Float s, c;
    sincos(x, s, c);
    return s;
  }
  static Float cos(Float x) {
    Float s, c;
    sincos(x, s, c);
    return c;
  }

 private:
  /// The sign changed where bit 1 is set.
  static Float flip(Float x, Int quadrant) {
    return __builtin_bit_cast(Float, __builtin_bit_cast(Int, x) ^ ((quadrant & Int(2)) << Int(30)));
  }
};

}  // namespace
}  // namespace aerosol::bench
