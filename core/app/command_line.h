// The command line: every option once, with its name, its help and its check.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/app/arguments.h"
#include "core/app/exit_code.h"

namespace aerosol::app {

/// The answer to a command line that asks for nothing but text: help, or what is wrong with it.
struct Reply {
  ExitCode code = ExitCode::success;  ///< Help goes to the standard output, everything else to the error output.
  std::string text;
};

/// `arguments` are those behind the program's name; `shaderPathVariable` is $AEROSOL_SHADER_PATH, folders between
/// colons. Nothing is looked up: files are not opened.
std::variant<Arguments, Reply> parseCommandLine(const std::vector<std::string>& arguments,
                                                std::string_view shaderPathVariable = {});

/// Names of the commands.
std::vector<std::string> commandNames();

/// The help of a command; of the whole program when `command` is empty.
std::string commandHelp(const std::string& command);

/// "x,y,w,h" in pixels: x and y at least 0, w and h at least 1.
std::optional<Crop> parseCrop(std::string_view text);

/// "a:b" with 0 ≤ a < b.
std::optional<SampleRange> parseSampleRange(std::string_view text);

}  // namespace aerosol::app
