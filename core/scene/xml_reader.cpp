#include "core/scene/xml_reader.h"

#include <fmt/format.h>

#include <pugixml.hpp>
#include <string_view>

namespace aerosol::scene {

namespace {

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
bool endsName(char c) { return isBlank(c) || c == '/' || c == '>' || c == '='; }

/// A tag that was closed wrongly or never: the parser only says that there is one.
struct TagMismatch {
  std::size_t offset = 0;
  std::string message;
  std::size_t opened = 0;  ///< Offset of the tag left open.
};

/// Walks over the tags alone and finds the first end tag that does not fit, or the innermost tag open at the end.
class TagBalance {
 public:
  explicit TagBalance(std::string_view text) : text_(text) {}

  std::optional<TagMismatch> check() {
    while ((at_ = text_.find('<', at_)) != std::string_view::npos) {
      const std::string_view rest = text_.substr(at_);
      if (rest.starts_with("<!--"))
        skipPast("-->");
      else if (rest.starts_with("<![CDATA["))
        skipPast("]]>");
      else if (rest.starts_with("<?"))
        skipPast("?>");
      else if (rest.starts_with("<!"))
        skipPast(">");
      else if (rest.starts_with("</")) {
        if (auto mismatch = close()) return mismatch;
      } else {
        open();
      }
    }
    if (open_.empty()) return std::nullopt;
    const std::string& tag = open_.back().tag;
    return TagMismatch{open_.back().offset, fmt::format("<{0}> is never closed: </{0}> is missing", tag),
                       open_.back().offset};
  }

 private:
  struct Open {
    std::string tag;
    std::size_t offset;
  };

  void skipPast(std::string_view end) {
    const std::size_t found = text_.find(end, at_);
    at_ = found == std::string_view::npos ? text_.size() : found + end.size();
  }

  std::string readName(std::size_t from) const {
    std::size_t end = from;
    while (end < text_.size() && !endsName(text_[end])) ++end;
    return std::string(text_.substr(from, end - from));
  }

  void open() {
    const std::size_t start = at_;
    std::string tag = readName(start + 1);
    char quote = 0;
    for (++at_; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (quote != 0) {
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '>') {
        break;
      }
    }
    if (at_ < text_.size() && text_[at_ - 1] != '/') open_.push_back({std::move(tag), start});
  }

  std::optional<TagMismatch> close() {
    const std::size_t start = at_;
    const std::string tag = readName(start + 2);
    if (open_.empty()) return TagMismatch{start, fmt::format("</{}> closes nothing", tag), start};
    if (open_.back().tag != tag) {
      return TagMismatch{start, fmt::format("</{}> stands where </{}> is expected", tag, open_.back().tag),
                         open_.back().offset};
    }
    open_.pop_back();
    skipPast(">");
    return std::nullopt;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<Open> open_;
};

std::string explain(pugi::xml_parse_status status) {
  switch (status) {
    case pugi::status_bad_start_element:
      return "this start tag is not well formed";
    case pugi::status_bad_attribute:
      return "this attribute is not well formed: write name=\"value\"";
    case pugi::status_bad_end_element:
      return "this end tag is not well formed";
    case pugi::status_end_element_mismatch:
      return "an end tag does not fit its start tag";
    case pugi::status_bad_comment:
      return "a comment is not closed by '-->'";
    case pugi::status_bad_cdata:
      return "a CDATA section is not closed by ']]>'";
    case pugi::status_bad_doctype:
      return "this document type declaration is not well formed";
    case pugi::status_bad_pi:
      return "this processing instruction is not well formed";
    case pugi::status_unrecognized_tag:
      return "'<' does not start a tag here; a literal one is written '&lt;'";
    case pugi::status_out_of_memory:
      return "the file is too large for the memory";
    default:
      return "the file is not well-formed XML";
  }
}

void reportParseError(const SourceText& source, const pugi::xml_parse_result& result, Reporter& reporter) {
  if (result.status == pugi::status_end_element_mismatch) {
    if (const auto mismatch = TagBalance(source.text()).check()) {
      std::vector<std::string> notes;
      if (mismatch->opened != mismatch->offset) {
        notes.push_back(fmt::format("the open tag is at {}", format(source.at(mismatch->opened))));
      }
      reporter.error(source.at(mismatch->offset), mismatch->message, std::move(notes));
      return;
    }
  }
  auto offset = result.offset < 0 ? std::size_t{0} : static_cast<std::size_t>(result.offset);
  if (result.status == pugi::status_bad_comment) {
    const std::size_t lastEnd = source.text().rfind("-->");
    offset = source.text().find("<!--", lastEnd == std::string::npos ? 0 : lastEnd);
  }
  reporter.error(source.at(offset), explain(result.status));
}

/// The parser's tree with the offsets of attributes, which it does not keep: they are found by reading the tag again.
class Converter {
 public:
  Converter(const SourceText& source, Reporter& reporter) : source_(source), reporter_(reporter) {}

  std::optional<XmlElement> root(const pugi::xml_document& document) {
    std::optional<XmlElement> root;
    for (const pugi::xml_node node : document.children()) {
      if (isText(node)) {
        reportText(node, "outside the root element");
      } else if (node.type() == pugi::node_element && root) {
        reporter_.error(source_.at(tagOffset(node)),
                        fmt::format("a second root element <{}>: a file has only one", node.name()));
      } else if (node.type() == pugi::node_element) {
        root = element(node, 1);
      }
    }
    if (!root)
      reporter_.error(source_.at(0), "the file holds no element: a scene starts with <scene version=\"3.0.0\">");
    return root;
  }

 private:
  static bool isText(const pugi::xml_node& node) {
    return node.type() == pugi::node_pcdata || node.type() == pugi::node_cdata;
  }

  static std::size_t tagOffset(const pugi::xml_node& node) { return static_cast<std::size_t>(node.offset_debug()) - 1; }

  void reportText(const pugi::xml_node& node, const std::string& where) {
    auto offset = static_cast<std::size_t>(node.offset_debug());
    while (offset < source_.text().size() && isBlank(source_.text()[offset])) ++offset;
    reporter_.error(source_.at(offset), fmt::format("text {}: only elements and comments belong here", where));
  }

  XmlElement element(const pugi::xml_node& node, int depth) {
    XmlElement result;
    result.tag = node.name();
    result.offset = tagOffset(node);
    readAttributes(node, result);
    for (const pugi::xml_node child : node.children()) {
      if (isText(child) && (result.tag == "source" || result.tag == "group" || result.tag == "ShaderGroup")) {
        if (result.text.empty()) result.textOffset = static_cast<std::size_t>(child.offset_debug());
        result.text += child.value();
      } else if (isText(child)) {
        reportText(child, fmt::format("in <{}>", result.tag));
      } else if (child.type() != pugi::node_element) {
        continue;
      } else if (depth >= nestingLimit) {
        reporter_.error(source_.at(tagOffset(child)),
                        fmt::format("elements are nested more than {} deep", nestingLimit));
        break;
      } else {
        result.children.push_back(element(child, depth + 1));
      }
    }
    return result;
  }

  void readAttributes(const pugi::xml_node& node, XmlElement& result) const {
    const std::string& text = source_.text();
    std::size_t at = result.offset + 1;
    while (at < text.size() && !endsName(text[at])) ++at;
    for (const pugi::xml_attribute attribute : node.attributes()) {
      XmlAttribute read;
      read.name = attribute.name();
      read.value = attribute.value();
      while (at < text.size() && isBlank(text[at])) ++at;
      read.nameOffset = at;
      while (at < text.size() && text[at] != '"' && text[at] != '\'') ++at;
      const char quote = at < text.size() ? text[at] : '"';
      read.valueOffset = at + 1;
      at = std::min(text.find(quote, at + 1), text.size());
      const std::string_view raw =
          std::string_view(text).substr(std::min(read.valueOffset, at), at - std::min(read.valueOffset, at));
      read.exact = raw.find_first_of("&\r") == std::string_view::npos;
      if (at < text.size()) ++at;
      result.attributes.push_back(std::move(read));
    }
  }

  const SourceText& source_;
  Reporter& reporter_;
};

/// The first byte that no XML 1.0 file in UTF-8 may hold; npos when all is well.
std::size_t findBadByte(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c < 0x80) {
      if (c < 0x20 && !isBlank(text[i])) return i;
      ++i;
      continue;
    }
    const std::size_t length = c >= 0xF0 && c < 0xF5 ? 4 : c >= 0xE0 && c < 0xF0 ? 3 : c >= 0xC2 && c < 0xE0 ? 2 : 0;
    if (length == 0 || i + length > text.size()) return i;
    for (std::size_t k = 1; k < length; ++k) {
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80) return i;
    }
    i += length;
  }
  return std::string_view::npos;
}

}  // namespace

std::optional<XmlElement> readXml(const SourceText& source, Reporter& reporter) {
  const std::string& text = source.text();
  if (const std::size_t bad = findBadByte(text); bad != std::string_view::npos) {
    reporter.error(source.at(bad), fmt::format("the byte 0x{:02x} does not belong in an XML file in UTF-8",
                                               static_cast<unsigned char>(text[bad])));
    return std::nullopt;
  }
  pugi::xml_document document;
  constexpr unsigned flags = pugi::parse_default | pugi::parse_fragment;
  const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size(), flags, pugi::encoding_utf8);
  if (!result) {
    reportParseError(source, result, reporter);
    return std::nullopt;
  }
  return Converter(source, reporter).root(document);
}

}  // namespace aerosol::scene
