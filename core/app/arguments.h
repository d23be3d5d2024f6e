// What a command line asks for, as plain data.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/scene/description.h"

namespace aerosol::app {

/// How shaders are found and compiled, the same for all commands.
struct KernelArguments {
  std::vector<std::filesystem::path> shaderPath;  ///< Options first, then $AEROSOL_SHADER_PATH.
  std::optional<int> width;                       ///< Lanes: 16, 8, 4 or 1; none: the best of this machine.
  std::string isa;                                ///< "avx2" or "avx512"; empty: the best of this machine.
  bool useCache = true;
};

/// Pixels of the film, from its upper left corner.
struct Crop {
  int x = 0, y = 0, width = 0, height = 0;

  friend bool operator==(const Crop&, const Crop&) = default;
};

struct RenderArguments {
  std::filesystem::path scene;
  std::vector<std::string> outputs;
  std::map<std::string, std::string> defines;
  std::vector<std::string> overrides;
  std::optional<int> samplesPerPixel;
  std::optional<int> seed;
  std::optional<Crop> crop;
  std::optional<scene::DistanceSampling> distance;
  std::optional<float> stepScale;
  int threads = 0;  ///< 0: one a processor.
  int textureMemory_MB = 1024;
  bool quiet = false;
  bool statistics = false;
  bool countLanes = false;
  KernelArguments kernels;
};

/// The rule for make that says what a shader depends on.
struct DependencyArguments {
  bool wanted = false;
  bool alone = false;            ///< Nothing else is made; the rule is printed.
  bool standardLibrary = false;  ///< Names the standard library's header too.
  std::string file, target;      ///< Empty: named after the shader.
};

struct CompileArguments {
  std::vector<std::filesystem::path> shaders;
  std::string outputFile;
  std::vector<std::string> defines, undefines;
  bool preprocessOnly = false, warningsAreErrors = false, quiet = false, verbose = false;
  DependencyArguments dependencies;
  std::vector<std::string> ignored;  ///< Options that mean nothing here, as they were spelled.
  KernelArguments kernels;           ///< Its shader path is searched for includes.
};

struct HelpArguments {
  std::string topic;  ///< Empty: everything in short.
  KernelArguments kernels;
};

struct VersionArguments {};

/// The commands that stand for programs of OSL. Each reads its own words: their order counts.
enum class Tool : std::uint8_t { compile, info, shade };

struct ToolArguments {
  Tool tool{};
  bool isOsl = false;  ///< Called by the name of OSL's program: its output is what that prints, and nothing more.
  std::vector<std::string> words;
  std::vector<std::filesystem::path> shaderPath;  ///< $AEROSOL_SHADER_PATH.
};

using Arguments = std::variant<RenderArguments, HelpArguments, VersionArguments, ToolArguments>;

}  // namespace aerosol::app
