#include "core/app/voxel_report.h"

#include <gtest/gtest.h>

#include "core/grid/grid_file.h"

namespace aerosol::app {
namespace {

TEST(VoxelReport, NamesWhatIsInTheFile) {
  const auto file = grid::readGrids(AEROSOL_SOURCE_DIR "/tests/language/textures/steps.vdb");
  ASSERT_TRUE(file) << format(file.errors());
  EXPECT_EQ(describeVoxels("steps.vdb", **file).substr(0, 306),
            "OpenVDB file \"steps.vdb\"\n"
            "  \"density\" float, unknown\n"
            "    active voxels  64\n"
            "    index bounds   (0, 0, 0) to (3, 3, 3)\n"
            "    bounds         (-0.25, -0.25, -0.25) to (1.75, 1.75, 1.75)\n"
            "    voxel size     (0.5, 0.5, 0.5)\n"
            "    background     -1\n"
            "    active values  0 to 333\n"
            "    NaN            0\n"
            "    infinite       0\n");
}

}  // namespace
}  // namespace aerosol::app
