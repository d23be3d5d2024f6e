#include "core/app/tools/group_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

namespace aerosol::app {

namespace {

struct Word {
  std::string text;
  bool isQuoted = false;
  int line = 1, column = 1;
};

bool isSpace(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

/// Words, strings in quotes, and `;` `[[` `]]` `=` `,` by themselves. `#` begins a comment.
std::vector<Word> splitWords(const std::string& text) {
  std::vector<Word> words;
  int line = 1, column = 1;
  std::size_t i = 0;
  const auto step = [&] {
    if (text[i++] == '\n') {
      ++line;
      column = 1;
    } else {
      ++column;
    }
  };
  while (i < text.size()) {
    if (isSpace(text[i])) {
      step();
    } else if (text[i] == '#') {
      while (i < text.size() && text[i] != '\n') step();
    } else if (text[i] == '"') {
      Word word{{}, true, line, column};
      for (step(); i < text.size() && text[i] != '"'; step()) {
        if (text[i] == '\\' && i + 1 < text.size()) {
          step();
          word.text += text[i] == 'n' ? '\n' : text[i] == 't' ? '\t' : text[i];
        } else {
          word.text += text[i];
        }
      }
      if (i < text.size()) step();
      words.push_back(std::move(word));
    } else {
      Word word{{}, false, line, column};
      const std::string two = text.substr(i, 2);
      if (two == "[[" || two == "]]") {
        word.text = two;
        step();
        step();
      } else if (std::string(";=,").find(text[i]) != std::string::npos) {
        word.text = text[i];
        step();
      } else {
        for (; i < text.size() && !isSpace(text[i]) && std::string(";=,\"#").find(text[i]) == std::string::npos &&
               text.compare(i, 2, "[[") != 0 && text.compare(i, 2, "]]") != 0;
             step())
          word.text += text[i];
      }
      words.push_back(std::move(word));
    }
  }
  words.push_back({{}, false, line, column});
  return words;
}

class GroupParser {
 public:
  GroupParser(const std::string& text, std::string file) : words_(splitWords(text)), file_(std::move(file)) {}

  Result<GroupText> parse() {
    while (!atEnd() && !errors_.hasErrors()) statement();
    if (!errors_.hasErrors() && !pending_.empty()) fail("parameters without a shader behind them");
    if (errors_.hasErrors()) return errors_;
    return std::move(group_);
  }

 private:
  const Word& peek() const { return words_[at_]; }
  bool atEnd() const { return at_ + 1 == words_.size(); }
  bool isSign(const char* sign) const { return !peek().isQuoted && peek().text == sign; }
  bool accept(const char* sign) {
    if (!isSign(sign)) return false;
    ++at_;
    return true;
  }
  void fail(std::string message) {
    errors_.error({file_, peek().line, peek().column}, std::move(message));
    at_ = words_.size() - 1;
  }
  std::string word(const char* what) {
    if (atEnd() || isSign(";")) {
      fail(fmt::format("expected {}", what));
      return {};
    }
    return words_[at_++].text;
  }
  void end() {
    if (!accept(";") && !atEnd()) fail(fmt::format("expected ';', found '{}'", peek().text));
  }

  void statement() {
    if (accept(";")) return;
    if (accept("param")) return parameter();
    if (accept("shader")) return shader();
    if (accept("connect")) return connection();
    // The type of a parameter may stand by itself.
    if (parseType(peek().text)) return parameter();
    fail(fmt::format("unknown statement '{}': known are param, shader, connect", peek().text));
  }

  void parameter() {
    const auto type = parseType(peek().text);
    if (!type) return fail(fmt::format("'{}' is not a type", peek().text));
    ++at_;
    NamedValue given;
    given.name = word("a parameter's name");
    std::vector<std::string> values;
    while (!atEnd() && !isSign(";") && !isSign("[[")) {
      if (!accept(",")) values.push_back(words_[at_++].text);
    }
    auto value = makeValue(*type, values);
    if (!value) return fail(fmt::format("these are not values of type {}", lang::toString(*type)));
    given.value = std::move(*value);
    hints(given);
    pending_.push_back(std::move(given));
    end();
  }

  static std::optional<TypedValue> makeValue(lang::Type type, std::vector<std::string> values) {
    if (type.base != lang::BaseType::string)
      return parseValue(type, values.empty() ? "0" : fmt::format("{}", fmt::join(values, ",")));
    if (type.arrayLength == lang::Type::unsized) type.arrayLength = std::max(1, static_cast<int>(values.size()));
    values.resize(type.isArray() ? static_cast<std::size_t>(type.arrayLength) : 1);
    return TypedValue{type, std::move(values)};
  }

  /// [[ int interpolated=1, int interactive=0 ]]
  void hints(NamedValue& given) {
    if (!accept("[[")) return;
    while (!atEnd() && !accept("]]")) {
      if (accept(",") || accept("int")) continue;
      const std::string name = word("a hint");
      if (!accept("=")) return fail("expected '='");
      const bool isOn = word("a number") != "0";
      if (name == "lockgeom") given.interpolated = !isOn;
      if (name == "interpolated") given.interpolated = isOn;
      if (name == "interactive") given.interactive = isOn;
    }
  }

  void shader() {
    ShadeLayer layer;
    layer.shader = word("a shader's name");
    if (!atEnd() && !isSign(";")) layer.layer = word("a layer's name");
    layer.values = std::exchange(pending_, {});
    group_.layers.push_back(std::move(layer));
    end();
  }

  /// "layer.parameter"; the parameter may have more points.
  std::pair<std::string, std::string> place() {
    const std::string text = word("layer.parameter");
    const std::size_t dot = text.find('.');
    if (dot == std::string::npos && !errors_.hasErrors()) fail("expected layer.parameter");
    return {text.substr(0, dot), dot == std::string::npos ? "" : text.substr(dot + 1)};
  }

  void connection() {
    const auto [fromLayer, output] = place();
    const auto [toLayer, input] = place();
    group_.connections.push_back({fromLayer, output, toLayer, input});
    end();
  }

  std::vector<Word> words_;
  std::string file_;
  std::size_t at_ = 0;
  std::vector<NamedValue> pending_;
  GroupText group_;
  Diagnostics errors_;
};

std::string valuesOf(const lang::ConstantValue& value) {
  if (const auto* integers = std::get_if<std::vector<std::int32_t>>(&value))
    return fmt::format("{}", fmt::join(*integers, " "));
  if (const auto* floats = std::get_if<std::vector<float>>(&value)) return fmt::format("{}", fmt::join(*floats, " "));
  std::string text;
  for (const std::string& each : std::get<std::vector<std::string>>(value)) {
    text += text.empty() ? "\"" : " \"";
    for (const char c : each) {
      if (c == '\n') {
        text += "\\n";
      } else {
        if (c == '"' || c == '\\') text += '\\';
        text += c;
      }
    }
    text += '"';
  }
  return text;
}

}  // namespace

Result<GroupText> parseGroupText(const std::string& text, const std::string& file) {
  return GroupParser(text, file).parse();
}

std::string printGroupText(const std::vector<ShadeLayer>& layers, const std::vector<ShadeConnection>& connections) {
  std::string text;
  for (const ShadeLayer& layer : layers) {
    for (const NamedValue& value : layer.values) {
      text += fmt::format("param {} {} {}", lang::toString(value.value.type), value.name, valuesOf(value.value.value));
      if (value.interpolated) text += " [[int interpolated=1]]";
      if (value.interactive) text += " [[int interactive=1]]";
      text += " ;\n";
    }
    text += fmt::format("shader {} {} ;\n", layer.shader, layer.layer);
  }
  for (const ShadeConnection& c : connections)
    text += fmt::format("connect {}.{} {}.{} ;\n", c.fromLayer, c.fromOutput, c.toLayer, c.toInput);
  return text;
}

}  // namespace aerosol::app
