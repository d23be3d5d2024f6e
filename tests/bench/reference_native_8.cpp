#include "tests/bench/reference_functions.h"

namespace aerosol::bench {

Reference vectorReference8() { return Functions<8>::reference(); }

}  // namespace aerosol::bench
