#include "core/render/path_state.h"

#include <utility>

namespace aerosol::render {

namespace {

/// What referred to lights of `from` refers to those of `to`, a copy of it.
void moveReference(DirectionRecord& direction, const PathState& from, const PathState& to) {
  if (!direction.place) return;
  for (std::size_t i = 0; i < from.lights.size(); ++i) {
    if (from.lights[i] && direction.place->lights == &*from.lights[i]) {
      direction.place->lights = &*to.lights[i];
      return;
    }
  }
}

}  // namespace

PathBranch& PathBranches::begin(PathContext& path, const PathState& state, int index) {
  constexpr std::uint64_t ofBranches = 0x5b1c7f3d00000000u;
  PathBranch& branch = *branches_.emplace_back(std::make_unique<PathBranch>());
  branch.state = state;
  branch.random = path.random().branch(ofBranches | static_cast<std::uint64_t>(state.length) << 8 |
                                       static_cast<std::uint64_t>(index));
  if (path.scene().nestsMedia) branch.media = path.media;
  if (path.record) before_ = path.record->place();
  return branch;
}

void PathBranches::finish(PathContext& path, const PathState& state, const RayFootprint& seen) {
  PathBranch& branch = *branches_.back();
  moveReference(branch.state.direction, state, branch.state);
  if (path.keepsFootprints()) {
    branch.footprint = path.footprint();
    path.setFootprint(seen);
  }
  if (!path.record) return;
  branch.place = path.record->place();
  path.record->returnTo(*std::exchange(before_, {}));
}

bool PathBranches::resumeLast(PathContext& path, PathState& state) {
  if (branches_.empty()) return false;
  const PathBranch& branch = *branches_.back();
  state = branch.state;
  moveReference(state.direction, branch.state, state);
  path.random() = branch.random;
  if (path.keepsFootprints()) path.setFootprint(branch.footprint);
  if (path.record) path.record->returnTo(*branch.place);
  if (path.scene().nestsMedia) {
    path.media = branch.media;
    if (!path.media.empty()) state.boundaryMedium = path.media.medium();
  }
  branches_.pop_back();
  return true;
}

}  // namespace aerosol::render
