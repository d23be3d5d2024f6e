#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "tests/render/film_checks.h"

// Every shipped scene has the same bits at every width of vectors: sums in double, before any rounding.

namespace aerosol::test {
namespace {

const std::filesystem::path scenes = AEROSOL_SOURCE_DIR "/scenes";

std::vector<std::string> namesOfScenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(scenes)) {
    if (entry.path().extension() == ".xml") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

class ShippedScenes : public ::testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<render::Film> renderWith(const SceneOptions& options) const {
    const TestScene scene(
        fmt::format(R"(<scene version="3.0.0"><include filename="{}/{}.xml"/></scene>)", scenes.string(), GetParam()),
        options);
    if (!scene.scene()) return nullptr;
    const render::PixelRect all = scene.film()->area();
    const int x = (all.x0 + all.x1) / 2, y = (all.y0 + all.y1) / 2;
    auto film = scene.film(render::PixelRect{x - 8, y - 5, x + 8, y + 5});
    scene.renderInto(*film, {.threads = 2, .endSample = 1});
    return film;
  }
};

TEST_P(ShippedScenes, HaveTheSameBitsAtEveryWidth) {
  const auto reference = renderWith({.shaderFolder = scenes});
  ASSERT_TRUE(reference);
  for (const int width : {16, 8, 4, 1}) {
    const auto film = renderWith({.shaderFolder = scenes, .width = width, .isa = "avx2"});
    ASSERT_TRUE(film);
    EXPECT_TRUE(identical(*reference, *film)) << width << " lanes";
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScenes, ::testing::ValuesIn(namesOfScenes()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace aerosol::test
