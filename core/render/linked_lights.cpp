#include "core/render/linked_lights.h"

#include <fmt/format.h>

#include <algorithm>

namespace aerosol::render {

Result<std::vector<bool>> namedLights(const std::string& list, const scene::Origin& origin,
                                      std::span<const std::string> ids, std::span<const std::string> shining) {
  std::vector<bool> named(ids.size(), false);
  if (list == "none") return named;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    std::string name = list.substr(begin, end - begin);
    name.erase(0, std::min(name.find_first_not_of(" \t\n\r"), name.size()));
    name.erase(name.find_last_not_of(" \t\n\r") + 1);
    bool isKnown = false;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (ids[i] != name || name.empty()) continue;
      named[i] = isKnown = true;
    }
    if (!isKnown) {
      std::string known;
      for (const std::string& id : shining) {
        if (!id.empty()) known += (known.empty() ? "" : ", ") + id;
      }
      return Diagnostic{Severity::error,
                        origin.of("lights"),
                        fmt::format("there is no light with the id '{}'", name),
                        {},
                        {known.empty() ? "no light has an id" : "the lights are: " + known}};
    }
    begin = end + 1;
  }
  return named;
}

}  // namespace aerosol::render
