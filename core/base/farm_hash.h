// FarmHash's 64-bit hash of a string, whose lower half is what the language's hash(string) gives.
#pragma once

#include <cstdint>
#include <string_view>

namespace aerosol {

/// FarmHash (Pike and Alakuijala, 2014, https://github.com/google/farmhash): its Hash64 without special instructions.
std::uint64_t farmHash(std::string_view text);

}  // namespace aerosol
