#include "tests/support/rendering.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/app/plan/effects.h"
#include "core/base/paths.h"
#include "core/jit/compiler.h"
#include "core/render/registry.h"
#include "core/scene/loader.h"
#include "plugins/registration.h"

namespace aerosol::test {

namespace {

/// What all scenes of a test program share; made at first use.
struct Tools {
  Installation installation;
  render::Registry registry;
  std::shared_ptr<jit::ObjectCache> cache;
  std::shared_ptr<jit::Compiler> compiler;
  scene::KnownTypes types;

  Tools() {
    render::registerPlugins(registry);
    types.volumes.clear();
    for (const render::VolumeType& type : registry.volumes()) types.volumes.push_back(type.described);
    auto found = findInstallation();
    if (!found) throw std::runtime_error(format(found.errors()));
    installation = *found;
    if (auto opened = jit::ObjectCache::open(jit::ObjectCache::defaultFolder())) cache = *opened;
    auto made = jit::Compiler::create({installation.runtime, cache});
    if (!made) throw std::runtime_error(format(made.errors()));
    compiler = *made;
  }

  static const Tools& instance() {
    static const Tools tools;
    return tools;
  }
};

}  // namespace

TestScene::TestScene(const std::string& xml, const SceneOptions& options) {
  const Tools& tools = Tools::instance();
  Diagnostics warnings;
  auto loaded = scene::loadString(xml, "test.xml", options.shaderFolder, {.knownTypes = tools.types}, warnings);
  if (!loaded) {
    ADD_FAILURE() << format(loaded.errors()) << xml;
    return;
  }
  description_ = std::move(*loaded);
  EXPECT_FALSE(app::removeEffects(options.without, *description_).hasErrors());
  const auto isa = options.isa ? std::optional<std::string_view>(*options.isa) : std::nullopt;
  const auto target = jit::chooseTarget(options.width, isa);
  if (!target) {
    ADD_FAILURE() << format(target.errors());
    return;
  }
  render::PrepareOptions prepare;
  if (!options.shaderFolder.empty()) prepare.shaderPath = {options.shaderFolder};
  prepare.shaderLibrary = tools.installation.shaders;
  prepare.compiler = tools.compiler;
  prepare.cache = tools.cache;
  prepare.target = *target;
  prepare.laneCounters = options.laneCounters;
  prepare.loopBudget = options.loopBudget;
  prepare.deepSlices = options.deepSlices;
  auto prepared = render::prepare(*description_, tools.registry, prepare, warnings);
  if (!prepared) {
    ADD_FAILURE() << format(prepared.errors());
    return;
  }
  warnings_ = format(warnings);
  if (!options.mayWarn) EXPECT_TRUE(warnings.empty()) << warnings_;
  scene_ = std::move(*prepared);
}

TestScene::~TestScene() = default;

std::unique_ptr<render::Film> TestScene::film(std::optional<render::PixelRect> crop) const {
  const scene::Film& film = description_->film;
  return std::make_unique<render::Film>(crop.value_or(render::PixelRect{0, 0, film.width, film.height}),
                                        scene_ && scene_->aovs ? scene_->aovs->layout : render::AovLayout{});
}

render::RenderReport TestScene::renderInto(render::Film& film, const render::RenderOptions& options) const {
  if (!scene_) return {};
  return render::render(*scene_, integrator(), film, options);
}

const render::Integrator& TestScene::integrator() const {
  return *Tools::instance().registry.integrator(description_->integrator.type);
}

std::unique_ptr<render::Film> TestScene::render(std::uint32_t samples) const {
  auto result = film();
  renderInto(*result, {.threads = 1, .endSample = samples});
  EXPECT_EQ(result->droppedCount(), 0u) << "samples that are not finite";
  return result;
}

std::string TestSensor::xml() const {
  const std::string lookAt = fmt::format(
      R"(<transform name="to_world"><lookat origin="{}" target="{}" up="0, 1, 0"/></transform>)", origin, target);
  const std::string angle =
      type == "orthographic" ? std::string() : fmt::format(R"(<float name="fov" value="{}"/>)", fov);
  return fmt::format(
      R"(<sensor type="{}">{}
        {}
        <float name="near_clip" value="{}"/>
        <float name="far_clip" value="{}"/>
        <film type="hdrfilm">
          <integer name="width" value="{}"/>
          <integer name="height" value="{}"/>
          <rfilter type="box"/>
        </film>
        <sampler type="{}"><integer name="seed" value="{}"/></sampler>
        {}
      </sensor>)",
      type, placement.empty() ? lookAt : placement, angle, nearClip, farClip, width, height, sampler, seed, medium);
}

std::string sceneXml(const std::string& integrator, const TestSensor& sensor, const std::string& content) {
  return fmt::format("<scene version=\"3.0.0\">\n<integrator type=\"path\">{}</integrator>\n{}\n{}\n</scene>\n",
                     integrator, sensor.xml(), content);
}

bool identical(const render::Film& a, const render::Film& b) {
  if (!(a.area() == b.area()) || a.layout() != b.layout()) return false;
  for (int y = a.area().y0; y < a.area().y1; ++y) {
    for (int x = a.area().x0; x < a.area().x1; ++x) {
      if (!(a.pixel(x, y) == b.pixel(x, y))) return false;
      if (!a.layout().isEmpty() && !(a.aovs(x, y) == b.aovs(x, y))) return false;
    }
  }
  return true;
}

}  // namespace aerosol::test
