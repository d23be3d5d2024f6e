#include "core/base/paths.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace aerosol {
namespace {

namespace fs = std::filesystem;

TEST(Paths, FollowTheExecutable) {
  const auto installation = installationOf("/opt/anywhere/bin/aerosol");
  EXPECT_EQ(installation.prefix, "/opt/anywhere");
  EXPECT_EQ(installation.modules, "/opt/anywhere/lib/aerosol");
  EXPECT_EQ(installation.runtime, "/opt/anywhere/lib/aerosol/runtime");
  EXPECT_EQ(installation.shaders, "/opt/anywhere/share/aerosol/shaders");
  EXPECT_EQ(installation.scenes, "/opt/anywhere/share/aerosol/scenes");
}

TEST(Paths, ALinkToTheExecutableLeadsToItsOwnTree) {
  const auto base = fs::path(testing::TempDir()) / "aerosol_paths_test";
  fs::remove_all(base);
  fs::create_directories(base / "tree" / "bin");
  fs::create_directories(base / "elsewhere");
  fs::copy_file("/proc/self/exe", base / "tree" / "bin" / "aerosol");
  fs::create_symlink(base / "tree" / "bin" / "aerosol", base / "elsewhere" / "aerosol");

  const auto installation = installationOf(base / "elsewhere" / "aerosol");
  EXPECT_EQ(installation.prefix, fs::canonical(base / "tree"));
  fs::remove_all(base);
}

TEST(Paths, TheBuildTreeHasTheLayoutOfAnInstallation) {
  const auto installation = findInstallation();
  ASSERT_TRUE(installation);
  EXPECT_TRUE(fs::is_directory(installation->modules));
  EXPECT_EQ(installation->shaders, fs::canonical(fs::path(AEROSOL_SOURCE_DIR) / "shaders"));
  EXPECT_EQ(installation->scenes, fs::canonical(fs::path(AEROSOL_SOURCE_DIR) / "scenes"));
}

}  // namespace
}  // namespace aerosol
