#include "core/grid/temporal_lookup.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace aerosol::grid {

namespace {

#define AEROSOL_LANES "core/grid/temporal_lanes.inc"
#include "core/grid/instruction_sets.inc"
#undef AEROSOL_LANES

template <int channels>
void lookUpIn(VoxelInterpolation interpolation, const CurveTables& curves, const LookupPoints& points) {
  static auto* const chosen =
      chooseByProcessor(avx512::lookUpAll<channels, CurveTables>, avx2::lookUpAll<channels, CurveTables>,
                        plain::lookUpAll<channels, CurveTables>);
  chosen(curves, interpolation, points);
}

}  // namespace

void lookUp(VoxelInterpolation interpolation, const CurveTables& curves, const LookupPoints& points) {
  (curves.channels == 1 ? lookUpIn<1> : lookUpIn<3>)(interpolation, curves, points);
}

}  // namespace aerosol::grid
