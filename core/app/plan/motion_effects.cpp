#include "core/app/plan/effects.h"
#include "core/app/plan/names.h"

namespace aerosol::app {

namespace {

Effect effectOf(const char* name, const Names& names, const char* offReason,
                std::function<std::uint64_t(const render::WorkerStatistics&)> work) {
  return {name, names.count() > 0 ? names.text() : offReason, names.count() > 0, std::move(work), {}};
}

std::uint64_t velocityPoints(const render::WorkerStatistics& s) {
  std::uint64_t points = 0;
  constexpr auto variant = static_cast<std::size_t>(shading::Variant::velocity);
  for (std::size_t i = variant; i < s.kernels.size(); i += shading::variantCount) points += s.kernels[i].points;
  return points;
}

}  // namespace

void addMotionEffects(const scene::SceneDescription& description, const render::PreparedScene& scene,
                      std::vector<Effect>& effects) {
  const Shutter shutter = description.sensor.shutter();
  const char* const still = shutter.isInstant() ? "the shutter is open for an instant" : "nothing of the kind moves";
  effects.push_back({"motion",
                     scene.changes ? fmt::format("the shutter is open from {:g} to {:g} s{}", shutter.open,
                                                 shutter.close, at(description.sensor.origin.location))
                                   : still,
                     scene.changes,
                     countOf(render::Work::time),
                     {}});
  Names cameras, shapes, lights, volumes, velocities, held;
  if (scene.camera->motion()) cameras.add("the camera", description.sensor.origin.location);
  for (const scene::Shape& shape : description.shapes) {
    if (!shape.toWorld.motionDuring(shutter)) continue;
    shapes.add("a shape", shape.origin.location);
    if (shape.emitter) lights.add("a light", shape.emitter->origin.location);
  }
  for (const scene::Emitter& emitter : description.emitters) {
    if (emitter.toWorld.motionDuring(shutter)) lights.add("a light", emitter.origin.location);
  }
  for (const scene::Volume& volume : description.volumes) {
    if (volume.toWorld.motionDuring(shutter)) volumes.add(volume.type, volume.origin.location);
    if (volume.controls.holdout) held.add(volume.type, volume.origin.location);
  }
  for (std::size_t i = 0; i < scene.media.size(); ++i) {
    if (scene.velocityOf(static_cast<std::uint32_t>(i))) velocities.add(scene.mediumNames[i], scene.mediumLocations[i]);
  }
  effects.push_back(effectOf("moving-camera", cameras, still, countOf(render::Work::cameraMotion)));
  effects.push_back(effectOf("moving-shapes", shapes, still,
                             [](const render::WorkerStatistics& s) { return s.accel.movingSurfaceTests; }));
  effects.push_back(effectOf("moving-lights", lights, still, countOf(render::Work::movingLight)));
  effects.push_back(effectOf("moving-volumes", volumes, still,
                             [](const render::WorkerStatistics& s) { return s.accel.movingVolumeTests; }));
  effects.push_back(
      effectOf("velocity-blur", velocities, shutter.isInstant() ? still : "no medium has velocities", velocityPoints));
  effects.push_back(effectOf("holdouts", held, "no volume cuts a hole", countOf(render::Work::holdout)));
  effects.push_back({"media-probes",
                     scene.probesMedia ? "paths may begin in different media: each looks above where it begins"
                                       : "all paths begin in the same medium",
                     scene.probesMedia,
                     countOf(render::Work::probe),
                     {}});
}

}  // namespace aerosol::app
