#include "core/app/tools/info_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "core/app/quantity.h"
#include "core/app/toolchain.h"
#include "core/app/tools/option_table.h"
#include "core/app/tools/shader_files.h"
#include "core/app/voxel_report.h"
#include "core/base/paths.h"
#include "core/grid/grid_file.h"
#include "core/shading/native_plugins.h"

namespace aerosol::app {

namespace {

namespace fs = std::filesystem;

struct InfoArguments {
  std::vector<std::string> shaders;
  std::string searchPath;
  InfoStyle style;
  bool statistics = false;
  bool help = false;
};

std::vector<OptionRow> infoRows(InfoArguments& info) {
  return {{"v", "", "Metadata too, and one fact a line", setFlag(info.style.verbose)},
          {"p", "DIRS", "Look for shaders in these folders, separated by colons", setText(info.searchPath)},
          {"param", "NAME", "This parameter alone", setText(info.style.parameter)},
          {"runstats", "", "Print how long reading took", setFlag(info.statistics)},
          {"help,h", "", "Show this help", setFlag(info.help)}};
}

lang::CompileOptions compileOptions(const Installation& installation) {
  lang::CompileOptions options;
  options.includePaths = {installation.shaders};
  options.standardLibrary = installation.shaders / "stdosl.h";
  options.natives = openPlugins({"", installation.shaders, installation.plugins});
  return options;
}

/// A plugin's functions, as shaders declare them.
bool describePlugin(const std::filesystem::path& file, const Console& console) {
  const auto plugin = shading::NativePlugins({}).open(file, {});
  if (!plugin) {
    console.report(plugin.errors());
    return false;
  }
  console.print(fmt::format("plugin \"{}\"{}\n", (*plugin)->name, (*plugin)->shader.empty() ? "" : ", with a shader"));
  const std::string stem = file.stem().string();
  for (std::size_t i = 0; i < (*plugin)->functions.size(); ++i)
    console.print(fmt::format("    {} [[ string native = \"{}\" ]];{}\n", (*plugin)->declarations[i], stem,
                              (*plugin)->functions[i]->hasRange ? "  // with a range version" : ""));
  return true;
}

}  // namespace

std::string infoHelp() {
  InfoArguments info;
  return "Show what shaders take and give: types, defaults, metadata\n"
         "Usage: aerosol info [OPTIONS] SHADER...   (in the manner of OSL's oslinfo)\n"
         "       aerosol info FILE.vdb...   lists the grids of OpenVDB files: types, bounds, values\n\n" +
         optionHelp(infoRows(info));
}

ExitCode infoCommand(const ToolArguments& arguments, const Console& console) {
  InfoArguments info;
  const auto addShader = [&info](const std::string& name) -> std::optional<std::string> {
    info.shaders.push_back(name);
    return {};
  };
  if (const auto problem = readOptions(arguments.words, infoRows(info), addShader)) {
    console.note("error: " + *problem + "\n");
    return ExitCode::usage;
  }
  if (info.help || info.shaders.empty()) {
    console.print(infoHelp());
    return info.help ? ExitCode::success : ExitCode::usage;
  }
  const auto installation = findInstallation();
  if (!installation) {
    console.report(installation.errors());
    return ExitCode::badInput;
  }
  std::vector<fs::path> folders = splitSearchPath(info.searchPath);
  folders.insert(folders.end(), arguments.shaderPath.begin(), arguments.shaderPath.end());
  if (info.searchPath.empty()) folders.insert(folders.begin(), "");
  folders.push_back(installation->shaders);
  folders.push_back(installation->plugins);
  bool allFound = true;
  for (const std::string& name : info.shaders) {
    if (grid::isGridFile(name)) {
      const auto file = grid::readGrids(name);
      if (file) {
        console.print(describeVoxels(name, **file));
      } else {
        console.report(file.errors());
      }
      allFound = allFound && file;
      continue;
    }
    const auto begin = std::chrono::steady_clock::now();
    const auto file = findShaderFile(name, folders);
    if (file && shading::isPluginFile(*file)) {
      allFound = describePlugin(*file, console) && allFound;
      continue;
    }
    const auto shader = file ? lang::readShaderInterface(*file, compileOptions(*installation))
                             : Diagnostic{.message = fmt::format("File \"{}\" could not be found.", name)};
    if (!shader) {
      console.print(fmt::format("ERROR opening shader \"{}\" ({})\n", name, shader.errors().entries()[0].message));
      if (file) console.report(shader.errors());
      allFound = false;
      continue;
    }
    console.print(describeInterface(*shader, info.style));
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    if (info.statistics) console.print(fmt::format("Reading took {}\n", formatDuration(seconds.count())));
  }
  return allFound ? ExitCode::success : ExitCode::badInput;
}

}  // namespace aerosol::app
