#include "core/render/picture_aspect.h"

namespace aerosol::render {

std::optional<float> pictureAspect(const scene::SceneDescription& description, const scene::Emitter& emitter,
                                   shading::Services& services) {
  if (!emitter.texture) return {};
  const auto& inputs = description.materials[*emitter.texture].inputs;
  if (inputs.empty()) return {};
  const scene::ShaderUse& picture = description.layers[inputs.front().layer];
  const scene::ShaderParameter* parameter = picture.find("filename");
  const auto* file = parameter ? std::get_if<std::string>(&parameter->value) : nullptr;
  if (picture.name != "bitmap" || !file) return {};
  std::string problem;
  TextureSource* const textures = services.textures(problem);
  if (!textures) return {};
  const auto size = textures->openSession()->info(*file, nullptr, "resolution", {.arrayLength = 2});
  if (!size || size->integers.size() != 2 || size->integers[0] < 1 || size->integers[1] < 1) return {};
  return static_cast<float>(size->integers[0]) / static_cast<float>(size->integers[1]);
}

}  // namespace aerosol::render
