// The two streams of the program and what stands at their other end.
#pragma once

#include <cstdio>
#include <string_view>

#include "core/base/diagnostic.h"

namespace aerosol::app {

/// Results go to `out`, messages to the user and progress to `err`.
struct Console {
  std::FILE* out = stdout;
  std::FILE* err = stderr;
  bool isTerminal = false;  ///< `err` is a terminal on which a line can be rewritten.
  int columns = 80;         ///< Of the terminal.

  void print(std::string_view text) const { std::fwrite(text.data(), 1, text.size(), out); }
  void note(std::string_view text) const { std::fwrite(text.data(), 1, text.size(), err); }
  void report(const Diagnostics& diagnostics) const { note(format(diagnostics)); }
  void report(const Diagnostic& diagnostic) const { note(format(diagnostic)); }
};

/// For work whose messages were told before.
class SilentConsole {
 public:
  SilentConsole() : stream_(std::fopen("/dev/null", "w")) { console_.err = console_.out = stream_; }
  ~SilentConsole() { std::fclose(stream_); }
  SilentConsole(const SilentConsole&) = delete;
  SilentConsole& operator=(const SilentConsole&) = delete;
  const Console& get() const { return console_; }

 private:
  std::FILE* stream_;
  Console console_;
};

/// The process's own streams.
Console standardConsole();

}  // namespace aerosol::app
