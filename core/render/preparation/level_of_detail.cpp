#include "core/render/preparation/level_of_detail.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "core/grid/grid_file.h"
#include "core/render/medium_preparation.h"

namespace aerosol::render {

namespace {

constexpr int mostLevels = 8;
constexpr std::size_t lines = 128, pointsOfLine = 64;

/// Calls use(parameter, name) for each parameter of an instance that names a voxel file.
template <class Use>
void forVoxelFiles(const Preparation& state, shading::InstanceRef shader, const Use& use) {
  const shading::Family& family = state.scene->shading.family(shader);
  for (std::uint32_t i = 0; i < family.program->parameters.size(); ++i) {
    const lang::ConstantValue* value = shading::valueOf(*family.program, state.scene->shading.instance(shader), i);
    const auto* names = value ? std::get_if<std::vector<std::string>>(value) : nullptr;
    if (!names || names->size() != 1 || !state.scene->services->isVoxelFile(names->front())) continue;
    use(i, names->front());
  }
}

double distanceTo(const Box<World>& box, Point<World> eye) {
  double squared = 0;
  for (int i = 0; i < 3; ++i) {
    const auto e = static_cast<double>(eye[i]);
    const double away = std::max({static_cast<double>(box.lower[i]) - e, e - static_cast<double>(box.upper[i]), 0.0});
    squared += away * away;
  }
  return std::sqrt(squared);
}

/// How long a pixel is at a distance from the camera, and from where the distance counts.
class PixelLength {
 public:
  PixelLength(const Camera& camera, float time) : toWorld_(camera.toWorld(time)), near_(camera.nearClip()) {
    const Camera::View view = camera.view();
    isOrthographic_ = camera.isOrthographic();
    const double across =
        isOrthographic_ ? static_cast<double>(length(toWorld_(Vector<aerosol::Camera>(1, 0, 0)))) : 1.0;
    atOne_ = across * (view.x1 - view.x0) / camera.projection().width;
  }
  double nearestIn(const Box<World>& box) const {
    if (isOrthographic_) return atOne_;
    return atOne_ * std::max(distanceTo(box, toWorld_(Point<aerosol::Camera>(0, 0, 0))), near_);
  }

 private:
  Transform<World, aerosol::Camera> toWorld_;
  double near_, atOne_ = 0;
  bool isOrthographic_ = false;
};

Box<World> worldBox(const VoxelGridInfo& info, const Transform<World, Object>& toWorld) {
  Box<World> box;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const auto at = [&](std::size_t i) { return static_cast<float>(info.bounds[i + (corner >> i & 1u ? 3 : 0)]); };
    box.extend(toWorld(Point<Object>(at(0), at(1), at(2))));
  }
  return box;
}

/// The voxels' longest edge in the world: what is left out is nowhere longer.
double voxelLength(const VoxelGridInfo& info, const Transform<World, Object>& toWorld) {
  double longest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Vector<Object> edge(0, 0, 0);
    edge[axis] = static_cast<float>(info.voxelSize[static_cast<std::size_t>(axis)]);
    longest = std::max(longest, static_cast<double>(length(toWorld(edge))));
  }
  return longest;
}

}  // namespace

int levelByDistance(const Preparation& state, shading::InstanceRef shader) {
  const float pixels = state.description.integrator.lodPixels;
  if (!(pixels > 0)) return 0;
  const shading::Instance& instance = state.scene->shading.instance(shader);
  double level = std::numeric_limits<double>::infinity();
  forVoxelFiles(state, shader, [&](std::uint32_t, const std::string& name) {
    std::string ignored;
    const VoxelFile* const file = state.scene->services->voxels(name, ignored);
    if (!file) return;
    for (const auto& grid : file->grids()) {
      const VoxelGridInfo& info = grid->info();
      if (info.isEmpty || !info.problem.empty()) continue;
      for (const float time : {state.scene->shutter.open, state.scene->shutter.close}) {
        const Transform<World, Object> toWorld =
            instance.motion ? instance.motion->at(time) : Transform<World, Object>(instance.objectToWorld);
        const double pixel = PixelLength(*state.scene->camera, time).nearestIn(worldBox(info, toWorld));
        level = std::min(level, std::log2(static_cast<double>(pixels) * pixel / voxelLength(info, toWorld)));
      }
    }
  });
  return std::isfinite(level) ? std::clamp(static_cast<int>(std::floor(level)), 0, mostLevels) : 0;
}

std::optional<shading::InstanceRef> coarserShader(Preparation& state, shading::InstanceRef shader, int level) {
  shading::Instance instance = state.scene->shading.instance(shader);
  bool isAny = false;
  forVoxelFiles(state, shader, [&](std::uint32_t parameter, const std::string& name) {
    std::erase_if(instance.values, [&](const shading::ParameterValue& v) { return v.parameter == parameter; });
    instance.values.push_back({parameter, std::vector<std::string>{grid::coarseName(name, level)}});
    isAny = true;
  });
  if (!isAny) return {};
  // A family of its own: the names stay constants of its kernels.
  return state.scene->shading.add(std::make_shared<const lang::Program>(*state.scene->shading.family(shader).program),
                                  std::move(instance));
}

namespace {

/// Differences of transmittance along the same lines.
struct LineDifference {
  double mean = 0, rms = 0;
};

/// Optical depths of lines between random places of the medium's box.
std::vector<double> depthsOfLines(const PreparedScene& scene, const volume::Medium& medium, const Box<Object>& box,
                                  const Transform<World, Object>& toWorld) {
  std::vector<Point<World>> points;
  std::vector<double> steps;
  const auto number = [](std::size_t line, std::size_t k) {
    return randomFloat(0, static_cast<std::uint32_t>(line), static_cast<std::uint32_t>(k));
  };
  for (std::size_t line = 0; line < lines; ++line) {
    const auto place = [&](std::size_t first) {
      Point<Object> p;
      for (int i = 0; i < 3; ++i) {
        p[i] = box.lower[i] + (box.upper[i] - box.lower[i]) * number(line, first + static_cast<std::size_t>(i));
      }
      return toWorld(p);
    };
    const Point<World> a = place(0), b = place(3);
    for (std::size_t k = 0; k < pointsOfLine; ++k) {
      points.push_back(a + (b - a) * ((static_cast<float>(k) + 0.5f) / static_cast<float>(pointsOfLine)));
    }
    steps.push_back(static_cast<double>(length(b - a)) / static_cast<double>(pointsOfLine));
  }
  std::vector<double> depths(lines);
  askExtinction(scene, medium, points, [&, next = std::size_t{0}](Color sigmaT) mutable {
    depths[next / pointsOfLine] += static_cast<double>(average(sigmaT)) * steps[next / pointsOfLine];
    ++next;
  });
  return depths;
}

LineDifference compare(const std::vector<double>& coarse, const std::vector<double>& fine) {
  LineDifference result;
  for (std::size_t i = 0; i < lines; ++i) {
    const double difference = std::exp(-coarse[i]) - std::exp(-fine[i]);
    result.mean += difference / static_cast<double>(lines);
    result.rms += difference * difference / static_cast<double>(lines);
  }
  result.rms = std::sqrt(result.rms);
  return result;
}

}  // namespace

void reportLevelsOfDetail(Preparation& state) {
  for (const CoarseMedium& each : state.coarseMedia) {
    const volume::Medium& medium = state.scene->media[each.medium];
    const std::optional<Box<Object>>& box = state.placements[each.medium].place.domain;
    std::string text = fmt::format("; its voxels are {} times as long", 1 << each.level);
    if (each.fine && box) {
      const shading::Instance& instance = state.scene->shading.instance(state.scene->mediumShaders[each.medium]);
      const Transform<World, Object> toWorld =
          instance.motion ? instance.motion->at(state.scene->shutter.open) : instance.objectToWorld;
      const LineDifference difference =
          compare(depthsOfLines(*state.scene, medium, *box, toWorld),
                  depthsOfLines(*state.scene, state.scene->media[*each.fine], *box, toWorld));
      text += fmt::format(", which changes the transmittance of lines through it by {:+.2g} on average, {:.2g} rms",
                          difference.mean, difference.rms);
    }
    state.scene->samplingReasons[each.medium] += text;
  }
}

}  // namespace aerosol::render
