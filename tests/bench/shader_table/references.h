// The shaders of the table (shaders.h) as an expert writes them in C++ with vectors, for this machine alone. Nothing of
// Aerosol is used.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace aerosol::bench {

/// n points as structure of arrays, 64-byte aligned, n a multiple of 16. Array number i of the results begins at
/// results + i * n.
using PatternFunction = void (*)(const float* x, const float* y, const float* z, float* results, std::size_t n);

/// By the names of shaders, for vectors of 8 and of 16 floats.
std::map<std::string, PatternFunction> references8();
std::map<std::string, PatternFunction> references16();

}  // namespace aerosol::bench
