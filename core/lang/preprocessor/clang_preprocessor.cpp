// The preprocessor: clang's, on files that the program provides. The only translation unit that sees clang's headers.
#include <clang/Basic/DiagnosticOptions.h>
#include <clang/Basic/FileManager.h>
#include <clang/Basic/LangOptions.h>
#include <clang/Basic/SourceManager.h>
#include <clang/Basic/TargetInfo.h>
#include <clang/Basic/TargetOptions.h>
#include <clang/Basic/Version.h>
#include <clang/Lex/HeaderSearch.h>
#include <clang/Lex/HeaderSearchOptions.h>
#include <clang/Lex/LexDiagnostic.h>
#include <clang/Lex/Lexer.h>
#include <clang/Lex/ModuleLoader.h>
#include <clang/Lex/PPCallbacks.h>
#include <clang/Lex/Pragma.h>
#include <clang/Lex/Preprocessor.h>
#include <clang/Lex/PreprocessorOptions.h>
#include <llvm/ADT/SmallString.h>
#include <llvm/Support/MemoryBuffer.h>
#include <llvm/Support/VirtualFileSystem.h>
#include <llvm/Support/thread.h>

#include <cctype>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/lang/preprocessor/interface.h"

namespace aerosol::lang::preprocessor {

namespace {

/// Includes entered in one run. clang bounds their depth, but two includes a file at full depth are 2^200 files.
constexpr unsigned maximumIncludes = 10000;
/// clang evaluates `#if` by recursion; the client bounds the length of a directive, this stack holds its parentheses.
constexpr unsigned stackBytes = 256u << 20;

std::string_view view(llvm::StringRef text) { return {text.data(), text.size()}; }
llvm::StringRef reference(std::string_view text) { return {text.data(), text.size()}; }

// Files --------------------------------------------------------------------------------------------------------------

class ClientFile final : public llvm::vfs::File {
 public:
  ClientFile(llvm::vfs::Status status, std::string_view text) : status_(std::move(status)), text_(text) {}

  llvm::ErrorOr<llvm::vfs::Status> status() override { return status_; }
  llvm::ErrorOr<std::unique_ptr<llvm::MemoryBuffer>> getBuffer(const llvm::Twine& name, std::int64_t, bool,
                                                               bool) override {
    return llvm::MemoryBuffer::getMemBuffer(reference(text_), name.str(), true);
  }
  std::error_code close() override { return {}; }

 private:
  llvm::vfs::Status status_;
  std::string_view text_;
};

class ClientFileSystem final : public llvm::vfs::FileSystem {
 public:
  explicit ClientFileSystem(Client& client) : client_(client) {}

  llvm::ErrorOr<llvm::vfs::Status> status(const llvm::Twine& path) override {
    const std::string name = path.str();
    const FileStatus status = client_.status(name);
    if (status.kind == FileKind::absent) return std::make_error_code(std::errc::no_such_file_or_directory);
    // Times are not told, so that __TIMESTAMP__ depends on nothing.
    return llvm::vfs::Status(name, llvm::sys::fs::UniqueID(status.device, status.inode), {}, 0, 0, status.size,
                             status.kind == FileKind::folder ? llvm::sys::fs::file_type::directory_file
                                                             : llvm::sys::fs::file_type::regular_file,
                             llvm::sys::fs::perms::all_read);
  }

  llvm::ErrorOr<std::unique_ptr<llvm::vfs::File>> openFileForRead(const llvm::Twine& path) override {
    const std::string name = path.str();
    auto fileStatus = status(name);
    if (!fileStatus) return fileStatus.getError();
    std::string_view text;
    if (!client_.read(name, text)) return std::make_error_code(std::errc::permission_denied);
    return std::make_unique<ClientFile>(llvm::vfs::Status::copyWithNewSize(*fileStatus, text.size()), text);
  }

  llvm::vfs::directory_iterator dir_begin(const llvm::Twine&, std::error_code& error) override {
    error = std::make_error_code(std::errc::function_not_supported);
    return {};
  }
  llvm::ErrorOr<std::string> getCurrentWorkingDirectory() const override {
    return std::make_error_code(std::errc::function_not_supported);
  }
  std::error_code setCurrentWorkingDirectory(const llvm::Twine&) override {
    return std::make_error_code(std::errc::function_not_supported);
  }

 private:
  Client& client_;
};

// Places -------------------------------------------------------------------------------------------------------------

/// From clang's locations to the client's files, lines and columns. Tokens come nearly in the order of their text, so
/// lines are counted from the last place of the file on.
class Places {
 public:
  Places(clang::SourceManager& sources, Client& client) : sources_(sources), client_(client) {}

  /// The place of a location that is not within a macro.
  Place file(clang::SourceLocation location) {
    if (location.isInvalid()) return {noFile, 0, 0};
    unsigned offset = 0;
    if (lastFile_.isInvalid() || !sources_.isInFileID(location, lastFile_, &offset)) {
      const auto decomposed = sources_.getDecomposedLoc(location);
      if (decomposed.first.isInvalid()) return {noFile, 0, 0};
      lastFile_ = decomposed.first;
      offset = decomposed.second;
      last_ = &cursor(lastFile_);
    }
    if (last_->file == noFile) return {noFile, 0, 0};
    if (offset < last_->offset || offset > last_->text.size()) {
      return {last_->file, sources_.getLineNumber(lastFile_, offset), sources_.getColumnNumber(lastFile_, offset)};
    }
    last_->advance(offset);
    return {last_->file, last_->line, offset - last_->lineStart + 1};
  }

  /// Tells the client when `#line` changes how lines are called.
  void follow(clang::SourceLocation location, const Place& place) {
    if (!sources_.hasLineTable() || place.file == noFile) return;
    const clang::PresumedLoc presumed = sources_.getPresumedLoc(location);
    if (presumed.isInvalid()) return;
    const auto offset = static_cast<std::int64_t>(presumed.getLine()) - static_cast<std::int64_t>(place.line);
    if (place.file == followedFile_ && offset == followedOffset_ && followedName_ == presumed.getFilename()) return;
    followedFile_ = place.file;
    followedOffset_ = offset;
    followedName_ = presumed.getFilename();
    client_.lineDirective(place.file, followedName_, offset);
  }

 private:
  struct Cursor {
    std::uint32_t file = noFile;
    std::string_view text;
    unsigned offset = 0;
    unsigned lineStart = 0;
    unsigned line = 1;

    /// A line ends with a line feed, a carriage return, or both.
    void advance(unsigned to) {
      for (; offset < to; ++offset) {
        const char c = text[offset];
        if (c != '\n' && (c != '\r' || (offset + 1 < text.size() && text[offset + 1] == '\n'))) continue;
        ++line;
        lineStart = offset + 1;
      }
    }
  };

  Cursor& cursor(clang::FileID file) {
    const auto [found, isNew] = cursors_.try_emplace(file.getHashValue());
    if (!isNew) return found->second;
    const auto buffer = sources_.getBufferOrNone(file);
    const auto entry = sources_.getFileEntryRefForID(file);
    if (buffer && entry) {
      found->second.text = view(buffer->getBuffer());
      found->second.file = client_.addFile(view(entry->getName()), found->second.text);
    }
    return found->second;
  }

  clang::SourceManager& sources_;
  Client& client_;
  clang::FileID lastFile_;
  Cursor* last_ = nullptr;
  std::map<unsigned, Cursor> cursors_;  ///< By file.
  std::uint32_t followedFile_ = noFile;
  std::int64_t followedOffset_ = 0;
  std::string followedName_;
};

// Messages -----------------------------------------------------------------------------------------------------------

/// A message at a location that may be invalid.
void sendMessage(Client& client, Places& places, const clang::SourceManager& sources, MessageLevel level,
                 clang::SourceLocation location, std::string_view text, std::string_view missingInclude = {}) {
  MessageEvent message;
  message.level = level;
  message.place = places.file(location);
  message.text = text;
  message.missingInclude = missingInclude;
  const clang::PresumedLoc presumed = location.isValid() ? sources.getPresumedLoc(location) : clang::PresumedLoc();
  if (presumed.isValid()) {
    message.fileName = presumed.getFilename();
    message.line = presumed.getLine();
  }
  client.message(message);
}

class Collector final : public clang::DiagnosticConsumer {
 public:
  Collector(Client& client, std::uint32_t maximumErrors) : client_(client), maximumErrors_(maximumErrors) {}

  void use(clang::SourceManager& sources, Places& places) {
    sources_ = &sources;
    places_ = &places;
  }

  bool tooManyErrors() const { return NumErrors >= maximumErrors_; }
  bool incomplete() const { return incomplete_; }

  void HandleDiagnostic(clang::DiagnosticsEngine::Level level, const clang::Diagnostic& info) override {
    using Level = clang::DiagnosticsEngine::Level;
    DiagnosticConsumer::HandleDiagnostic(level, info);
    if (level == Level::Ignored || level == Level::Remark) return;
    const unsigned id = info.getID();
    if (level == Level::Note) {
      if (dropped_) return;
    } else {
      dropped_ = isReportedByTheLexer(id) || (id == clang::diag::ext_pp_undef_builtin_macro && isPredefined(info));
      if (dropped_) return;
    }
    if (leavesSomethingOut(id)) incomplete_ = true;
    llvm::SmallString<128> text;
    info.FormatDiagnostic(text);
    std::string missing;
    if (id == clang::diag::err_pp_file_not_found && info.getNumArgs() > 0 &&
        info.getArgKind(0) == clang::DiagnosticsEngine::ak_std_string) {
      missing = info.getArgStdStr(0);
    }
    clang::SourceLocation location = info.getLocation();
    if (location.isValid()) location = sources_->getFileLoc(location);
    const MessageLevel messageLevel = level == Level::Note      ? MessageLevel::note
                                      : level == Level::Warning ? MessageLevel::warning
                                                                : MessageLevel::error;
    sendMessage(client_, *places_, *sources_, messageLevel, location, view(text), missing);
  }

 private:
  /// The lexer reports what is wrong with a token, with the language's own rules.
  static bool isReportedByTheLexer(unsigned id) {
    switch (id) {
      case clang::diag::ext_unterminated_char_or_string:
      case clang::diag::ext_empty_character:
      case clang::diag::warn_pragma_ignored:
      case clang::diag::pp_pragma_once_in_main_file:  // Headers are compiled alone, too.
        return true;
      default:
        return false;
    }
  }

  bool isPredefined(const clang::Diagnostic& info) const {
    return info.getLocation().isValid() && sources_->isWrittenInBuiltinFile(info.getLocation());
  }

  static bool leavesSomethingOut(unsigned id) {
    switch (id) {
      case clang::diag::err_pp_file_not_found:
      case clang::diag::err_pp_include_too_deep:
      case clang::diag::err_pp_unterminated_conditional:
      case clang::diag::err_unterminated_block_comment:
      case clang::diag::err_cannot_open_file:
      case clang::diag::err_file_too_large:
      case clang::diag::err_unsupported_bom:
        return true;
      default:
        return false;
    }
  }

  Client& client_;
  std::uint32_t maximumErrors_;
  clang::SourceManager* sources_ = nullptr;
  Places* places_ = nullptr;
  bool dropped_ = false;
  bool incomplete_ = false;
};

// Pragmas ------------------------------------------------------------------------------------------------------------

/// The text of the rest of a pragma's line.
std::string restOfLine(clang::Preprocessor& preprocessor) {
  std::string text;
  clang::Token token;
  for (preprocessor.LexUnexpandedToken(token); token.isNot(clang::tok::eod); preprocessor.LexUnexpandedToken(token)) {
    if (!text.empty() && token.hasLeadingSpace()) text += ' ';
    text += preprocessor.getSpelling(token);
  }
  return text;
}

/// `#pragma osl nowarn`; what else follows `osl` is unknown.
class OslPragma final : public clang::PragmaHandler {
 public:
  OslPragma(Client& client, Places& places) : PragmaHandler("osl"), client_(client), places_(places) {}

  void HandlePragma(clang::Preprocessor& preprocessor, clang::PragmaIntroducer introducer, clang::Token&) override {
    const clang::SourceLocation location = preprocessor.getSourceManager().getFileLoc(introducer.Loc);
    const auto& sources = preprocessor.getSourceManager();
    const std::string text = restOfLine(preprocessor);
    if (text == "nowarn") {
      client_.noWarnings(places_.file(location));
    } else {
      sendMessage(client_, places_, sources, MessageLevel::warning, location,
                  "unknown pragma '" + text + "' is ignored");
    }
  }

 private:
  Client& client_;
  Places& places_;
};

/// `#pragma error "message"` and `#pragma warning "message"`.
class MessagePragma final : public clang::PragmaHandler {
 public:
  MessagePragma(llvm::StringRef name, MessageLevel level, Client& client, Places& places)
      : PragmaHandler(name), level_(level), client_(client), places_(places) {}

  void HandlePragma(clang::Preprocessor& preprocessor, clang::PragmaIntroducer, clang::Token& first) override {
    const auto& sources = preprocessor.getSourceManager();
    const clang::SourceLocation location = sources.getFileLoc(first.getLocation());
    std::string text = restOfLine(preprocessor);
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    sendMessage(client_, places_, sources, level_, location, text);
  }

 private:
  MessageLevel level_;
  Client& client_;
  Places& places_;
};

void addPragmas(clang::Preprocessor& preprocessor, Client& client, Places& places) {
  preprocessor.AddPragmaHandler(new OslPragma(client, places));
  preprocessor.AddPragmaHandler(new MessagePragma("error", MessageLevel::error, client, places));
  preprocessor.AddPragmaHandler(new MessagePragma("warning", MessageLevel::warning, client, places));
  // clang's own pragmas load modules and crash on demand: this replaces them.
  preprocessor.AddPragmaHandler(new clang::EmptyPragmaHandler("clang"));
  preprocessor.AddPragmaHandler(new clang::EmptyPragmaHandler());
}

// The run ------------------------------------------------------------------------------------------------------------

/// Counts the files entered; past the limit every further file, and the current one, ends at once.
class IncludeLimit final : public clang::PPCallbacks {
 public:
  explicit IncludeLimit(clang::Preprocessor& preprocessor) : preprocessor_(preprocessor) {}

  void FileChanged(clang::SourceLocation, FileChangeReason reason, clang::SrcMgr::CharacteristicKind,
                   clang::FileID) override {
    if (reason == EnterFile && ++entered_ > maximumIncludes) {
      auto* lexer = static_cast<clang::Lexer*>(preprocessor_.getCurrentLexer());
      if (lexer) lexer->seek(static_cast<unsigned>(lexer->getBuffer().size()), false);
    }
  }

  bool exceeded() const { return entered_ > maximumIncludes; }

 private:
  clang::Preprocessor& preprocessor_;
  unsigned entered_ = 0;
};

/// Macros whose arguments are macros, each with its parameter several times, can grow beyond any memory before one
/// token comes out: past the limit no macro is expanded any more. What one call makes of an argument is as many copies
/// as its body has places for it; calls between two tokens are taken for nested ones.
class ExpansionLimit final : public clang::PPCallbacks {
 public:
  explicit ExpansionLimit(clang::Preprocessor& preprocessor) : preprocessor_(preprocessor) {}

  void MacroExpands(const clang::Token&, const clang::MacroDefinition& definition, clang::SourceRange,
                    const clang::MacroArgs*) override {
    const clang::MacroInfo* const macro = definition.getMacroInfo();
    if (!macro || !macro->isFunctionLike()) return;
    std::map<const clang::IdentifierInfo*, unsigned> places;
    unsigned most = 1;
    for (const clang::Token& token : macro->tokens()) {
      const clang::IdentifierInfo* const name = token.getIdentifierInfo();
      if (name && macro->getParameterNum(name) >= 0) most = std::max(most, ++places[name]);
    }
    copies_ *= most;
    if (!exceeded()) return;
    hasExceeded_ = true;
    preprocessor_.SetMacroExpansionOnlyInDirectives();
  }

  void tokenCameOut() { copies_ = 1; }
  bool exceeded() const { return hasExceeded_ || copies_ > 1e6; }

 private:
  clang::Preprocessor& preprocessor_;
  double copies_ = 1;
  bool hasExceeded_ = false;
};

clang::LangOptions languageOptions() {
  clang::LangOptions options;
  options.C99 = options.C11 = options.C17 = 1;
  options.LineComment = 1;
  options.GNUMode = 1;  // `, ##__VA_ARGS__`
  options.Digraphs = 0;
  options.Trigraphs = 0;
  options.DollarIdents = 0;
  return options;
}

TokenKind kindOf(const clang::Token& token) {
  if (token.getIdentifierInfo()) return TokenKind::identifier;
  switch (token.getKind()) {
    case clang::tok::numeric_constant:
      return TokenKind::number;
    case clang::tok::char_constant:
    case clang::tok::wide_char_constant:
    case clang::tok::utf8_char_constant:
    case clang::tok::utf16_char_constant:
    case clang::tok::utf32_char_constant:
      return TokenKind::character;
    case clang::tok::unknown:
      return TokenKind::unknown;
    default:
      return token.isLiteral() ? TokenKind::string : TokenKind::punctuator;
  }
}

class Run {
 public:
  Run(const Request& request, Client& client)
      : request_(request),
        client_(client),
        collector_(client, request.maximumErrors),
        diagnostics_(new clang::DiagnosticIDs, new clang::DiagnosticOptions, &collector_, false),
        files_(clang::FileSystemOptions(), new ClientFileSystem(client)),
        sources_(diagnostics_, files_),
        places_(sources_, client),
        language_(languageOptions()),
        target_(makeTarget()),
        headers_(std::make_shared<clang::HeaderSearchOptions>(), sources_, diagnostics_, language_, target_.get()),
        preprocessor_(preprocessorOptions(), diagnostics_, language_, sources_, headers_, modules_) {
    diagnostics_.setFatalsAsError(true);  // Otherwise the first one silences all that follow.
    collector_.use(sources_, places_);
    preprocessor_.Initialize(*target_);
    // clang 19 crashes on _Pragma in an #include: the operator is understood in `pragmaOperator` instead.
    preprocessor_.setPredefines("#undef _Pragma\n" + std::string(request.predefines));
    addPragmas(preprocessor_, client_, places_);
    auto limit = std::make_unique<IncludeLimit>(preprocessor_);
    includeLimit_ = limit.get();
    preprocessor_.addPPCallbacks(std::move(limit));
    auto expansions = std::make_unique<ExpansionLimit>(preprocessor_);
    expansionLimit_ = expansions.get();
    preprocessor_.addPPCallbacks(std::move(expansions));
    for (std::uint32_t i = 0; i < request.includePathCount; ++i) {
      if (const auto folder = files_.getOptionalDirectoryRef(reference(request.includePaths[i]))) {
        headers_.AddSearchPath(clang::DirectoryLookup(*folder, clang::SrcMgr::C_User, false), true);
      }
    }
  }

  bool run() {
    const clang::FileEntryRef main =
        files_.getVirtualFileRef(reference(request_.mainName), static_cast<off_t>(request_.mainText.size()), 0);
    sources_.overrideFileContents(
        main, llvm::MemoryBuffer::getMemBuffer(reference(request_.mainText), reference(request_.mainName), true));
    sources_.setMainFileID(sources_.createFileID(main, clang::SourceLocation(), clang::SrcMgr::C_User));
    collector_.BeginSourceFile(language_, &preprocessor_);
    preprocessor_.EnterMainSourceFile();
    const bool complete = tokens();
    collector_.EndSourceFile();
    return complete && !collector_.incomplete();
  }

 private:
  static std::shared_ptr<clang::PreprocessorOptions> preprocessorOptions() {
    auto options = std::make_shared<clang::PreprocessorOptions>();
    options->DisablePragmaDebugCrash = true;
    options->SourceDateEpoch = 0;  // __DATE__ and __TIME__ are the same every day.
    return options;
  }

  /// The machine of `#if` arithmetic: the same everywhere.
  clang::IntrusiveRefCntPtr<clang::TargetInfo> makeTarget() {
    auto options = std::make_shared<clang::TargetOptions>();
    options->Triple = "x86_64-unknown-linux-gnu";
    return clang::TargetInfo::CreateTargetInfo(diagnostics_, options);
  }

  bool tokens() {
    clang::Token token;
    for (std::uint32_t count = 0;; ++count) {
      preprocessor_.Lex(token);
      const bool isPragma = !token.isAnnotation() && token.getIdentifierInfo() == pragmaWord_;
      if (isPragma) pragmaOperator(token);
      if (includeLimit_->exceeded()) return stop(token, "too many files are included");
      if (expansionLimit_->exceeded()) return stop(token, "macros inside of macros grow without end");
      expansionLimit_->tokenCameOut();
      if (token.is(clang::tok::eof)) {
        client_.end(places_.file(sources_.getFileLoc(token.getLocation())));
        return true;
      }
      if (count >= request_.maximumTokens) return stop(token, "the source is too long after preprocessing");
      if (collector_.tooManyErrors()) return stop(token, {});
      if (token.isAnnotation()) return stop(token, "this directive has no place in a shader");
      if (!isPragma) emit(token);
    }
  }

  /// `_Pragma("…")`, of which `token` is the first one and becomes the last.
  void pragmaOperator(clang::Token& token) {
    const clang::SourceLocation location = sources_.getFileLoc(token.getLocation());
    std::string text;
    for (const auto kind : {clang::tok::l_paren, clang::tok::string_literal, clang::tok::r_paren}) {
      preprocessor_.Lex(token);
      if (token.isNot(kind)) return sendError(location, "_Pragma takes a string in parentheses");
      if (kind == clang::tok::string_literal) text = preprocessor_.getSpelling(token);
    }
    if (text == "\"osl nowarn\"") client_.noWarnings(places_.file(location));
  }

  void emit(const clang::Token& token) {
    const clang::SourceLocation location = token.getLocation();
    const clang::SourceLocation fileLocation = sources_.getFileLoc(location);
    TokenEvent event;
    event.kind = kindOf(token);
    event.place = places_.file(fileLocation);
    event.definition.file = noFile;
    if (location.isMacroID()) describeExpansion(location, fileLocation, event);
    places_.follow(fileLocation, event.place);
    if (event.kind == TokenKind::punctuator) {
      const char* text = clang::tok::getPunctuatorSpelling(token.getKind());
      event.text = text ? text : "";
      client_.token(event);
    } else if (location.isFileID() && !token.needsCleaning()) {
      event.text = {sources_.getCharacterData(location), token.getLength()};
      client_.token(event);
    } else {
      llvm::SmallString<64> buffer;
      event.text = view(preprocessor_.getSpelling(token, buffer));
      client_.token(event);
    }
  }

  /// A token from a macro's body, rather than from its arguments: names the macro and tells where it was defined.
  void describeExpansion(clang::SourceLocation location, clang::SourceLocation fileLocation, TokenEvent& event) {
    if (sources_.getExpansionLoc(location) != fileLocation) return;
    if (fileLocation != lastExpansion_) {
      lastExpansion_ = fileLocation;
      lastDefinition_ = {noFile, 0, 0};
      const char* name = sources_.getCharacterData(fileLocation);
      std::size_t length = 0;
      while (std::isalnum(static_cast<unsigned char>(name[length])) || name[length] == '_') ++length;
      lastMacro_ = {name, length};
      const auto* information = preprocessor_.getMacroInfo(preprocessor_.getIdentifierInfo(reference(lastMacro_)));
      if (information) lastDefinition_ = places_.file(information->getDefinitionLoc());
    }
    event.definition = lastDefinition_;
    event.macro = lastMacro_;
  }

  bool stop(const clang::Token& token, std::string_view why) {
    const clang::SourceLocation location = sources_.getFileLoc(token.getLocation());
    if (!why.empty()) sendError(location, why);
    client_.end(places_.file(location));
    return false;
  }

  void sendError(clang::SourceLocation location, std::string_view text) {
    sendMessage(client_, places_, sources_, MessageLevel::error, location, text);
  }

  const Request& request_;
  Client& client_;
  Collector collector_;
  clang::DiagnosticsEngine diagnostics_;
  clang::FileManager files_;
  clang::SourceManager sources_;
  Places places_;
  clang::LangOptions language_;
  clang::IntrusiveRefCntPtr<clang::TargetInfo> target_;
  clang::HeaderSearch headers_;
  clang::TrivialModuleLoader modules_;
  clang::Preprocessor preprocessor_;
  IncludeLimit* includeLimit_ = nullptr;
  ExpansionLimit* expansionLimit_ = nullptr;
  const clang::IdentifierInfo* pragmaWord_ = preprocessor_.getIdentifierInfo("_Pragma");
  clang::SourceLocation lastExpansion_;
  Place lastDefinition_;
  std::string_view lastMacro_;
};

}  // namespace

extern "C" __attribute__((visibility("default"))) bool aerosolPreprocess(const Request& request, Client& client) {
  bool complete = false;
  llvm::thread thread(std::optional<unsigned>(stackBytes), [&] { complete = Run(request, client).run(); });
  thread.join();
  return complete;
}

extern "C" __attribute__((visibility("default"))) const char* aerosolClangVersion() { return CLANG_VERSION_STRING; }

}  // namespace aerosol::lang::preprocessor
