#include "core/shading/services.h"

namespace aerosol::shading {

namespace {

constexpr const char* noServices = "there are no files here";

}  // namespace

TextureSession* ServicesOfThread::textures(std::string& problem) {
  if (!triedTextures_) {
    triedTextures_ = true;
    TextureSource* source = services_ ? services_->textures(textureProblem_) : nullptr;
    if (source) textures_ = source->openSession();
    if (!services_) textureProblem_ = noServices;
  }
  if (!textures_) problem = textureProblem_;
  return textures_.get();
}

const VoxelFile* ServicesOfThread::voxels(std::string_view name, std::string& problem) {
  auto known = voxels_.find(name);
  if (known == voxels_.end()) {
    OpenVoxels open;
    if (services_) {
      open.file = services_->voxels(name, open.problem);
    } else {
      open.problem = noServices;
    }
    known = voxels_.emplace(std::string(name), std::move(open)).first;
  }
  problem = known->second.problem;
  return known->second.file;
}

}  // namespace aerosol::shading
