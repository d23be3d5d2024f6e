#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <unordered_map>

#include "core/lang/array_lengths.h"
#include "core/lang/effects.h"
#include "core/lang/fold.h"
#include "core/lang/group.h"
#include "core/lang/group_names.h"

namespace aerosol::lang {

namespace {

/// What is known of one shader, however many layers it has.
struct Shader {
  explicit Shader(const Program& program) : names(program), effects(findEffects(program)) {
    std::uint32_t count = 0;
    for (const Parameter& parameter : program.parameters) {
      numbers.push_back(count);
      count += parameter.type.closure ? 0 : 1;
    }
    parameterCount = count;
  }
  ParameterNames names;
  Effects effects;
  std::vector<std::uint32_t> numbers;  ///< By parameter: its number when closures do not count.
  std::uint32_t parameterCount = 0;
};

struct LayerState {
  Shader* shader = nullptr;
  std::map<std::uint32_t, ConstantValue> values;
  std::map<std::uint32_t, std::vector<MetadataValue>> hints;
  std::vector<Link> links;  ///< Into this layer.
  std::set<std::uint32_t> asked;
  bool isEntry = false;
  bool alwaysRuns = false;
  bool hasOutgoing = false;
};

/// The value as one of type `to`, with the conversions of assignments; float arrays and triples and matrices with
/// equally many numbers stand for one another.
std::optional<ConstantValue> converted(const GivenValue& given, const Type& to, bool exactly) {
  const std::size_t count = leafCount(given.type);
  if (given.type.closure || to.closure) return std::nullopt;
  if (sameKind(given.type, to)) return given.value;
  const auto base = [](const Type& type) { return type.isTriple() || type.base == BaseType::matrix; };
  const bool isFloats = given.type.base == BaseType::floating || given.type.element().isTriple() || base(given.type);
  const bool wantsFloats = to.base == BaseType::floating || to.element().isTriple() || base(to);
  if (isFloats && wantsFloats && count == leafCount(to) && !exactly) return given.value;
  if (exactly) return std::nullopt;
  if (!given.type.isArray() && !to.isArray()) {
    if (to.base == BaseType::integer) return std::nullopt;
    if (auto constant = convertConstant({given.type, given.value}, to)) return std::move(constant->value);
  }
  const auto* ints = std::get_if<std::vector<std::int32_t>>(&given.value);
  if (ints && wantsFloats && count == leafCount(to)) return std::vector<float>(ints->begin(), ints->end());
  return std::nullopt;
}

class Resolver {
 public:
  Resolver(const Group& group, const GroupOptions& options) : group_(group), options_(options) {}

  Result<ResolvedGroup> run() {
    readLayers();
    if (errors_.hasErrors()) return errors_;
    for (std::size_t i = 0; i < group_.layers.size(); ++i) readValues(i);
    for (const Connection& connection : group_.connections) readConnection(connection);
    readEntries();
    for (const std::string& output : group_.outputs) readOutput(output);
    if (errors_.hasErrors()) return errors_;
    decideWhatRuns();
    mergeInstances();
    finish();
    result_.userDataIsConnected = options_.userDataIsConnected;
    return std::move(result_);
  }

 private:
  void readLayers() {
    SourceLocation place;
    if (!group_.layers.empty()) place = group_.layers.front().location;
    if (group_.layers.empty()) {
      errors_.error(place, "a shader group needs at least one layer");
    } else if (group_.layers.size() > maximumLayers) {
      errors_.error(group_.layers[maximumLayers].location,
                    fmt::format("a shader group has at most {} layers", maximumLayers));
    }
    if (errors_.hasErrors()) return;
    layers_.resize(group_.layers.size());
    for (std::uint32_t i = 0; i < layers_.size(); ++i) {
      const GroupLayer& layer = group_.layers[i];
      if (!byName_.emplace(layer.name, i).second) {
        errors_.error(layer.location, fmt::format("there is a layer '{}' already", layer.name));
      }
      auto& shader = shaders_[layer.program.get()];
      if (!shader) shader = std::make_unique<Shader>(*layer.program);
      layers_[i].shader = shader.get();
    }
  }

  const Parameter& parameter(std::size_t layer, std::uint32_t index) const {
    return group_.layers[layer].program->parameters[index];
  }

  void readValues(std::size_t at) {
    for (const GivenValue& given : group_.layers[at].values) {
      const auto index = layers_[at].shader->names.findLeaf(given.parameter);
      if (!index) {
        if (options_.exactTypes) {
          result_.warnings.warning(given.location,
                                   fmt::format("attempting to set nonexistent parameter: {}", given.parameter));
        } else {
          errors_.error(given.location,
                        fmt::format("shader '{}' has no parameter '{}'", shaderName(at), given.parameter),
                        alternatives(at, given.parameter, false));
        }
        continue;
      }
      const Type& type = parameter(at, *index).type;
      auto value = converted(given, type, options_.exactTypes);
      if (value) {
        layers_[at].values[*index] = std::move(*value);
        if (!given.hints.empty()) layers_[at].hints[*index] = given.hints;
      } else if (options_.exactTypes) {
        result_.warnings.warning(
            given.location,
            fmt::format("attempting to set parameter with wrong type: {} (expected '{}', received '{}')",
                        given.parameter, declaredType(parameter(at, *index)), toString(given.type)));
      } else {
        errors_.error(given.location,
                      fmt::format("parameter '{}' of shader '{}' is a {}; a {} does not fit", given.parameter,
                                  shaderName(at), toString(type), toString(given.type)));
      }
    }
  }

  /// Of arrays without a length, without the one that they were given.
  static std::string declaredType(const Parameter& parameter) {
    Type type = parameter.type;
    if (isUnsized(parameter)) type.arrayLength = Type::unsized;
    return toString(type);
  }

  const std::string& shaderName(std::size_t layer) const { return group_.layers[layer].program->name; }

  std::vector<std::string> alternatives(std::size_t at, const std::string& name, bool outputsOnly) const {
    const ParameterNames& names = layers_[at].shader->names;
    std::vector<std::string> notes;
    if (const std::string hint = didYouMean(name, names.names(outputsOnly)); !hint.empty()) notes.push_back(hint);
    const std::string list = names.list(outputsOnly);
    const char* what = outputsOnly ? "outputs" : "parameters";
    notes.push_back(list.empty() ? fmt::format("it has no {}", what) : fmt::format("its {}: {}", what, list));
    return notes;
  }

  std::optional<std::uint32_t> findLayer(const std::string& name, const SourceLocation& location) {
    const auto found = byName_.find(name);
    if (found != byName_.end()) return found->second;
    std::vector<std::string> known;
    for (const GroupLayer& layer : group_.layers) known.push_back(layer.name);
    std::vector<std::string> notes;
    if (const std::string hint = didYouMean(name, known); !hint.empty()) notes.push_back(hint);
    std::string list;
    for (std::size_t i = 0; i < known.size() && i < 40; ++i) list += (i > 0 ? ", " : "") + known[i];
    notes.push_back("layers: " + list + (known.size() > 40 ? ", ..." : ""));
    errors_.error(location, fmt::format("there is no layer '{}' in this group", name), std::move(notes));
    return std::nullopt;
  }

  std::optional<NamedPart> findSource(std::uint32_t layer, const std::string& name) const {
    const Program& program = *group_.layers[layer].program;
    auto part = layers_[layer].shader->names.find(name);
    if (part || name != "Ci" || program.ci == noVariable || (!program.isSurface() && !program.isVolume())) return part;
    return NamedPart{{ciParameter}, {""}};
  }

  bool isOutput(std::uint32_t layer, std::uint32_t index) const {
    return index == ciParameter || parameter(layer, index).isOutput;
  }
  Type typeOf(std::uint32_t layer, const NamedPart& part, std::size_t i) const {
    if (part.parameters[i] == ciParameter) return types::closure;
    return partType(parameter(layer, part.parameters[i]).type, part.element, part.component);
  }

  void readConnection(const Connection& connection) {
    const auto from = findLayer(connection.sourceLayer, connection.sourceLocation);
    const auto to = findLayer(connection.layer, connection.location);
    if (!from || !to) return;
    if (*from >= *to) {
      errors_.error(connection.sourceLocation,
                    fmt::format("layer '{}' does not come before layer '{}'", connection.sourceLayer, connection.layer),
                    {"connections lead from earlier layers to later ones"});
      return;
    }
    const auto source = findSource(*from, connection.source);
    const auto target = layers_[*to].shader->names.find(connection.parameter);
    if (!source || !isOutput(*from, source->parameters[0])) {
      const std::string name = connection.sourceLayer + "." + connection.source;
      errors_.error(connection.sourceLocation,
                    source ? fmt::format("'{}' (shader '{}') is not an output", name, shaderName(*from))
                           : fmt::format("layer '{}' (shader '{}') has no output '{}'", connection.sourceLayer,
                                         shaderName(*from), connection.source),
                    alternatives(*from, connection.source, true));
    }
    if (!target) {
      errors_.error(connection.location,
                    fmt::format("layer '{}' (shader '{}') has no parameter '{}'", connection.layer, shaderName(*to),
                                connection.parameter),
                    alternatives(*to, connection.parameter, false));
    }
    if (source && target) link(connection, *from, *source, *to, *target);
  }

  /// Structures connect when they have the same fields; these are connected one by one.
  void link(const Connection& connection, std::uint32_t from, const NamedPart& source, std::uint32_t to,
            const NamedPart& target) {
    bool fits = source.fields == target.fields;
    for (std::size_t i = 0; fits && i < source.parameters.size(); ++i)
      fits = connects(typeOf(from, source, i), typeOf(to, target, i));
    if (!fits) {
      const auto describe = [&](std::uint32_t layer, const NamedPart& part) {
        if (part.fields != std::vector<std::string>{""}) return std::string("a structure");
        return "a " + toString(typeOf(layer, part, 0));
      };
      errors_.error(
          connection.location,
          fmt::format("'{}.{}' is {}: {} ('{}.{}') cannot be connected to it", connection.layer, connection.parameter,
                      describe(to, target), describe(from, source), connection.sourceLayer, connection.source));
      return;
    }
    layers_[from].hasOutgoing = true;
    for (std::size_t i = 0; i < source.parameters.size(); ++i) {
      const Link one{from,
                     {source.parameters[i], source.element, source.component},
                     to,
                     {target.parameters[i], target.element, target.component},
                     connection.location};
      addLink(one, connection);
    }
  }

  /// A later connection takes the place of earlier ones to the same part, or to parts of it.
  void addLink(const Link& added, const Connection& connection) {
    std::vector<Link>& links = layers_[added.layer].links;
    const auto isHidden = [&](const Link& old) {
      const Part &a = added.target, &b = old.target;
      return a.parameter == b.parameter &&
             (a.isWhole() || (a.element == b.element && (a.component < 0 || a.component == b.component)));
    };
    if (std::erase_if(links, isHidden) > 0) {
      result_.warnings.warning(connection.location, fmt::format("'{}.{}' was connected before; this connection counts",
                                                                connection.layer, connection.parameter));
    }
    links.push_back(added);
  }

  void readEntries() {
    for (const std::string& name : group_.entryLayers)
      if (const auto layer = findLayer(name, group_.layers.front().location)) layers_[*layer].isEntry = true;
    if (group_.entryLayers.empty()) layers_.back().isEntry = true;
  }

  void readOutput(const std::string& name) {
    // Names of layers may have dots in them.
    for (std::size_t dot = name.find('.'); dot != std::string::npos; dot = name.find('.', dot + 1)) {
      const auto layer = byName_.find(name.substr(0, dot));
      if (layer != byName_.end() && ask(layer->second, name.substr(dot + 1))) return;
    }
    for (std::size_t i = layers_.size(); i-- > 0;)
      if (ask(static_cast<std::uint32_t>(i), name)) return;
    std::vector<std::string> known;
    for (std::size_t i = 0; i < layers_.size() && known.size() < 40; ++i)
      for (const std::string& output : layers_[i].shader->names.names(true))
        known.push_back(group_.layers[i].name + "." + output);
    std::vector<std::string> notes;
    if (const std::string hint = didYouMean(name, known); !hint.empty()) notes.push_back(hint);
    std::string list;
    for (const std::string& each : known) list += (list.empty() ? "" : ", ") + each;
    notes.push_back("outputs: " + list);
    errors_.error(group_.layers.front().location, fmt::format("no layer of this group has an output '{}'", name),
                  std::move(notes));
  }

  bool ask(std::uint32_t layer, const std::string& name) {
    const auto part = layers_[layer].shader->names.find(name);
    if (!part || part->element >= 0 || part->component >= 0) return false;
    for (const std::uint32_t index : part->parameters)
      if (!parameter(layer, index).type.closure) layers_[layer].asked.insert(index);
    return true;
  }

  void decideWhatRuns() {
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      LayerState& layer = layers_[i];
      layer.alwaysRuns = layer.isEntry || !layer.asked.empty() || !options_.lazyLayers ||
                         (!options_.lazyGlobals && layer.shader->effects.writesGlobals()) ||
                         (!options_.lazyUnconnected && !layer.hasOutgoing);
      if (!layer.isEntry) continue;
      const Program& program = *group_.layers[i].program;
      for (std::uint32_t p = 0; p < program.parameters.size(); ++p)
        if (program.parameters[p].isOutput && !program.parameters[p].type.closure) layer.asked.insert(p);
    }
  }

  /// Everything that decides what a layer computes, layers that it is connected to being known by their first equal.
  std::string signature(std::size_t at) const {
    const LayerState& layer = layers_[at];
    std::string text(reinterpret_cast<const char*>(&layer.shader), sizeof layer.shader);
    const auto number = [&](std::int64_t value) { text += std::to_string(value) + " "; };
    for (const auto& [index, value] : layer.values) {
      number(index);
      text += bitsKey({parameter(at, index).type, value}) + ";";
    }
    for (const auto& [index, hints] : layer.hints) text += hintsKey(index, hints);
    for (const Link& link : layer.links) {
      number(-1);
      number(same_[link.sourceLayer]);
      for (const Part& part : {link.source, link.target}) {
        number(part.parameter);
        number(part.element);
        number(part.component);
      }
    }
    return text;
  }

  static std::string hintsKey(std::uint32_t index, const std::vector<MetadataValue>& hints) {
    std::string text = fmt::format("h{} ", index);
    for (const MetadataValue& hint : hints) text += hint.name + "=" + bitsKey({hint.type, hint.value}) + ";";
    return text;
  }

  void mergeInstances() {
    std::array<bool, globalCount> written{};
    for (const LayerState& layer : layers_)
      for (std::size_t g = 0; g < written.size(); ++g) written[g] = written[g] || layer.shader->effects.writes[g];
    std::unordered_map<std::string, std::uint32_t> known;
    for (std::uint32_t i = 0; i < layers_.size(); ++i) {
      const LayerState& layer = layers_[i];
      same_.push_back(i);
      bool dependsOnOrder = layer.shader->effects.any();
      for (std::size_t g = 0; g < written.size(); ++g)
        dependsOnOrder = dependsOnOrder || (written[g] && layer.shader->effects.reads[g]);
      if (options_.mergeInstances && !layer.alwaysRuns && !dependsOnOrder)
        same_[i] = known.emplace(signature(i), i).first->second;
    }
  }

  void finish() {
    result_.name = group_.name;
    std::vector<std::uint32_t> newIndex(layers_.size(), 0);
    std::uint32_t parameters = 0;
    const auto add = [&](const auto& value) { result_.key += fmt::format("{} ", value); };
    for (std::uint32_t i = 0; i < layers_.size(); ++i) {
      newIndex[i] = static_cast<std::uint32_t>(result_.layers.size());
      if (same_[i] != i) continue;
      LayerState& state = layers_[i];
      ResolvedGroup::Layer layer;
      layer.name = group_.layers[i].name;
      layer.program = group_.layers[i].program;
      layer.firstParameter = parameters;
      layer.isEntry = state.isEntry;
      layer.alwaysRuns = state.alwaysRuns;
      layer.asked.assign(state.asked.begin(), state.asked.end());
      for (auto& [index, value] : state.values)
        result_.values[parameters + state.shader->numbers[index]] = std::move(value);
      parameters += state.shader->parameterCount;
      add(layer.name);
      add(static_cast<const void*>(layer.program.get()));
      add(layer.isEntry ? 'e' : layer.alwaysRuns ? 'a' : 'l');
      for (const std::uint32_t asked : layer.asked) add(asked);
      for (const auto& [index, hints] : state.hints) result_.key += hintsKey(index, hints);
      layer.hints = std::move(state.hints);
      for (Link link : state.links) {
        link.sourceLayer = newIndex[same_[link.sourceLayer]];
        link.layer = newIndex[i];
        add('c');
        add(link.sourceLayer);
        for (const Part& part : {link.source, link.target})
          result_.key += fmt::format("{} {} {} ", part.parameter, part.element, part.component);
        result_.links.push_back(std::move(link));
      }
      result_.key += "\n";
      result_.layers.push_back(std::move(layer));
    }
    result_.key += group_.name;
  }

  const Group& group_;
  const GroupOptions& options_;
  Diagnostics errors_;
  ResolvedGroup result_;
  std::unordered_map<const Program*, std::unique_ptr<Shader>> shaders_;
  std::unordered_map<std::string, std::uint32_t> byName_;
  std::vector<LayerState> layers_;
  std::vector<std::uint32_t> same_;  ///< By layer: the first one that is like it.
};

}  // namespace

Result<ResolvedGroup> resolve(const Group& group, const GroupOptions& options) {
  return Resolver(group, options).run();
}

}  // namespace aerosol::lang
