#include "core/shading/services.h"

namespace aerosol::shading {

TextureSession* ServicesOfThread::textures(std::string& problem) {
  if (!triedTextures_) {
    triedTextures_ = true;
    textureProblem_ = noServices;
    TextureSource* source = services_ ? services_->textures(textureProblem_) : nullptr;
    if (source) textures_ = source->openSession();
  }
  if (!textures_) problem = textureProblem_;
  return textures_.get();
}

bool ServicesOfThread::writePoint(std::string_view name, std::vector<PointAttribute> point, std::string& problem) {
  if (services_) return services_->writePoint(name, std::move(point), problem);
  problem = noServices;
  return false;
}

const ColorTransform* ServicesOfThread::colors(std::string_view from, std::string_view to, std::string& problem) {
  problem = noServices;
  ColorSource* const source = services_ ? services_->colors(problem) : nullptr;
  return source ? source->between(from, to, problem) : nullptr;
}

}  // namespace aerosol::shading
