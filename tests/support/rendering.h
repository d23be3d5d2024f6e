// Whole renders from the text of a scene: loading, preparation, rendering, as the program does them.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/render/film.h"
#include "core/render/prepare.h"
#include "core/render/renderer.h"

namespace aerosol::test {

/// How a scene is prepared. Shaders are found in `shaderFolder` and in the installed library.
struct SceneOptions {
  std::filesystem::path shaderFolder;
  std::optional<int> width;        ///< Lanes; the machine's own otherwise.
  std::optional<std::string> isa;  ///< Of shaders.
  bool laneCounters = false;
  std::uint32_t loopBudget = 1u << 24;
  bool mayWarn = false;                ///< Warnings are no failures.
  int deepSlices = 0;                  ///< Of a deep image; 0: none.
  std::vector<std::string> without{};  ///< Effects forced off.
};

/// A scene that is ready. Errors and warnings are test failures with their text.
class TestScene {
 public:
  explicit TestScene(const std::string& xml, const SceneOptions& options = {});
  TestScene(TestScene&&) = default;
  ~TestScene();

  /// Null when something was wrong.
  const render::PreparedScene* scene() const { return scene_.get(); }
  /// Of preparation, as they are printed.
  const std::string& warnings() const { return warnings_; }
  const scene::SceneDescription& description() const { return *description_; }
  const render::Integrator& integrator() const;

  /// The whole film, or `crop` of it, with the AOVs of the scene.
  std::unique_ptr<render::Film> film(std::optional<render::PixelRect> crop = {}) const;
  render::RenderReport renderInto(render::Film& film, const render::RenderOptions& options) const;
  /// Samples 0 ≤ i < `samples` of all pixels, on one thread.
  std::unique_ptr<render::Film> render(std::uint32_t samples) const;

 private:
  std::optional<scene::SceneDescription> description_;
  std::unique_ptr<const render::PreparedScene> scene_;
  std::string warnings_;
};

/// A perspective camera and a film with a box filter, as XML: what most test scenes begin with.
struct TestSensor {
  std::string origin = "0, 0, -5";
  std::string target = "0, 0, 0";
  double fov = 20;  ///< Degrees, of the width; of no meaning to an orthographic one.
  int width = 16;
  int height = 16;
  std::string sampler = "independent";
  int seed = 0;
  std::string medium;  ///< An element inside the sensor, or empty.
  std::string type = "perspective";
  std::string placement;  ///< An element in place of that from `origin` to `target`, or empty.
  double nearClip = 0.01, farClip = 10000;

  std::string xml() const;
};

/// `<scene>` with an integrator of the given parameters (elements), the sensor and the rest.
std::string sceneXml(const std::string& integrator, const TestSensor& sensor, const std::string& content);

/// The same samples in every pixel, bit by bit, AOVs included.
bool identical(const render::Film& a, const render::Film& b);

}  // namespace aerosol::test
