#include "core/render/coefficient_layout.h"

#include <algorithm>

namespace aerosol::render {

std::size_t coefficientOffset(const jit::OutputComponent& output) {
  using volume::Coefficients;
  using volume::Lobe;
  const std::size_t lobe = offsetof(Coefficients, lobes) + output.index * sizeof(Lobe);
  std::size_t bytes = 0;
  switch (output.kind) {
    case lang::OutputKind::sigmaT:
      bytes = offsetof(Coefficients, sigmaT);
      break;
    case lang::OutputKind::sigmaS:
      bytes = offsetof(Coefficients, sigmaS);
      break;
    case lang::OutputKind::emission:
      bytes = offsetof(Coefficients, emission);
      break;
    case lang::OutputKind::lobeSigmaS:
      bytes = lobe + offsetof(Lobe, sigmaS);
      break;
    default:
      bytes = lobe + offsetof(Lobe, anisotropy);
      break;
  }
  return bytes / sizeof(float) + output.component;
}

volume::Coefficients readCoefficients(const shading::Batch& batch, std::size_t lane) {
  volume::Coefficients c;
  auto* const floats = reinterpret_cast<float*>(&c);
  const auto& outputs = batch.interface().outputs;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    floats[coefficientOffset(outputs[k])] = batch.output(k)[lane];
    if (outputs[k].kind == lang::OutputKind::lobeAnisotropy) c.lobeCount = std::max(c.lobeCount, outputs[k].index + 1);
  }
  if (c.lobeCount == 1) c.lobes[0].sigmaS = c.sigmaS;
  return c;
}

}  // namespace aerosol::render
