#include "core/lang/native.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

namespace aerosol::lang {

namespace {

constexpr std::string_view mark = "native|";

std::vector<std::string> wordsOf(std::string_view text) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < text.size();) {
    const auto isWord = [&](std::size_t at) {
      return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
    };
    if (isWord(i)) {
      const std::size_t begin = i;
      while (isWord(i)) ++i;
      words.emplace_back(text.substr(begin, i - begin));
    } else {
      if (std::isspace(static_cast<unsigned char>(text[i])) == 0) words.emplace_back(1, text[i]);
      ++i;
    }
  }
  return words;
}

bool isType(const std::string& word, bool isResult) {
  static constexpr std::array<std::string_view, 8> types = {"float", "int",    "string", "color",
                                                            "point", "vector", "normal", "matrix"};
  return std::ranges::find(types, word) != types.end() || (isResult && word == "void");
}

}  // namespace

std::string nativeSymbol(const NativeName& name) {
  return std::string(mark) + name.contentHash + "|" + name.signature + "|" + name.file.string();
}

std::optional<NativeName> parseNativeSymbol(std::string_view symbol) {
  if (!symbol.starts_with(mark)) return {};
  symbol.remove_prefix(mark.size());
  const std::size_t hash = symbol.find('|');
  const std::size_t signature = hash == std::string_view::npos ? hash : symbol.find('|', hash + 1);
  if (signature == std::string_view::npos) return {};
  return NativeName{std::string(symbol.substr(signature + 1)), std::string(symbol.substr(0, hash)),
                    std::string(symbol.substr(hash + 1, signature - hash - 1))};
}

std::optional<std::string> nativeSignature(std::string_view declaration) {
  const std::vector<std::string> words = wordsOf(declaration);
  std::size_t at = 0;
  const auto next = [&]() -> std::string { return at < words.size() ? words[at++] : std::string(); };
  const auto peek = [&]() -> std::string_view { return at < words.size() ? std::string_view(words[at]) : ""; };
  const std::string result = next(), name = next();
  if (!isType(result, true) || name.empty() || std::isalpha(static_cast<unsigned char>(name[0])) == 0) return {};
  std::string signature = result + " " + name + "(";
  if (next() != "(") return {};
  for (bool isFirst = true; peek() != ")"; isFirst = false) {
    if (!isFirst && next() != ",") return {};
    if (!isFirst) signature += ",";
    if (peek() == "output") signature += next() + " ";
    const std::string type = next();
    if (!isType(type, false)) return {};
    signature += type;
    if (peek() != "," && peek() != ")" && peek() != "[") next();
    if (peek() == "[") {
      next();
      const std::string length = peek() == "]" ? std::string() : next();
      if (next() != "]") return {};
      signature += "[" + length + "]";
    }
  }
  return signature + ")";
}

bool attachNatives(Program& program, NativeSource* source) {
  for (FunctionUse& function : program.functions) {
    if (!function.host || !parseNativeSymbol(function.symbol)) continue;
    function.native = source ? source->findSymbol(function.symbol) : nullptr;
    if (!function.native) return false;
  }
  return true;
}

}  // namespace aerosol::lang
