// Noise without interpolation: a hash of the cell (cell noise) or of the coordinates' bits (hash noise) as a number in
// [0, 1], with the values of Open Shading Language. Triples hash one word more: 0, 1 and 2.
#pragma once

#include "core/jit/runtime/hash.h"
#include "core/jit/runtime/processor.h"
#include "core/jit/runtime/triple.h"

namespace aerosol::jit::runtime {

namespace detail {

/// Coordinates beyond the ints lie in one cell.
struct CellKey {
  template <FloatLanes F>
  AEROSOL_INLINE UintOf<F> operator()(F x) const {
    return asUint(floorToInt(x));
  }
};
struct BitsKey {
  template <FloatLanes F>
  AEROSOL_INLINE UintOf<F> operator()(F x) const {
    return asUint(x);
  }
};

template <UintLanes... U>
AEROSOL_INLINE auto hashTriple(U... words) -> Triple<decltype(bitsToUnit(hashWords(words...)))> {
  using Word = std::common_type_t<U...>;
  return {bitsToUnit(hashWords(words..., Word(0u))), bitsToUnit(hashWords(words..., Word(1u))),
          bitsToUnit(hashWords(words..., Word(2u)))};
}

/// s - period floor(s / period) with the period made whole and at least 1.
template <FloatLanes F>
AEROSOL_INLINE F wrap(F s, F period) {
  const F whole = floor(period);
  const F length = select(less(whole, F(1.0f)), F(1.0f), whole);
  return s - length * floor(s / length);
}
template <FloatLanes F>
AEROSOL_INLINE Triple<F> wrap(Triple<F> s, Triple<F> period) {
  return {wrap(s.x, period.x), wrap(s.y, period.y), wrap(s.z, period.z)};
}

template <class Key, FloatLanes F>
AEROSOL_INLINE F hashedValue(F x) {
  return bitsToUnit(hashWords(Key{}(x)));
}
template <class Key, FloatLanes F>
AEROSOL_INLINE F hashedValue(F x, F y) {
  return bitsToUnit(hashWords(Key{}(x), Key{}(y)));
}
template <class Key, FloatLanes F>
AEROSOL_INLINE F hashedValue(Triple<F> p) {
  return bitsToUnit(hashWords(Key{}(p.x), Key{}(p.y), Key{}(p.z)));
}
template <class Key, FloatLanes F>
AEROSOL_INLINE F hashedValue(Triple<F> p, F t) {
  return bitsToUnit(hashWords(Key{}(p.x), Key{}(p.y), Key{}(p.z), Key{}(t)));
}
template <class Key, FloatLanes F>
AEROSOL_INLINE Triple<F> hashedTriple(F x) {
  return hashTriple(Key{}(x));
}
template <class Key, FloatLanes F>
AEROSOL_INLINE Triple<F> hashedTriple(F x, F y) {
  return hashTriple(Key{}(x), Key{}(y));
}
template <class Key, FloatLanes F>
AEROSOL_INLINE Triple<F> hashedTriple(Triple<F> p) {
  return hashTriple(Key{}(p.x), Key{}(p.y), Key{}(p.z));
}
template <class Key, FloatLanes F>
AEROSOL_INLINE Triple<F> hashedTriple(Triple<F> p, F t) {
  return hashTriple(Key{}(p.x), Key{}(p.y), Key{}(p.z), Key{}(t));
}

}  // namespace detail

// Each takes (x), (x, y), (p) or (p, t); the periodic ones the periods after that.

template <class... A>
AEROSOL_INLINE auto cellNoise(A... at) {
  return detail::hashedValue<detail::CellKey>(at...);
}
template <class... A>
AEROSOL_INLINE auto cellNoiseTriple(A... at) {
  return detail::hashedTriple<detail::CellKey>(at...);
}
template <class... A>
AEROSOL_INLINE auto hashNoise(A... at) {
  return detail::hashedValue<detail::BitsKey>(at...);
}
template <class... A>
AEROSOL_INLINE auto hashNoiseTriple(A... at) {
  return detail::hashedTriple<detail::BitsKey>(at...);
}

template <class A>
AEROSOL_INLINE auto periodicCellNoise(A x, A period) {
  return cellNoise(detail::wrap(x, period));
}
template <class A, class B>
AEROSOL_INLINE auto periodicCellNoise(A x, B y, A periodX, B periodY) {
  return cellNoise(detail::wrap(x, periodX), detail::wrap(y, periodY));
}
template <class A>
AEROSOL_INLINE auto periodicCellNoiseTriple(A x, A period) {
  return cellNoiseTriple(detail::wrap(x, period));
}
template <class A, class B>
AEROSOL_INLINE auto periodicCellNoiseTriple(A x, B y, A periodX, B periodY) {
  return cellNoiseTriple(detail::wrap(x, periodX), detail::wrap(y, periodY));
}
template <class A>
AEROSOL_INLINE auto periodicHashNoise(A x, A period) {
  return hashNoise(detail::wrap(x, period));
}
template <class A, class B>
AEROSOL_INLINE auto periodicHashNoise(A x, B y, A periodX, B periodY) {
  return hashNoise(detail::wrap(x, periodX), detail::wrap(y, periodY));
}
template <class A>
AEROSOL_INLINE auto periodicHashNoiseTriple(A x, A period) {
  return hashNoiseTriple(detail::wrap(x, period));
}
template <class A, class B>
AEROSOL_INLINE auto periodicHashNoiseTriple(A x, B y, A periodX, B periodY) {
  return hashNoiseTriple(detail::wrap(x, periodX), detail::wrap(y, periodY));
}

// The language's hash(): an int of the coordinates' bits.

template <IntLanes I>
AEROSOL_INLINE I hashInt(I x) {
  return asInt(hashWords(asUint(x)));
}
template <IntLanes I>
AEROSOL_INLINE I hashInt(I a, I b, I c, I d) {
  return asInt(hashWords(asUint(a), asUint(b), asUint(c), asUint(d)));
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> hashInt(F x) {
  return asInt(hashWords(asUint(x)));
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> hashInt(F x, F y) {
  return asInt(hashWords(asUint(x), asUint(y)));
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> hashInt(Triple<F> p) {
  return asInt(hashWords(asUint(p.x), asUint(p.y), asUint(p.z)));
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> hashInt(Triple<F> p, F t) {
  return asInt(hashWords(asUint(p.x), asUint(p.y), asUint(p.z), asUint(t)));
}

}  // namespace aerosol::jit::runtime
