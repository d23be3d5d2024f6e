#include <algorithm>
#include <exception>

#include "core/app/run.h"

int main(int argc, char** argv) {
  const aerosol::app::Console console = aerosol::app::standardConsole();
  try {
    return static_cast<int>(
        aerosol::app::run(argc > 0 ? argv[0] : "", {argv + std::min(argc, 1), argv + argc}, console));
  } catch (const std::exception& failure) {  // No memory left, above all.
    console.note(std::string("aerosol: error: ") + failure.what() + "\n");
    return static_cast<int>(aerosol::app::ExitCode::badInput);
  }
}
