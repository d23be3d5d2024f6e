#include "core/render/preparation/velocities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/grid/grid_file.h"
#include "core/render/scene_services.h"

namespace aerosol::render {

namespace {

/// Seconds times the factor of velocities, when the shutter opens and when it closes.
std::array<double, 2> secondsOf(const Preparation& state, const scene::VelocityBlur& blur) {
  const auto from = [&](float time) {
    return static_cast<double>(blur.factor()) * (static_cast<double>(time) - static_cast<double>(blur.referenceTime));
  };
  return {from(state.scene->shutter.open), from(state.scene->shutter.close)};
}

std::string fileOfVelocity(const scene::Volume& volume) {
  const scene::Value* own = volume.find("filename");
  return volume.velocity.file.empty() && own ? std::get<std::string>(*own) : volume.velocity.file;
}

/// Voxels that the velocities of a grid carry anything by. An error when there is no such grid; a warning when that
/// is more than anybody means.
int reachOfVelocity(Preparation& state, const scene::Volume& volume, const std::string& file,
                    const SourceLocation& location) {
  std::string problem;
  const VoxelFile* read = state.scene->services->voxels(file, problem);
  const VoxelGrid* grid = read ? read->find(volume.velocity.grid) : nullptr;
  if (!read) {
    state.errors.error(location, problem);
  } else if (!grid || grid->info().channels != 3) {
    state.errors.error(location, fmt::format("'{}' has no vector grid '{}'", file, volume.velocity.grid));
  }
  if (!grid || grid->info().channels != 3) return 0;
  const VoxelGridInfo& info = grid->info();
  const auto [s0, s1] = secondsOf(state, volume.velocity);
  double square = 0;
  for (std::size_t c = 0; c < 3; ++c)
    square += std::pow(static_cast<double>(std::max(std::fabs(info.least[c]), std::fabs(info.greatest[c]))), 2);
  const double way = std::sqrt(square) * std::max(std::fabs(s0), std::fabs(s1));
  const double voxel = *std::ranges::min_element(info.voxelSize);
  constexpr double most = 256;
  const double voxels = way > 0 ? std::ceil(way / voxel) + 2 : 0;
  if (voxels > most) {
    state.warnings.warning(
        location,
        fmt::format("velocities of grid '{}' carry its matter by up to {} scene units while the shutter "
                    "is open, {} voxels: blur reaches {} voxels at most",
                    volume.velocity.grid, way, voxels, most),
        {"velocities are per second; 'fps' says that they are per frame"});
  }
  return static_cast<int>(std::min(voxels, most));
}

/// velocity_grid.osl, reading the volume's grid, which goes on as far as it carries anything.
scene::ShaderUse velocityShader(Preparation& state, const scene::Volume& volume, const SourceLocation& location) {
  scene::ShaderUse use;
  use.name = "velocity_grid";
  use.nameLocation = use.origin.location = location;
  std::string file = fileOfVelocity(volume);
  if (const int voxels = reachOfVelocity(state, volume, file, location); voxels > 0)
    file = grid::continuedName(file, volume.velocity.grid, voxels);
  use.parameters.push_back({"filename", file, location, location});
  use.parameters.push_back({"gridname", volume.velocity.grid, location, location});
  return use;
}

}  // namespace

void placeVelocity(Preparation& state, const scene::Volume& volume, std::uint32_t medium) {
  const scene::VelocityBlur& blur = volume.velocity;
  shading::InstanceRef shader = state.scene->mediumShaders[medium];
  const SourceLocation& location = volume.origin.of(blur.grid.empty() ? "velocity" : "velocity_grid");
  if (!blur.grid.empty()) {
    const shading::Instance& placed = state.scene->shading.instance(shader);
    auto bound = bindShader(velocityShader(state, volume, location), "shader", placed.objectToWorld,
                            state.shaderSources(), state.scene->shading, state.warnings);
    if (!bound) return state.appendNew(bound.errors());
    const auto motion = state.scene->shading.instance(shader).motion;
    if (motion) state.scene->shading.setMotion(*bound, *motion);
    shader = *bound;
  }
  const std::string output = blur.grid.empty() ? blur.output : "velocity";
  const lang::Program& program = *state.scene->shading.family(shader).program;
  const auto isMeant = [&](const lang::Parameter& p) { return p.isOutput && p.name == output; };
  const auto found = std::ranges::find_if(program.parameters, isMeant);
  if (found == program.parameters.end() || found->type.isArray() || !found->type.isTriple()) {
    Diagnostic error{Severity::error,
                     location,
                     fmt::format("shader '{}' has no output '{}' that is a vector", program.name, output),
                     {},
                     {}};
    std::vector<std::string> outputs;
    for (const lang::Parameter& p : program.parameters) {
      if (p.isOutput && p.type.isTriple() && !p.type.isArray()) outputs.push_back(p.name);
    }
    error.notes.push_back(outputs.empty() ? "it has no vector among its outputs"
                                          : fmt::format("its vectors: {}", fmt::join(outputs, ", ")));
    return state.appendNew(error);
  }
  if (!state.scene->shading.setVelocity(shader, output)) {
    return state.errors.error(location,
                              fmt::format("another volume with the same shader takes its velocity from an output "
                                          "other than '{}'",
                                          output));
  }
  state.scene->velocities.resize(state.scene->media.size());
  state.scene->velocities[medium] = MediumVelocity{shader, blur.factor(), blur.referenceTime};
  state.scene->changes = state.scene->changes || !state.scene->shutter.isInstant();
}

CarriedMatter carriedBy(Preparation& state, const scene::Volume& volume) {
  if (volume.velocity.grid.empty()) return {};
  std::string problem;
  const VoxelFile* file = state.scene->services->voxels(fileOfVelocity(volume), problem);
  return {file ? file->find(volume.velocity.grid) : nullptr, secondsOf(state, volume.velocity)};
}

}  // namespace aerosol::render
