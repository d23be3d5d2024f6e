#include "core/grid/module/lookup.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace aerosol::grid {

namespace {

#define AEROSOL_LANES "core/grid/module/lookup_lanes.inc"
#include "core/grid/instruction_sets.inc"
#undef AEROSOL_LANES

template <int channels>
void lookUpIn(VoxelInterpolation interpolation, const Directory& directory, const LookupPoints& points) {
  static auto* const chosen =
      chooseByProcessor(avx512::lookUpAll<channels, Directory>, avx2::lookUpAll<channels, Directory>,
                        plain::lookUpAll<channels, Directory>);
  chosen(directory, interpolation, points);
}

}  // namespace

void lookUp(VoxelInterpolation interpolation, const Directory& directory, const LookupPoints& points) {
  (directory.channels == 1 ? lookUpIn<1> : lookUpIn<3>)(interpolation, directory, points);
}

}  // namespace aerosol::grid
