// What priorities cost: glass balls, apart from each other, that say nothing of their inside, that say it without a
// priority, that have one each, and such that overlap.
#include <fmt/format.h>

#include "tests/bench/places/tables.h"
#include "tests/support/rendering.h"

namespace aerosol::bench {

namespace {

/// `material` holds parameters of dielectrics, all with the index 1.5.
test::TestScene balls(const char* material, double distance) {
  std::string content = R"(<emitter type="constant"/>)";
  for (int i = 0; i < 3; ++i) {
    content += fmt::format(R"(<shape type="sphere"><point name="center" x="{}"/><float name="radius" value="0.5"/>
        <bsdf type="dielectric">{}</bsdf></shape>)",
                           distance * (i - 1), material);
  }
  return test::TestScene(
      test::sceneXml(R"(<integer name="max_depth" value="8"/>)", {.fov = 30, .width = 48, .height = 24}, content));
}

constexpr const char* surfaceOnly = R"(<float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/>)";
constexpr const char* withInside = R"(<float name="ior" value="1.5"/>)";
constexpr const char* withPriority = R"(<float name="ior" value="1.5"/><integer name="priority" value="1"/>)";

}  // namespace

void printPriorities() {
  struct Case {
    const char* name;
    test::TestScene scene;
    render::WorkerStatistics statistics = {};
  };
  std::vector<Case> cases;
  cases.push_back({"off, nothing said of the inside", balls(surfaceOnly, 1.2)});
  cases.push_back({"off, with medium_vdf, apart", balls(withInside, 1.2)});
  cases.push_back({"off, with medium_vdf, overlapping", balls(withInside, 0.8)});
  cases.push_back({"priority 1, apart", balls(withPriority, 1.2)});
  cases.push_back({"priority 1, overlapping", balls(withPriority, 0.8)});
  std::vector<std::function<void()>> works;
  for (Case& each : cases) {
    works.emplace_back([&each] {
      const auto film = each.scene.film();
      each.statistics = each.scene.renderInto(*film, {.threads = 1, .endSample = 64}).statistics;
    });
  }
  const std::vector<double> seconds = medianSeconds(works);
  fmt::print("\nGlass with and without priorities\n  {:<36}{:>12}{:>15}{:>16}{:>14}{:>18}\n", "", "ns a path",
             "of the first", "stack is kept", "faces judged", "hits passed over");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& each = cases[i];
    fmt::print("  {:<36}{:>12.0f}{:>15.3f}{:>16}{:>14}{:>18}\n", each.name,
               1e9 * seconds[i] / static_cast<double>(each.statistics.samples), seconds[i] / seconds[0],
               each.scene.scene()->nestsMedia ? "yes" : "no", each.statistics.work.of(render::Work::nesting),
               each.statistics.media.rejectedHits);
  }
  fmt::print("  tests/bench/lean_counts.sh counts the instructions of the first beside a build without priorities.\n");
}

}  // namespace aerosol::bench
