#include "core/render/preparation/velocities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/grid/grid_file.h"
#include "core/render/carried_volume.h"
#include "core/render/scene_services.h"
#include "core/shading/bounds.h"

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
  // Outputs of layers have the layer's name before theirs, which may be left out.
  const lang::Program& program = *state.scene->shading.family(shader).program;
  const auto isMeant = [&](const lang::Parameter& p) {
    return p.isOutput && (p.name == output || p.name.ends_with("." + output));
  };
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
  if (!state.scene->shading.setVelocity(shader, found->name)) {
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

namespace {

constexpr Box<Object> everywhere{{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}};

/// How far velocities carry what is in a box of the shader's space.
class Carrying {
 public:
  Carrying(Preparation& state, const MediumVelocity& velocity, std::uint32_t medium)
      : state_(state),
        velocity_(velocity),
        placed_(state.scene->shading.instance(state.scene->mediumShaders[medium])),
        host_(state.scene->namedSpaces, state.scene->loopBudget, state.scene->services.get()) {}

  /// `box` grown to hold all that comes out of it: the velocities are those where the matter is, so the box that is
  /// asked for them grows with it, until it holds what is carried by all within. `isAll`: false where that never comes
  /// about, as velocities grow with the distance; then it holds what gets out of the box in two rounds, if anything is
  /// known of the velocities at all, which else is empty.
  Box<Object> from(const Box<Object>& box, bool& isAll) {
    constexpr int rounds = 8;
    isAll = true;
    if (!placed_.motion) {
      Box<Object> reached = box;
      for (int i = 0; i < rounds; ++i) {
        const Box<Object> next = grown(box, reached);
        if (next.isEmpty()) break;
        if (holds(reached, next)) return reached;
        reached = next;
        if (i + 2 >= rounds) reached = widened(reached);
      }
    }
    const Box<Object> reached = grown(box, everywhere);
    isAll = !reached.isEmpty() && length(reached.upper - reached.lower) < 1e25f;
    return isAll ? reached : grown(box, grown(box, box));
  }

 private:
  static bool holds(const Box<Object>& outer, const Box<Object>& inner) {
    for (int i = 0; i < 3; ++i) {
      if (inner.lower[i] < outer.lower[i] || inner.upper[i] > outer.upper[i]) return false;
    }
    return true;
  }
  static Box<Object> widened(Box<Object> box) {
    const Vector<Object> sides = (box.upper - box.lower) * 0.25f;
    return {box.lower - sides, box.upper + sides};
  }

  /// By the velocities of the places `at`.
  Box<Object> grown(Box<Object> box, const Box<Object>& at) {
    const shading::Family& family = state_.scene->shading.family(velocity_.shader);
    if (!family.velocityBounds) return {};
    const Shutter& shutter = state_.scene->shutter;
    const shading::VolumeBox asked{at, shutter.open, shutter.close};
    shading::VelocityBounds bounds;
    batch_.evaluateVelocity(host_, family, velocity_.shader.index, {&asked, 1}, {&bounds, 1});
    const auto seconds = [&](float time) {
      return static_cast<double>(velocity_.factor) *
             (static_cast<double>(time) - static_cast<double>(velocity_.referenceTime));
    };
    const double s0 = seconds(shutter.open), s1 = seconds(shutter.close);
    std::array<double, 3> low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v0 = static_cast<double>(bounds.velocity[k].low), v1 = static_cast<double>(bounds.velocity[k].high);
      if (!std::isfinite(v0) || !std::isfinite(v1)) return {};
      const auto [least, greatest] = std::minmax({s0 * v0, s0 * v1, s1 * v0, s1 * v1});
      // A velocity that is no number moves nothing.
      low[k] = bounds.mayBeNan ? std::min(least, 0.0) : least;
      high[k] = bounds.mayBeNan ? std::max(greatest, 0.0) : greatest;
    }
    if (at.isEmpty()) return {};
    Box<Object> sum;
    constexpr int looks = 65;
    for (int look = 0; look < (placed_.motion ? looks : 1); ++look) {
      const Matrix4 back = placed_.motion
                               ? placed_.motion->at(shutter.at(static_cast<float>(look) / (looks - 1))).inverseMatrix()
                               : placed_.objectToWorld.inverseMatrix();
      Box<Object> moved = box;
      for (int i = 0; i < 3; ++i) {
        const auto row = static_cast<std::size_t>(i);
        double from = 0, to = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          from += std::min(back[row][k] * low[k], back[row][k] * high[k]);
          to += std::max(back[row][k] * low[k], back[row][k] * high[k]);
        }
        // Turning, it may reach a little further between two looks.
        const double slack = (placed_.motion ? 0.02 : 1e-6) * (to - from + std::fabs(from) + std::fabs(to));
        moved.lower[i] = std::nextafter(static_cast<float>(static_cast<double>(box.lower[i]) + from - slack), -1e38f);
        moved.upper[i] = std::nextafter(static_cast<float>(static_cast<double>(box.upper[i]) + to + slack), 1e38f);
      }
      sum.extend(moved.lower);
      sum.extend(moved.upper);
    }
    return sum;
  }

  Preparation& state_;
  const MediumVelocity& velocity_;
  const shading::Instance& placed_;
  shading::KernelHost host_;
  shading::BoundsBatch batch_{16};
};

}  // namespace

std::unique_ptr<const accel::VolumeShape> carry(Preparation& state, const scene::Volume& volume, std::uint32_t medium,
                                                const Transform<World, Object>& placed, bool hasRoom,
                                                std::unique_ptr<const accel::VolumeShape> shape) {
  const MediumVelocity* const velocity = state.scene->velocityOf(medium);
  const bool byGrid = !volume.velocity.grid.empty();
  if (!velocity || (byGrid && hasRoom) || shape->objectBounds().isEmpty()) return shape;
  bool isAll = true;
  const Box<Object> reach = Carrying(state, *velocity, medium).from(shape->objectBounds(), isAll);
  if (!isAll) {
    const std::string where =
        reach.isEmpty() ? "out of the primitive"
                        : fmt::format("beyond ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) of its space", reach.lower.x,
                                      reach.lower.y, reach.lower.z, reach.upper.x, reach.upper.y, reach.upper.z);
    state.warnings.warning(volume.origin.of(byGrid ? "velocity_grid" : "velocity"),
                           "nothing bounds this velocity: what it carries " + where + " is not seen",
                           {"clamp it in the shader, or make the primitive as large as what is carried"});
  }
  if (reach.isEmpty()) return shape;
  // Where voxels carry voxels there is nothing around them anyway.
  const bool isConfined = !(byGrid && volume.type == "grid");
  auto carried = std::make_unique<const CarriedVolume>(std::move(shape), placed, reach);
  if (isConfined) {
    const auto i = static_cast<std::size_t>(&volume - state.description.volumes.data());
    for (const volume::Medium* each : state.scene->mediaOf(i)) {
      state.scene->velocities[each->index]->within = carried.get();
    }
  }
  return carried;
}

}  // namespace aerosol::render
