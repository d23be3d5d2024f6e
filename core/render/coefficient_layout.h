// From the outputs of a volume kernel to coefficients.
#pragma once

#include <cstddef>

#include "core/shading/batch.h"
#include "core/volume/coefficients.h"

namespace aerosol::render {

/// Where a kernel's output component goes within volume::Coefficients, as a float index.
std::size_t coefficientOffset(const jit::OutputComponent& output);

/// The coefficients of one point of a batch that ran the variant Variant::coefficients, as the kernel gave them.
volume::Coefficients readCoefficients(const shading::Batch& batch, std::size_t lane);

}  // namespace aerosol::render
