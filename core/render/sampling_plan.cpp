#include "core/render/sampling_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "core/scene/field.h"

namespace aerosol::render {

namespace {

using scene::DistanceSampling;
using scene::TransmittanceSampling;
using volume::DistanceMethod;
using volume::TransmittanceMethod;

template <class E>
const char* wordOf(E value) {
  return scene::Words<E>::words[static_cast<std::size_t>(value)];
}

template <class E>
std::optional<E> fromWord(std::string_view word) {
  const auto& words = scene::Words<E>::words;
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) return {};
  return static_cast<E>(found - words.begin());
}

DistanceSampling trackingOf(const volume::Medium& medium) {
  switch (medium.collisions) {
    case volume::Collisions::weighted:
      break;
    case volume::Collisions::analogue:
      return DistanceSampling::delta;
    case volume::Collisions::decomposed:
      return DistanceSampling::decomposition;
    case volume::Collisions::listed:
      return DistanceSampling::candidates;
  }
  return medium.relaxesBound ? DistanceSampling::relaxed : DistanceSampling::nullScattering;
}

/// Closed forms of constants are found again by themselves.
DistanceSampling distanceOf(const volume::Medium& medium) {
  switch (medium.method) {
    case DistanceMethod::closedForm:
      break;
    case DistanceMethod::analytic:
      return DistanceSampling::analytic;
    case DistanceMethod::marching:
      return DistanceSampling::marching;
    case DistanceMethod::nullScattering:
      return trackingOf(medium);
  }
  return DistanceSampling::automatic;
}

TransmittanceSampling transmittanceOf(const volume::Medium& medium) {
  switch (medium.transmittance) {
    case TransmittanceMethod::closedForm:
    case TransmittanceMethod::analytic:
      break;
    case TransmittanceMethod::marching:
      return TransmittanceSampling::marching;
    case TransmittanceMethod::ratioTracking:
      return TransmittanceSampling::ratio;
    case TransmittanceMethod::twoCombs:
      return TransmittanceSampling::twoCombs;
    case TransmittanceMethod::unbiasedMarching:
      return TransmittanceSampling::unbiased;
    case TransmittanceMethod::deltaTracking:
      return TransmittanceSampling::delta;
  }
  return TransmittanceSampling::automatic;
}

/// Takes what follows `key` up to a comma or the end off the front; nothing where it is not there.
std::optional<std::string_view> take(std::string_view& rest, std::string_view key) {
  if (!rest.starts_with(key)) return {};
  rest.remove_prefix(key.size());
  const std::string_view word = rest.substr(0, rest.find(','));
  rest.remove_prefix(word.size());
  return word;
}

std::optional<SamplingChoice> parseLine(std::string_view line) {
  const std::size_t colon = line.rfind(": distance ");
  if (colon == std::string_view::npos) return {};
  SamplingChoice choice{std::string(line.substr(0, colon)), {}};
  std::string_view rest = line.substr(colon);
  const auto distance = take(rest, ": distance "), transmittance = take(rest, ", transmittance "),
             step = take(rest, ", step ");
  if (!distance || !transmittance || !step || !rest.empty()) return {};
  choice.sampling.distance = fromWord<DistanceSampling>(*distance);
  choice.sampling.transmittance = fromWord<TransmittanceSampling>(*transmittance);
  float size = 0;
  const auto end = std::from_chars(step->data(), step->data() + step->size(), size);
  const bool isNumber = end.ec == std::errc() && end.ptr == step->data() + step->size() && size > 0;
  if (!choice.sampling.distance || !choice.sampling.transmittance || !isNumber) return {};
  choice.sampling.stepSize = size;
  return choice;
}

}  // namespace

SamplingChoice choiceOf(const std::string& name, const volume::Medium& medium, float stepSize) {
  return {name, {distanceOf(medium), transmittanceOf(medium), stepSize, {}}};
}

std::string toText(const SamplingPlan& plan) {
  std::string text;
  for (const SamplingChoice& choice : plan) {
    text +=
        fmt::format("{}: distance {}, transmittance {}, step {}\n", choice.medium, wordOf(*choice.sampling.distance),
                    wordOf(*choice.sampling.transmittance), *choice.sampling.stepSize);
  }
  return text;
}

Result<SamplingPlan> parseSamplingPlan(const std::string& text, const std::string& file) {
  SamplingPlan plan;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const auto choice = parseLine(line);
    if (!choice) {
      return Diagnostic{Severity::error,
                        {file, number, 1},
                        fmt::format("'{}' says nothing about a medium", line),
                        {},
                        {"a line is NAME: distance WORD, transmittance WORD, step NUMBER"}};
    }
    plan.push_back(*choice);
  }
  return plan;
}

std::string whyNotFor(const SamplingPlan& plan, const std::vector<std::string>& mediumNames) {
  if (plan.size() != mediumNames.size()) {
    return fmt::format("the plan is for {} media, the scene has {}", plan.size(), mediumNames.size());
  }
  for (std::size_t i = 0; i < plan.size(); ++i) {
    if (plan[i].medium == mediumNames[i]) continue;
    return fmt::format("medium {} of the plan is '{}', that of the scene '{}'", i + 1, plan[i].medium, mediumNames[i]);
  }
  return {};
}

}  // namespace aerosol::render
