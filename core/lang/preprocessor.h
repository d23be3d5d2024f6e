// The C preprocessor in front of the language: a file and what it includes become one stream of tokens.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/result.h"
#include "core/lang/compile.h"
#include "core/lang/source_map.h"

namespace aerosol::lang {

/// The version of the language that shaders see as OSL_VERSION (10000 major + 100 minor + patch).
inline constexpr int oslVersionMajor = 1;
inline constexpr int oslVersionMinor = 14;
inline constexpr int oslVersionPatch = 5;
inline constexpr int oslVersion = 10000 * oslVersionMajor + 100 * oslVersionMinor + oslVersionPatch;

/// Files (the main one and each included one) may be this large.
inline constexpr std::size_t maximumSourceBytes = std::size_t{16} << 20;
/// Tokens after all includes and macros.
inline constexpr std::size_t maximumTokens = std::size_t{1} << 20;

struct PreprocessRequest {
  std::string mainFile;  ///< Path; with `text` its name in messages. Includes are searched in its folder first.
  std::optional<std::string> text;  ///< The main file's contents, when they are not to be read from `mainFile`.
  std::vector<std::filesystem::path> includePaths;
  std::vector<std::string> defines;    ///< NAME (defined as 1) or NAME=VALUE.
  std::vector<std::string> undefines;  ///< Removed before `defines` count.
  /// Included before the first line (stdosl.h); empty: nothing. Its folder is searched last. An explicit include of a
  /// file of its name means this file, wherever a file of that name lies, and has no further effect.
  std::filesystem::path prelude;
};

enum class PpTokenKind : std::uint8_t {
  identifier,
  number,     ///< In the wide sense of C: a digit, or a point and a digit, and everything that clings to it.
  string,     ///< With its quotes.
  character,  ///< 'c' with its quotes.
  punctuator,
  unknown,  ///< A stray character, or a string that ends with its line.
};

struct PpToken {
  PpTokenKind kind{};
  std::string_view text;
  Position position = 0;
};

struct PreprocessResult {
  std::vector<PpToken> tokens;
  Position end = 0;  ///< The end of the main file.
  std::shared_ptr<SourceMap> sourceMap = std::make_shared<SourceMap>();
  std::vector<Dependency> dependencies;  ///< Absolute paths; without the main file when its text was given.
  Diagnostics diagnostics;
  /// False when the tokens miss something (an include that was not found, a limit): syntax errors would mislead.
  bool complete = true;
  std::shared_ptr<const void> storage;  ///< Owns what `tokens` view.
};

/// Runs the preprocessor (clang's, loaded at first use). Comments are gone, adjacent strings are not yet joined.
PreprocessResult preprocess(const PreprocessRequest& request);

/// "19.1.7": the version of the preprocessor's clang, which is loaded for this.
Result<std::string> clangVersion();

}  // namespace aerosol::lang
