#include "tests/bench/reference_functions.h"

namespace aerosol::bench {

Reference vectorReference16() { return Functions<16>::reference(); }

}  // namespace aerosol::bench
