#include "core/render/preparation/materials.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/lang/analysis.h"
#include "core/lang/reached_sites.h"
#include "core/render/scene_attributes.h"

namespace aerosol::render {

namespace {

/// Whether light goes straight through: where the material asks for the kind of ray, may be transparent, and does not
/// have the parameter `straight_shadows` set to 0.
bool letsShadowsPass(const Preparation& state, const PreparedObject& object) {
  const auto isTransparent = [](const Closure* c) { return c && c->kind() == ClosureKind::transparent; };
  if (std::none_of(object.closures.begin(), object.closures.end(), isTransparent)) return false;
  const shading::Family& family = state.scene->shading.family(object.material);
  const auto& sites = family.kernel(shading::Variant::surface).interface().hostSites;
  if (std::none_of(sites.begin(), sites.end(), [](const auto& s) { return s.function == "raytype"; })) return false;
  const auto parameter = shading::findParameter(*family.program, "straight_shadows");
  if (!parameter) return true;
  const lang::ConstantValue* const value =
      shading::valueOf(*family.program, family.instances[object.material.index], *parameter);
  const auto* numbers = value ? std::get_if<std::vector<std::int32_t>>(value) : nullptr;
  return !numbers || numbers->empty() || numbers->front() != 0;
}

/// Whether light that no path can meet shines through what paths pass straight.
bool letsPointsShine(const Preparation& state, const PreparedObject& object) {
  const auto isTransparent = [](const Closure* c) { return c && c->kind() == ClosureKind::transparent; };
  const auto isPoint = [](const scene::Emitter& emitter) {
    using scene::EmitterType;
    return emitter.type == EmitterType::point || emitter.type == EmitterType::spot ||
           emitter.type == EmitterType::directional || emitter.type == EmitterType::projector;
  };
  const scene::SceneDescription& description = state.description;
  return description.integrator.transparentShadows &&
         std::any_of(object.closures.begin(), object.closures.end(), isTransparent) &&
         std::any_of(description.emitters.begin(), description.emitters.end(), isPoint);
}

/// All parameters of an instance, those that its program computes without a value.
lang::ParameterValues valuesOf(const Preparation& state, shading::InstanceRef ref) {
  const lang::Program& program = *state.scene->shading.family(ref).program;
  lang::ParameterValues values;
  for (std::uint32_t i = 0; i < program.parameters.size(); ++i) {
    const lang::ConstantValue* value = shading::valueOf(program, state.scene->shading.instance(ref), i);
    values[i] = value ? *value : lang::ConstantValue{};
  }
  return values;
}

/// Whether a site's weight is always black with the instance's parameters.
bool isWeightless(const lang::Program& program, std::uint32_t site) {
  return std::any_of(program.outputs.begin(), program.outputs.end(), [&](const lang::Output& output) {
    if (output.kind != lang::OutputKind::siteWeight || output.index != site) return false;
    const lang::Variable& variable = program.variables[output.variable];
    const auto* floats = std::get_if<std::vector<float>>(&variable.value);
    return variable.storage == lang::Storage::constant && floats &&
           std::all_of(floats->begin(), floats->end(), [](float value) { return value == 0; });
  });
}

/// Options that a shader does not write are zero.
bool isZero(const lang::Program& program, std::uint32_t site, std::size_t parameter) {
  for (const lang::Output& output : program.outputs) {
    if (output.kind != lang::OutputKind::siteParameter || output.index != site || output.subIndex != parameter)
      continue;
    const lang::Variable& variable = program.variables[output.variable];
    if (variable.storage != lang::Storage::constant) return false;
    const auto isZeroNumber = [](auto value) { return value == 0; };
    if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&variable.value))
      return std::ranges::all_of(*ints, isZeroNumber);
    const auto* floats = std::get_if<std::vector<float>>(&variable.value);
    return floats && std::ranges::all_of(*floats, isZeroNumber);
  }
  return true;
}

/// Whether the site's weight and parameters are the same wherever the material is.
bool isConstant(const lang::Program& program, std::uint32_t site) {
  return std::ranges::all_of(program.outputs, [&](const lang::Output& output) {
    const bool isOfSite = output.kind == lang::OutputKind::siteWeight || output.kind == lang::OutputKind::siteParameter;
    return !isOfSite || output.index != site || program.variables[output.variable].storage == lang::Storage::constant;
  });
}

/// Whether the interior that a site describes takes part in priorities.
bool hasPriority(const lang::Program& program, std::uint32_t site) {
  const std::vector<std::string>& names = program.closureSites[site].parameterNames;
  const auto priority = std::ranges::find(names, "priority");
  return priority != names.end() && !isZero(program, site, static_cast<std::size_t>(priority - names.begin()));
}

/// Every parameter of the site has to mean something to the closure.
void checkSite(Preparation& state, const lang::Program& program, std::uint32_t index, const Closure* closure) {
  const lang::ClosureSite& site = program.closureSites[index];
  const SourceLocation& place = program.locations[site.location];
  if (!closure) {
    state.appendNew(Diagnostic{
        Severity::error, place, fmt::format("closure '{}' is not implemented for surfaces", site.closure), {}, {}});
    return;
  }
  const std::size_t size = static_cast<std::size_t>(componentCount(closure->fields())) + 3 * site.layers.size();
  if (size > SurfaceAnswer::maximumParameters) {
    state.appendNew(Diagnostic{
        Severity::error,
        place,
        fmt::format(
            "closure '{}' lies below {} others: {} is the most", site.closure, site.layers.size(),
            (SurfaceAnswer::maximumParameters - static_cast<std::size_t>(componentCount(closure->fields()))) / 3),
        {},
        {}});
    return;
  }
  for (std::size_t i = 0; i < site.parameterNames.size(); ++i) {
    const std::string& name = site.parameterNames[i];
    const auto fields = closure->fields();
    const bool isLayer = std::any_of(site.layers.begin(), site.layers.end(),
                                     [&](const lang::ClosureLayer& layer) { return layer.weight == i; });
    const bool isKnown =
        isLayer || name == "label" ||
        std::any_of(fields.begin(), fields.end(), [&](const DescribedField& f) { return f.name == name; });
    if (isKnown || isZero(program, index, i)) continue;
    state.appendNew(Diagnostic{
        Severity::error, place, fmt::format("'{}' of closure '{}' is not implemented", name, site.closure), {}, {}});
  }
}

/// A material that may return more closures than that at a point is a mistake.
constexpr std::size_t maximumSites = 256;

bool checkCount(Preparation& state, const lang::Program& program, const std::vector<bool>& reached) {
  const auto count = static_cast<std::size_t>(std::ranges::count(reached, true));
  if (count <= maximumSites) return true;
  std::size_t site = 0;
  for (std::size_t seen = 0; seen <= maximumSites; ++site) seen += reached[site] ? 1 : 0;
  state.appendNew(Diagnostic{
      Severity::error,
      program.locations[program.closureSites[site - 1].location],
      fmt::format("shader '{}' may return {} closures at a point: {} is the most", program.name, count, maximumSites),
      {},
      {"what lies below several layers counts once for each way to lie below them: layer a sum of closures once, "
       "instead of sums of layers; what has a constant weight of 0 does not count"}});
  return false;
}

/// A parameter of a site that is a text known before the render; null for any other.
const std::string* constantText(const lang::Program& program, std::uint32_t site, std::size_t parameter) {
  for (const lang::Output& output : program.outputs) {
    if (output.kind != lang::OutputKind::siteParameter || output.index != site || output.subIndex != parameter)
      continue;
    const lang::Variable& variable = program.variables[output.variable];
    const auto* text = std::get_if<std::vector<std::string>>(&variable.value);
    return variable.storage == lang::Storage::constant && text && text->size() == 1 ? &text->front() : nullptr;
  }
  return nullptr;
}

/// The label of a closure; one that is not known before the render is none.
void findLabel(const lang::Program& program, std::uint32_t site, PreparedObject& object) {
  const std::vector<std::string>& names = program.closureSites[site].parameterNames;
  const auto label = std::find(names.begin(), names.end(), "label");
  if (label == names.end()) return;
  const std::string* text = constantText(program, site, static_cast<std::size_t>(label - names.begin()));
  if (text && !text->empty()) object.labelNames.push_back({site, *text});
}

/// The name of an output, which has to be known before the render.
void findOutput(Preparation& state, const lang::Program& program, std::uint32_t site, PreparedObject& object) {
  if (const std::string* text = constantText(program, site, 0)) {
    object.outputs.push_back({site, *text});
    return;
  }
  state.appendNew(Diagnostic{Severity::error,
                             program.locations[program.closureSites[site].location],
                             "the name of an output has to be known before the render",
                             {},
                             {"write it as text, or as a parameter that nothing feeds"}});
}

}  // namespace

void bindMaterials(Preparation& state) {
  describeScene(state.description, state.scene->attributes);
  for (const scene::Shape& shape : state.description.shapes) {
    auto bound = bindShader(state.description.materials[shape.material], "surface", state.atOpening(shape.toWorld),
                            state.shaderSources(), state.scene->shading, state.warnings);
    state.scene->objects.emplace_back();
    if (bound) {
      state.scene->objects.back().material = *bound;
      if (const auto motion = state.motionOf(shape.toWorld))
        state.scene->shading.setMotion(*bound, MovingPlace(motion));
    } else {
      state.appendNew(bound.errors());
    }
  }
}

void findSiteClosures(Preparation& state) {
  for (const shading::Family& family : state.scene->shading.families()) {
    auto& closures = state.scene->siteClosures.emplace_back();
    for (const lang::ClosureSite& site : family.program->closureSites) {
      closures.push_back(state.registry.closure(site.closure));
    }
  }
}

void describeMaterial(Preparation& state, PreparedObject& object) {
  const lang::Program& program = *state.scene->shading.family(object.material).program;
  object.closures = state.scene->siteClosures[object.material.family];
  const lang::Program folded = lang::specialise(program, valuesOf(state, object.material));
  const std::vector<bool> reached = lang::reachedSites(folded);
  if (!checkCount(state, program, reached)) return;
  const bool isLayered = std::any_of(program.closureSites.begin(), program.closureSites.end(),
                                     [](const lang::ClosureSite& site) { return !site.layers.empty(); });
  for (std::size_t i = 0; i < program.closureSites.size(); ++i) {
    const lang::ClosureSite& site = program.closureSites[i];
    if (isLayered) object.layers.push_back(site.layers);
    const auto index = static_cast<std::uint32_t>(i);
    if (object.closures[i] && object.closures[i]->kind() == ClosureKind::output)
      findOutput(state, folded, index, object);
    findLabel(folded, index, object);
    if (!reached[i]) {
      object.closures[i] = nullptr;
      continue;
    }
    checkSite(state, folded, index, object.closures[i]);
    const bool isInterior = object.closures[i] && object.closures[i]->kind() == ClosureKind::interior;
    if (isInterior && !isWeightless(folded, index)) {
      object.saysInside = true;
      state.scene->nestsMedia = state.scene->nestsMedia || !isConstant(folded, index) || hasPriority(folded, index);
    }
    const bool isBody = object.closures[i] && object.closures[i]->kind() == ClosureKind::subsurface;
    if (isBody && !isWeightless(folded, index)) state.scene->hasSubsurface = true;
  }
  if (state.errors.hasErrors()) return;
  object.passesShadows = letsShadowsPass(state, object);
  object.passesPoints = !object.passesShadows && letsPointsShine(state, object);
  const std::optional<SurfaceAnswer> constant = constantClosures(*state.scene, object.material);
  if (!constant) return;
  Color passing;
  bool hasOther = false;
  for (std::uint32_t s = 0; s < constant->siteCount(); ++s) {
    if (!object.closures[s]) continue;
    if (object.closures[s]->kind() == ClosureKind::transparent) {
      passing += constant->sites[s].weight;
    } else {
      hasOther = hasOther || !isBlack(constant->sites[s].weight);
    }
  }
  object.isBoundary = !hasOther && passing == Color(1.0f);
  object.passesPoints = object.passesPoints && !object.isBoundary && !isBlack(passing);
}

}  // namespace aerosol::render
