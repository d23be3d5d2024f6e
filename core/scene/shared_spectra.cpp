#include "core/scene/shared_spectra.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/scene/spectrum_reader.h"

namespace aerosol::scene {

SpectrumUse spectrumUseIn(const std::string& tag) {
  return tag == "emitter" ? SpectrumUse::emitted : SpectrumUse::factor;
}

void SharedSpectra::add(const XmlElement& xml, ReadContext context) {
  const Attributes attributes(xml, {"id"}, {"name", "value", "type", "filename"}, context);
  if (!attributes.has("id")) return;
  const auto [found, isNew] =
      entries_.try_emplace(attributes.text("id"), Entry{.xml = xml,
                                                        .source = &context.source,
                                                        .location = attributes.at("id"),
                                                        .standsAlone = !attributes.has("name")});
  if (!isNew) {
    context.reporter.error(attributes.at("id"), fmt::format("the id '{}' is given twice", found->first),
                           {fmt::format("the first one is at {}", format(found->second.location))});
  }
}

void SharedSpectra::takeAliases(SceneTree& tree) {
  for (bool isChanged = true; isChanged;) {
    isChanged = std::erase_if(tree.aliases, [&](const Alias& alias) {
                  const bool isOurs = entries_.contains(alias.id) || aliases_.contains(alias.id);
                  if (isOurs) aliases_[alias.as] = entries_.contains(alias.id) ? alias.id : aliases_[alias.id];
                  return isOurs;
                }) > 0;
  }
}

void SharedSpectra::resolveBelow(Element& object, const std::vector<std::filesystem::path>& searchPath,
                                 Definitions& definitions, Reporter& reporter) {
  for (Element& child : object.children) {
    const auto alias = aliases_.find(child.id);
    const auto found = entries_.find(alias == aliases_.end() ? child.id : alias->second);
    if (child.tag != "ref") {
      if (found != entries_.end() && !child.id.empty()) {
        reporter.error(child.idLocation, fmt::format("the id '{}' is given twice", child.id),
                       {fmt::format("a spectrum has it at {}", format(found->second.location))});
      }
      resolveBelow(child, searchPath, definitions, reporter);
      continue;
    }
    if (found == entries_.end()) continue;
    Entry& spectrum = found->second;
    spectrum.isReferredTo = true;
    if (child.name.empty()) {
      reporter.error(child.location, fmt::format("which parameter the spectrum '{}' is for is missing", child.id),
                     {"write name=\"…\" into the <ref>"});
      continue;
    }
    const auto same = std::find_if(object.properties.begin(), object.properties.end(),
                                   [&](const Property& property) { return property.name == child.name; });
    if (same != object.properties.end()) {
      reporter.error(child.nameLocation, fmt::format("parameter '{}' is given twice", child.name),
                     {fmt::format("the first one is at {}", format(same->nameLocation))});
      continue;
    }
    const ReadContext context{*spectrum.source, definitions, reporter};
    const Attributes attributes(spectrum.xml, {"id"}, {"name", "value", "type", "filename"}, context);
    object.properties.push_back(
        {.name = child.name,
         .tag = "spectrum",
         .value = readSpectrum(spectrum.xml, attributes, spectrumUseIn(object.tag), searchPath, context),
         .location = child.location,
         .nameLocation = child.nameLocation,
         .valueLocation = child.idLocation});
  }
  const auto isSpectrum = [&](const Element& child) {
    return child.tag == "ref" && (entries_.contains(child.id) || aliases_.contains(child.id));
  };
  std::erase_if(object.children, isSpectrum);
}

void SharedSpectra::resolve(SceneTree& tree, Definitions& definitions, Reporter& reporter) {
  if (entries_.empty()) return;
  takeAliases(tree);
  resolveBelow(tree.scene, tree.searchPath, definitions, reporter);
  for (const auto& [id, entry] : entries_) {
    if (entry.isReferredTo || !entry.standsAlone) continue;
    reporter.warning(
        entry.location, fmt::format("spectrum '{}' is never referred to", id),
        {fmt::format("refer to it with <ref id=\"{}\" name=\"…\"/> where it is wanted, or remove it", id)});
    // What is wrong with it is told as well.
    const ReadContext context{*entry.source, definitions, reporter};
    const Attributes attributes(entry.xml, {"id"}, {"value", "type", "filename"}, context);
    readSpectrum(entry.xml, attributes, SpectrumUse::factor, tree.searchPath, context);
  }
}

}  // namespace aerosol::scene
