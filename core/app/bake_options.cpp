#include "core/app/bake_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/app/option_helpers.h"
#include "core/scene/value.h"

namespace aerosol::app {

namespace {

constexpr const char* bakeExamples = R"(Examples:
  aerosol bake cumulus --bounds -1,-1,-1,1,1,1 --voxel 0.02 -o cloud.vdb
  aerosol bake puff.osl --bounds -1,-1,-1,1,1,1 --voxel 0.05 -o puff.%04d.vdb --time 0,1,24 --set density=20
  aerosol bake flame.osl --bounds -1,-1,-1,1,3,1 --voxel 0.05 --temporal --time 0,0.5,16 -o flame.avt
  aerosol bake --temporal --time 0,1,3 a.vdb b.vdb c.vdb -o smoke.avt
  aerosol bake cumulus --frustum scene.xml --bounds -1,-1,-1,1,1,1 --voxel 0.01 -o cloud.vdb

With --temporal each voxel's values become a few straight lines in time, for motion blur: what passes is seen where it
passes, and no velocity is needed. The OpenVDB files of a sequence stand for evenly spaced times.

Voxels lie at whole multiples of their size, in the shader's object space, which is the file's. The grids are density
(extinction; three channels where they differ), albedo where it varies, and emission where there is some. The medium
'baked' reads them: a line for the scene is printed at the end.)";

/// Numbers between commas.
std::optional<std::vector<double>> parseList(const std::string& text) {
  scene::TextError error;
  return scene::parseNumbers(text, error);
}

}  // namespace

void addBake(CLI::App& program, BakeArguments& bake) {
  CLI::App& app = *program.add_subcommand("bake", "Write what a volume shader gives into voxels, as an OpenVDB file");
  app.footer(bakeExamples);
  const auto sources = [&bake](const std::vector<std::string>& names) {
    const auto isFrame = [](const std::string& name) { return std::filesystem::path(name).extension() == ".vdb"; };
    const bool areFrames = std::ranges::all_of(names, isFrame);
    if (areFrames) {
      bake.frames = names;
    } else if (names.size() == 1) {
      bake.shader = names.front();
    } else {
      refuse("shader", "give one shader, or the .vdb files of a sequence");
    }
  };
  app.add_option_function<std::vector<std::string>>("shader", sources,
                                                    "A .osl file, or a shader's name; or the .vdb files of a sequence")
      ->required()
      ->option_text(" ");
  const auto bounds = [&bake](const std::string& option, const std::string& text) {
    const auto numbers = parseList(text);
    if (!numbers || numbers->size() != 6)
      refuse(option, fmt::format("'{}' is not six numbers x0,y0,z0,x1,y1,z1", text));
    for (std::size_t i = 0; i < 6; ++i) bake.bounds[i] = static_cast<float>((*numbers)[i]);
    for (std::size_t i = 0; i < 3; ++i) {
      if (bake.bounds[i] > bake.bounds[3 + i]) refuse(option, fmt::format("'{}' has its greater corner first", text));
    }
  };
  addParsed(app, "--bounds", "X0,Y0,Z0,X1,Y1,Z1", bounds, "The box to bake, in the shader's object space");
  const auto voxel = [&bake](const std::string& option, const std::string& text) {
    scene::TextError error;
    const auto number = scene::parseNumber(text, error);
    if (!number || !(*number > 0)) refuse(option, fmt::format("'{}' is not a number greater than 0", text));
    bake.voxelSize = *number;
  };
  addParsed(app, "--voxel", "SIZE", voxel, "Size of a voxel");
  app.add_option(
         "--frustum", bake.frustum,
         "Voxels stand in what the camera of this scene sees, finer near to it;\n--voxel is their width at the near "
         "end of the bounds, which are in world space.\nEach time of --time has the camera of that time")
      ->option_text("SCENE");
  const auto depth = [&bake](const std::string& option, const std::string& text) {
    if (text != "linear" && text != "projective") refuse(option, fmt::format("'{}' is not linear or projective", text));
    bake.projective = text == "projective";
  };
  addParsed(app, "--depth", "linear|projective", depth,
            "With --frustum: even steps of depth, which all programs read\nthat read OpenVDB's frustums, or of 1 / "
            "depth [linear]");
  addInteger(app, "--slices", bake.slices, 1, "With --frustum: voxels along the depth");
  app.add_flag("--temporal", bake.temporal, "All times in one file of curves, .avt");
  const auto deviation = [&bake](const std::string& option, const std::string& text) {
    scene::TextError error;
    const auto number = scene::parseFloat(text, error);
    if (!number || !(*number >= 0)) refuse(option, fmt::format("'{}' is not a number of at least 0", text));
    bake.error = *number;
  };
  addParsed(app, "--error", "E", deviation,
            "With --temporal: how far a curve may be from what it stands\nfor, in the unit of the values [0.01]");
  app.add_option("-o,--output", bake.output,
                 "The .vdb file to write (.avt with --temporal); %04d in it\nis the number of a frame, from 1")
      ->required()
      ->option_text("FILE");
  const auto set = [&bake](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const std::size_t equals = text.find('=');
      if (equals == 0 || equals == std::string::npos) refuse("--set", fmt::format("'{}' is not PARAMETER=VALUE", text));
      bake.values.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
  };
  app.add_option_function<std::vector<std::string>>("--set", set, "Give a parameter of the shader a value; repeatable")
      ->allow_extra_args(false)
      ->option_text("PARAMETER=VALUE");
  const auto time = [&bake](const std::string& option, const std::string& text) {
    const auto numbers = parseList(text);
    const bool isOne = numbers && numbers->size() == 1;
    if (!isOne && (!numbers || numbers->size() != 3))
      refuse(option, fmt::format("'{}' is neither a time nor FIRST,LAST,COUNT", text));
    const double count = isOne ? 1 : (*numbers)[2];
    if (!(count >= 1 && count <= 100000 && count == static_cast<int>(count)))
      refuse(option, "the number of frames is an integer from 1 to 100000");
    bake.time = {static_cast<float>((*numbers)[0]), static_cast<float>((*numbers)[isOne ? 0 : 1]),
                 static_cast<int>(count)};
  };
  addParsed(app, "--time", "T|FIRST,LAST,COUNT", time, "The shader's time in seconds [0], or that of several frames");
  app.add_flag("--half", bake.asHalf, "Keep values as 16-bit floats");
  addInteger(app, "--threads", bake.threads, 1, "Threads that bake [one a processor]; the file is the same",
             mostThreads);
  addKernelOptions(app, bake.kernels);
  app.add_flag("--quiet,-q", bake.quiet, "No progress; warnings stay");
}

std::string problemOf(const BakeArguments& bake) {
  const std::string extension = std::filesystem::path(bake.output).extension().string();
  if (!bake.temporal && !bake.frames.empty()) return "files of a sequence are joined with --temporal";
  if (bake.temporal && !bake.frustum.empty()) return "a file of curves has no frustum: --temporal or --frustum";
  if (bake.frustum.empty() && (bake.projective || bake.slices > 0)) return "--depth and --slices are for --frustum";
  if (bake.temporal && bake.time.count > 255) return "a file of curves has at most 255 times";
  if (extension != (bake.temporal ? ".avt" : ".vdb"))
    return fmt::format("'{}' does not end in {}", bake.output, bake.temporal ? ".avt" : ".vdb");
  if (!bake.frames.empty()) {
    if (static_cast<std::size_t>(bake.time.count) != bake.frames.size())
      return fmt::format("--time names {} times, but there are {} files", bake.time.count, bake.frames.size());
    return {};
  }
  if (!(bake.voxelSize > 0)) return "--voxel is needed: the size of a voxel";
  if (bake.bounds == std::array<float, 6>{}) return "--bounds is needed: the box to bake";
  return {};
}

}  // namespace aerosol::app
