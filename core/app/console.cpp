#include "core/app/console.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

namespace aerosol::app {

Console standardConsole() {
  Console console;
  const char* const type = std::getenv("TERM");
  console.isTerminal = isatty(STDERR_FILENO) == 1 && type && std::string_view(type) != "dumb";
  winsize size{};
  if (console.isTerminal && ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
    console.columns = size.ws_col;
  }
  return console;
}

}  // namespace aerosol::app
