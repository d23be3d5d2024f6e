// What priorities cost: glass balls, apart from each other, that have none, that have one each, and that overlap.
#include <fmt/format.h>

#include "tests/bench/places/tables.h"
#include "tests/support/rendering.h"

namespace aerosol::bench {

namespace {

test::TestScene balls(const char* priority, double distance) {
  std::string content = R"(<emitter type="constant"/>)";
  for (int i = 0; i < 3; ++i) {
    content += fmt::format(R"(<shape type="sphere"><point name="center" x="{}"/><float name="radius" value="0.5"/>
        <bsdf type="dielectric"><float name="int_ior" value="1.5"/>{}</bsdf></shape>)",
                           distance * (i - 1), priority);
  }
  return test::TestScene(
      test::sceneXml(R"(<integer name="max_depth" value="8"/>)", {.fov = 30, .width = 48, .height = 24}, content));
}

}  // namespace

void printPriorities() {
  struct Case {
    const char* name;
    test::TestScene scene;
    render::WorkerStatistics statistics = {};
  };
  std::vector<Case> cases;
  cases.push_back({"off, apart", balls("", 1.2)});
  cases.push_back({"priority 1, apart", balls(R"(<integer name="priority" value="1"/>)", 1.2)});
  cases.push_back({"priority 1, overlapping", balls(R"(<integer name="priority" value="1"/>)", 0.8)});
  std::vector<std::function<void()>> works;
  for (Case& each : cases) {
    works.emplace_back([&each] {
      const auto film = each.scene.film();
      each.statistics = each.scene.renderInto(*film, {.threads = 1, .endSample = 64}).statistics;
    });
  }
  const std::vector<double> seconds = medianSeconds(works);
  fmt::print("\nGlass with and without priorities\n  {:<28}{:>18}{:>10}{:>16}{:>18}\n", "", "ns a path", "of off",
             "stack is kept", "hits passed over");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& each = cases[i];
    fmt::print("  {:<28}{:>18.0f}{:>10.3f}{:>16}{:>18}\n", each.name,
               1e9 * seconds[i] / static_cast<double>(each.statistics.samples), seconds[i] / seconds[0],
               each.scene.scene()->nestsMedia ? "yes" : "no", each.statistics.media.rejectedHits);
  }
  fmt::print("  tests/bench/lean_counts.sh counts the instructions of the first beside a build without priorities.\n");
}

}  // namespace aerosol::bench
