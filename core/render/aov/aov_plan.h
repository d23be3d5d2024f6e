// What the AOVs that were asked for take: decided when a scene is prepared.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/motion.h"
#include "core/base/result.h"
#include "core/render/aov/aov_layout.h"
#include "core/render/aov/aov_table.h"
#include "core/render/aov/light_path_automaton.h"
#include "core/scene/description.h"
#include "core/volume/medium.h"

namespace aerosol::render {

/// Const; every path reads it.
struct AovPlan {
  struct FeatureSlot {
    AovFeature feature{};
    std::uint32_t slot = 0;  ///< Its first value; of those that have a weight, that comes last.
  };
  struct SquareSlots {
    std::uint32_t from = 0, to = 0, count = 0;
  };

  AovLayout layout;
  LightPathAutomaton automaton;
  bool followsPaths = false;                   ///< There are expressions.
  std::vector<std::uint32_t> expressionSlots;  ///< By expression: red, then green and blue.
  std::size_t labelCount = 1;
  std::vector<std::string> labels;        ///< The first stands for none.
  std::vector<PathSymbol> lightSymbols;   ///< By light: how paths end at it.
  std::vector<PathSymbol> objectSymbols;  ///< By object, that emits by its shader.
  std::vector<FeatureSlot> firstHit, firstSeen, picture;
  std::vector<SquareSlots> squares;
  struct Matte {
    std::uint32_t slot = 0;
    std::vector<std::uint32_t> objects, media;  ///< Ids by object and by medium.
  };
  std::vector<Matte> mattes;
  struct OutputSlot {
    std::uint32_t site = 0, slot = 0;
  };
  std::vector<std::vector<OutputSlot>> outputs;        ///< By object: closure sites whose weights are shown.
  std::vector<std::vector<OutputSlot>> mediumOutputs;  ///< By medium: parameters of its shader that are shown.
  std::uint32_t matteWeightSlot = 0;
  std::vector<std::optional<MovingTransform<World, Object>>> objectMotions;  ///< By object, for motion vectors.

  PathSymbol symbol(PathEvent event, std::size_t label = 0) const { return symbolOf(event, label, labelCount); }
  bool wants(AovFeature feature) const;
  std::span<const OutputSlot> outputsOf(const volume::Medium& medium) const {
    return medium.index < mediumOutputs.size() ? std::span<const OutputSlot>(mediumOutputs[medium.index])
                                               : std::span<const OutputSlot>();
  }
};

/// Of the lights and objects of a scene, in the order of preparation, what the plan needs to know.
struct AovScene {
  struct Source {
    PathEvent end = PathEvent::light;
    std::string group;  ///< Empty: none.
  };
  std::vector<Source> lights, objects;
  /// What a thing is called, and what it is made of.
  struct Thing {
    std::string name, material;
  };
  struct Output {
    std::uint32_t object = 0, site = 0;
    std::string name;
  };
  std::vector<Output> outputs;                    ///< What shaders show by `debug`.
  std::vector<Output> mediumOutputs;              ///< By medium instead of object: its shader's output parameters.
  std::vector<std::string> closureLabels;         ///< That shaders give to closures; may come several times.
  std::vector<Thing> objectThings, mediumThings;  ///< By object, and by medium.
  bool tracesPaths = true;  ///< The integrator follows light paths, rather than showing distances.
};

/// Errors for what cannot be given, each at its request's place, or without one as the command line's.
Result<std::unique_ptr<AovPlan>> planAovs(std::span<const scene::AovRequest> requests, const AovScene& scene);

}  // namespace aerosol::render
