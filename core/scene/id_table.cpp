#include "core/scene/id_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/scene/property_reader.h"

namespace aerosol::scene {

namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

IdTable::IdTable(const SceneTree& tree, Reporter& reporter) {
  collect(tree.scene, reporter);
  for (const Alias& alias : tree.aliases) {
    const auto found = entries_.find(alias.id);
    if (found == entries_.end()) {
      std::vector<std::string> ids;
      for (const auto& [id, entry] : entries_) ids.push_back(id);
      reporter.error(alias.idLocation, fmt::format("no object has the id '{}'", alias.id),
                     alternatives(alias.id, ids, "known ids:"));
      continue;
    }
    add(alias.as, {found->second.object, alias.asLocation}, reporter);
  }
}

void IdTable::add(const std::string& id, Entry entry, Reporter& reporter) {
  const auto [first, isNew] = entries_.try_emplace(id, entry);
  if (isNew) return;
  reporter.error(entry.location, fmt::format("the id '{}' is given twice", id),
                 {fmt::format("the first one is at {}", format(first->second.location))});
}

void IdTable::collect(const Element& element, Reporter& reporter) {
  if (element.tag != "ref" && !element.id.empty()) add(element.id, {&element, element.idLocation}, reporter);
  for (const Element& child : element.children) collect(child, reporter);
}

const Element* IdTable::resolve(const Element& reference, const std::vector<std::string>& tags, Reporter& reporter) {
  const auto found = entries_.find(reference.id);
  if (found != entries_.end()) {
    used_.insert(found->second.object);
    return found->second.object;
  }
  std::vector<std::string> ids;
  for (const auto& [id, entry] : entries_) {
    if (contains(tags, entry.object->tag)) ids.push_back(id);
  }
  reporter.error(reference.idLocation, fmt::format("no object has the id '{}'", reference.id),
                 alternatives(reference.id, ids, fmt::format("ids of {} objects:", joinWithOr(tags))));
  return nullptr;
}

std::vector<Child> IdTable::children(const Element& parent, const std::vector<std::string>& tags, Reporter& reporter) {
  std::vector<Child> result;
  for (const Element& use : parent.children) {
    const bool isReference = use.tag == "ref";
    if (isReference && tags.empty()) {
      reporter.error(use.location,
                     fmt::format("{} has no nested objects, so nothing can be referred to", describe(parent)));
      continue;
    }
    const Element* object = isReference ? resolve(use, tags, reporter) : &use;
    if (!object) continue;
    if (!contains(tags, object->tag)) {
      const std::string message =
          isReference ? fmt::format("'{}' is a {}, which does not belong in {}", use.id, object->tag, describe(parent))
                      : fmt::format("<{}> does not belong in {}", use.tag, describe(parent));
      reporter.error(isReference ? use.idLocation : use.location, message,
                     {tags.empty() ? "it has parameters only, no nested objects" : "valid here: " + join(tags)});
      continue;
    }
    result.push_back({object, &use});
  }
  return result;
}

Child IdTable::single(const std::vector<Child>& children, const std::string& tag, Reporter& reporter) {
  Child first;
  for (const Child& child : children) {
    if (child.object->tag != tag) continue;
    if (!first.object) {
      first = child;
      continue;
    }
    reporter.error(child.use->location, fmt::format("a second {}: only one is possible here", tag),
                   {fmt::format("the first one is at {}", format(first.use->location))});
  }
  return first;
}

}  // namespace aerosol::scene
