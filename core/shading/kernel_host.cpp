#include "core/shading/kernel_host.h"

#include <algorithm>
#include <array>

#include "core/base/hash.h"
#include "core/shading/shading_system.h"

namespace aerosol::shading {

namespace {

void writeMatrix(const Matrix4& matrix, float* rows) {
  for (std::size_t i = 0; i < 16; ++i) rows[i] = static_cast<float>(matrix[i / 4][i % 4]);
}

}  // namespace

void NamedSpaces::add(const std::string& name, const Matrix4& toWorld, const Matrix4& fromWorld) {
  Space space;
  writeMatrix(toWorld, space.toWorld.data());
  writeMatrix(fromWorld, space.fromWorld.data());
  spaces_.insert_or_assign(hashString(name), std::move(space));
}

void NamedSpaces::addCamera(const MovingTransform<World, Camera>& toWorld, const CameraProjection& camera) {
  const auto addProjection = [&](const std::string& name, const Matrix4& fromCamera) {
    Space space;
    space.motion.emplace(toWorld);
    space.fromCamera = fromCamera;
    if (invert(fromCamera, space.toCamera)) spaces_.insert_or_assign(hashString(name), std::move(space));
  };
  Matrix4 pixels = identityMatrix();
  pixels[0][0] = camera.width;
  pixels[1][1] = camera.height;
  const Matrix4 ndc = multiply(camera.screenToNdc, camera.toScreen);
  addProjection("camera", identityMatrix());
  addProjection("screen", camera.toScreen);
  addProjection("NDC", ndc);
  addProjection("raster", multiply(pixels, ndc));
}

void NamedSpaces::addCamera(const Matrix4& worldToCamera, const CameraProjection& camera) {
  const auto addProjection = [this](const std::string& name, const Matrix4& fromWorld) {
    Matrix4 toWorld = identityMatrix();
    if (invert(fromWorld, toWorld)) add(name, toWorld, fromWorld);
  };
  Matrix4 pixels = identityMatrix();
  pixels[0][0] = camera.width;
  pixels[1][1] = camera.height;
  const Matrix4 screen = multiply(camera.toScreen, worldToCamera);
  const Matrix4 ndc = multiply(camera.screenToNdc, screen);
  addProjection("screen", screen);
  addProjection("NDC", ndc);
  addProjection("raster", multiply(pixels, ndc));
}

const NamedSpaces::Space* NamedSpaces::find(std::uint64_t nameHash) const {
  const auto found = spaces_.find(nameHash);
  return found == spaces_.end() ? nullptr : &found->second;
}

const AerosolHostServices KernelHost::services_{sizeof(AerosolHostServices), &KernelHost::record,
                                                &KernelHost::spaceToWorld, &KernelHost::worldToSpace,
                                                &KernelHost::call};

KernelHost::KernelHost(const NamedSpaces& spaces, std::uint32_t loopBudget, Services* services)
    : context_{{&services_, {0, 0}, loopBudget}, this},
      spaces_(spaces),
      calls_(
          [this](std::uint32_t site, std::uint32_t point, std::string_view text) {
            AerosolRecordValue value;
            value.s = calls_.strings().add(text);
            records_.push_back({AEROSOL_REPORT_HOST, site, point, {value}});
          },
          services) {}

void KernelHost::call(AerosolKernelContext* context, const AerosolHostCall* call) { of(context).calls_.call(*call); }

void KernelHost::record(AerosolKernelContext* context, std::uint32_t kind, std::uint32_t site, std::uint32_t lane,
                        const AerosolRecordValue* arguments, std::uint32_t count) {
  of(context).records_.push_back({kind, site, lane, {arguments, arguments + count}});
}

void KernelHost::begin(const jit::KernelInterface& interface, const Family& family, std::size_t count) {
  instanceData_ = family.instanceData.empty() ? nullptr : family.instanceData.data();
  instanceStride_ = interface.instanceStride;
  calls_.begin(interface, &family.strings, count, family.program.get());
}

/// Kernels know the spaces of the language themselves, except by names that are only known when they run.
bool KernelHost::spaceMatrix(std::uint64_t name, std::uint32_t instance, float time, bool toWorld,
                             float* matrix) const {
  static constexpr std::array<float, 16> identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  static const std::uint64_t common = hashString("common"), world = hashString("world");
  static const std::uint64_t object = hashString("object"), shader = hashString("shader");
  std::ranges::copy(identity, matrix);
  if (name == common || name == world) return true;
  if ((name == object || name == shader) && instanceData_) {
    const auto* header =
        reinterpret_cast<const AerosolInstanceHeader*>(instanceData_ + instanceStride_ * std::size_t{instance});
    const bool isObject = name == object;
    const float* toIt = isObject ? header->worldToObject : header->worldToShader;
    const float* fromIt = isObject ? header->objectToWorld : header->shaderToWorld;
    std::copy_n(toWorld ? fromIt : toIt, 12, matrix);
    return true;
  }
  const NamedSpaces::Space* space = spaces_.find(name);
  if (!space) return false;
  if (space->motion) {
    const Transform<World, Camera> placed = space->motion->at(time);
    writeMatrix(
        toWorld ? multiply(placed.matrix(), space->toCamera) : multiply(space->fromCamera, placed.inverseMatrix()),
        matrix);
    return true;
  }
  std::ranges::copy(toWorld ? space->toWorld : space->fromWorld, matrix);
  return true;
}

std::int32_t KernelHost::spaceToWorld(AerosolKernelContext* context, std::uint64_t name, std::uint32_t instance,
                                      float time, float* matrix) {
  return of(context).spaceMatrix(name, instance, time, true, matrix);
}

std::int32_t KernelHost::worldToSpace(AerosolKernelContext* context, std::uint64_t name, std::uint32_t instance,
                                      float time, float* matrix) {
  return of(context).spaceMatrix(name, instance, time, false, matrix);
}

}  // namespace aerosol::shading
