// What the program says to whoever started it.
#pragma once

namespace aerosol::app {

enum class ExitCode : int {
  success = 0,
  badInput = 1,     ///< A scene, a shader or a file that cannot be used, here and now.
  usage = 2,        ///< A command line that no input would make right.
  interrupted = 3,  ///< By SIGINT or SIGTERM; the image so far is written.
};

}  // namespace aerosol::app
