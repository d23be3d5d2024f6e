// How long tests take that could take any time: some seconds; with AEROSOL_WHOLE_TESTS=1 in the environment what the
// names of such tests promise, which takes minutes.
#pragma once

#include <cstdlib>
#include <string_view>

namespace aerosol::test {

template <class Number>
Number effort(Number usual, Number whole) {
  const char* const wanted = std::getenv("AEROSOL_WHOLE_TESTS");
  return wanted && std::string_view(wanted) == "1" ? whole : usual;
}

}  // namespace aerosol::test
