// Benchmark at equal time (see scenes.h): relative mean squared error times processor seconds of every method against a
// reference of which one half comes from null scattering and one from another method, as medians over seeds.
//
//   equal_time [--tiny | --quick | --full] [--scene NAME]… [--method NAME] [-o FILE.json] [--compare FILE.json]
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/app/run.h"
#include "tests/bench/equal_time/report.h"

namespace {

using namespace aerosol;

constexpr const char* usage =
    R"(usage: equal_time [--tiny | --quick | --full] [--scene NAME]... [--method NAME] [-o FILE] [--compare FILE]

  --quick         a few minutes [the default]; --full takes hours, --tiny tells only that it runs
  --scene NAME    only this scene; repeatable
  --method NAME   only this method, beside the automatic choice and the simplest one
  -o FILE         write the measurements as JSON
  --compare FILE  show them as ratios to those of an earlier run
)";

struct Options {
  bench::Effort effort = bench::efforts[1];
  std::vector<std::string> scenes;
  std::string method, output, earlier;
};

/// False where the words are not understood.
bool parse(const std::vector<std::string>& words, Options& options) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto effort = std::ranges::find_if(
        bench::efforts, [&](const bench::Effort& e) { return words[i] == std::string("--") + e.name; });
    if (effort != bench::efforts.end()) {
      options.effort = *effort;
      continue;
    }
    if (i + 1 == words.size()) return false;
    const std::string& value = words[i + 1];
    if (words[i] == "--scene") {
      options.scenes.push_back(value);
    } else if (words[i] == "--method") {
      options.method = value;
    } else if (words[i] == "-o") {
      options.output = value;
    } else if (words[i] == "--compare") {
      options.earlier = value;
    } else {
      return false;
    }
    ++i;
  }
  return true;
}

/// The same cloud as the scripted one.
bool bakeCloud(const std::filesystem::path& file, double voxel) {
  return app::run("aerosol",
                  {"bake", bench::bakedShader, "--bounds", "-1,-1,-1,1,1,1", "--voxel", fmt::format("{}", voxel), "-o",
                   file.string(), "--set", "density=40", "--quiet"},
                  app::standardConsole()) == app::ExitCode::success;
}

int fail(const std::string& why) {
  fmt::print(stderr, "equal_time: {}\n{}", why, usage);
  return 2;
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  if (!parse({arguments + 1, arguments + count}, options)) return fail("these options are not understood");
  std::optional<bench::Earlier> earlier;
  if (!options.earlier.empty()) {
    auto read = bench::readJson(options.earlier);
    if (!read) return fail(format(read.errors()));
    earlier = *read;
  }
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("equal_time.{}", getpid());
  std::filesystem::create_directories(folder);
  const std::filesystem::path voxels = folder / "cloud.vdb";
  const std::vector<bench::BenchScene> all = bench::allScenes(voxels);
  const auto isWanted = [&](const bench::BenchScene& scene) {
    return options.scenes.empty() || std::ranges::find(options.scenes, scene.name) != options.scenes.end();
  };
  for (const std::string& name : options.scenes) {
    if (std::ranges::find(all, name, &bench::BenchScene::name) == all.end()) return fail("no scene '" + name + "'");
  }
  const auto isMethod = [&](const bench::Method& m) { return m.name == options.method; };
  if (!options.method.empty() && std::ranges::none_of(bench::allMethods(), isMethod)) {
    return fail("no method '" + options.method + "'");
  }
  const auto readsVoxels = [&](const bench::BenchScene& scene) {
    return isWanted(scene) && scene.content.find(voxels.string()) != std::string::npos;
  };
  if (std::ranges::any_of(all, readsVoxels) && !bakeCloud(voxels, options.effort.voxel)) return 1;
  std::vector<bench::SceneResult> results;
  for (const bench::BenchScene& scene : all) {
    if (!isWanted(scene)) continue;
    results.push_back(bench::measure(scene, options.effort, options.method));
    fmt::print("{}", bench::describe(results.back()));
    std::fflush(stdout);
  }
  std::filesystem::remove_all(folder);
  fmt::print("{}", bench::summarise(results));
  if (earlier) fmt::print("{}", bench::compare(results, options.effort, *earlier));
  if (!options.output.empty()) {
    std::ofstream file(options.output);
    file << bench::toJson(results, options.effort);
    if (!file) return fail("cannot write " + options.output);
  }
  return 0;
}
