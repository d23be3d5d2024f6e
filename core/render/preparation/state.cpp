#include "core/render/preparation/state.h"

#include <algorithm>

#include "core/render/scene_services.h"

namespace aerosol::render {

namespace {

std::vector<std::filesystem::path> searchPath(const scene::SceneDescription& description,
                                              const PrepareOptions& options) {
  std::vector<std::filesystem::path> path = options.shaderPath;
  path.insert(path.end(), description.searchPath.begin(), description.searchPath.end());
  path.push_back(options.shaderLibrary);
  if (!options.plugins.empty()) path.push_back(options.plugins);
  return path;
}

shading::ShaderLibrary makeLibrary(const scene::SceneDescription& description, const PrepareOptions& options) {
  const std::vector<std::filesystem::path> path = searchPath(description, options);
  lang::CompileOptions compile;
  compile.includePaths = path;
  compile.standardLibrary = options.shaderLibrary / "stdosl.h";
  return {path, compile, options.cache};
}

}  // namespace

Box<World> placed(const Box<World>& box, const Transform<World, Object>& place) {
  Box<World> bounds;
  for (int corner = 0; corner < 8; ++corner) {
    const auto end = [&](int axis) { return corner >> axis & 1 ? box.upper[axis] : box.lower[axis]; };
    bounds.extend(place(Point<Object>(end(0), end(1), end(2))));
  }
  return bounds;
}

Transform<Object, Object> asObject(const Transform<World, Object>& local) {
  return {local.matrix(), local.inverseMatrix()};
}

Preparation::Preparation(const scene::SceneDescription& about, const Registry& plugins, const PrepareOptions& how,
                         Diagnostics& warned)
    : description(about),
      registry(plugins),
      options(how),
      warnings(warned),
      library(makeLibrary(about, how)),
      scene(std::make_unique<PreparedScene>()),
      meshFiles(about),
      links(about, *scene) {
  scene->services = makeServices({searchPath(about, how), how.textureMemory_MB, how.colors});
}

void Preparation::appendNew(const Diagnostics& added) {
  for (const Diagnostic& each : added.entries()) appendNew(each);
}

void Preparation::appendNew(const Diagnostic& error) {
  const bool known = std::any_of(errors.entries().begin(), errors.entries().end(), [&](const Diagnostic& e) {
    return e.location == error.location && e.message == error.message;
  });
  if (!known) errors.add(error);
}

void Preparation::appendAt(const SourceLocation& element, const Diagnostics& added) {
  for (Diagnostic error : added.entries()) {
    if (error.location.file.empty()) error.location = element;
    appendNew(error);
  }
}

std::shared_ptr<const Motion> Preparation::motionOf(const scene::Placement<World, Object>& placement) {
  auto motion = placement.motionDuring(scene->shutter);
  scene->changes = scene->changes || motion;
  return motion;
}

scene::Volume Preparation::standing(const scene::Volume& volume, bool moves) const {
  scene::Volume still = volume;
  still.toWorld = moves ? Transform<World, Object>() : atOpening(volume.toWorld);
  return still;
}

float Preparation::sceneExtent() const {
  const Box<World> bounds = scene->geometry->bounds();
  return bounds.isEmpty() ? 1.0f : length(bounds.upper - bounds.lower);
}

}  // namespace aerosol::render
