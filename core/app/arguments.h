// What a command line asks for, as plain data.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/image/image.h"
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

/// Samples first ≤ i < end of every pixel.
struct SampleRange {
  int first = 0, end = 0;

  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

/// A deep image beside the picture.
struct DeepArguments {
  std::string file;      ///< Empty: none.
  int slices = 32;       ///< Through media.
  double error = 0.002;  ///< By which its curves along depth may differ from what was gathered.
};

struct RenderArguments {
  std::filesystem::path scene;
  std::vector<std::string> outputs;
  std::map<std::string, std::string> defines;
  std::vector<std::string> overrides;
  std::string sensor;  ///< Of several, by id or number; empty: the first.
  std::optional<int> samplesPerPixel;
  std::optional<int> seed;
  std::optional<Crop> crop;
  std::optional<scene::DistanceSampling> distance;
  std::optional<scene::TransmittanceSampling> transmittance;
  bool noEquiangular = false;
  bool jointLights = false;
  std::string plan;  ///< A file that says how media are sampled; empty: none.
  std::optional<float> stepScale;
  std::optional<SampleRange> samples;  ///< A part of the samples; the image is joined later.
  std::vector<int> frames;             ///< In this order; empty: the scene is one image.
  bool keepSums = false;               ///< EXR files keep what joining and carrying on need.
  double checkpointSeconds = 30;       ///< 0: none.
  bool resume = false;
  double targetError = 0;               ///< Relative, of the image; 0: all samples are rendered.
  double timeLimit = 0;                 ///< Seconds; 0: none.
  bool adaptive = false;                ///< More samples where the error is; their mean is what is asked for.
  std::vector<scene::AovRequest> aovs;  ///< Beside those that the scene asks for.
  DeepArguments deep;
  std::vector<std::string> without;  ///< Effects forced off.
  int threads = 0;                   ///< 0: one a processor.
  int textureMemory_MB = 1024;
  int loopBudget = 1 << 20;  ///< Rounds of one loop that one point may run.
  bool quiet = false;
  std::string statisticsFile;  ///< JSON; empty: none.
  bool explainCost = false;
  bool statistics = false;
  bool countLanes = false;
  bool watch = false;             ///< Start over when a file of the scene changes, until the program is ended.
  image::DisplayOptions display;  ///< Of .png and .jpg files.
  std::string tev;                ///< Where a viewer listens; empty: none.
  KernelArguments kernels;
};

struct MergeArguments {
  std::vector<std::string> parts;
  std::vector<std::string> outputs;
  std::optional<Crop> crop;   ///< All that is wanted of the film.
  bool mixed = false;         ///< Parts of other instruction sets or versions are joined too.
  bool allowMissing = false;  ///< Writes what there is, with its sums.
  DeepArguments deep;
  image::DisplayOptions display;
  bool quiet = false;
};

struct DenoiseArguments {
  std::string input;
  std::vector<std::string> outputs;
  int radius = 9;         ///< Pixels.
  float strength = 0.5f;  ///< Standard deviations.
  int threads = 0;        ///< 0: one a processor.
  image::DisplayOptions display;
  bool quiet = false;
};

/// A parameter that takes several values.
struct StudyAxis {
  std::string parameter;
  std::vector<std::string> values;
};

struct StudyArguments {
  RenderArguments render;  ///< The scene and all that is common to its renders.
  std::string folder;
  std::vector<StudyAxis> axes;
  double budget = 100;  ///< Seconds of rendering.
  int size = 96;        ///< Pixels of the longer side.
  int repetitions = 8;
};

struct PlanArguments {
  RenderArguments render;
  int size = 160;  ///< Pixels of the pilot's longer side.
};

struct DoctorArguments {
  RenderArguments render;
  int size = 96;  ///< Pixels of the pilot's longer side.
};

struct CheckArguments {
  RenderArguments render;
};

struct SubmitArguments {
  RenderArguments render;
  std::string folder;  ///< Of the job's files; empty: beside the first output.
  int tasks = 8;       ///< Into which the samples of a frame are cut, at most.
  bool slurm = false;
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
  bool advice = false;  ///< Called as oslc: also the warnings that it does not have.
  DependencyArguments dependencies;
  std::vector<std::string> ignored;  ///< Options that mean nothing here, as they were spelled.
  KernelArguments kernels;           ///< Its shader path is searched for includes.
};

/// Evenly spaced times; one of them when `count` is 1.
struct TimeRange {
  float first = 0, last = 0;  ///< Seconds.
  int count = 1;

  std::vector<float> times() const {
    std::vector<float> all;
    for (int i = 0; i < count; ++i)
      all.push_back(count == 1 ? first
                               : first + (last - first) * static_cast<float>(i) / static_cast<float>(count - 1));
    return all;
  }
  friend bool operator==(const TimeRange&, const TimeRange&) = default;
};

struct BakeArguments {
  std::filesystem::path shader;     ///< A file, or a name on the search path.
  std::vector<std::string> frames;  ///< Instead of a shader: OpenVDB files, one a time.
  std::array<float, 6> bounds{};    ///< Least corner, greatest corner; scene units.
  double voxelSize = 0;             ///< Scene units.
  std::string frustum;              ///< A scene, in the frustum of whose camera voxels stand; empty: none.
  bool projective = false;          ///< Of that: even steps of 1 / depth, not of depth.
  int slices = 0;                   ///< Of that: voxels along the depth; 0: chosen.
  std::string output;
  std::vector<std::pair<std::string, std::string>> values;  ///< Of parameters.
  TimeRange time;
  bool temporal = false;  ///< All times in one file of curves.
  float error = 0.01f;    ///< Largest deviation of a curve from what it stands for, in the unit of the values.
  bool asHalf = false;
  int threads = 0;  ///< 0: one a processor.
  bool quiet = false;
  KernelArguments kernels;
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

using Arguments =
    std::variant<RenderArguments, BakeArguments, MergeArguments, DenoiseArguments, StudyArguments, PlanArguments,
                 DoctorArguments, CheckArguments, SubmitArguments, HelpArguments, VersionArguments, ToolArguments>;

}  // namespace aerosol::app
