// What the program and the preprocessor's module share: plain structures and abstract classes.
#pragma once

#include <cstdint>
#include <string_view>

namespace aerosol::lang::preprocessor {

enum class FileKind : std::uint8_t { absent, file, folder };

struct FileStatus {
  FileKind kind = FileKind::absent;
  std::uint64_t size = 0;
  std::uint64_t device = 0;  ///< With `inode`: the identity of a file that has several names.
  std::uint64_t inode = 0;
};

/// As PpTokenKind.
enum class TokenKind : std::uint8_t { identifier, number, string, character, punctuator, unknown };

enum class MessageLevel : std::uint8_t { note, warning, error };

/// A physical place: `file` as given by `Client::addFile`, or `noFile`.
struct Place {
  std::uint32_t file = 0;
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};
inline constexpr std::uint32_t noFile = 0xffffffffu;

struct TokenEvent {
  TokenKind kind{};
  std::string_view text;  ///< Valid during the call, unless it lies within the text of a file.
  Place place;
  std::string_view macro;  ///< The macro, as used in the file, from whose body the token came; or empty.
  Place definition;        ///< Where that macro was defined; `file` is `noFile` when that is in no file.
};

struct MessageEvent {
  MessageLevel level{};
  Place place;
  std::string_view fileName;  ///< As `#line` has it.
  std::uint32_t line = 0;     ///< As `#line` has it.
  std::string_view text;
  std::string_view missingInclude;  ///< The name of the file that an #include did not find.
};

/// The program's side: provides files and receives what comes out.
class Client {
 public:
  virtual FileStatus status(std::string_view path) = 0;
  /// The contents; they stay valid as long as the client, and a zero byte follows them. False when unreadable.
  virtual bool read(std::string_view path, std::string_view& text) = 0;
  /// Names a file that tokens or messages are about to refer to; returns its index.
  virtual std::uint32_t addFile(std::string_view name, std::string_view text) = 0;
  virtual void token(const TokenEvent& token) = 0;
  virtual void end(const Place& place) = 0;
  /// From the next token on, lines of `file` are called `name` and count `lineOffset` more.
  virtual void lineDirective(std::uint32_t file, std::string_view name, std::int64_t lineOffset) = 0;
  /// `#pragma osl nowarn` at this place.
  virtual void noWarnings(const Place& place) = 0;
  virtual void message(const MessageEvent& message) = 0;

 protected:
  ~Client() = default;
};

struct Request {
  std::string_view mainName;
  std::string_view mainText;    ///< A zero byte follows.
  std::string_view predefines;  ///< Lines in front of the main file.
  const std::string_view* includePaths = nullptr;
  std::uint32_t includePathCount = 0;
  std::uint32_t maximumTokens = 0;
  std::uint32_t maximumErrors = 0;
};

/// False when a limit stopped the preprocessor.
using PreprocessFunction = bool(const Request& request, Client& client);
inline constexpr const char* preprocessFunctionName = "aerosolPreprocess";

/// "19.1.7": of the clang that the module works with.
using ClangVersionFunction = const char*();
inline constexpr const char* clangVersionFunctionName = "aerosolClangVersion";

}  // namespace aerosol::lang::preprocessor
