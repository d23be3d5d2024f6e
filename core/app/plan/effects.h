// Every effect that the renderer knows, and whether a scene calls for it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/render/prepared_scene.h"
#include "core/render/statistics.h"
#include "core/scene/description.h"

namespace aerosol::app {

/// Decided from what preparation found out: compiled programs, bounds and geometry, not names.
struct Effect {
  std::string name;    ///< As `--without` takes it, where that is possible.
  std::string reason;  ///< Why it is on, with object and place; or why it is off.
  bool isOn = false;
  /// Work done for it alone, of the render's statistics: 0 where the effect is off.
  std::function<std::uint64_t(const render::WorkerStatistics&)> work;
  /// Part of the work of paths, as far as it can be told apart; null where it cannot. Parts overlap: light of the sun
  /// is sampled at scattering events.
  std::function<double(const render::WorkerStatistics&)> share;
};

/// One of the counters of what is done for effects.
inline std::function<std::uint64_t(const render::WorkerStatistics&)> countOf(render::Work work) {
  return [work](const render::WorkerStatistics& s) { return s.work.of(work); };
}

/// Kinds of lights and of their sampling.
void addLightEffects(const scene::SceneDescription& description, const render::PreparedScene& scene,
                     std::vector<Effect>& effects);
/// What changes while the shutter is open, and where paths begin and end.
void addMotionEffects(const scene::SceneDescription& description, const render::PreparedScene& scene,
                      std::vector<Effect>& effects);

std::vector<Effect> listEffects(const scene::SceneDescription& description, const render::PreparedScene& scene);

/// Effects that can be forced off, with what that changes.
struct RemovableEffect {
  std::string name;
  std::string consequence;
  void (*remove)(scene::SceneDescription&);
};
const std::vector<RemovableEffect>& removableEffects();

/// Forces effects off. Errors name those that are known.
Diagnostics removeEffects(const std::vector<std::string>& names, scene::SceneDescription& description);

}  // namespace aerosol::app
