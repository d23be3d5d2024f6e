#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <random>

#include "core/image/image.h"
#include "tests/support/program.h"

// Bakes and studies that are killed at random moments: whatever stands under the name of a file is complete, and the
// same command comes to the same end. (Renders: parts_test.cpp.)

namespace aerosol::test {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;
using testing::HasSubstr;

class Killed : public testing::Test {
 protected:
  /// Runs to the end; how long that takes.
  milliseconds run(const std::vector<std::string>& words) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = folder_.run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - start);
  }
  /// At a random moment of a run of that length. False when it ended before: then it is known to be shorter.
  bool kill(const std::vector<std::string>& words, milliseconds& whole) {
    const auto longest = static_cast<unsigned>(std::max<milliseconds::rep>(1, whole.count()));
    const auto start = std::chrono::steady_clock::now();
    const bool isKilled = !folder_.run(words, milliseconds(random_() % longest)).code;
    if (!isKilled) whole = std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - start);
    return isKilled;
  }
  /// OpenVDB gives every file a random number behind its versions; all the rest are the voxels.
  std::string voxels(const std::string& name) const {
    std::string text = folder_.read(name);
    if (name.ends_with(".vdb") && text.size() > 57) text.erase(21, 36);
    return text;
  }
  /// Whether files without a name are there, of which a kill leaves nothing.
  bool leavesNothing() const {
    const int descriptor = open(folder_.path("").c_str(), O_TMPFILE | O_RDWR, 0600);
    if (descriptor >= 0) close(descriptor);
    return descriptor >= 0;
  }
  std::vector<std::string> filesBut(const std::vector<std::string>& known) const {
    std::vector<std::string> others;
    for (const std::string& file : folder_.files()) {
      if (std::find(known.begin(), known.end(), file) == known.end()) others.push_back(file);
    }
    return others;
  }

  ProgramFolder folder_;
  std::mt19937 random_{20};
};

/// A bake that writes these files, killed while they are not there, and while there are others in their place.
struct BakeCase {
  const char* name;
  std::vector<std::string> words;
  std::vector<std::string> files;
};

class KilledBakes : public Killed, public testing::WithParamInterface<BakeCase> {};

TEST_P(KilledBakes, LeaveWholeFilesOrNone) {
  const BakeCase& bake = GetParam();
  folder_.write("boil.osl", R"(volume boil (float density = 4) {
    float sum = 0;
    for (int i = 0; i < 6; ++i) sum += noise("snoise", 2 * (i + 1) * P, time) / (i + 1);
    Ci = density * max(0, sum + 0.2) * anisotropic_vdf(color(0.9), color(1), 0.3);
})");
  const auto with = [&](const char* density) {
    std::vector<std::string> words{"bake", "boil.osl", "--bounds", "-1,-1,-1,1,1,1", "-q", "--set"};
    words.push_back(fmt::format("density={}", density));
    words.insert(words.end(), bake.words.begin(), bake.words.end());
    return words;
  };
  std::vector<std::string> before, after;
  run(with("2"));
  for (const std::string& file : bake.files) before.push_back(voxels(file));
  milliseconds whole = run(with("4"));
  for (const std::string& file : bake.files) {
    after.push_back(voxels(file));
    std::filesystem::remove(folder_.path(file));
  }
  ASSERT_NE(before, after);
  int killed = 0, none = 0, old = 0;
  for (int time = 0; time < 8; ++time) {
    if (time == 4) run(with("2"));
    killed += kill(with("4"), whole);
    bool isTooLate = true;
    for (std::size_t i = 0; i < bake.files.size(); ++i) {
      const bool isThere = folder_.has(bake.files[i]);
      none += !isThere;
      if (!isThere) {
        EXPECT_LT(time, 4) << "an older file is lost";
        isTooLate = false;
        continue;
      }
      const std::string found = voxels(bake.files[i]);
      old += found == before[i];
      isTooLate = isTooLate && found == after[i];
      EXPECT_TRUE(found == after[i] || found == before[i]) << bake.files[i] << " is half written";
    }
    // The machine was slower when the time was taken.
    if (isTooLate) whole = std::max(whole / 2, milliseconds(2));
    if (leavesNothing()) EXPECT_THAT(filesBut(bake.files), testing::ElementsAre("boil.osl"));
  }
  EXPECT_GE(killed, 2);
  EXPECT_GE(none + old, 2) << "all came too late to show anything";
  run(with("4"));
  for (std::size_t i = 0; i < bake.files.size(); ++i) EXPECT_EQ(voxels(bake.files[i]), after[i]);
}

INSTANTIATE_TEST_SUITE_P(All, KilledBakes,
                         testing::Values(BakeCase{"voxels", {"--voxel", "0.028", "-o", "a.vdb"}, {"a.vdb"}},
                                         BakeCase{"sequence",
                                                  {"--voxel", "0.035", "-o", "f.%02d.vdb", "--time", "0,1,3"},
                                                  {"f.01.vdb", "f.02.vdb", "f.03.vdb"}},
                                         BakeCase{"curves",
                                                  {"--voxel", "0.035", "--temporal", "-o", "a.avt", "--time", "0,1,4"},
                                                  {"a.avt"}}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_F(Killed, StudiesGoOnWithWholeFiles) {
  folder_.write("wisps.xml", R"(<scene version="3.0.0">
  <sensor type="perspective"><float name="fov" value="30"/>
    <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/></film></sensor>
  <emitter type="constant"/><volume type="sphere"><medium type="wisps"/></volume></scene>)");
  const std::vector<std::string> words{"study", "wisps.xml", "-o", "study", "--budget", "2s", "--size", "16"};
  std::size_t finished = 0;
  milliseconds whole = 1500ms;
  int killed = 0;
  for (int time = 0; time < 6; ++time) {
    const bool isKilled = kill(words, whole);
    killed += isKilled;
    for (const std::string& file : folder_.files()) {
      const std::string text = folder_.read(file);
      if (file.ends_with(".html")) EXPECT_TRUE(text.ends_with("</body></html>\n"));
      if (file.ends_with(".json")) EXPECT_TRUE(text.ends_with("}\n")) << text.substr(text.size() - 20);
      if (file.ends_with(".png")) EXPECT_TRUE(image::readImage(folder_.path(file))) << file;
      if (!file.ends_with("study.csv")) continue;
      // A line a round: what has been found is never lost.
      const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
      EXPECT_GE(lines, finished);
      EXPECT_TRUE(text.ends_with("\n"));
      finished = lines;
    }
    if (!isKilled) break;
  }
  EXPECT_GE(killed, 2);
  const Outcome outcome = folder_.run(words);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("has the smallest error"));
  if (leavesNothing())
    for (const std::string& file : folder_.files()) EXPECT_FALSE(file.ends_with(".tmp")) << file;
}

}  // namespace
}  // namespace aerosol::test
