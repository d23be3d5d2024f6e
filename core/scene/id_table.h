// Objects by id, and which of them were asked for.
#pragma once

#include <map>
#include <set>
#include <string>

#include "core/scene/element.h"
#include "core/scene/reporter.h"

namespace aerosol::scene {

/// An object where it is used: `use` is the object itself, or the `ref` that names it.
struct Child {
  const Element* object = nullptr;
  const Element* use = nullptr;
};

class IdTable {
 public:
  /// Takes all ids of the tree, whatever their order; reports repeated ones and aliases of nothing.
  IdTable(const SceneTree& tree, Reporter& reporter);

  /// The children of an object with references resolved. Reports dangling ones and those whose tag is not in `tags`.
  std::vector<Child> children(const Element& parent, const std::vector<std::string>& tags, Reporter& reporter);

  /// The one child with a tag; further ones are reported. `object` is null when there is none.
  static Child single(const std::vector<Child>& children, const std::string& tag, Reporter& reporter);

  bool isUsed(const Element& object) const { return used_.contains(&object); }

 private:
  struct Entry {
    const Element* object;
    SourceLocation location;
  };

  void collect(const Element& element, Reporter& reporter);
  void add(const std::string& id, Entry entry, Reporter& reporter);
  const Element* resolve(const Element& reference, const std::vector<std::string>& tags, Reporter& reporter);

  std::map<std::string, Entry> entries_;
  std::set<const Element*> used_;
};

}  // namespace aerosol::scene
