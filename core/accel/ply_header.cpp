#include "core/accel/ply_header.h"

#include <algorithm>
#include <utility>

namespace aerosol::accel {

namespace {

std::optional<PlyType> typeNamed(std::string_view name) {
  static constexpr std::pair<std::string_view, PlyType> names[] = {
      {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
      {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
      {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
      {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
      {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
      {"float64", PlyType::float64}};
  const auto* found = std::ranges::find(names, name, &std::pair<std::string_view, PlyType>::first);
  if (found == std::end(names)) return {};
  return found->second;
}

struct Word {
  std::string_view text;
  std::size_t offset = 0;
};

class HeaderParser {
 public:
  explicit HeaderParser(const TextSource& source) : source_(source) {}

  Result<PlyHeader> parse() {
    if (!readLine() || words_.size() != 1 || words_[0].text != "ply") {
      return source_.at(0, "not a PLY file: it does not begin with a line 'ply'");
    }
    bool hasFormat = false;
    while (readLine()) {
      if (words_.empty() || words_[0].text == "comment" || words_[0].text == "obj_info") continue;
      if (words_[0].text == "end_header") {
        if (!hasFormat) return source_.at(words_[0].offset, "the header has no 'format' line");
        header_.dataOffset = position_;
        return finish();
      }
      if (words_[0].text == "format") {
        hasFormat = true;
        parseFormat();
      } else if (words_[0].text == "element") {
        parseElement();
      } else if (words_[0].text == "property") {
        parseProperty();
      } else {
        fail(0, "'" + std::string(words_[0].text) +
                    "' is not a header word; known are: format element property comment obj_info end_header");
      }
      if (errors_.hasErrors()) return errors_;
    }
    return source_.at(source_.text().size(), "the file ends before 'end_header'");
  }

 private:
  bool readLine() {
    const std::string_view text = source_.text();
    words_.clear();
    if (position_ >= text.size()) return false;
    lineStart_ = position_;
    const std::size_t end = std::min(text.find('\n', position_), text.size());
    while (position_ < end) {
      if (text[position_] == ' ' || text[position_] == '\t' || text[position_] == '\r') {
        ++position_;
        continue;
      }
      const std::size_t wordEnd = std::min(text.find_first_of(" \t\r\n", position_), end);
      words_.push_back({text.substr(position_, wordEnd - position_), position_});
      position_ = wordEnd;
    }
    position_ = end + 1;
    return true;
  }

  void fail(std::size_t word, std::string message) {
    const std::size_t offset = word < words_.size() ? words_[word].offset : lineStart_;
    errors_.add(source_.at(offset, std::move(message)));
  }

  void parseFormat() {
    if (words_.size() != 3 || words_[2].text != "1.0") return fail(0, "expected 'format NAME 1.0'");
    if (words_[1].text == "ascii") {
      header_.format = PlyFormat::ascii;
    } else if (words_[1].text == "binary_little_endian") {
      header_.format = PlyFormat::littleEndian;
    } else if (words_[1].text == "binary_big_endian") {
      header_.format = PlyFormat::bigEndian;
    } else {
      fail(1, "'" + std::string(words_[1].text) +
                  "' is not a format; known are: ascii binary_little_endian binary_big_endian");
    }
  }

  void parseElement() {
    if (words_.size() != 3) return fail(0, "expected 'element NAME COUNT'");
    const auto count = parseInteger(words_[2].text);
    if (!count || *count < 0) return fail(2, "'" + std::string(words_[2].text) + "' is not a count");
    header_.elements.push_back({std::string(words_[1].text), static_cast<std::uint64_t>(*count), {}, words_[2].offset});
  }

  void parseProperty() {
    if (header_.elements.empty()) return fail(0, "a property before the first element");
    const bool isList = words_.size() == 5 && words_[1].text == "list";
    if (!isList && words_.size() != 3)
      return fail(0, "expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    PlyProperty property;
    property.offset = words_[0].offset;
    property.name = words_.back().text;
    for (std::size_t i = isList ? 2 : 1; i + 1 < words_.size(); ++i) {
      const auto type = typeNamed(words_[i].text);
      if (!type) {
        return fail(
            i, "'" + std::string(words_[i].text) +
                   "' is not a type; known are: char uchar short ushort int uint float double (or int8 … float64)");
      }
      if (isList && i == 2) {
        if (!isInteger(*type)) return fail(i, "the length of a list is an integer");
        property.countType = type;
      } else {
        property.type = *type;
      }
    }
    header_.elements.back().properties.push_back(std::move(property));
  }

  Result<PlyHeader> finish() {
    std::uint64_t left = source_.text().size() - std::min(header_.dataOffset, source_.text().size());
    for (const PlyElement& element : header_.elements) {
      const std::uint64_t least = element.leastBytes(header_.format);
      // The last record of ASCII data may lack its line end.
      const std::uint64_t available = left + (header_.format == PlyFormat::ascii ? 1 : 0);
      if (least > 0 && element.count > available / least) {
        return source_.at(element.offset,
                          "the file is too short for " + std::to_string(element.count) + " of '" + element.name + "'");
      }
      left -= std::min(left, least * element.count);
    }
    return std::move(header_);
  }

  const TextSource& source_;
  Diagnostics errors_;
  PlyHeader header_;
  std::vector<Word> words_;
  std::size_t position_ = 0, lineStart_ = 0;
};

}  // namespace

std::size_t PlyElement::leastBytes(PlyFormat format) const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) {
    constexpr std::size_t digitAndBlank = 2;
    bytes += format == PlyFormat::ascii ? digitAndBlank : sizeOf(property.countType.value_or(property.type));
  }
  return bytes;
}

Result<PlyHeader> parsePlyHeader(const TextSource& source) { return HeaderParser(source).parse(); }

}  // namespace aerosol::accel
