// `<spectrum>`: values by wavelength, or one of the named kinds.
#pragma once

#include <optional>

#include "core/scene/attributes.h"
#include "core/scene/spectrum.h"

namespace aerosol::scene {

/// A colour from `value="…"`, `filename="…"` (lines of wavelength and value) or `type="…"` with parameters inside.
/// Nothing after an error, which is reported. One number is that at all wavelengths: as light of its own it is a little
/// warmer than white.
std::optional<Value> readSpectrum(const XmlElement& xml, const Attributes& attributes, SpectrumUse use,
                                  const std::vector<std::filesystem::path>& searchPath, ReadContext context);

}  // namespace aerosol::scene
