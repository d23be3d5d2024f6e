#include "core/render/aov/aov_plan.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>

namespace aerosol::render {

namespace {

bool isWeighted(AovFeature feature) {
  return feature == AovFeature::visibleDepth || feature == AovFeature::visibleMotion || feature == AovFeature::halfA ||
         feature == AovFeature::halfB;
}

/// Gathers slots as requests come in, each thing once.
class PlanBuilder {
 public:
  explicit PlanBuilder(const AovScene& scene) : scene_(scene) {
    for (const auto* sources : {&scene.lights, &scene.objects}) {
      for (const AovScene::Source& source : *sources) addLabel(source.group);
    }
    groupCount_ = labels_.size();
    for (const std::string& label : scene.closureLabels) {
      if (std::find(labels_.begin(), labels_.end(), label) == labels_.end()) labels_.push_back(label);
    }
    plan_->labelCount = labels_.size();
    plan_->labels = labels_;
  }

  void add(const scene::AovRequest& request) {
    if (request.quantity.starts_with("debug:")) {
      addOutput(request, request.quantity.substr(6));
    } else if (request.quantity == "light_groups") {
      addLightGroups(request);
    } else if (const AovType* type = findAovType(request.quantity); type && type->kind == AovKind::list) {
      for (std::string_view rest = type->members; !rest.empty();) {
        const std::size_t end = std::min(rest.find(' '), rest.size());
        add({std::string(rest.substr(0, end)), std::string(rest.substr(0, end)), request.location});
        rest.remove_prefix(std::min(end + 1, rest.size()));
      }
    } else if (type) {
      addType(request, *type);
    } else if (isExpression(request.quantity)) {
      addLight(request, request.quantity);
    } else {
      std::vector<std::string> notes;
      if (std::string near = didYouMean(request.quantity, aovNames()); !near.empty()) notes.push_back(std::move(near));
      notes.push_back("known are: " + joined(aovNames()) + ", debug:OUTPUT, or a light path expression such as C<RD>L");
      errors_.error(request.location, "'" + request.quantity + "' is no AOV", std::move(notes));
    }
  }

  Result<std::unique_ptr<AovPlan>> finish() {
    if (errors_.hasErrors()) return errors_;
    for (const AovScene::Source& source : scene_.lights) plan_->lightSymbols.push_back(symbolOf(source));
    for (const AovScene::Source& source : scene_.objects) plan_->objectSymbols.push_back(symbolOf(source));
    plan_->followsPaths = !expressions_.empty();
    plan_->automaton = LightPathAutomaton(expressions_, pathEventCount * labels_.size());
    if (plan_->automaton.isTooLarge()) {
      errors_.error({}, "the light path expressions are too complex together", {"ask for fewer of them"});
      return errors_;
    }
    return std::move(plan_);
  }

 private:
  static std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
  }
  /// A path begins at the camera.
  static bool isExpression(const std::string& text) {
    const bool hasNotation = text.find_first_of("<>[](){}*+?|.'") != std::string::npos;
    const bool isLetters = text.find_first_not_of("CRTVLOBDGSs") == std::string::npos;
    return !text.empty() && (text[0] == 'C' || text[0] == '(' || text[0] == '<' || text[0] == '.') &&
           (hasNotation || isLetters);
  }

  void addLabel(const std::string& name) {
    if (std::find(labels_.begin(), labels_.end(), name) == labels_.end()) labels_.push_back(name);
  }
  PathSymbol symbolOf(const AovScene::Source& source) const {
    const auto label = std::find(labels_.begin(), labels_.end(), source.group);
    return render::symbolOf(source.end, static_cast<std::size_t>(label - labels_.begin()), labels_.size());
  }

  AovLayer& addLayer(const scene::AovRequest& request, std::string_view channels, AovFinish finish, bool isData) {
    if (!names_.insert(request.name).second)
      errors_.error(request.location, "a second AOV with the name '" + request.name + "'");
    AovLayer& layer = plan_->layout.layers.emplace_back();
    layer.name = request.name;
    layer.quantity = request.quantity;
    for (const char channel : channels) layer.channels.push_back(request.name + "." + channel);
    layer.finish = finish;
    layer.isData = isData;
    return layer;
  }
  std::uint32_t reserve(std::size_t count) {
    const std::uint32_t first = plan_->layout.width;
    plan_->layout.width += static_cast<std::uint32_t>(count);
    return first;
  }

  std::uint32_t slotOf(const AovType& type) {
    auto& slots = isOfFirstHit(type.feature)    ? plan_->firstHit
                  : isOfFirstSeen(type.feature) ? plan_->firstSeen
                                                : plan_->picture;
    for (const auto& slot : slots) {
      if (slot.feature == type.feature) return slot.slot;
    }
    slots.push_back({type.feature, reserve(type.channels.size() + (isWeighted(type.feature) ? 1 : 0))});
    return slots.back().slot;
  }
  std::uint32_t squaresOf(std::uint32_t slot, std::size_t count) {
    for (const auto& squares : plan_->squares) {
      if (squares.from == slot && squares.count == count) return squares.to;
    }
    plan_->squares.push_back({slot, reserve(count), static_cast<std::uint32_t>(count)});
    return plan_->squares.back().to;
  }

  void addType(const scene::AovRequest& request, const AovType& type) {
    const bool isData = !type.channels.starts_with("RGB");
    switch (type.kind) {
      case AovKind::light:
        addLight(request, std::string(type.paths));
        break;
      case AovKind::feature: {
        if (isOfFirstSeen(type.feature)) needPaths(request);
        AovLayer& layer =
            addLayer(request, type.channels, isWeighted(type.feature) ? AovFinish::share : AovFinish::mean, isData);
        layer.first = slotOf(type);
        layer.second = isWeighted(type.feature) ? layer.first + static_cast<std::uint32_t>(type.channels.size()) : 0;
        square(request, layer);
        break;
      }
      case AovKind::variance: {
        needPaths(request);
        AovLayer& layer = addLayer(request, type.channels, AovFinish::meanVariance, true);
        layer.first = slotOf(type);
        layer.second = squaresOf(layer.first, type.channels.size());
        break;
      }
      case AovKind::picture:
        addLayer(request, type.channels, AovFinish::picture, isData);
        break;
      case AovKind::standardError:
        addLayer(request, type.channels, AovFinish::standardError, true);
        break;
      case AovKind::pictureVariance:
        addLayer(request, type.channels, AovFinish::pictureVariance, true);
        break;
      case AovKind::sampleCount:
        addLayer(request, type.channels, AovFinish::sampleCount, true);
        break;
      case AovKind::objectMatte:
        addMatte(request, type, "CryptoObject", &AovScene::Thing::name);
        break;
      case AovKind::materialMatte:
        addMatte(request, type, "CryptoMaterial", &AovScene::Thing::material);
        break;
      case AovKind::list:
        break;
    }
  }

  /// What shaders give to an output. Asked for by its plain name the layer is called as the output.
  void addOutput(const scene::AovRequest& request, const std::string& name) {
    needPaths(request);
    std::vector<std::string> known;
    for (const auto* outputs : {&scene_.outputs, &scene_.mediumOutputs}) {
      for (const AovScene::Output& output : *outputs) {
        if (std::find(known.begin(), known.end(), output.name) == known.end()) known.push_back(output.name);
      }
    }
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string what =
          known.empty() ? "no surface shader of the scene calls debug(), and no volume shader has such an output"
                        : "known are: " + joined(known);
      errors_.error(request.location, "no shader has the output '" + name + "'", {what});
      return;
    }
    AovLayer& layer =
        addLayer({request.name == request.quantity ? name : request.name, request.quantity, request.location}, "RGB",
                 AovFinish::mean, false);
    layer.first = reserve(3);
    for (const AovScene::Output& output : scene_.outputs) {
      if (output.name != name) continue;
      if (plan_->outputs.size() <= output.object) plan_->outputs.resize(output.object + 1);
      plan_->outputs[output.object].push_back({output.site, layer.first});
    }
    for (const AovScene::Output& output : scene_.mediumOutputs) {
      if (output.name != name) continue;
      if (plan_->mediumOutputs.size() <= output.object) plan_->mediumOutputs.resize(output.object + 1);
      plan_->mediumOutputs[output.object].push_back({output.site, layer.first});
    }
    square(request, layer);
  }

  /// Three layers with two pairs each. Asked for by its plain name it is called as compositors expect.
  void addMatte(const scene::AovRequest& request, const AovType& type, const char* usual,
                std::string AovScene::Thing::* nameOf) {
    needPaths(request);
    if (plan_->mattes.empty()) plan_->matteWeightSlot = reserve(1);
    AovMatte matte{request.name == type.name ? usual : request.name, reserve(1), plan_->matteWeightSlot, {}};
    AovPlan::Matte& ids = plan_->mattes.emplace_back();
    ids.slot = matte.slot;
    std::map<std::string, std::uint32_t> names;
    const auto addThings = [&](const std::vector<AovScene::Thing>& things, std::vector<std::uint32_t>& list) {
      for (const AovScene::Thing& thing : things) {
        const std::string& name = thing.*nameOf;
        list.push_back(name.empty() ? 0 : matteId(name));
        if (!name.empty()) names[name] = list.back();
      }
    };
    addThings(scene_.objectThings, ids.objects);
    addThings(scene_.mediumThings, ids.media);
    for (const auto& [name, id] : names) matte.names.push_back({name, id});
    for (std::uint32_t part = 0; part < 3; ++part) {
      AovLayer& layer = addLayer({matte.name + "0" + std::to_string(part), request.quantity, request.location},
                                 type.channels, AovFinish::matte, true);
      layer.first = 2 * part;
      layer.second = static_cast<std::uint32_t>(plan_->layout.mattes.size());
    }
    plan_->layout.mattes.push_back(std::move(matte));
  }

  /// The layer becomes that of the squares of its values, where a request asks for these.
  void square(const scene::AovRequest& request, AovLayer& layer) {
    if (!request.isSecondMoment || layer.finish != AovFinish::mean) return;
    layer.first = squaresOf(layer.first, layer.channels.size());
    layer.isData = true;
  }

  void needPaths(const scene::AovRequest& request) {
    if (scene_.tracesPaths) return;
    errors_.error(request.location,
                  "the integrator 'depth' follows no light, which '" + request.quantity + "' is about");
  }

  void addLight(const scene::AovRequest& request, const std::string& paths) {
    needPaths(request);
    LightPathExpression expression;
    ExpressionProblem problem;
    if (!parseLightPath(paths, labels_, expression, problem)) {
      errors_.error(request.location, "light path expression '" + paths + "': " + problem.message,
                    {"at byte " + std::to_string(problem.at + 1) + ", behind '" + paths.substr(0, problem.at) + "'"});
      return;
    }
    if (!canMatch(expression)) {
      errors_.error(request.location, "no light path matches '" + paths + "'",
                    {"a path begins with C and ends with L, O or B"});
      return;
    }
    AovLayer& layer = addLayer(request, "RGB", AovFinish::mean, false);
    layer.first = reserve(3);
    expressions_.push_back(std::move(expression));
    plan_->expressionSlots.push_back(layer.first);
    square(request, layer);
  }

  /// Whether there is any path from the camera to a light that matches.
  bool canMatch(const LightPathExpression& expression) const {
    const LightPathAutomaton automaton(std::span(&expression, 1), pathEventCount * labels_.size());
    if (automaton.isTooLarge()) return true;  // All of them together are refused for that later.
    std::vector<LightPathAutomaton::State> open = {automaton.next(automaton.start(), plan_->symbol(PathEvent::camera))};
    std::set<LightPathAutomaton::State> seen(open.begin(), open.end());
    while (!open.empty()) {
      const auto state = open.back();
      open.pop_back();
      for (std::size_t event = 1; event < pathEventCount; ++event) {
        for (std::size_t label = 0; label < labels_.size(); ++label) {
          const auto e = static_cast<PathEvent>(event);
          const auto next = automaton.next(state, render::symbolOf(e, label, labels_.size()));
          if (isEnd(e) && !automaton.matches(next).empty()) return true;
          if (!isEnd(e) && seen.insert(next).second) open.push_back(next);
        }
      }
    }
    return false;
  }

  void addLightGroups(const scene::AovRequest& request) {
    if (groupCount_ == 1) {
      errors_.error(request.location, "no light of the scene is in a group",
                    {"an emitter or a shape gets into one by <string name=\"light_group\" value=\"NAME\"/>"});
      return;
    }
    std::string named;
    for (std::size_t i = 1; i < groupCount_; ++i) {
      addLight({"light_" + labels_[i], "light_" + labels_[i], request.location}, "C.*<[LOB].'" + labels_[i] + "'>");
      named += "'" + labels_[i] + "'";
    }
    addLight({"light_rest", "light_rest", request.location}, "C.*<[LOB].[^" + named + "]>");
  }

  const AovScene& scene_;
  std::unique_ptr<AovPlan> plan_ = std::make_unique<AovPlan>();
  std::vector<std::string> labels_ = {""};
  std::size_t groupCount_ = 1;  ///< Of the labels, those of light groups and none.
  std::vector<LightPathExpression> expressions_;
  std::set<std::string> names_;
  Diagnostics errors_;
};

}  // namespace

bool AovPlan::wants(AovFeature feature) const {
  for (const auto* slots : {&firstHit, &firstSeen, &picture}) {
    if (std::any_of(slots->begin(), slots->end(), [=](const FeatureSlot& s) { return s.feature == feature; }))
      return true;
  }
  return false;
}

Result<std::unique_ptr<AovPlan>> planAovs(std::span<const scene::AovRequest> requests, const AovScene& scene) {
  PlanBuilder builder(scene);
  for (const scene::AovRequest& request : requests) builder.add(request);
  return builder.finish();
}

}  // namespace aerosol::render
