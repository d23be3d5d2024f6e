// What a shader delivers of its closures.
#include <string>

#include "core/lang/closure_values.h"

namespace aerosol::lang {

namespace {

VariableId plus(CodeWriter& writer, VariableId sum, VariableId more) {
  return sum == noVariable ? more : writer.emit(Op::add, types::color, {sum, more});
}

void addVolumeOutputs(CodeWriter& writer, const SiteValues& result, const ReportAt& report) {
  Program& program = writer.program();
  VariableId sigmaT = noVariable, sigmaS = noVariable, emission = noVariable;
  std::vector<const SiteValue*> lobes;
  for (const auto& [site, value] : result) {
    if (isEmitting(program.closureSites[site].closure)) {
      emission = plus(writer, emission, value.linear[0]);
      continue;
    }
    sigmaT = plus(writer, sigmaT, value.linear[0]);
    if (!isScattering(program.closureSites[site].closure)) continue;
    sigmaS = plus(writer, sigmaS, value.linear[1]);
    lobes.push_back(&value);
    if (lobes.size() == maximumLobes + 1) {
      report(program.closureSites[site].location,
             "this volume adds more than " + std::to_string(maximumLobes) +
                 " scattering closures to Ci (each call in the source counts, with functions inlined)");
    }
  }
  const auto output = [&](OutputKind kind, std::uint32_t index, VariableId variable) {
    program.outputs.push_back({kind, index, 0, variable == noVariable ? writer.grey(0) : variable});
  };
  output(OutputKind::sigmaT, 0, sigmaT);
  output(OutputKind::sigmaS, 0, sigmaS);
  output(OutputKind::emission, 0, emission);
  for (std::uint32_t i = 0; i < lobes.size(); ++i) {
    output(OutputKind::lobeSigmaS, i, lobes[i]->linear[1]);
    output(OutputKind::lobeAnisotropy, i, lobes[i]->mean[0]);
  }
}

}  // namespace

bool isScattering(std::string_view closure) {
  return closure == "anisotropic_vdf" || closure == "medium_vdf" || closure == "isotropic" ||
         closure == "henyey_greenstein";
}

bool isEmitting(std::string_view closure) { return closure == "emission" || closure == "uniform_edf"; }

void addClosureOutputs(CodeWriter& writer, const SiteValues& result, const ReportAt& report) {
  Program& program = writer.program();
  if (program.isVolume()) return addVolumeOutputs(writer, result, report);
  for (const auto& [site, value] : result) {
    program.outputs.push_back({OutputKind::siteWeight, site, 0, value.linear[0]});
    for (std::size_t i = 0; i < value.mean.size(); ++i)
      program.outputs.push_back({OutputKind::siteParameter, site, static_cast<std::uint32_t>(i), value.mean[i]});
  }
}

}  // namespace aerosol::lang
