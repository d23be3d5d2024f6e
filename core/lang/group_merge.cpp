#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "core/lang/effects.h"
#include "core/lang/fold.h"
#include "core/lang/group.h"
#include "core/lang/group_names.h"
#include "core/lang/group_placement.h"
#include "core/lang/lower.h"
#include "core/lang/uniformity.h"
#include "core/lang/user_data.h"

namespace aerosol::lang {

namespace {

constexpr std::size_t maximumGroupInstructions = 5 * maximumInstructions;
constexpr int maximumBlockDepth = 100;

/// What all layers of one shader share in the merged program.
struct Shader {
  std::vector<VariableId> variables;  ///< Of constants and globals; noVariable for the rest.
  std::vector<std::uint32_t> functions;
  std::uint32_t firstLocation = 0;
  std::vector<bool> written;    ///< By variable; what gives a parameter its default aside.
  std::uint32_t scopes = 0;     ///< Scope ids are below.
  std::uint32_t layerings = 0;  ///< Numbers of closureLayer are below.
  std::size_t instructions = 0;
  Effects effects;
};

class Merger {
 public:
  explicit Merger(const ResolvedGroup& group) : group_(group) {}

  Result<std::shared_ptr<const Program>> run() {
    const Program& last = *group_.layers.back().program;
    program_.kind = last.kind;
    program_.name = group_.name.empty() ? last.name : group_.name;
    program_.metadata = metadataOf(last);
    findNeeded();
    for (std::uint32_t i = 0; i < group_.layers.size(); ++i) addLayer(i);
    if (errors_.hasErrors()) return errors_;
    decideMovability();
    program_.ci = globals_[static_cast<std::size_t>(Global::Ci)];
    if (const auto output = writesCi_ ? std::nullopt : onlyClosureOutput(last)) program_.ci = values_.back()[*output];
    if (program_.kind == "displacement") addDisplaced();
    program_.body = LayerPlacement(program_, std::move(codes_), std::move(producers_)).run();
    const std::vector<SourceLocation> locations = program_.locations;
    Program whole = complete(std::move(program_), [&](std::uint32_t location, std::string message) {
      errors_.error(locations[location], std::move(message));
    });
    if (errors_.hasErrors()) return errors_;
    return std::make_shared<const Program>(slice(whole, whole.outputs, Messages::keep));
  }

 private:
  /// The shader's metadata. The parameter that `extinction_bound` names is called otherwise in the group, and says
  /// nothing about what is connected to it.
  std::vector<MetadataValue> metadataOf(const Program& last) const {
    std::vector<MetadataValue> metadata;
    for (MetadataValue entry : last.metadata) {
      auto* texts = std::get_if<std::vector<std::string>>(&entry.value);
      if (entry.name == "extinction_bound" && texts && !texts->empty()) {
        const auto parameter = ParameterNames(last).findLeaf(texts->front());
        const bool isLinked = std::any_of(group_.links.begin(), group_.links.end(), [&](const Link& link) {
          return link.layer + 1 == group_.layers.size() && parameter && link.target.parameter == *parameter;
        });
        if (isLinked) continue;
        texts->front() = group_.layers.back().name + "." + texts->front();
      }
      metadata.push_back(std::move(entry));
    }
    return metadata;
  }

  // What is needed

  void findNeeded() {
    needed_.assign(group_.layers.size(), false);
    outgoing_.resize(group_.layers.size());
    std::size_t link = group_.links.size();
    for (std::size_t i = group_.layers.size(); i-- > 0;) {
      needed_[i] = needed_[i] || group_.layers[i].alwaysRuns;
      for (; link > 0 && group_.links[link - 1].layer == i; --link) {
        const Link& one = group_.links[link - 1];
        if (needed_[i]) needed_[one.sourceLayer] = true;
        outgoing_[one.sourceLayer].insert(one.source.parameter);
        if (one.source.parameter == ciParameter) ownCi_[one.sourceLayer] = noVariable;
      }
    }
  }

  Shader& shaderOf(const Program& program) {
    auto& known = shaders_[&program];
    if (known) return *known;
    known = std::make_unique<Shader>();
    Shader& shader = *known;
    shader.effects = findEffects(program);
    shader.firstLocation = static_cast<std::uint32_t>(program_.locations.size());
    program_.locations.insert(program_.locations.end(), program.locations.begin(), program.locations.end());
    for (const Variable& variable : program.variables) shader.variables.push_back(shared(variable));
    for (const FunctionUse& function : program.functions) {
      const auto [same, isNew] =
          functions_.emplace(keyOf(function), static_cast<std::uint32_t>(program_.functions.size()));
      if (isNew) program_.functions.push_back(function);
      shader.functions.push_back(same->second);
    }
    std::vector<bool> isSet(program.variables.size(), false);
    for (const Parameter& parameter : program.parameters)
      if (parameter.isSet != noVariable) isSet[parameter.isSet] = true;
    shader.written.assign(program.variables.size(), false);
    const auto visit = [&](const auto& self, const Code& code) -> void {
      for (const Instruction& instruction : code) {
        ++shader.instructions;
        if (instruction.op == Op::scope || instruction.op == Op::leave)
          shader.scopes = std::max(shader.scopes, instruction.scopeId + 1);
        if (instruction.op == Op::closureLayer) shader.layerings = std::max(shader.layerings, instruction.site + 1);
        if (instruction.op == Op::branch && isSet[instruction.arguments[0]]) continue;
        forEachWritten(program, instruction, [&](VariableId id) { shader.written[id] = true; });
        for (const Code& body : instruction.bodies) self(self, body);
      }
    };
    visit(visit, program.body);
    return shader;
  }

  /// Constants (by the name that they have in reports) and globals are the same variables in all layers.
  VariableId shared(const Variable& variable) {
    if (variable.storage == Storage::global) {
      VariableId& known = globals_[static_cast<std::size_t>(variable.global)];
      if (known == noVariable) known = add(variable);
      return known;
    }
    if (isClosureMessage(variable)) {
      const auto [known, isNew] = closureMessages_.emplace(variable.name, noVariable);
      if (isNew) known->second = add(variable);
      return known->second;
    }
    if (variable.storage != Storage::constant) return noVariable;
    return constant({variable.type, variable.value}, variable.name);
  }

  VariableId add(Variable variable) {
    program_.variables.push_back(std::move(variable));
    producers_.push_back(noLayer);
    return static_cast<VariableId>(program_.variables.size() - 1);
  }

  VariableId constant(const Constant& value, const std::string& name = {}) {
    const auto [known, isNew] = constants_.emplace(name + ":" + bitsKey(value), noVariable);
    if (isNew) {
      Variable variable;
      variable.name = name;
      variable.type = value.type;
      variable.storage = Storage::constant;
      variable.value = value.value;
      known->second = add(std::move(variable));
    }
    return known->second;
  }
  VariableId number(int value) { return constant(Constant::ofInt(value)); }

  VariableId temporary(const Type& type) {
    Variable variable;
    variable.type = type;
    variable.storage = Storage::temporary;
    return add(std::move(variable));
  }

  // One layer

  void addLayer(std::uint32_t index) {
    const ResolvedGroup::Layer& layer = group_.layers[index];
    const Program& source = *layer.program;
    links_ = linksInto(index);
    values_.emplace_back();
    codes_.emplace_back();
    codes_.back().alwaysRuns = layer.alwaysRuns;
    shadersOfLayers_.push_back(nullptr);
    if (!needed_[index]) {
      addUnusedParameters(layer);
      return;
    }
    Shader& shader = shaderOf(source);
    shadersOfLayers_.back() = &shader;
    instructions_ += shader.instructions;
    if (instructions_ > maximumGroupInstructions) {
      if (!errors_.hasErrors())
        errors_.error(source.locations.empty() ? SourceLocation{} : source.locations[0],
                      fmt::format("this shader group has more than {} instructions", maximumGroupInstructions));
      return;
    }
    map_ = shader.variables;
    writesCi_ = writesCi_ || (source.ci != noVariable && shader.written[source.ci] && !ownCi_.contains(index));
    if (const auto own = ownCi_.find(index); own != ownCi_.end()) {
      Variable closure = source.variables[source.ci];
      closure.storage = Storage::local;
      own->second = map_[source.ci] = add(std::move(closure));
      producers_[own->second] = index;
    }
    addParameters(index, shader);
    for (VariableId id = 0; id < map_.size(); ++id)
      if (map_[id] == noVariable) map_[id] = add(source.variables[id]);
    Code& code = codes_.back().code;
    clone(source, shader, source.body, code);
    firstScope_ += shader.scopes;
    firstLayering_ += shader.layerings;
    firstSite_ += static_cast<std::uint32_t>(source.closureSites.size());
    for (ClosureSite site : source.closureSites) {
      site.location += shader.firstLocation;
      program_.closureSites.push_back(std::move(site));
    }
    for (const Link& link : links_)
      if (!isAlias(link, shader)) adapt(index, source, link, code);
    for (std::uint32_t p = 0; p < source.parameters.size(); ++p)
      if (isProduced(index, p, source, shader)) producers_[values_[index][p]] = index;
    addOutputs(index, layer, code);
  }

  std::vector<Link> linksInto(std::uint32_t layer) {
    std::vector<Link> links;
    for (; nextLink_ < group_.links.size() && group_.links[nextLink_].layer == layer; ++nextLink_)
      links.push_back(group_.links[nextLink_]);
    return links;
  }

  void addUnusedParameters(const ResolvedGroup::Layer& layer) {
    for (std::uint32_t p = 0; p < layer.program->parameters.size(); ++p)
      if (!layer.program->parameters[p].type.closure) addParameter(layer, p);
  }

  Parameter& addParameter(const ResolvedGroup::Layer& layer, std::uint32_t index) {
    Parameter& added = program_.parameters.emplace_back(layer.program->parameters[index]);
    added.name = layer.name + "." + added.name;
    added.variable = added.isSet = added.isConnected = noVariable;
    if (const auto hints = layer.hints.find(index); hints != layer.hints.end()) {
      for (const MetadataValue& hint : hints->second) {
        std::erase_if(added.metadata, [&](const MetadataValue& known) { return known.name == hint.name; });
        added.metadata.push_back(hint);
      }
    }
    return added;
  }

  const Link* wholeLink(std::uint32_t parameter) const {
    for (const Link& link : links_)
      if (link.target.parameter == parameter && link.target.isWhole()) return &link;
    return nullptr;
  }

  /// The source itself stands for the parameter where that is of the same kind and the layer never writes it.
  bool isAlias(const Link& link, const Shader& shader) const {
    if (!link.target.isWhole() || !link.source.isWhole()) return false;
    const Parameter& target = group_.layers[link.layer].program->parameters[link.target.parameter];
    const VariableId source = sourceOf(link);
    return (source == noVariable || sameKind(program_.variables[source].type, target.type)) &&
           (target.variable == noVariable || !shader.written[target.variable]);
  }

  VariableId sourceOf(const Link& link) const {
    if (link.source.parameter == ciParameter) return ownCi_.at(link.sourceLayer);
    return values_[link.sourceLayer][link.source.parameter];
  }

  /// Gives every parameter its variables: its own as before, those of the layer that it is connected to, or new ones.
  void addParameters(std::uint32_t index, const Shader& shader) {
    const ResolvedGroup::Layer& layer = group_.layers[index];
    std::vector<bool> isLinked(layer.program->parameters.size(), false);
    for (const Link& link : links_) isLinked[link.target.parameter] = true;
    for (std::uint32_t p = 0; p < layer.program->parameters.size(); ++p) {
      const Parameter& parameter = layer.program->parameters[p];
      const auto number = static_cast<std::uint32_t>(program_.parameters.size());
      Parameter* added = parameter.type.closure ? nullptr : &addParameter(layer, p);
      const Link* whole = isLinked[p] ? wholeLink(p) : nullptr;
      VariableId value = noVariable;
      if (whole && isAlias(*whole, shader)) {
        value = sourceOf(*whole);
      } else if (parameter.variable != noVariable) {
        Variable own = layer.program->variables[parameter.variable];
        own.name = layer.name + "." + parameter.name;
        own.parameter = number;
        if (whole || parameter.type.closure) own.storage = Storage::local;
        value = add(std::move(own));
        if (added && !whole) added->variable = value;
      }
      values_[index].push_back(value);
      if (parameter.variable != noVariable) map_[parameter.variable] = value;
      if (parameter.isSet != noVariable) {
        map_[parameter.isSet] = isSetVariable(*layer.program, parameter, number, whole != nullptr);
        if (added && !whole) added->isSet = map_[parameter.isSet];
      }
      const bool isUserData = group_.userDataIsConnected && readsUserData(parameter);
      if (parameter.isConnected != noVariable)
        map_[parameter.isConnected] =
            this->number((isLinked[p] || isUserData ? 1 : 0) + (outgoing_[index].contains(p) ? 2 : 0));
    }
  }

  VariableId isSetVariable(const Program& source, const Parameter& parameter, std::uint32_t number, bool connected) {
    if (connected) return this->number(1);
    if (parameter.type.closure) return this->number(0);
    Variable variable = source.variables[parameter.isSet];
    variable.parameter = number;
    return add(std::move(variable));
  }

  bool isProduced(std::uint32_t index, std::uint32_t p, const Program& source, const Shader& shader) const {
    const Parameter& parameter = source.parameters[p];
    if (values_[index][p] == noVariable) return false;
    for (const Link& link : links_)
      if (link.target.parameter == p) return !isAlias(link, shader);
    return parameter.variable != noVariable && (shader.written[parameter.variable] || !parameter.hasConstantDefault);
  }

  void clone(const Program& source, const Shader& shader, const Code& code, Code& out) {
    for (const Instruction& instruction : code) {
      if (instruction.op == Op::branch) {
        const Variable& condition = program_.variables[map_[instruction.arguments[0]]];
        if (condition.storage == Storage::constant) {
          const bool holds = std::get<std::vector<std::int32_t>>(condition.value)[0] != 0;
          clone(source, shader, instruction.bodies[holds ? 0 : 1], out);
          continue;
        }
      }
      Instruction copy;
      copy.op = instruction.op;
      copy.testsLast = instruction.testsLast;
      copy.result = instruction.result == noVariable ? noVariable : map_[instruction.result];
      copy.location = instruction.location + shader.firstLocation;
      copy.scopeId = instruction.scopeId;
      if (copy.op == Op::scope || copy.op == Op::leave) copy.scopeId += firstScope_;
      copy.site = instruction.site;
      if (copy.op == Op::closureMake || copy.op == Op::closureWeight || copy.op == Op::closureParameter)
        copy.site += firstSite_;
      if (copy.op == Op::closureLayer) copy.site += firstLayering_;
      copy.function = instruction.op == Op::call ? shader.functions[instruction.function] : instruction.function;
      for (const VariableId argument : instruction.arguments)
        copy.arguments.push_back(argument == noVariable ? noVariable : map_[argument]);
      copy.bodies.resize(instruction.bodies.size());
      for (std::size_t i = 0; i < copy.bodies.size(); ++i) clone(source, shader, instruction.bodies[i], copy.bodies[i]);
      out.push_back(std::move(copy));
    }
  }

  // Connections that convert, or of parts

  VariableId emit(Code& code, Op op, const Type& type, std::vector<VariableId> arguments) {
    const VariableId result = temporary(type);
    set(code, op, result, std::move(arguments));
    return result;
  }
  void set(Code& code, Op op, VariableId target, std::vector<VariableId> arguments) {
    Instruction instruction;
    instruction.op = op;
    instruction.result = target;
    instruction.arguments = std::move(arguments);
    code.push_back(std::move(instruction));
  }

  VariableId convert(Code& code, VariableId value, const Type& from, const Type& to) {
    if (sameKind(from, to)) return value;
    if (from == types::integer) value = emit(code, Op::toFloat, types::floating, {value});
    if (to == types::floating) return value;
    return emit(code, to == types::matrix ? Op::toMatrix : Op::toTriple, to, {value});
  }

  /// Code that sets a parameter from what it is connected to, before the layer first looks at it.
  void adapt(std::uint32_t index, const Program& source, const Link& link, Code& code) {
    VariableId value = sourceOf(link);
    const VariableId target = values_[index][link.target.parameter];
    if (value == noVariable || target == noVariable) return;
    Code added;
    Type from = program_.variables[value].type;
    if (link.source.element >= 0)
      value = emit(added, Op::element, from.element(), {value, number(link.source.element)});
    if (link.source.component >= 0)
      value = emit(added, Op::component, types::floating, {value, number(link.source.component)});
    from = partType(from, link.source.element, link.source.component);
    const Type whole = program_.variables[target].type;
    value = convert(added, value, from, partType(whole, link.target.element, link.target.component));
    store(added, target, link.target, value);
    const Parameter& parameter = source.parameters[link.target.parameter];
    const VariableId isSet = parameter.isSet == noVariable ? noVariable : map_[parameter.isSet];
    const Matcher touches = [&](const Instruction& instruction) {
      if (instruction.op == Op::branch && isSet != noVariable && instruction.arguments[0] == isSet) return Match::skip;
      const auto& arguments = instruction.arguments;
      const bool touched =
          instruction.result == target || std::find(arguments.begin(), arguments.end(), target) != arguments.end();
      return touched ? Match::yes : Match::no;
    };
    // Nothing looks at it here: later layers may.
    if (!insertBeforeAll(code, touches, added, maximumBlockDepth))
      code.insert(code.end(), std::make_move_iterator(added.begin()), std::make_move_iterator(added.end()));
  }

  void store(Code& code, VariableId target, const Part& part, VariableId value) {
    if (part.isWhole()) {
      set(code, Op::assign, target, {value});
    } else if (part.element < 0) {
      set(code, Op::setComponent, target, {number(part.component), value});
    } else if (part.component < 0) {
      set(code, Op::setElement, target, {number(part.element), value});
    } else {
      Variable element;
      element.type = program_.variables[target].type.element();
      element.storage = Storage::local;
      const VariableId copy = add(std::move(element));
      set(code, Op::element, copy, {target, number(part.element)});
      set(code, Op::setComponent, copy, {number(part.component), value});
      set(code, Op::setElement, target, {number(part.element), copy});
    }
  }

  void addOutputs(std::uint32_t index, const ResolvedGroup::Layer& layer, Code& code) {
    std::uint32_t number = layer.firstParameter;
    std::size_t next = 0;
    for (std::uint32_t p = 0; p < layer.program->parameters.size(); ++p) {
      const Parameter& parameter = layer.program->parameters[p];
      if (parameter.type.closure) continue;
      if (next < layer.asked.size() && layer.asked[next] == p) {
        ++next;
        VariableId value = values_[index][p];
        if (value != noVariable && wholeLink(p) && producers_[value] != index) {
          // Someone else's: read here, so that it is there.
          Variable copy;
          copy.name = layer.name + "." + parameter.name;
          copy.type = parameter.type;
          const VariableId own = add(std::move(copy));
          set(code, Op::assign, own, {value});
          value = own;
        }
        if (value != noVariable) program_.outputs.push_back({OutputKind::parameter, number, 0, value});
      }
      ++number;
    }
  }

  /// What all layers together make of the point and its normal.
  void addDisplaced() {
    for (const Global global : displacedGlobals) {
      Variable variable;
      variable.type = global == Global::P ? types::point : types::normal;
      variable.storage = Storage::global;
      variable.global = global;
      program_.outputs.push_back(displacedOutput(global, shared(variable)));
    }
  }

  /// A layer may be moved when it does nothing besides its outputs and reads nothing that others change.
  void decideMovability() {
    std::array<bool, globalCount> written{};
    std::vector<Effects> all(codes_.size());
    for (std::uint32_t i = 0; i < codes_.size(); ++i) {
      if (!shadersOfLayers_[i]) continue;
      all[i] = shadersOfLayers_[i]->effects;
      if (ownCi_.contains(i))
        all[i].writes[static_cast<std::size_t>(Global::Ci)] = all[i].reads[static_cast<std::size_t>(Global::Ci)] =
            false;
      for (std::size_t g = 0; g < written.size(); ++g) written[g] = written[g] || all[i].writes[g];
    }
    for (std::size_t i = 0; i < codes_.size(); ++i) {
      const Effects& effects = all[i];
      codes_[i].isMovable = !effects.any();
      for (std::size_t g = 0; g < written.size(); ++g)
        if (written[g] && effects.reads[g]) codes_[i].isMovable = false;
    }
  }

  const ResolvedGroup& group_;
  Diagnostics errors_;
  Program program_;
  std::vector<bool> needed_;  ///< By layer.
  std::vector<std::set<std::uint32_t>> outgoing_;
  std::map<std::uint32_t, VariableId> ownCi_;  ///< Of layers whose Ci is the source of a connection.
  bool writesCi_ = false;                      ///< Some layer writes the Ci of the group.
  std::unordered_map<const Program*, std::unique_ptr<Shader>> shaders_;
  std::vector<const Shader*> shadersOfLayers_;
  std::array<VariableId, globalCount> globals_ = noGlobals();
  std::unordered_map<std::string, VariableId> constants_, closureMessages_;
  /// A function of the host may write other arguments at another place.
  static std::string keyOf(const FunctionUse& function) {
    return fmt::format("{} {} {} {} {}", function.symbol, function.host, function.pure, function.outputs,
                       function.traits);
  }

  std::unordered_map<std::string, std::uint32_t> functions_;
  std::vector<std::uint32_t> producers_;         ///< By variable.
  std::vector<std::vector<VariableId>> values_;  ///< By layer and its parameter.
  std::vector<LayerCode> codes_;
  std::size_t nextLink_ = 0, instructions_ = 0;
  std::uint32_t firstScope_ = 0, firstSite_ = 0, firstLayering_ = 0;

  // Of the layer that is being added
  std::vector<Link> links_;
  std::vector<VariableId> map_;

  static std::array<VariableId, globalCount> noGlobals() {
    std::array<VariableId, globalCount> none{};
    none.fill(noVariable);
    return none;
  }
};

}  // namespace

Result<std::shared_ptr<const Program>> merge(const ResolvedGroup& group) { return Merger(group).run(); }

}  // namespace aerosol::lang
