#include "core/lang/compiled_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/base/hash.h"
#include "core/lang/preprocessor.h"

namespace aerosol::lang {

namespace {

constexpr std::string_view firstLine = "AerosolShader 1\n";
constexpr std::string_view sourceLine = "source\n";

std::string inQuotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

/// Tokens as lines again, each at the line and (where macros leave room) the column from which it came.
class Printer {
 public:
  void print(std::string_view text, const SourceLocation& at) {
    if (text.empty()) return;
    moveTo(at, text.front());
    text_ += text;
    column_ += static_cast<int>(text.size());
    line_ += static_cast<int>(std::ranges::count(text, '\n'));
  }
  std::string take() {
    if (!text_.empty()) text_ += '\n';
    return std::move(text_);
  }

 private:
  void moveTo(const SourceLocation& at, char next) {
    constexpr int fewLines = 8;
    const bool isFar = at.file != file_ || at.line < line_ || at.line > line_ + fewLines;
    if (isFar) {
      if (!text_.empty()) text_ += '\n';
      text_ += fmt::format("# {} {}\n", at.line, inQuotes(at.file));
      file_ = at.file;
      line_ = at.line;
      column_ = 1;
    }
    while (line_ < at.line) {
      text_ += '\n';
      ++line_;
      column_ = 1;
    }
    if (at.column == column_ && !(column_ > 1 && wouldJoin(text_.back(), next))) return;
    const int blanks = std::max(1, at.column - column_);
    text_.append(static_cast<std::size_t>(blanks), ' ');
    column_ += blanks;
  }

  /// Tokens of macros may end where the next one began: two words would become one, two operators another one.
  static bool wouldJoin(char last, char next) {
    const auto isWord = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
    constexpr std::string_view operators = "+-*/%&|^<>=!:#";
    const auto isOperator = [&](char c) { return operators.find(c) != std::string_view::npos; };
    return (isWord(last) && isWord(next)) || (isOperator(last) && isOperator(next));
  }

  std::string text_, file_;
  int line_ = 0, column_ = 1;
};

}  // namespace

Result<Preprocessed> preprocessFile(const std::filesystem::path& path, const CompileOptions& options) {
  PreprocessRequest request{.mainFile = path.string(),
                            .text = {},
                            .includePaths = options.includePaths,
                            .defines = options.defines,
                            .undefines = options.undefines,
                            .prelude = options.standardLibrary};
  PreprocessResult result = preprocess(request);
  if (!result.complete || result.diagnostics.hasErrors()) return result.diagnostics;
  Printer printer;
  for (const PpToken& token : result.tokens) {
    if (result.sourceMap->isInPrelude(token.position)) continue;
    printer.print(token.text, result.sourceMap->location(token.position));
  }
  return Preprocessed{printer.take(), std::move(result.dependencies), std::move(result.diagnostics)};
}

std::string compiledFileText(const Preprocessed& source, const std::string& kind, const std::string& name,
                             const std::vector<std::string>& comments) {
  std::string text(firstLine);
  for (const std::string& comment : comments) text += "# " + comment + "\n";
  text += fmt::format("{} {}\n{}{}", kind, name, sourceLine, source.text);
  return text;
}

Result<std::string> sourceOfCompiledFile(const std::string& text, const std::string& path) {
  const auto refuse = [&](std::string why, std::vector<std::string> notes = {}) {
    return Diagnostic{Severity::error, {path, 0, 0}, std::move(why), {}, std::move(notes)};
  };
  if (text.starts_with("OpenShadingLanguage"))
    return refuse("this file was compiled for another renderer", {"compile the shader's source: aerosol compile -o"});
  if (!text.starts_with(firstLine)) return refuse("this is not a compiled shader");
  const std::size_t begin = text.find("\n" + std::string(sourceLine));
  if (begin == std::string::npos) return refuse("this compiled shader is not complete");
  return text.substr(begin + 1 + sourceLine.size());
}

Result<ParsedSource> parseShaderFile(const std::filesystem::path& path, const CompileOptions& options) {
  if (!isCompiledFile(path)) return parseFile(path, options);
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return Diagnostic{Severity::error, {path.string(), 0, 0}, "cannot read this file", {}, {}};
  const auto source = sourceOfCompiledFile(text, path.string());
  if (!source) return source.errors();
  auto parsed = parseString(*source, path.string(), options);
  if (parsed) {
    std::error_code ignored;
    parsed->dependencies.push_back({std::filesystem::absolute(path, ignored), StrongHash().add(text).hex()});
  }
  return parsed;
}

bool isCompiledFile(const std::filesystem::path& path) { return path.extension() == ".oso"; }

}  // namespace aerosol::lang
