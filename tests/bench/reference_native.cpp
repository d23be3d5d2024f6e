#include "tests/bench/reference_functions.h"

namespace aerosol::bench {

Reference scalarReference() { return Functions<1>::reference(); }

}  // namespace aerosol::bench
