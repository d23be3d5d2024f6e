#include "core/lang/preprocessor.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <fstream>
#include <map>
#include <unordered_set>

#include "core/base/hash.h"
#include "core/base/module.h"
#include "core/lang/lexer.h"
#include "core/lang/preprocessor/interface.h"

namespace aerosol::lang {

namespace {

namespace fs = std::filesystem;
using preprocessor::FileKind;
using preprocessor::FileStatus;

/// A preprocessor directive (with its continuation lines) may be this long: clang evaluates `#if` by recursion.
constexpr std::size_t maximumDirectiveBytes = std::size_t{1} << 16;

/// Copies of short texts that stay where they are.
class TextArena {
 public:
  std::string_view copy(std::string_view text) {
    if (text.size() > left_) {
      left_ = std::max(chunkBytes, text.size());
      chunks_.push_back(std::make_unique<char[]>(left_));
      next_ = chunks_.back().get();
    }
    if (!text.empty()) std::memcpy(next_, text.data(), text.size());
    const std::string_view result(next_, text.size());
    next_ += text.size();
    left_ -= text.size();
    return result;
  }

 private:
  static constexpr std::size_t chunkBytes = 16384;
  std::vector<std::unique_ptr<char[]>> chunks_;
  char* next_ = nullptr;
  std::size_t left_ = 0;
};

/// What the tokens of a result view.
struct Storage {
  TextArena arena;
  std::map<std::string, std::shared_ptr<const std::string>, std::less<>> texts;  ///< By path.
};

FileStatus systemStatus(const std::string& path) {
  struct stat status{};
  if (path.find('\0') != std::string::npos || stat(path.c_str(), &status) != 0) return {};
  FileStatus result;
  if (S_ISDIR(status.st_mode)) {
    result.kind = FileKind::folder;
  } else if (S_ISREG(status.st_mode)) {
    result.kind = FileKind::file;
  }
  result.size = static_cast<std::uint64_t>(status.st_size);
  result.device = status.st_dev;
  result.inode = status.st_ino;
  return result;
}

/// The file's contents, or why they cannot be had.
std::optional<std::string> readFile(const std::string& path, std::string& text) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return fmt::format("cannot read this file: {}", std::strerror(errno));
  text.clear();
  char buffer[1 << 16];
  while (text.size() <= maximumSourceBytes && (stream.read(buffer, sizeof buffer) || stream.gcount() > 0)) {
    text.append(buffer, static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) return "cannot read this file: input error";
  return std::nullopt;
}

/// The first line (from 1) whose directive is longer than is allowed, or 0.
std::uint32_t findOverlongDirective(std::string_view text) {
  std::uint32_t line = 1;
  std::size_t begin = 0;
  while (begin < text.size()) {
    std::uint32_t lines = 0;
    std::size_t end = begin;
    do {
      end = text.find('\n', end == begin ? end : end + 1);
      ++lines;
    } while (end != std::string_view::npos && end > begin &&
             (text[end - 1] == '\\' || (text[end - 1] == '\r' && end > begin + 1 && text[end - 2] == '\\')));
    if (end == std::string_view::npos) end = text.size();
    if (end - begin > maximumDirectiveBytes) {
      const std::size_t first = text.find_first_not_of(" \t\v\f\r", begin);
      const bool mayBeDirective = first != std::string_view::npos && (text[first] == '#' || text[first] == '/');
      if (mayBeDirective && text.substr(first, end - first).find('#') != std::string_view::npos) return line;
    }
    line += lines;
    begin = end + 1;
  }
  return 0;
}

/// Reports why the text cannot be given to the preprocessor, if it cannot.
bool refuse(const std::string& name, std::string_view text, Diagnostics& diagnostics) {
  if (text.size() > maximumSourceBytes) {
    diagnostics.error({.file = name}, fmt::format("this file is larger than {} MiB", maximumSourceBytes >> 20));
    return true;
  }
  if (const std::uint32_t line = findOverlongDirective(text)) {
    diagnostics.error({.file = name, .line = static_cast<int>(line), .column = 1},
                      fmt::format("this line is longer than {} KiB, the limit for a preprocessor directive",
                                  maximumDirectiveBytes >> 10));
    return true;
  }
  return false;
}

/// The prelude's path, absolute, so that it is one string however it is found.
fs::path preludeFile(const PreprocessRequest& request) {
  if (request.prelude.empty()) return {};
  std::error_code error;
  const fs::path absolute = fs::absolute(request.prelude, error);
  return error ? request.prelude : absolute;
}

/// The folders that are searched for includes, after that of the including file.
std::vector<std::string> searchFolders(const PreprocessRequest& request) {
  std::vector<std::string> folders;
  const auto add = [&](std::string folder) {
    if (std::find(folders.begin(), folders.end(), folder) == folders.end()) folders.push_back(std::move(folder));
  };
  for (const auto& path : request.includePaths) add(path.empty() ? "." : path.lexically_normal().string());
  if (!request.prelude.empty()) add(preludeFile(request).parent_path().lexically_normal().string());
  return folders;
}

// The client ----------------------------------------------------------------------------------------------------------

class FileClient final : public preprocessor::Client {
 public:
  FileClient(const PreprocessRequest& request, PreprocessResult& result)
      : request_(request), result_(result), storage_(std::make_shared<Storage>()) {
    result.storage = storage_;
    preludePath_ = preludeFile(request).string();
    preludeName_ = request.prelude.filename().string();
  }

  /// Takes the main file in. False, with an error in the result, when it cannot be read.
  bool openMain() {
    const std::string& name = request_.mainFile;
    if (request_.text) {
      auto text = std::make_shared<const std::string>(*request_.text);
      if (!accept(name, *text)) return false;
      storage_->texts.insert_or_assign(name, std::move(text));
      return true;
    }
    auto text = std::make_shared<std::string>();
    std::error_code error;
    std::optional<std::string> problem;
    if (fs::is_directory(name, error)) problem = "this is a folder, not a file";
    if (!problem) problem = readFile(name, *text);
    if (problem) {
      result_.diagnostics.error({.file = name}, *problem);
      return false;
    }
    if (!accept(name, *text)) return false;
    addDependency(name, StrongHash().add(*text).hex());
    storage_->texts.emplace(name, std::move(text));
    return true;
  }

  std::string_view mainText() const { return *storage_->texts.at(request_.mainFile); }

  /// False, with an error in the result, when there is a prelude and it cannot be read.
  bool openPrelude() {
    if (preludePath_.empty()) return true;
    std::string_view text;
    if (read(preludePath_, text)) return true;
    if (!result_.diagnostics.hasErrors()) {
      result_.diagnostics.error({.file = preludePath_}, "cannot read the standard library's header");
    }
    return false;
  }

  FileStatus status(std::string_view path) override {
    const std::string name(path);
    if (const auto known = statuses_.find(name); known != statuses_.end()) return known->second;
    FileStatus status = systemStatus(name);
    if (name == request_.mainFile && request_.text) {
      if (status.kind != FileKind::file) status = {FileKind::file, request_.text->size(), ~std::uint64_t{0}, 1};
    } else if (status.kind != FileKind::folder && isAnotherPrelude(name)) {
      status = {};
    } else if (status.kind == FileKind::absent) {
      addDependency(name, {});
    }
    statuses_.emplace(name, status);
    return status;
  }

  bool read(std::string_view path, std::string_view& text) override {
    const std::string name(path);
    auto found = storage_->texts.find(name);
    if (found == storage_->texts.end()) {
      auto content = std::make_shared<std::string>();
      if (readFile(name, *content) || !accept(name, *content)) return false;
      addDependency(name, StrongHash().add(*content).hex());
      found = storage_->texts.emplace(name, std::move(content)).first;
    }
    text = *found->second;
    return true;
  }

  std::uint32_t addFile(std::string_view clangName, std::string_view text) override {
    const std::string_view name = shown(clangName);
    for (std::uint32_t i = 0; i < files_.size(); ++i) {
      if (files_[i].data() == text.data() && fileNames_[i] == name) return i;
    }
    std::shared_ptr<const void> owner;
    for (const auto& [path, content] : storage_->texts) {
      if (content->data() == text.data()) owner = content;
    }
    if (!owner) {
      auto copy = std::make_shared<const std::string>(text);
      text = *copy;
      owner = copy;
    }
    const bool isPrelude = !preludePath_.empty() && name == preludePath_;
    files_.push_back(text);
    fileNames_.emplace_back(name);
    return result_.sourceMap->addFile(std::string(name), text, std::move(owner), isPrelude);
  }

  void token(const preprocessor::TokenEvent& event) override {
    PpToken token;
    token.kind = static_cast<PpTokenKind>(event.kind);
    token.text = keep(event.text);
    token.position = add(event.place);
    if (!event.macro.empty()) {
      const auto& definition = event.definition;
      result_.sourceMap->addExpansion(event.macro, {definition.file, definition.line, definition.column});
    }
    result_.tokens.push_back(token);
  }

  void end(const preprocessor::Place& place) override { result_.end = add(place); }

  void lineDirective(std::uint32_t file, std::string_view name, std::int64_t lineOffset) override {
    result_.sourceMap->addLineDirective(file, std::string(name), lineOffset);
  }

  void noWarnings(const preprocessor::Place& place) override {
    result_.sourceMap->suppressWarnings(place.file, place.line);
  }

  void message(const preprocessor::MessageEvent& event) override;

 private:
  /// clang writes "./file.h" for what lies beside a main file without a folder.
  std::string_view shown(std::string_view name) const {
    if (name.starts_with("./") && !request_.mainFile.starts_with("./")) name.remove_prefix(2);
    return name;
  }

  void addDependency(const std::string& path, std::string hash) {
    if (!seen_.insert(path).second) return;
    std::error_code error;
    const fs::path absolute = fs::absolute(shown(path), error);
    result_.dependencies.push_back({error ? fs::path(path) : absolute, std::move(hash)});
  }

  /// Whether the path is a file of the prelude's name that is not the prelude (nor the main file).
  bool isAnotherPrelude(const std::string& name) const {
    return !preludeName_.empty() && name != preludePath_ && name != request_.mainFile &&
           fs::path(name).filename() == preludeName_;
  }

  bool accept(const std::string& name, std::string_view text) {
    if (!refuse(name, text, result_.diagnostics)) return true;
    result_.complete = false;
    return false;
  }

  Position add(const preprocessor::Place& place) {
    if (place.file == preprocessor::noFile) return 0;
    return result_.sourceMap->add({place.file, place.line, place.column});
  }

  std::string_view keep(std::string_view text) {
    for (const std::string_view file : files_) {
      if (!std::less<>()(text.data(), file.data()) && std::less<>()(text.data(), file.data() + file.size()))
        return text;
    }
    return storage_->arena.copy(text);
  }

  const PreprocessRequest& request_;
  PreprocessResult& result_;
  std::shared_ptr<Storage> storage_;
  std::string preludePath_, preludeName_;
  std::map<std::string, FileStatus> statuses_;
  std::unordered_set<std::string> seen_;  ///< Paths among the dependencies.
  std::vector<std::string_view> files_;   ///< Texts by index.
  std::vector<std::string> fileNames_;
  bool lastMessageKept_ = false;
};

void FileClient::message(const preprocessor::MessageEvent& event) {
  auto& entries = result_.diagnostics.entries();
  SourceLocation location{std::string(shown(event.fileName)), static_cast<int>(event.line), 0};
  if (event.place.file == preprocessor::noFile) {
    location = {.file = request_.mainFile};
  } else {
    location.column = static_cast<int>(event.place.column);
  }
  if (event.level == preprocessor::MessageLevel::note) {
    if (lastMessageKept_ && !entries.empty()) {
      entries.back().notes.push_back(
          location.line > 0 ? fmt::format("{} ({}:{}:{})", event.text, location.file, location.line, location.column)
                            : std::string(event.text));
    }
    return;
  }
  Diagnostic diagnostic;
  diagnostic.severity = event.level == preprocessor::MessageLevel::error ? Severity::error : Severity::warning;
  diagnostic.location = std::move(location);
  diagnostic.message = event.text.empty() ? "this directive gives no reason" : std::string(event.text);
  if (event.place.file != preprocessor::noFile) {
    diagnostic.sourceLine = result_.sourceMap->shownLine(event.place.file, event.place.line);
  }
  if (!event.missingInclude.empty()) {
    diagnostic.message = fmt::format("cannot find the included file '{}'", event.missingInclude);
    for (const std::string& folder : searchFolders(request_))
      diagnostic.notes.push_back("searched in '" + folder + "'");
  }
  const bool suppressed = diagnostic.severity == Severity::warning && event.place.file != preprocessor::noFile &&
                          result_.sourceMap->warningsSuppressed(event.place.file, event.place.line);
  lastMessageKept_ = !suppressed && result_.diagnostics.errorCount() < maximumErrors;
  if (lastMessageKept_) result_.diagnostics.add(std::move(diagnostic));
}

// Predefines ----------------------------------------------------------------------------------------------------------

/// The `#define` line for NAME, NAME=VALUE or NAME(a,b)=VALUE; nothing when malformed.
std::optional<std::string> defineLine(std::string_view define) {
  const std::size_t equals = define.find('=');
  const std::string_view name = define.substr(0, equals);
  const std::string_view value = equals == std::string_view::npos ? "1" : define.substr(equals + 1);
  const auto isWord = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  std::size_t end = 0;
  while (end < name.size() && isWord(name[end])) ++end;
  const bool wellFormed = end > 0 && !std::isdigit(static_cast<unsigned char>(name[0])) &&
                          (end == name.size() || (name[end] == '(' && name.back() == ')'));
  if (!wellFormed || define.find_first_of("\r\n") != std::string_view::npos || value.ends_with('\\'))
    return std::nullopt;
  return fmt::format("#define {} {}\n", name, value);
}

/// The lines in front of the main file.
std::string predefines(const PreprocessRequest& request, Diagnostics& diagnostics) {
  std::string lines = fmt::format(
      "#define OSL_VERSION_MAJOR {0}\n#define OSL_VERSION_MINOR {1}\n#define OSL_VERSION_PATCH {2}\n"
      "#define OSL_VERSION {3}\n",
      oslVersionMajor, oslVersionMinor, oslVersionPatch, oslVersion);
  for (const std::string& name : request.undefines) {
    const auto define = defineLine(name);
    if (define && name.find_first_of("=(") == std::string::npos) {
      lines += fmt::format("#undef {}\n", name);
    } else {
      diagnostics.error({.file = "-U " + name}, "this is not the name of a macro");
    }
  }
  for (const std::string& define : request.defines) {
    if (const auto line = defineLine(define)) {
      lines += *line;
    } else {
      diagnostics.error({.file = "-D " + define}, "this is not a macro definition",
                        {"a definition is NAME or NAME=VALUE, where NAME is made of letters, digits and '_'"});
    }
  }
  if (!request.prelude.empty()) lines += fmt::format("#include \"{}\"\n", preludeFile(request).string());
  return lines;
}

}  // namespace

PreprocessResult preprocess(const PreprocessRequest& request) {
  PreprocessResult result;
  FileClient client(request, result);
  const std::string lines = predefines(request, result.diagnostics);
  const auto module = openModule("aerosol_preprocessor");
  if (!module) result.diagnostics.append(module.errors());
  if (result.diagnostics.hasErrors() || !client.openMain() || !client.openPrelude()) {
    result.complete = false;
    return result;
  }
  const auto run = module->function<preprocessor::PreprocessFunction>(preprocessor::preprocessFunctionName);
  if (!run) {
    result.diagnostics.append(run.errors());
    result.complete = false;
    return result;
  }
  const std::vector<std::string> folders = searchFolders(request);
  const std::vector<std::string_view> paths(folders.begin(), folders.end());
  preprocessor::Request moduleRequest;
  moduleRequest.mainName = request.mainFile;
  moduleRequest.mainText = client.mainText();
  moduleRequest.predefines = lines;
  moduleRequest.includePaths = paths.data();
  moduleRequest.includePathCount = static_cast<std::uint32_t>(paths.size());
  moduleRequest.maximumTokens = static_cast<std::uint32_t>(maximumTokens);
  moduleRequest.maximumErrors = maximumErrors;
  if (!(*run)(moduleRequest, client)) result.complete = false;
  return result;
}

Result<std::string> clangVersion() {
  const auto module = openModule("aerosol_preprocessor");
  if (!module) return module.errors();
  const auto version = module->function<preprocessor::ClangVersionFunction>(preprocessor::clangVersionFunctionName);
  if (!version) return version.errors();
  return std::string((*version)());
}

}  // namespace aerosol::lang
