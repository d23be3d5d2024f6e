#include "core/scene/integrator_reader.h"

#include <fmt/format.h>

#include "core/scene/property_reader.h"
#include "core/scene/tables.h"

namespace aerosol::scene {

namespace {

/// A part of a list and where it begins in it.
struct ListPart {
  std::string text;
  std::size_t at = 0;
};

std::vector<ListPart> split(std::string_view text) {
  std::vector<ListPart> parts;
  int depth = 0;
  bool isQuoted = false, isOpen = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\'') isQuoted = !isQuoted;
    if (!isQuoted && std::string_view("([{<").find(c) != std::string_view::npos) ++depth;
    if (!isQuoted && std::string_view(")]}>").find(c) != std::string_view::npos) --depth;
    const bool isSpace = c == ' ' || c == '\t' || c == '\n' || c == '\r';
    if (depth <= 0 && !isQuoted && (c == ',' || isSpace)) {
      isOpen = false;
      continue;
    }
    if (!isOpen) parts.push_back({{}, i});
    isOpen = true;
    parts.back().text += c;
  }
  return parts;
}

/// Reads from the outside in; what is found is named from the inside out, as Mitsuba names channels.
class IntegratorReader {
 public:
  IntegratorReader(IdTable& ids, Reporter& reporter, Integrator& innermost)
      : ids_(ids), reporter_(reporter), innermost_(innermost) {}

  std::vector<AovRequest> read(const Element& element) {
    const TypeTable<Integrator>* type = findType(integratorTypes(), element.type);
    const bool isWrapper = type && (type->type == "aov" || type->type == "moment" || type->type == "stokes");
    if (!isWrapper) {
      readPlain(element);
      return {};
    }
    Integrator wrapper;
    readTyped(element, integratorTypes(), wrapper, reporter_);
    const std::vector<Child> children = ids_.children(element, {"integrator"}, reporter_);
    if (children.size() > 1) {
      reporter_.error(children[1].use->location,
                      fmt::format("a second integrator in {}: only one is possible", describe(element)));
    }
    if (++depth_ > 16) {
      reporter_.error(element.location, "integrators stand in each other too deeply");
      return {};
    }
    if (children.empty()) innermost_.maxDepth = 0;  // No light is followed: the picture stays black.
    if (children.empty()) innermost_.origin.location = element.location;
    if (type->type == "stokes") return readIntensity(element, children);
    return type->type == "aov" ? readAovs(wrapper, children) : readMoments(element, children);
  }

 private:
  void readPlain(const Element& element) {
    innermost_.transparentShadows = element.type == "volpath" || element.type == "volpathmis";
    const TypeTable<Integrator>* type = readTyped(element, integratorTypes(), innermost_, reporter_);
    if (type && type->type == "direct") innermost_.maxDepth = 2;
    if (type && !type->substitute.empty()) {
      reporter_.warning(element.typeLocation,
                        fmt::format("instead of the integrator '{}' '{}' is used, whose picture has the same mean",
                                    element.type, type->substitute));
    }
    if (type && type->type == "depth") innermost_.type = "depth";
    ids_.children(element, {}, reporter_);
  }

  /// The name that stands before the channels of a nested integrator.
  static std::string nameOf(const Child& child) { return child.use->name.empty() ? "_arg_0" : child.use->name; }

  std::vector<AovRequest> readNested(const Child& child) {
    std::vector<AovRequest> requests = read(*child.object);
    for (AovRequest& request : requests) request.name = nameOf(child) + "." + request.name;
    return requests;
  }

  std::vector<AovRequest> readAovs(const Integrator& wrapper, const std::vector<Child>& children) {
    std::vector<AovRequest> requests;
    if (!children.empty()) {
      requests.push_back({nameOf(children[0]), "picture", children[0].use->location});
      const std::vector<AovRequest> nested = readNested(children[0]);
      requests.insert(requests.end(), nested.begin(), nested.end());
    }
    if (!wrapper.origin.has("aovs")) return requests;
    for (const ListPart& part : split(wrapper.aovList)) {
      SourceLocation place = wrapper.origin.of("aovs");
      place.column += static_cast<int>(part.at);
      const std::size_t colon = part.text.find(':');
      if (colon == std::string::npos || colon == 0 || colon + 1 == part.text.size()) {
        reporter_.error(place, fmt::format("'{}' is not NAME:QUANTITY", part.text), {"such as dd.y:depth"});
        continue;
      }
      place.column += static_cast<int>(colon + 1);
      requests.push_back({part.text.substr(0, colon), part.text.substr(colon + 1), place});
    }
    return requests;
  }

  /// Of Stokes' four numbers the first is the picture; light without polarisation has none of the others.
  std::vector<AovRequest> readIntensity(const Element& element, const std::vector<Child>& children) {
    reporter_.warning(element.typeLocation, "polarisation is not followed: the picture is the intensity alone");
    return children.empty() ? std::vector<AovRequest>{} : read(*children[0].object);
  }

  std::vector<AovRequest> readMoments(const Element& element, const std::vector<Child>& children) {
    if (children.empty()) {
      reporter_.error(element.location, "integrator 'moment' lacks the integrator whose moments it shows",
                      {"write an <integrator type=\"path\"/> into it"});
      return {};
    }
    std::vector<AovRequest> requests = readNested(children[0]);
    std::erase_if(requests, [](const AovRequest& r) { return r.quantity == "picture"; });
    requests.push_back({nameOf(children[0]), "picture_xyz", children[0].use->location});
    const std::size_t count = requests.size();
    for (std::size_t i = 0; i < count; ++i) {
      AovRequest squared = requests[i];
      squared.name = "m2_" + squared.name;
      squared.isSecondMoment = true;
      requests.push_back(std::move(squared));
    }
    return requests;
  }

  IdTable& ids_;
  Reporter& reporter_;
  Integrator& innermost_;
  int depth_ = 0;
};

}  // namespace

void readIntegrator(const Element& element, IdTable& ids, Reporter& reporter, Integrator& integrator) {
  std::vector<AovRequest> requests = IntegratorReader(ids, reporter, integrator).read(element);
  integrator.aovs = std::move(requests);
}

std::vector<std::string> splitAovList(std::string_view text) {
  std::vector<std::string> texts;
  for (ListPart& part : split(text)) texts.push_back(std::move(part.text));
  return texts;
}

}  // namespace aerosol::scene
