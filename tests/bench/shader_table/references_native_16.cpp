#include "tests/bench/shader_table/patterns.h"

namespace aerosol::bench {

std::map<std::string, PatternFunction> references16() { return Patterns<16>::all(); }

}  // namespace aerosol::bench
