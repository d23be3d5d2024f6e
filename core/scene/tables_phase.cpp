#include <algorithm>

#include "core/scene/tables.h"
#include "core/scene/value.h"

namespace aerosol::scene {

namespace {

Field<Phase> anisotropyField(const char* doc) {
  return field<&Phase::g>(
      {.name = "g", .doc = doc, .range = {.minimum = -1, .maximum = 1, .openMinimum = true, .openMaximum = true}});
}

/// Numbers with commas or blanks between them.
Field<Phase> valuesField() {
  return {
      {.name = "values",
       .type = ValueType::string,
       .doc = "values at equal distances of the cosine, from -1 (backwards) to 1 (straight on); their scale is free",
       .required = true},
      [](Phase& phase, const Value& value) -> std::string {
        TextError error;
        const auto numbers = parseNumbers(std::get<std::string>(value), error);
        if (!numbers) return error.message;
        if (numbers->size() < 2) return "a table of one value has no ends: write two or more";
        if (std::any_of(numbers->begin(), numbers->end(), [](double v) { return v < 0; }))
          return "a phase function is nowhere negative";
        for (const double v : *numbers) phase.values.push_back(static_cast<float>(v));
        if (std::all_of(phase.values.begin(), phase.values.end(), [](float v) { return v == 0; }))
          return "a phase function that is zero everywhere scatters nowhere";
        return {};
      }};
}

}  // namespace

const std::vector<TypeTable<Phase>>& phaseTypes() {
  static const std::vector<TypeTable<Phase>> tables = {
      {.type = "hg",
       .doc = "Henyey-Greenstein scattering",
       .fields = {anisotropyField("mean cosine of the scattering angle; alone it becomes the shader's g")}},
      {.type = "isotropic", .doc = "equal scattering into all directions; alone it makes the shader's g 0"},
      {.type = "rayleigh", .doc = "scattering by particles much smaller than the wavelength: air, fine smoke"},
      {.type = "draine",
       .doc = "a Henyey-Greenstein lobe times 1 + alpha cos^2 (Draine 2003)",
       .fields = {anisotropyField("mean cosine of the lobe"),
                  field<&Phase::alpha>(
                      {.name = "alpha", .doc = "modulation", .range = {.minimum = 0, .maximum = 1000}})}},
      {.type = "mie",
       .doc = "water droplets of clouds, fog and haze, fitted to Mie's theory (Jendersie and d'Eon 2023)",
       .fields = {field<&Phase::particleDiameter_um>(
           {.name = "particle_diameter",
            .unit = "micrometres",
            .doc = "diameter of the droplets: haze 0.1 to 2, fog 2 to 20, clouds 5 to 50",
            .range = {.minimum = 0, .maximum = 50, .openMinimum = true}})}},
      {.type = "tabphase", .doc = "a table over the cosine", .fields = {valuesField()}},
      {.type = "blendphase",
       .doc = "a mean of two phase functions",
       .fields = {field<&Phase::weight>(
           {.name = "weight", .doc = "share of the second one", .range = {.minimum = 0, .maximum = 1}})},
       .nested = "two phases, those with names in the order of the names; a texture or volume named weight, which is "
                 "fed to the medium's g"}};
  return tables;
}

}  // namespace aerosol::scene
