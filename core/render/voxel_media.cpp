#include "core/render/voxel_media.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "core/lang/voxel_density.h"
#include "core/shading/instance_values.h"

namespace aerosol::render {

namespace {

using volume::VoxelField;
using volume::VoxelKernel;

/// Fields by what they were made of; null where a grid cannot be one.
using Fields = std::map<std::pair<const VoxelGrid*, VoxelKernel>, std::shared_ptr<const VoxelField>>;

bool readsVoxels(const lang::Program& program) {
  const auto isLookup = [](const lang::FunctionUse& function) { return function.symbol == "texture3d"; };
  return program.isVolume() && std::ranges::any_of(program.functions, isLookup);
}

Color toColor(const std::array<float, 3>& c) { return {c[0], c[1], c[2]}; }

volume::Coefficients coefficientsOf(const lang::VoxelDensity& density) {
  volume::Coefficients c;
  c.sigmaT = toColor(density.sigmaT);
  c.sigmaS = toColor(density.sigmaS);
  c.emission = toColor(density.emission);
  c.lobeCount = static_cast<std::uint32_t>(density.lobes.size());
  for (std::size_t i = 0; i < density.lobes.size(); ++i) {
    c.lobes[i] = {toColor(density.lobes[i].sigmaS), density.lobes[i].anisotropy};
  }
  return c;
}

/// As texture functions take the words; nothing for kernels without a closed form.
std::optional<VoxelKernel> kernelOf(const std::string& interpolation) {
  if (interpolation == "linear" || interpolation == "smartcubic") return VoxelKernel::trilinear;
  if (interpolation == "closest") return VoxelKernel::constant;
  return {};
}

const VoxelGrid* gridOf(const PreparedScene& scene, const lang::VoxelLookup& lookup) {
  std::string problem;
  if (!scene.services || !scene.services->isVoxelFile(lookup.file)) return nullptr;
  const VoxelFile* const file = scene.services->voxels(lookup.file, problem);
  const VoxelGrid* const grid = file ? file->find(lookup.grid) : nullptr;
  const bool isStill = grid && !grid->info().type.starts_with("curves");
  return isStill && lookup.channel == 0 ? grid : nullptr;
}

/// The index space of a grid, seen from the file's, which is the medium's object space.
std::optional<Matrix4> objectToIndex(const VoxelGridInfo& info) {
  Matrix4 toFile, inverse;
  for (std::size_t i = 0; i < 16; ++i) toFile[i / 4][i % 4] = info.indexToFile[i];
  if (!invert(toFile, inverse)) return {};
  return inverse;
}

}  // namespace

void findVoxelMedia(PreparedScene& scene, const std::function<bool(std::uint32_t)>& isWanted,
                    std::uint64_t largestBytes) {
  scene.voxelMedia.resize(scene.media.size());
  Fields fields;
  std::uint64_t bytes = 0;
  for (volume::Medium& medium : scene.media) {
    const shading::InstanceRef shader = scene.mediumShaders[medium.index];
    const shading::Family& family = scene.shading.family(shader);
    const shading::Instance& instance = family.instances[shader.index];
    if (!readsVoxels(*family.program) || scene.velocityOf(medium.index) || !isWanted(medium.index)) continue;
    const VolumeLook* const look = scene.lookOf(medium.index);
    // Ramps over the density are no factors.
    if (look && !(look->densityRamp.empty() && look->colorRamp.empty())) continue;
    const auto density = lang::findVoxelDensity(*family.program, shading::valuesOf(*family.program, instance));
    const auto kernel = density ? kernelOf(density->lookup.interpolation) : std::nullopt;
    const VoxelGrid* const grid = kernel ? gridOf(scene, density->lookup) : nullptr;
    const auto toIndex = grid ? objectToIndex(grid->info()) : std::nullopt;
    if (!toIndex || grid->info().greatest[0] > density->largestValue) continue;
    const auto [known, isNew] = fields.try_emplace({grid, *kernel});
    if (isNew) {
      if (auto field = VoxelField::make(*grid, *kernel, largestBytes - bytes)) {
        bytes += std::min(field->bytes(), largestBytes - bytes);
        known->second = std::make_shared<const VoxelField>(std::move(*field));
      }
    }
    if (!known->second) continue;
    volume::Coefficients unit = coefficientsOf(*density);
    if (look) look->apply(unit);
    scene.voxelMedia[medium.index] = std::make_unique<const volume::VoxelMedium>(
        volume::VoxelMedium{known->second, unit, *toIndex, instance.objectToWorld});
    medium.voxels = scene.voxelMedia[medium.index].get();
  }
}

}  // namespace aerosol::render
