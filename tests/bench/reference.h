// The benchmarks' functions in plain C++: what compiled shaders are measured against. Nothing of Aerosol is used.
#pragma once

#include <cstddef>

namespace aerosol::bench {

/// n points as structure of arrays, 64-byte aligned, n a multiple of 16; one float a point is written.
using Function = void (*)(const float* x, const float* y, const float* z, float* result, std::size_t count);

struct Reference {
  Function sphere;       ///< max(0, 1 - |P|)
  Function fbm;          ///< Six octaves of Perlin noise.
  Function pyroclastic;  ///< A sphere displaced by six octaves of |noise|; points far outside are done early.
};

/// One point after the other.
Reference scalarReference();
/// Vectors of 8 and of 16 floats by hand.
Reference vectorReference8();
Reference vectorReference16();

}  // namespace aerosol::bench
