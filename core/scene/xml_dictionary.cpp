#include "core/scene/xml_dictionary.h"

#include <fmt/format.h>

#include <map>
#include <mutex>
#include <pugixml.hpp>

#include "core/base/hash.h"

namespace aerosol::scene {

namespace {

namespace fs = std::filesystem;

/// What is kept at most, of documents and of nodes found: a shader may ask for new ones at every point.
constexpr std::size_t maximumDocuments = 1000, maximumNodes = 1000000;

/// Nodes that a query matched, in the order of the document.
struct Matches {
  std::vector<pugi::xml_node> nodes;
  std::uint64_t key = 0;  ///< What was asked, as a hash.
  std::string problem;    ///< What is wrong with the query.
};

class XmlDictionaries final : public DictionarySource {
 public:
  explicit XmlDictionaries(std::vector<fs::path> searchPath) : searchPath_(std::move(searchPath)) {}

  std::int32_t find(std::string_view dictionary, std::string_view query, std::string& problem) override {
    const std::lock_guard lock(mutex_);
    const Document* document = open(dictionary);
    if (!document) return -1;
    problem = document->problem;
    return problem.empty() ? find(document->content, hashString(dictionary), query, problem) : -1;
  }

  std::int32_t find(std::int32_t node, std::string_view query, std::string& problem) override {
    const std::lock_guard lock(mutex_);
    const auto found = places_.find(node);
    if (found == places_.end()) return 0;
    const Place place = found->second;
    return find(place.matches->nodes[place.index], keyOf(place), query, problem);
  }

  std::int32_t next(std::int32_t node) override {
    const std::lock_guard lock(mutex_);
    const auto found = places_.find(node);
    return found == places_.end() ? 0 : numberOf({found->second.matches, found->second.index + 1});
  }

  std::optional<std::string> value(std::int32_t node, std::string_view attribute) override {
    const std::lock_guard lock(mutex_);
    const auto found = places_.find(node);
    if (found == places_.end()) return std::nullopt;
    const pugi::xml_node at = found->second.matches->nodes[found->second.index];
    if (attribute.empty()) return at.text().get();
    const pugi::xml_attribute given = at.attribute(std::string(attribute).c_str());
    return given ? std::optional<std::string>(given.value()) : std::nullopt;
  }

 private:
  struct Document {
    pugi::xml_document content;
    std::string problem;  ///< Why it cannot be read.
  };
  struct Place {
    const Matches* matches = nullptr;
    std::size_t index = 0;
  };

  static std::uint64_t combine(std::uint64_t a, std::uint64_t b) {
    const std::uint64_t both[2] = {a, b};
    return hashString({reinterpret_cast<const char*>(both), sizeof both});
  }
  static std::uint64_t keyOf(const Place& place) { return combine(place.matches->key, place.index); }

  /// Null when there are too many. What begins with a tag, or is empty, is the text itself.
  const Document* open(std::string_view dictionary) {
    if (documents_.size() >= maximumDocuments && !documents_.contains(dictionary)) return nullptr;
    const auto [entry, isNew] = documents_.try_emplace(std::string(dictionary));
    if (!isNew) return entry->second.get();
    entry->second = std::make_unique<Document>();
    Document& document = *entry->second;
    const std::size_t first = dictionary.find_first_not_of(" \t\r\n");
    const bool isText = first == std::string_view::npos || dictionary[first] == '<';
    const pugi::xml_parse_result result = isText ? document.content.load_buffer(dictionary.data(), dictionary.size())
                                                 : document.content.load_file(locate(dictionary).c_str());
    if (!result)
      document.problem = fmt::format("XML parsed with errors: {}, at offset {}", result.description(), result.offset);
    return &document;
  }

  fs::path locate(std::string_view name) const {
    const fs::path path(name);
    for (const fs::path& folder : searchPath_) {
      std::error_code ignored;
      if (path.is_relative() && fs::is_regular_file(folder / path, ignored)) return folder / path;
    }
    return path;
  }

  std::int32_t find(const pugi::xml_node& from, std::uint64_t fromKey, std::string_view query, std::string& problem) {
    const std::uint64_t key = combine(fromKey, hashString(query));
    if (matches_.size() >= maximumNodes && !matches_.contains(key)) return 0;
    const auto [entry, isNew] = matches_.try_emplace(key);
    if (isNew) {
      entry->second.key = key;
      if (places_.size() < maximumNodes) select(from, query, entry->second);
    }
    problem = entry->second.problem;
    return numberOf({&entry->second, 0});
  }

  static void select(const pugi::xml_node& from, std::string_view query, Matches& matches) {
    try {
      pugi::xpath_node_set found = from.select_nodes(std::string(query).c_str());
      found.sort();
      for (const pugi::xpath_node& node : found)
        if (node.node()) matches.nodes.push_back(node.node());
    } catch (const pugi::xpath_exception& problem) {  // Such a query matches nothing.
      matches.problem = fmt::format("Invalid dict_find query '{}': {}", query, problem.what());
    }
  }

  /// From the node's key, so that it does not depend on who asks first; the next free number where keys collide.
  std::int32_t numberOf(const Place& place) {
    if (place.index >= place.matches->nodes.size()) return 0;
    auto number = static_cast<std::int32_t>(keyOf(place) & 0x7fffffffu);
    for (;; number = number == 0x7fffffff ? 1 : number + 1) {
      if (number == 0) continue;
      const auto [entry, isNew] = places_.try_emplace(number, place);
      const Place& known = entry->second;
      if (isNew || (known.matches == place.matches && known.index == place.index)) return number;
    }
  }

  std::vector<fs::path> searchPath_;
  std::mutex mutex_;
  std::map<std::string, std::unique_ptr<Document>, std::less<>> documents_;
  std::map<std::uint64_t, Matches> matches_;  ///< By their keys; addresses are stable.
  std::map<std::int32_t, Place> places_;      ///< By number.
};

}  // namespace

std::unique_ptr<DictionarySource> openDictionaries(std::vector<fs::path> searchPath) {
  return std::make_unique<XmlDictionaries>(std::move(searchPath));
}

}  // namespace aerosol::scene
