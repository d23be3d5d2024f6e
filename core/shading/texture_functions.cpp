#include "core/shading/texture_functions.h"

#include <array>
#include <vector>

#include "core/shading/texture_call.h"
#include "core/shading/voxel_functions.h"

namespace aerosol::shading {

namespace {

constexpr std::size_t lanes = AEROSOL_MAXIMUM_WIDTH;

/// Active lanes that name the same file are looked up together.
template <class LookUp>
void forEachFile(PointCall& call, LookUp&& lookUp) {
  std::array<unsigned, lanes> pending{};
  std::size_t count = 0;
  call.forEachLane([&](unsigned lane) { pending[count++] = lane; });
  while (count > 0) {
    std::array<unsigned, lanes> group{};
    std::size_t size = 0, left = 0;
    const std::uint64_t file = call.hash(0, pending[0]);
    for (std::size_t i = 0; i < count; ++i) {
      if (call.hash(0, pending[i]) == file) {
        group[size++] = pending[i];
      } else {
        pending[left++] = pending[i];
      }
    }
    count = left;
    lookUp(call.text(0, group[0]), std::span(group.data(), size));
  }
}

void lookUpImage(TextureCall& call, ServicesOfThread& services, TextureKind kind, std::string_view file,
                 std::span<const unsigned> group) {
  std::array<TexturePoint, lanes> points;
  for (std::size_t i = 0; i < group.size(); ++i) points[i] = call.read(group[i]);
  std::array<float, lanes * maximumTextureChannels> results{};
  const auto channels = static_cast<std::size_t>(call.channels());
  std::string problem;
  if (TextureSession* session = services.textures(problem)) {
    std::vector<TextureFailure> failures;
    session->lookup(kind, file, {points.data(), group.size()}, call.channels(), results.data(), failures);
    for (const TextureFailure& failure : failures) call.fail(group[failure.point], failure.message);
  } else {
    for (const unsigned lane : group) call.fail(lane, problem);
  }
  for (std::size_t i = 0; i < group.size(); ++i) call.write(group[i], results.data() + i * channels);
}

void lookUpAll(PointCall& raw, std::string_view name, TextureKind kind) {
  TextureCall call(raw, *lang::findTextureFunction(name));
  call.clearMessages();
  ServicesOfThread& services = raw.host().services();
  forEachFile(raw, [&](std::string_view file, std::span<const unsigned> group) {
    if (kind == TextureKind::volume && services.isVoxelFile(file)) {
      lookUpVoxels(call, services, file, group);
    } else {
      lookUpImage(call, services, kind, file, group);
    }
  });
}

}  // namespace

void texture(PointCall& call) { lookUpAll(call, "texture", TextureKind::plane); }
void texture3d(PointCall& call) { lookUpAll(call, "texture3d", TextureKind::volume); }
void environment(PointCall& call) { lookUpAll(call, "environment", TextureKind::environment); }

/// (file [, s, t], name, destination) → whether the destination was set.
void getTextureInfo(PointCall& call) {
  const bool hasPlace = call.argumentCount() == 5;
  const std::size_t name = hasPlace ? 3 : 1, destination = name + 1;
  const lang::Type& type = call.type(destination);
  TextureInfoType wanted;
  wanted.base = type.base == lang::BaseType::integer  ? TextureInfoType::Base::integer
                : type.base == lang::BaseType::string ? TextureInfoType::Base::string
                                                      : TextureInfoType::Base::floating;
  wanted.isTriple = type.isTriple() || type.element().isTriple();
  wanted.isMatrix = type.element().base == lang::BaseType::matrix;
  wanted.arrayLength = type.isArray() ? type.arrayLength : 0;
  ServicesOfThread& services = call.host().services();
  call.forEachLane([&](unsigned lane) {
    const std::string_view file = call.text(0, lane);
    std::optional<TextureInfo> info;
    std::string problem;
    if (services.isVoxelFile(file)) {
      info = voxelInfo(services, file, call.text(name, lane), wanted);
    } else if (TextureSession* session = services.textures(problem)) {
      const float st[2] = {hasPlace ? call.floating(1, lane) : 0, hasPlace ? call.floating(2, lane) : 0};
      info = session->info(file, hasPlace ? st : nullptr, call.text(name, lane), wanted);
    } else {
      call.report(lane, problem);
    }
    call.set(PointCall::result, lane, info ? 1 : 0);
    if (!info) return;
    for (std::size_t i = 0; i < info->integers.size(); ++i) call.set(destination, lane, info->integers[i], i);
    for (std::size_t i = 0; i < info->floats.size(); ++i) call.set(destination, lane, info->floats[i], i);
    for (std::size_t i = 0; i < info->strings.size(); ++i)
      call.set(destination, lane, std::string_view(info->strings[i]), i);
  });
}

}  // namespace aerosol::shading
