// `<bsdf>`, `<medium>` and `<texture>`: shaders by name with whatever parameters they are given.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/scene/description.h"
#include "core/scene/field.h"
#include "core/scene/id_table.h"
#include "core/scene/reporter.h"

namespace aerosol::scene {

/// Turns shader elements into entries of the description, each once however often it is referred to.
class ShaderBuilder {
 public:
  ShaderBuilder(SceneDescription& scene, IdTable& ids, Reporter& reporter)
      : scene_(scene), ids_(ids), reporter_(reporter) {}

  Index material(const Element& element);
  Index medium(const Element& element);
  Index displacement(const Element& element);
  /// The texture of a light as a material that emits it.
  std::optional<Index> lightTexture(const Child& texture);
  /// What a shape without bsdf is made of, as Mitsuba has it: grey diffuse, or black diffuse when it emits.
  Index defaultMaterial(const SourceLocation& shape, bool emits);

 private:
  ShaderUse shaderOf(const Element& element, const std::vector<const Property*>& properties);
  /// A shader whose element also has the fields of `object`.
  template <class T>
  ShaderUse shaderWith(const Element& element, const std::vector<Field<T>>& fields, T& object);
  void addLayers(const Element& element, const std::vector<Child>& children, ShaderUse& shader);
  void addInputs(const std::vector<Child>& children, ShaderUse& shader);
  std::optional<Index> layer(const Child& child);
  void addPhase(const std::vector<Child>& children, Medium& medium);
  std::optional<Phase> readPhase(const Element& element);
  void feedWeight(const Child& weight, ShaderUse& shader);
  bool takeWeight(const Element& blend, std::vector<Child>& children, Phase& phase);

  SceneDescription& scene_;
  IdTable& ids_;
  Reporter& reporter_;
  std::map<const Element*, Index> materials_;
  std::map<const Element*, Index> media_;
  std::map<const Element*, Index> displacements_;
  std::map<const Element*, Index> layers_;
  std::vector<const Element*> open_;  ///< Layers around the one that is being built.
  std::optional<Child> phaseWeight_;  ///< What feeds the weight of the blendphase that is being read.
  std::optional<Index> grey_;
  std::optional<Index> black_;
};

}  // namespace aerosol::scene
