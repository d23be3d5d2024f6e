// The number types of the kernels' runtime library: W lanes of float, int32 or uint64, and the operations that differ
// from the built-in operators.
//
// A lane type is a clang vector for W > 1 and the plain scalar for W = 1, so that one template serves every width and
// the uniform (scalar) form. Arithmetic is IEEE and never contracted; a fused multiply-add is written as `fma`. A mask
// is an int lane type with all bits set (true) or none. All that is here is inlined, free of branches and free of
// undefined behaviour for every input, because lanes that are masked off compute too.
#pragma once

#include <cstdint>
#include <type_traits>

#define AEROSOL_INLINE inline __attribute__((always_inline))

// Vectors are passed between functions that are always inlined: how a call would pass them does not matter.
#pragma clang diagnostic ignored "-Wpsabi"

namespace aerosol::jit::runtime {

template <class T, int W>
struct WideOf {
  typedef T type __attribute__((ext_vector_type(W)));
};
template <class T>
struct WideOf<T, 1> {
  using type = T;
};

/// W lanes of T, contiguous in memory and aligned to their size.
template <class T, int W>
using Wide = typename WideOf<T, W>::type;

/// Lanes of a float or 32-bit int lane type.
template <class T>
inline constexpr int widthOf = static_cast<int>(sizeof(T) / 4);
template <class T>
using FloatOf = Wide<float, widthOf<T>>;
template <class T>
using IntOf = Wide<std::int32_t, widthOf<T>>;
template <class T>
using UintOf = Wide<std::uint32_t, widthOf<T>>;

template <class T>
concept FloatLanes =
    std::is_same_v<T, FloatOf<T>> && (sizeof(T) == 4 || sizeof(T) == 16 || sizeof(T) == 32 || sizeof(T) == 64);
template <class T>
concept IntLanes =
    std::is_same_v<T, IntOf<T>> && (sizeof(T) == 4 || sizeof(T) == 16 || sizeof(T) == 32 || sizeof(T) == 64);
template <class T>
concept UintLanes =
    std::is_same_v<T, UintOf<T>> && (sizeof(T) == 4 || sizeof(T) == 16 || sizeof(T) == 32 || sizeof(T) == 64);

inline constexpr float infinity = __builtin_inff();
inline constexpr float notANumber = __builtin_nanf("");
inline constexpr float largestFloat = 3.40282346638528859811704183484516925e+38f;
inline constexpr float smallestNormal = 1.17549435082228750796873653722224568e-38f;

// --- bits and conversions --------------------------------------------------------------------------------------------

template <FloatLanes F>
AEROSOL_INLINE IntOf<F> asInt(F x) {
  return __builtin_bit_cast(IntOf<F>, x);
}
template <FloatLanes F>
AEROSOL_INLINE UintOf<F> asUint(F x) {
  return __builtin_bit_cast(UintOf<F>, x);
}
template <IntLanes I>
AEROSOL_INLINE UintOf<I> asUint(I x) {
  return __builtin_bit_cast(UintOf<I>, x);
}
template <UintLanes U>
AEROSOL_INLINE IntOf<U> asInt(U x) {
  return __builtin_bit_cast(IntOf<U>, x);
}
template <class T>
AEROSOL_INLINE FloatOf<T> asFloat(T x) {
  return __builtin_bit_cast(FloatOf<T>, x);
}

/// Nearest float.
template <class T>
AEROSOL_INLINE FloatOf<T> toFloat(T x) {
  if constexpr (widthOf<T> == 1) {
    return static_cast<float>(x);
  } else {
    return __builtin_convertvector(x, FloatOf<T>);
  }
}

/// Truncates. The value must be in [-2^31, 2^31).
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> toIntUnchecked(F x) {
  if constexpr (widthOf<F> == 1) {
    return static_cast<std::int32_t>(x);
  } else {
    return __builtin_convertvector(x, IntOf<F>);
  }
}

// --- masks -----------------------------------------------------------------------------------------------------------

#define AEROSOL_COMPARISON(name, op)                       \
  template <class T>                                       \
    requires(FloatLanes<T> || IntLanes<T> || UintLanes<T>) \
  AEROSOL_INLINE IntOf<T> name(T a, T b) {                 \
    if constexpr (widthOf<T> == 1) {                       \
      return a op b ? -1 : 0;                              \
    } else {                                               \
      return a op b;                                       \
    }                                                      \
  }
AEROSOL_COMPARISON(less, <)
AEROSOL_COMPARISON(lessEqual, <=)
AEROSOL_COMPARISON(greater, >)
AEROSOL_COMPARISON(greaterEqual, >=)
AEROSOL_COMPARISON(equal, ==)
AEROSOL_COMPARISON(notEqual, !=)
#undef AEROSOL_COMPARISON

/// The lanes of a where the mask is set, of b elsewhere.
template <IntLanes I, class T>
AEROSOL_INLINE T select(I mask, T a, T b) {
  static_assert(widthOf<I> == widthOf<T>);
  if constexpr (widthOf<I> == 1) {
    return mask != 0 ? a : b;
  } else {
    return mask ? a : b;
  }
}

/// Is the mask set in any lane?
template <IntLanes I>
AEROSOL_INLINE bool any(I mask) {
  if constexpr (widthOf<I> == 1) {
    return mask != 0;
  } else {
    return __builtin_reduce_or(mask) != 0;
  }
}

// --- float operations ------------------------------------------------------------------------------------------------

/// a * b + c, rounded once.
template <FloatLanes F>
AEROSOL_INLINE F fma(F a, F b, F c) {
  return __builtin_elementwise_fma(a, b, c);
}
template <FloatLanes F>
AEROSOL_INLINE F fma(F a, F b, std::type_identity_t<float> c)
  requires(!std::is_same_v<F, float>)
{
  return __builtin_elementwise_fma(a, b, F(c));
}

template <FloatLanes F>
AEROSOL_INLINE F floor(F x) {
  return __builtin_elementwise_floor(x);
}
template <FloatLanes F>
AEROSOL_INLINE F ceil(F x) {
  return __builtin_elementwise_ceil(x);
}
template <FloatLanes F>
AEROSOL_INLINE F trunc(F x) {
  return __builtin_elementwise_trunc(x);
}
/// Nearest integer, ties to even.
template <FloatLanes F>
AEROSOL_INLINE F roundEven(F x) {
  return __builtin_elementwise_roundeven(x);
}
/// Square root by IEEE: NaN below zero.
template <FloatLanes F>
AEROSOL_INLINE F rawSqrt(F x) {
  return __builtin_elementwise_sqrt(x);
}
template <FloatLanes F>
AEROSOL_INLINE F abs(F x) {
  return __builtin_elementwise_abs(x);
}
template <FloatLanes F>
AEROSOL_INLINE F copySign(F magnitude, F sign) {
  return __builtin_elementwise_copysign(magnitude, sign);
}
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> isNan(F x) {
  return notEqual(x, x);
}

/// The smaller one; b where either is NaN (one instruction everywhere).
template <FloatLanes F>
AEROSOL_INLINE F min(F a, F b) {
  return select(less(a, b), a, b);
}
/// The larger one; b where either is NaN.
template <FloatLanes F>
AEROSOL_INLINE F max(F a, F b) {
  return select(less(b, a), a, b);
}

/// Truncated to an int: saturating, NaN gives 0.
template <FloatLanes F>
AEROSOL_INLINE IntOf<F> toInt(F x) {
  const F low = F(-2147483648.0f);
  const F high = F(2147483520.0f);  // the largest float below 2^31
  const IntOf<F> inside = toIntUnchecked(max(min(x, high), low));
  const IntOf<F> saturated = select(greater(x, high), IntOf<F>(0x7fffffff), inside);
  return select(isNan(x), IntOf<F>(0), saturated);
}

// --- int operations: all wrap ----------------------------------------------------------------------------------------

template <IntLanes I>
AEROSOL_INLINE I wrapAdd(I a, I b) {
  return asInt(asUint(a) + asUint(b));
}
template <IntLanes I>
AEROSOL_INLINE I wrapSub(I a, I b) {
  return asInt(asUint(a) - asUint(b));
}
template <IntLanes I>
AEROSOL_INLINE I wrapMul(I a, I b) {
  return asInt(asUint(a) * asUint(b));
}
template <IntLanes I>
AEROSOL_INLINE I wrapNegate(I a) {
  return asInt(UintOf<I>(0u) - asUint(a));
}
template <IntLanes I>
AEROSOL_INLINE I shiftLeft(I a, int bits) {
  return asInt(asUint(a) << UintOf<I>(static_cast<std::uint32_t>(bits)));
}
template <UintLanes U>
AEROSOL_INLINE U rotateLeft(U a, std::uint32_t bits) {
  return (a << U(bits)) | (a >> U(32u - bits));
}

/// a / b truncated; 0 where b is 0; INT_MIN / -1 wraps.
template <IntLanes I>
AEROSOL_INLINE I divide(I a, I b) {
  const I overflow = equal(a, I(-0x7fffffff - 1)) & equal(b, I(-1));
  const I zero = equal(b, I(0));
  const I quotient = a / select(zero | overflow, I(1), b);
  return select(zero, I(0), quotient);
}
/// a % b with the sign of a; 0 where b is 0.
template <IntLanes I>
AEROSOL_INLINE I remainder(I a, I b) {
  const I unsafe = equal(b, I(0)) | equal(b, I(-1));
  return select(unsafe, I(0), a % select(unsafe, I(1), b));
}

}  // namespace aerosol::jit::runtime
