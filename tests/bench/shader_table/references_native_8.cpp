#include "tests/bench/shader_table/patterns.h"

namespace aerosol::bench {

std::map<std::string, PatternFunction> references8() { return Patterns<8>::all(); }

}  // namespace aerosol::bench
