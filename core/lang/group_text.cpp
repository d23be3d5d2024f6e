#include "core/lang/group_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/lang/fold.h"

namespace aerosol::lang {

namespace {

constexpr int maximumGroupErrors = 100;
constexpr std::size_t longestShownLine = 1000;
constexpr int maximumValues = 1 << 20;  ///< Of one array.

struct Word {
  enum class Kind { word, string, separator, openHints, closeHints, equals, end };
  Kind kind = Kind::end;
  std::string text;  ///< Of a string, without its quotes and escapes.
  std::size_t offset = 0;
};

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

/// Cuts the text into words, and knows places in it.
class Words {
 public:
  Words(std::string_view text, const SourceLocation& start, Diagnostics& diagnostics)
      : text_(text), start_(start), diagnostics_(diagnostics) {
    lines_.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i)
      if (text[i] == '\n') lines_.push_back(i + 1);
    advance();
  }

  const Word& peek() const { return next_; }
  Word take() {
    Word word = std::move(next_);
    advance();
    return word;
  }
  bool at(Word::Kind kind) const { return next_.kind == kind; }
  /// Is it the end of a statement?
  bool atEnd() const { return at(Word::Kind::separator) || at(Word::Kind::end); }

  SourceLocation place(std::size_t offset) const {
    const std::size_t line = lineOf(offset);
    SourceLocation location = start_;
    location.line += static_cast<int>(line);
    location.column = static_cast<int>(offset - lines_[line]) + (line == 0 ? start_.column : 1);
    return location;
  }

  void error(std::size_t offset, std::string message, std::vector<std::string> notes = {}) {
    if (diagnostics_.errorCount() >= maximumGroupErrors) return;
    const std::size_t line = lineOf(offset);
    std::string_view shown = text_.substr(lines_[line]);
    shown = shown.substr(0, shown.find_first_of("\r\n"));
    // The first line stands behind something else when the text is part of a file.
    if (shown.size() > longestShownLine || (line == 0 && start_.column > 1)) shown = {};
    diagnostics_.add({Severity::error, place(offset), std::move(message), std::string(shown), std::move(notes)});
  }

 private:
  std::size_t lineOf(std::size_t offset) const {
    return static_cast<std::size_t>(std::upper_bound(lines_.begin(), lines_.end(), offset) - lines_.begin()) - 1;
  }

  void skipBlanks() {
    while (at_ < text_.size() && (isBlank(text_[at_]) || text_[at_] == '#')) {
      if (text_[at_] == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else {
        ++at_;
      }
    }
  }

  void advance() {
    skipBlanks();
    next_ = {Word::Kind::end, {}, at_};
    if (at_ == text_.size()) return;
    const std::string_view rest = text_.substr(at_);
    if (rest[0] == '"') {
      readString();
    } else if (rest.starts_with("[[") || rest.starts_with("]]")) {
      next_.kind = rest[0] == '[' ? Word::Kind::openHints : Word::Kind::closeHints;
      next_.text = rest.substr(0, 2);
      inHints_ = rest[0] == '[';
      at_ += 2;
    } else if (rest[0] == ';' || rest[0] == ',' || (rest[0] == '=' && inHints_)) {
      next_.kind = rest[0] == '=' ? Word::Kind::equals : Word::Kind::separator;
      next_.text = rest.substr(0, 1);
      ++at_;
    } else {
      next_.kind = Word::Kind::word;
      std::size_t length = 0;
      while (length < rest.size() && !isBlank(rest[length]) && rest[length] != ';' && rest[length] != ',' &&
             rest[length] != '"' && !(inHints_ && rest[length] == '=') && !rest.substr(length).starts_with("[[") &&
             !rest.substr(length).starts_with("]]"))
        ++length;
      next_.text = rest.substr(0, length);
      at_ += length;
    }
  }

  void readString() {
    next_.kind = Word::Kind::string;
    std::size_t i = at_ + 1;
    for (; i < text_.size() && text_[i] != '"' && text_[i] != '\n'; ++i) {
      if (text_[i] == '\\' && i + 1 < text_.size() && text_[i + 1] != '\n') {
        const char c = text_[++i];
        next_.text += c == 'n' ? '\n' : c == 't' ? '\t' : c == 'r' ? '\r' : c;
      } else {
        next_.text += text_[i];
      }
    }
    if (i < text_.size() && text_[i] == '"') {
      at_ = i + 1;
    } else {
      error(at_, "this string does not end on its line: a '\"' is missing");
      at_ = i;
    }
  }

  std::string_view text_;
  SourceLocation start_;
  Diagnostics& diagnostics_;
  std::vector<std::size_t> lines_;  ///< Offset of each line.
  std::size_t at_ = 0;
  bool inHints_ = false;
  Word next_;
};

struct NamedType {
  std::string_view name;
  Type type;
};
constexpr std::array<NamedType, 8> typeNames = {{{"int", types::integer},
                                                 {"float", types::floating},
                                                 {"string", types::string},
                                                 {"color", types::color},
                                                 {"point", types::point},
                                                 {"vector", types::vector},
                                                 {"normal", types::normal},
                                                 {"matrix", types::matrix}}};

template <class Number>
std::optional<Number> parseNumber(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (end != text.data() + text.size() || text.empty()) return std::nullopt;
  if constexpr (std::is_floating_point_v<Number>) {
    // What is too small to be told from 0 is 0.
    if (error == std::errc::result_out_of_range) {
      const double wide = std::strtod(std::string(text).c_str(), nullptr);
      if (std::abs(wide) < 1) return static_cast<Number>(wide);
    }
  }
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

class Parser {
 public:
  Parser(std::string_view text, const SourceLocation& start) : words_(text, start, diagnostics_) {}

  Result<GroupText> run() {
    while (!words_.at(Word::Kind::end) && diagnostics_.errorCount() < maximumGroupErrors) {
      if (words_.at(Word::Kind::separator)) {
        words_.take();
        continue;
      }
      statement();
    }
    if (!pending_.empty() && !diagnostics_.hasErrors())
      diagnostics_.error(pending_.front().location,
                         fmt::format("no shader follows for the parameter '{}'", pending_.front().parameter));
    if (diagnostics_.hasErrors()) return diagnostics_;
    return std::move(group_);
  }

 private:
  void statement() {
    const Word word = words_.take();
    bool good = false;
    if (word.kind == Word::Kind::word && word.text == "param") {
      good = parameter();
    } else if (word.kind == Word::Kind::word && word.text == "shader") {
      good = shader();
    } else if (word.kind == Word::Kind::word && word.text == "connect") {
      good = connection();
    } else {
      words_.error(word.offset, fmt::format("'{}' is no statement of a shader group", word.text),
                   {"statements: param, shader, connect"});
    }
    if (good && !words_.atEnd()) {
      words_.error(words_.peek().offset, fmt::format("unexpected '{}' after the statement", words_.peek().text),
                   {"statements end with ';'"});
      good = false;
    }
    if (good) return;
    while (!words_.at(Word::Kind::end) && !(words_.at(Word::Kind::separator) && words_.peek().text == ";"))
      words_.take();
  }

  /// A word or a string; an error names what is missing.
  bool take(const char* what, Word& word) {
    if (!words_.at(Word::Kind::word) && !words_.at(Word::Kind::string)) {
      words_.error(words_.peek().offset, fmt::format("{} is missing here", what));
      return false;
    }
    word = words_.take();
    return true;
  }

  std::optional<Type> type(const Word& word, bool& isUnsized) {
    std::string_view text = word.text;
    const std::size_t bracket = std::min(text.find('['), text.size());
    const NamedType* found = nullptr;
    for (const NamedType& known : typeNames)
      if (known.name == text.substr(0, bracket)) found = &known;
    text.remove_prefix(bracket);
    // The length may be a word of its own.
    std::string length(text);
    if (length.empty() && words_.at(Word::Kind::word) && words_.peek().text.starts_with('['))
      length = words_.take().text;
    if (!found) {
      std::vector<std::string> known;
      for (const NamedType& one : typeNames) known.emplace_back(one.name);
      std::vector<std::string> notes;
      if (const std::string hint = didYouMean(word.text, known); !hint.empty()) notes.push_back(hint);
      notes.emplace_back("types: int, float, string, color, point, vector, normal, matrix, and arrays of them");
      words_.error(word.offset, fmt::format("'{}' is no type of a parameter", word.text), std::move(notes));
      return std::nullopt;
    }
    if (length.empty()) return found->type;
    isUnsized = length == "[]";
    if (isUnsized) return found->type;
    const auto count =
        length.ends_with(']') ? parseNumber<int>(std::string_view(length).substr(1, length.size() - 2)) : std::nullopt;
    if (!count || *count < 1 || *count > maximumValues) {
      words_.error(word.offset, fmt::format("'{}' is no length of an array: a number from 1 to {} in brackets", length,
                                            maximumValues));
      return std::nullopt;
    }
    return found->type.arrayOf(*count);
  }

  bool parameter() {
    Word typeWord, name;
    bool isUnsized = false;
    if (!take("the type of a parameter", typeWord)) return false;
    const auto known = type(typeWord, isUnsized);
    if (!known || !take("the name of a parameter", name)) return false;
    GivenValue given{name.text, *known, {}, words_.place(name.offset), {}};
    if (!values(given, isUnsized)) return false;
    if (words_.at(Word::Kind::openHints) && !hints(given)) return false;
    pending_.push_back(std::move(given));
    return true;
  }

  bool values(GivenValue& given, bool isUnsized) {
    const std::size_t single = leafCount(given.type.element());
    const std::size_t most = isUnsized ? single * static_cast<std::size_t>(maximumValues) : leafCount(given.type);
    std::size_t count = 0;
    const auto read = [&](auto example, auto&& convert) {
      std::vector<decltype(example)> leaves;
      while (words_.at(Word::Kind::word) || words_.at(Word::Kind::string)) {
        const Word word = words_.take();
        auto leaf = convert(word);
        if (!leaf) {
          words_.error(word.offset, fmt::format("'{}' is no {}", word.text, toString(elementOf(given.type))));
          return false;
        }
        if (++count > most) {
          words_.error(word.offset, fmt::format("too many values: a {} has {}", toString(given.type), most));
          return false;
        }
        leaves.push_back(std::move(*leaf));
      }
      if (isUnsized)
        given.type = given.type.arrayOf(static_cast<int>(std::max<std::size_t>(1, (count + single - 1) / single)));
      leaves.resize(leafCount(given.type));
      given.value = std::move(leaves);
      return true;
    };
    if (given.type.base == BaseType::string) {
      return read(std::string(), [](const Word& word) { return std::optional(word.text); });
    }
    const auto isNumber = [](const Word& word) { return word.kind == Word::Kind::word; };
    if (given.type.base == BaseType::integer) {
      return read(std::int32_t(), [&](const Word& word) {
        return isNumber(word) ? parseNumber<std::int32_t>(word.text) : std::nullopt;
      });
    }
    return read(float(),
                [&](const Word& word) { return isNumber(word) ? parseNumber<float>(word.text) : std::nullopt; });
  }

  /// What one written value is.
  static Type elementOf(const Type& type) {
    return type.base == BaseType::integer || type.base == BaseType::string ? type.element() : types::floating;
  }

  /// `[[ int lockgeom = 0, string label = "x" ]]`
  bool hints(GivenValue& given) {
    words_.take();
    while (!words_.at(Word::Kind::closeHints)) {
      Word typeWord, name;
      bool isUnsized = false;
      if (!take("the type of a hint", typeWord)) return false;
      const auto known = type(typeWord, isUnsized);
      if (!known || !take("the name of a hint", name)) return false;
      if (!words_.at(Word::Kind::equals)) {
        words_.error(words_.peek().offset, fmt::format("'=' and a value are missing after the hint '{}'", name.text));
        return false;
      }
      words_.take();
      GivenValue value{name.text, *known, {}, {}, {}};
      if (!values(value, isUnsized)) return false;
      given.hints.push_back({name.text, value.type, std::move(value.value)});
      if (words_.at(Word::Kind::separator)) {
        words_.take();
      } else if (!words_.at(Word::Kind::closeHints)) {
        words_.error(words_.peek().offset, "']]' is missing here");
        return false;
      }
    }
    words_.take();
    return true;
  }

  bool shader() {
    Word name, layer;
    if (!take("the name of a shader", name)) return false;
    layer = name;
    if (!words_.atEnd() && !take("the name of a layer", layer)) return false;
    group_.layers.push_back(
        {name.text, layer.text, std::move(pending_), words_.place(name.offset), words_.place(layer.offset)});
    pending_.clear();
    return true;
  }

  bool connection() {
    Word source, target;
    if (!take("the output to connect", source) || !take("the parameter to connect it to", target)) return false;
    Connection connection;
    if (!cut(source, connection.sourceLayer, connection.source) || !cut(target, connection.layer, connection.parameter))
      return false;
    connection.sourceLocation = words_.place(source.offset);
    connection.location = words_.place(target.offset);
    group_.connections.push_back(std::move(connection));
    return true;
  }

  /// At the first '.' behind the name of a layer; names of layers may have dots in them.
  bool cut(const Word& word, std::string& layer, std::string& parameter) {
    std::size_t dot = word.text.find('.');
    for (std::size_t at = dot; at != std::string::npos; at = word.text.find('.', at + 1)) {
      const std::string name = word.text.substr(0, at);
      if (dot != at && std::none_of(group_.layers.begin(), group_.layers.end(),
                                    [&](const GroupText::Layer& known) { return known.name == name; }))
        continue;
      dot = at;
    }
    if (dot == std::string::npos || dot == 0 || dot + 1 == word.text.size()) {
      words_.error(word.offset, fmt::format("'{}' has to be written layer.parameter", word.text));
      return false;
    }
    layer = word.text.substr(0, dot);
    parameter = word.text.substr(dot + 1);
    return true;
  }

  Diagnostics diagnostics_;
  Words words_;
  std::vector<GivenValue> pending_;
  GroupText group_;
};

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    switch (c) {
      case '\n':
        result += "\\n";
        break;
      case '\t':
        result += "\\t";
        break;
      case '\r':
        result += "\\r";
        break;
      default:
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
  }
  return result + "\"";
}

std::string valueText(const ConstantValue& value) {
  std::string text;
  if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&value))
    for (const std::int32_t leaf : *ints) text += fmt::format(" {}", leaf);
  if (const auto* floats = std::get_if<std::vector<float>>(&value))
    for (const float leaf : *floats) text += fmt::format(" {}", leaf);
  if (const auto* strings = std::get_if<std::vector<std::string>>(&value))
    for (const std::string& leaf : *strings) text += " " + quoted(leaf);
  return text;
}

}  // namespace

Result<GroupText> parseGroup(std::string_view text, const SourceLocation& start) {
  if (text.size() > maximumGroupTextBytes) {
    Diagnostics errors;
    errors.error(start, fmt::format("the text of a shader group is at most {} MiB long", maximumGroupTextBytes >> 20));
    return errors;
  }
  return Parser(text, start).run();
}

std::string format(const GroupText& group) {
  std::string text;
  for (const GroupText::Layer& layer : group.layers) {
    for (const GivenValue& given : layer.values) {
      text += fmt::format("param {} {}{}", toString(given.type), given.parameter, valueText(given.value));
      for (std::size_t i = 0; i < given.hints.size(); ++i)
        text += fmt::format("{} {} {} ={}", i == 0 ? " [[" : ",", toString(given.hints[i].type), given.hints[i].name,
                            valueText(given.hints[i].value));
      text += given.hints.empty() ? " ;\n" : " ]] ;\n";
    }
    text += fmt::format("shader {} {} ;\n", quoted(layer.shader), quoted(layer.name));
  }
  for (const Connection& c : group.connections)
    text += fmt::format("connect {}.{} {}.{} ;\n", c.sourceLayer, c.source, c.layer, c.parameter);
  return text;
}

}  // namespace aerosol::lang
