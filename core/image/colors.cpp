#include "core/image/colors.h"

#include "core/image/module_access.h"

namespace aerosol::image {

Result<std::unique_ptr<ColorSource>> openColors(const ColorSettings& settings) {
  if (!table()) return table().errors();
  std::string message;
  auto source = (*table())->colors(settings, message);
  if (!source) return Diagnostic{Severity::error, {}, message, {}, {}};
  return source;
}

}  // namespace aerosol::image
