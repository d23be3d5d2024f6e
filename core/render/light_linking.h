// Which lights light which volumes and surfaces, as a scene is prepared.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "core/render/prepared_scene.h"

namespace aerosol::render {

/// Reads the `lights` of volumes and shapes, before media are decided; then, when all lights are there, makes their
/// sets.
class LightLinking {
 public:
  /// Adds a medium that is another one of the scene but for what its look changes.
  using CopyMedium = std::function<const volume::Medium*(const volume::Medium&, const VolumeLook&)>;

  LightLinking(const scene::SceneDescription& description, PreparedScene& scene)
      : description_(description), scene_(scene) {}

  /// How many media `read` adds at most, of `media`.
  static std::size_t mostCopies(std::size_t media) { return media; }
  /// Media of the scene stand where they stay. Errors for names that are no lights.
  Diagnostics read(const CopyMedium& copy);
  /// Behind the lights of the description, one for each of these media (by index).
  void makeSets(std::span<const std::uint32_t> glowingMedia, float sceneRadius);

 private:
  struct Candidate {
    std::string id;
    std::optional<std::uint32_t> medium;  ///< One that glows; none: a light of the description.
  };
  void findCandidates();
  bool emits(const volume::Medium& medium) const;
  bool isDark(const volume::Medium& medium) const;
  std::uint32_t setOf(std::vector<bool> named);
  std::unique_ptr<LinkedLights> seenBy(const std::vector<bool>& named, const CopyMedium& copy);

  const scene::SceneDescription& description_;
  PreparedScene& scene_;
  std::vector<Candidate> candidates_;
  std::vector<std::vector<bool>> sets_;                  ///< By candidate.
  std::map<std::uint32_t, const volume::Medium*> dark_;  ///< By the medium that glows: itself without its glow.
};

}  // namespace aerosol::render
