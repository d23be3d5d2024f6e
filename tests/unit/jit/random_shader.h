// Shaders made of dice, as source text: expressions over floats, ints, triples and matrices, every library function
// that is pure, branches, bounded loops, arrays, functions with early returns.
#pragma once

#include <cstdint>
#include <string>

namespace aerosol::jit::test {

/// A shader with outputs of floats, ints and triples. It reads P, u, v and time. Equal seeds give equal texts.
std::string randomShader(std::uint64_t seed);

}  // namespace aerosol::jit::test
