#include "core/shading/group_library.h"

#include <utility>

#include "core/lang/array_lengths.h"

namespace aerosol::shading {

Result<BoundGroup> GroupLibrary::bind(const lang::Group& group, Diagnostics& warnings,
                                      const lang::GroupOptions& options) {
  auto resolved = lang::resolve(group, options);
  if (!resolved) return resolved.errors();
  warnings.append(resolved->warnings);
  Known& known = known_[resolved->key];
  if (!known.program) {
    auto merged = lang::merge(*resolved);
    if (!merged) return merged.errors();
    known.program = std::move(*merged);
    for (const auto& layer : resolved->layers) known.layers.push_back(layer.program);
  }
  BoundGroup bound{known.program, {}};
  for (auto& [parameter, value] : resolved->values) bound.values.push_back({parameter, std::move(value)});
  return bound;
}

Result<lang::Group> loadGroup(const lang::GroupText& text, const std::string& name, ShaderLibrary& library,
                              Diagnostics& warnings) {
  Diagnostics errors;
  lang::Group group;
  group.name = name;
  group.connections = text.connections;
  for (const lang::GroupText::Layer& layer : text.layers) {
    auto program = library.findLayer(layer.shader, layer.shaderLocation, warnings);
    if (!program) {
      errors.append(program.errors());
      continue;
    }
    group.layers.push_back({layer.name, std::move(*program), layer.values, layer.location});
  }
  if (errors.hasErrors()) return errors;
  errors = lang::fitArrays(group, [&](std::size_t layer, const lang::ArrayLengths& lengths) {
    return library.findLayer(text.layers[layer].shader, text.layers[layer].shaderLocation, warnings, lengths);
  });
  if (errors.hasErrors()) return errors;
  return group;
}

}  // namespace aerosol::shading
