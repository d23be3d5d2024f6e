#include "core/image/textures.h"

#include "core/image/module_access.h"

namespace aerosol::image {

Result<std::unique_ptr<TextureSource>> openTextures(const TextureSettings& settings) {
  if (!table()) return table().errors();
  std::string message;
  auto source = (*table())->textures(settings, message);
  if (!source) return Diagnostic{Severity::error, {}, message, {}, {}};
  return source;
}

}  // namespace aerosol::image
