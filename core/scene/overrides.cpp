#include "core/scene/overrides.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "core/scene/checks.h"
#include "core/scene/property_reader.h"
#include "core/scene/syntax.h"
#include "core/scene/tables.h"

namespace aerosol::scene {

namespace {

/// The pieces of `target.parameter=value`.
struct Assignment {
  std::string target;
  std::string parameter;
  std::string value;
  SourceLocation location;
};

std::optional<Assignment> split(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t dot = text.substr(0, equals).rfind('.');
  if (equals == std::string::npos || dot == std::string::npos) return std::nullopt;
  Assignment a{std::string(trim(std::string_view(text).substr(0, dot))),
               std::string(trim(std::string_view(text).substr(dot + 1, equals - dot - 1))),
               text.substr(equals + 1),
               {"--set " + text, 0, 0}};
  if (a.target.empty() || a.parameter.empty()) return std::nullopt;
  return a;
}

/// One object that can be changed, whatever its C++ type.
struct Target {
  std::string kind;
  std::string type;
  std::string id;
  std::vector<std::string> parameters;  ///< Those that `*` reaches.
  bool takesAny = false;                ///< A shader.
  /// Returns what is wrong, or nothing.
  std::function<std::string(const Assignment&)> set;

  bool knows(const std::string& parameter) const {
    return std::find(parameters.begin(), parameters.end(), parameter) != parameters.end();
  }
};

template <class T>
std::vector<std::string> namesOf(const std::vector<Field<T>>& fields) {
  std::vector<std::string> names;
  for (const Field<T>& f : fields) {
    if (!f.spec.withoutEffect) names.push_back(f.spec.name);
  }
  return names;
}

/// The value of an assignment as a parameter, or what is wrong with it.
std::optional<Value> valueFor(const ParameterSpec& spec, const Assignment& a, std::string& problem) {
  TextError error;
  std::optional<Value> value = parseValue(spec.type, a.value, error);
  problem = value ? checkValue(spec, *value) : fmt::format("'{}': {}", spec.name, error.message);
  if (!problem.empty()) return std::nullopt;
  return value;
}

template <class T>
std::string setField(const std::vector<Field<T>>& fields, T& object, Origin& origin, const Assignment& a) {
  const Field<T>* field = findField(fields, a.parameter);
  std::string problem;
  const std::optional<Value> value = valueFor(field->spec, a, problem);
  if (!value) return problem;
  problem = field->set(object, *value);
  if (problem.empty()) origin.parameters[a.parameter] = a.location;
  return problem;
}

std::string setNamedValue(const VolumeType& type, Volume& volume, const Assignment& a) {
  for (const ParameterSpec& spec : type.parameters) {
    if (spec.name != a.parameter) continue;
    std::string problem;
    std::optional<Value> value = valueFor(spec, a, problem);
    if (!value) return problem;
    std::erase_if(volume.parameters, [&](const NamedValue& p) { return p.name == a.parameter; });
    volume.parameters.push_back({a.parameter, std::move(*value)});
    volume.origin.parameters[a.parameter] = a.location;
  }
  return {};
}

/// The scene tells a parameter's type when it writes one; otherwise the text is guessed and marked as such. What is
/// called `input.parameter` is a parameter of the layer that is connected there.
std::string setShaderParameter(SceneDescription& scene, ShaderUse& shader, const Assignment& a) {
  for (const ShaderInput& input : shader.inputs) {
    if (input.parameter.empty() || !a.parameter.starts_with(input.parameter + ".")) continue;
    Assignment inner = a;
    inner.parameter = a.parameter.substr(input.parameter.size() + 1);
    return setShaderParameter(scene, scene.layers[input.layer], inner);
  }
  std::erase_if(shader.inputs, [&](const ShaderInput& input) { return input.parameter == a.parameter; });
  ShaderParameter changed{a.parameter, guessValue(a.value), a.location, a.location, true};
  const auto written = std::find_if(shader.parameters.begin(), shader.parameters.end(),
                                    [&](const ShaderParameter& p) { return p.name == a.parameter; });
  if (written == shader.parameters.end()) {
    shader.parameters.push_back(std::move(changed));
  } else if (written->untyped) {
    *written = std::move(changed);
  } else {
    TextError error;
    std::optional<Value> value = parseValue(typeOf(written->value), a.value, error);
    const bool widens = typeOf(written->value) == ValueType::integer;  // `2` was written where 2.5 may well be meant.
    if (!value && !widens) return fmt::format("'{}': {}", a.parameter, error.message);
    if (value) {
      changed.value = std::move(*value);
      changed.untyped = false;
    }
    *written = std::move(changed);
  }
  shader.origin.parameters[a.parameter] = a.location;
  return {};
}

/// All that `--set` can reach in a scene.
class Targets {
 public:
  Targets(SceneDescription& scene, const KnownTypes& known) : scene_(scene), known_(known) {
    addFields("integrator", scene.integrator.type, integratorTypes().front().fields, scene.integrator);
    addFields("sensor", sensorTypes(), scene.sensor);
    addFields("film", "hdrfilm", filmTypes().front().fields, scene.film);
    addFields("rfilter", filterTypes(), scene.film.filter);
    addFields("sampler", samplerTypes(), scene.sampler);
    for (Shape& shape : scene.shapes) {
      addFields("shape", shapeTypes(), shape);
      if (shape.emitter) addFields("emitter", emitterTypes(), *shape.emitter);
    }
    for (Emitter& emitter : scene.emitters) addFields("emitter", emitterTypes(), emitter);
    for (Volume& volume : scene.volumes) addVolume(volume);
    for (ShaderUse& material : scene.materials) addShader("bsdf", material);
    for (ShaderUse& layer : scene.layers) addShader("texture", layer);
    for (Medium& medium : scene.media) addShader("medium", medium.shader, samplingFields(), medium.sampling);
    for (Displacement& displacement : scene.displacements)
      addShader("displacement", displacement.shader, tessellationFields(), displacement.tessellation);
  }

  /// Those whose id is `name`; else of that type; else of that kind; all of them for `*`.
  std::vector<const Target*> find(const std::string& name) const {
    for (const std::string Target::* key : {&Target::id, &Target::type, &Target::kind}) {
      std::vector<const Target*> found;
      for (const Target& t : targets_) {
        if (name == "*" || t.*key == name) found.push_back(&t);
      }
      if (!found.empty()) return found;
    }
    return {};
  }

  std::vector<std::string> names() const {
    std::set<std::string> names = {"*"};
    for (const Target& t : targets_) names.insert({t.kind, t.type});
    for (const Target& t : targets_) {
      if (!t.id.empty()) names.insert(t.id);
    }
    return {names.begin(), names.end()};
  }

 private:
  template <class T>
  void addFields(const std::string& kind, const std::vector<TypeTable<T>>& tables, T& object) {
    const TypeTable<T>& table = tables[static_cast<std::size_t>(object.type)];
    addFields(kind, table.type, table.fields, object);
  }

  template <class T>
  void addFields(const std::string& kind, const std::string& type, const std::vector<Field<T>>& fields, T& object) {
    targets_.push_back({kind, type, object.origin.id, namesOf(fields), false,
                        [&](const Assignment& a) { return setField(fields, object, object.origin, a); }});
  }

  void addVolume(Volume& volume) {
    const VolumeType& type = *known_.volume(volume.type);
    Target target{"volume", volume.type, volume.origin.id, namesOf(volumeFields()), false, {}};
    for (const std::string& name : namesOf(velocityFields())) target.parameters.push_back(name);
    for (const std::string& name : namesOf(samplingFields())) target.parameters.push_back(name);
    for (const ParameterSpec& spec : type.parameters) target.parameters.push_back(spec.name);
    target.set = [&volume, &type](const Assignment& a) {
      if (findField(volumeFields(), a.parameter)) return setField(volumeFields(), volume, volume.origin, a);
      if (findField(velocityFields(), a.parameter)) {
        return setField(velocityFields(), volume.velocity, volume.origin, a);
      }
      if (findField(samplingFields(), a.parameter)) {
        return setField(samplingFields(), volume.sampling, volume.origin, a);
      }
      return setNamedValue(type, volume, a);
    };
    targets_.push_back(std::move(target));
  }

  void addShader(const char* kind, ShaderUse& shader) {
    Target target{kind, shader.name, shader.origin.id, {}, true, {}};
    for (const ShaderParameter& p : shader.parameters) target.parameters.push_back(p.name);
    target.set = [this, &shader](const Assignment& a) { return setShaderParameter(scene_, shader, a); };
    targets_.push_back(std::move(target));
  }

  /// A shader that has fields of its own beside its parameters.
  template <class T>
  void addShader(const char* kind, ShaderUse& shader, const std::vector<Field<T>>& fields, T& object) {
    Target target{kind, shader.name, shader.origin.id, namesOf(fields), true, {}};
    for (const ShaderParameter& p : shader.parameters) target.parameters.push_back(p.name);
    target.set = [this, &shader, &fields, &object](const Assignment& a) {
      if (!findField(fields, a.parameter)) return setShaderParameter(scene_, shader, a);
      return setField(fields, object, shader.origin, a);
    };
    targets_.push_back(std::move(target));
  }

  SceneDescription& scene_;
  const KnownTypes& known_;
  std::vector<Target> targets_;
};

/// Mesh files named on the command line are looked for like those in the scene.
void findChangedFiles(SceneDescription& scene, const SourceLocation& location, Reporter& reporter) {
  for (Shape& shape : scene.shapes) {
    if (!(shape.origin.of("filename") == location) || !shape.origin.has("filename")) continue;
    const std::vector<std::filesystem::path> others(scene.searchPath.begin() + 1, scene.searchPath.end());
    const auto found = findFile(shape.file.string(), scene.searchPath.front(), others);
    if (found) {
      shape.file = *found;
    } else {
      reporter.error(location, fmt::format("there is no file '{}'", shape.file.string()),
                     {describeSearch(shape.file.string(), scene.searchPath.front(), others)});
    }
  }
}

}  // namespace

void applyOverride(SceneDescription& scene, const std::string& assignment, const KnownTypes& known,
                   Reporter& reporter) {
  std::optional<Assignment> a = split(assignment);
  if (!a) {
    reporter.error({"--set " + assignment, 0, 0}, "an assignment is written target.parameter=value");
    return;
  }
  const Targets targets(scene, known);
  std::vector<const Target*> found = targets.find(a->target);
  // `shader.layer.parameter`: what stands before the last dot may begin with the layer.
  Assignment shorter = *a;
  for (std::size_t dot; found.empty() && (dot = shorter.target.rfind('.')) != std::string::npos;) {
    shorter.parameter = shorter.target.substr(dot + 1) + "." + shorter.parameter;
    shorter.target.resize(dot);
    found = targets.find(shorter.target);
    std::erase_if(found, [](const Target* target) { return !target->takesAny; });
    if (!found.empty()) a = shorter;
  }
  if (found.empty()) {
    reporter.error(a->location, fmt::format("nothing in the scene is called '{}'", a->target),
                   alternatives(a->target, targets.names(), "targets:"));
    return;
  }
  bool reached = false;
  std::vector<std::string> knownParameters;
  for (const Target* target : found) {
    knownParameters.insert(knownParameters.end(), target->parameters.begin(), target->parameters.end());
    if (!target->knows(a->parameter) && (a->target == "*" || !target->takesAny)) continue;
    reached = true;
    if (const std::string problem = target->set(*a); !problem.empty()) {
      reporter.error(a->location, problem);
      return;
    }
  }
  if (!reached) {
    std::sort(knownParameters.begin(), knownParameters.end());
    knownParameters.erase(std::unique(knownParameters.begin(), knownParameters.end()), knownParameters.end());
    reporter.error(a->location, fmt::format("'{}' has no parameter '{}'", a->target, a->parameter),
                   alternatives(a->parameter, knownParameters, "its parameters:"));
    return;
  }
  completeFilter(scene.film.filter);
  checkFilm(scene.film, reporter);
  checkSensor(scene.sensor, reporter);
  findChangedFiles(scene, a->location, reporter);
}

}  // namespace aerosol::scene
