#include "core/app/bake_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/app/baked_grids.h"
#include "core/app/interrupt.h"
#include "core/app/progress.h"
#include "core/app/quantity.h"
#include "core/app/registered_types.h"
#include "core/app/temporal_bake.h"
#include "core/app/toolchain.h"
#include "core/image/pending_file.h"
#include "core/render/baker.h"
#include "core/render/camera_frustum.h"
#include "core/render/scene_services.h"
#include "core/scene/loader.h"
#include "plugins/registration.h"

namespace aerosol::app {

namespace {

using Clock = std::chrono::steady_clock;

/// Points that nobody wants to wait for: some days of work.
constexpr double mostPoints = 1e12;

/// One run of the command, step by step. A step that fails has told why.
class Bake {
 public:
  Bake(const BakeArguments& arguments, const Console& console)
      : arguments_(arguments), console_(console), watch_(console) {
    lattice_.voxelSize = arguments.voxelSize;
    for (int i = 0; i < 3; ++i) {
      lattice_.bounds.lower[i] = arguments.bounds[static_cast<std::size_t>(i)];
      lattice_.bounds.upper[i] = arguments.bounds[static_cast<std::size_t>(3 + i)];
    }
  }

  ExitCode run() {
    const std::vector<float> times = arguments_.time.times();
    if (!loadCamera() || !placeFrustum(times.front()) || !checkLattice() || !prepare()) return ExitCode::badInput;
    if (arguments_.temporal)
      return bakeTemporal(times) ? (watch_.stopFlag() ? ExitCode::interrupted : ExitCode::success) : ExitCode::badInput;
    const bool cameraMoves = camera_ && camera_->sensor.toWorld.motionDuring({times.front(), times.back()});
    if (times.size() > 1 && !baker_->readsTime() && !cameraMoves)
      console_.note("aerosol: warning: the shader does not read 'time': all frames are the same\n");
    for (std::size_t frame = 0; frame < times.size(); ++frame) {
      const std::string name = times.size() == 1 ? arguments_.output : frameName(arguments_.output, frame + 1);
      const bool isPlaced = frame == 0 || (placeFrustum(times[frame]) && checkLattice());
      if (!isPlaced || !bakeFrame(name, times[frame])) return ExitCode::badInput;
      if (watch_.stopFlag()) return ExitCode::interrupted;
    }
    return ExitCode::success;
  }

 private:
  bool fail(const std::string& message) {
    console_.note("aerosol: error: " + message + "\n");
    return false;
  }
  bool accept(const Diagnostics& diagnostics) {
    console_.report(diagnostics);
    return !diagnostics.hasErrors();
  }

  bool loadCamera() {
    if (arguments_.frustum.empty()) return true;
    render::Registry registry;
    render::registerPlugins(registry);
    Diagnostics warnings;
    auto scene = scene::load(arguments_.frustum, {{}, {}, registeredTypes(registry)}, warnings);
    if (!scene) return accept(scene.errors());
    camera_ = std::move(*scene);
    return true;
  }

  /// Where voxels stand in the view of a camera at a time, if they shall.
  bool placeFrustum(float time) {
    if (!camera_) return true;
    Box<World> bounds;
    for (int i = 0; i < 3; ++i) {
      bounds.lower[i] = lattice_.bounds.lower[i];
      bounds.upper[i] = lattice_.bounds.upper[i];
    }
    using render::FrustumDepth;
    const auto frustum =
        render::makeCameraFrustum(camera_->sensor, camera_->film, bounds,
                                  {arguments_.voxelSize, arguments_.slices,
                                   arguments_.projective ? FrustumDepth::projective : FrustumDepth::linear, time});
    if (!frustum) return fail(frustum.errors().entries().front().message);
    lattice_.frustum = {frustum->map, frustum->size};
    frustumInFile_ = frustum->file;
    return true;
  }

  bool checkLattice() {
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double most = 1 << 30;
      const auto far =
          static_cast<double>(std::max(std::fabs(lattice_.bounds.lower[axis]), std::fabs(lattice_.bounds.upper[axis])));
      if (!lattice_.frustum && !(far / lattice_.voxelSize < most))
        return fail(
            fmt::format("the bounds reach {:g} from the origin, {:.3g} voxels of this size: more than can be "
                        "numbered",
                        far, far / lattice_.voxelSize));
      const auto [first, last] = lattice_.range(axis);
      if (first > last) return fail("no voxel of this size has its centre within the bounds");
    }
    if (lattice_.size() > mostPoints)
      return fail(fmt::format("{} voxels are too many: take larger ones", formatShort(lattice_.size())));
    return true;
  }

  bool prepare() {
    Diagnostics warnings;
    auto toolchain = openToolchain(arguments_.kernels, warnings);
    console_.report(warnings);
    if (!toolchain) return accept(toolchain.errors());
    KernelArguments kernels = arguments_.kernels;
    scene::ShaderUse use;
    use.name = arguments_.shader.stem().string();
    use.nameLocation = {"command line", 0, 0};
    const bool isFile = arguments_.shader.has_extension();
    if (isFile) {
      std::error_code ignored;
      if (!std::filesystem::exists(arguments_.shader, ignored))
        return fail(fmt::format("there is no file '{}'", arguments_.shader.string()));
      kernels.shaderPath.insert(kernels.shaderPath.begin(), std::filesystem::absolute(arguments_.shader).parent_path());
    }
    for (const auto& [name, value] : arguments_.values) {
      const SourceLocation place{fmt::format("--set {}={}", name, value), 0, 0};
      use.parameters.push_back({name, scene::guessValue(value), place, place, true});
    }
    library_.emplace(openShaderLibrary(kernels, toolchain->installation, toolchain->cache));
    services_ = render::makeServices({.searchPath = library_->searchPath()});
    render::BakeOptions options;
    options.compiler = toolchain->compiler.get();
    options.target = toolchain->target;
    compiler_ = toolchain->compiler;
    Diagnostics told;
    auto baker = render::Baker::make(use, {*library_, groups_, layers_}, *services_, options, told);
    console_.report(told);
    if (!baker) return accept(baker.errors());
    baker_ = std::move(*baker);
    return true;
  }

  int threadCount() const {
    return arguments_.threads > 0 ? arguments_.threads
                                  : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  }

  bool bakeFrame(const std::string& name, float time) {
    auto file = image::PendingFile::create(name);
    if (!file) return accept(file.errors());
    const Clock::time_point start = Clock::now();
    const auto secondsSince = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    ProgressDisplay display(console_);
    std::function<void(double, std::uint64_t)> progress;
    if (!arguments_.quiet)
      progress = [&](double part, std::uint64_t points) { display.show({part, secondsSince(), points}); };
    render::BakeCounts counts;
    watch_.startRendering();
    const auto blocks = baker_->bake(lattice_, {time}, threadCount(), progress, &watch_.stopFlag(), counts);
    display.finish();
    if (watch_.stopFlag()) {
      console_.note("aerosol: interrupted, nothing is written\n");
      return true;
    }
    const BakedKinds kinds = findKinds(blocks);
    std::vector<grid::NewGrid> grids = emptyGrids(kinds, lattice_.voxelSize, frustumInFile_);
    for (grid::NewGrid& grid : grids) {
      for (const render::BakedBlock& block : blocks) grid.blocks.push_back({block.origin, valuesOf(block, grid)});
    }
    if (!accept(grid::writeGrids(file->path(), grids, arguments_.asHalf))) return false;
    if (!accept(file->commit())) return false;
    tell(counts, kinds, name, fmt::format("{} blocks of 8^3 voxels", blocks.size()), secondsSince(), false);
    return true;
  }

  void tell(const render::BakeCounts& counts, const BakedKinds& kinds, const std::string& name,
            const std::string& content, double seconds, bool moving) {
    if (counts.unsound > 0) {
      console_.note(fmt::format(
          "aerosol: warning: {} results of the shader were not finite or negative: they count as 0\n", counts.unsound));
    }
    if (arguments_.quiet) return;
    console_.note(fmt::format("wrote {}: {} in {}, {} of {} proven empty, {}\n", name, kinds.description(), content,
                              counts.proven, counts.blocks, formatDuration(seconds)));
    console_.note("  " + sceneText(kinds, counts, name, moving) + "\n");
  }

  /// All times in one file. A look at every fourth voxel decides which grids it gets.
  bool bakeTemporal(const std::vector<float>& times) {
    auto file = image::PendingFile::create(arguments_.output);
    if (!file) return accept(file.errors());
    const Clock::time_point start = Clock::now();
    const auto secondsSince = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    render::BakeLattice coarse = lattice_;
    coarse.voxelSize *= 4;
    render::BakeCounts counts, ignored;
    watch_.startRendering();
    const BakedKinds kinds = findKinds(baker_->bake(coarse, {times.front(), times[times.size() / 2], times.back()},
                                                    threadCount(), {}, &watch_.stopFlag(), ignored));
    const std::vector<grid::NewGrid> grids = emptyGrids(kinds, lattice_.voxelSize);
    const std::size_t parts = render::Baker::partCount(lattice_);
    std::vector<std::vector<grid::TemporalCurves>> curves(parts);
    const auto take = [&](std::size_t part, render::BakedBlock&& block) {
      if (curves[part].empty()) curves[part] = emptyCurves(grids, times);
      for (std::size_t g = 0; g < grids.size(); ++g)
        curves[part][g].add(samplesOf(block, grids[g], times.size()), arguments_.error);
    };
    ProgressDisplay display(console_);
    std::function<void(double, std::uint64_t)> progress;
    if (!arguments_.quiet)
      progress = [&](double part, std::uint64_t points) { display.show({part, secondsSince(), points}); };
    baker_->bake(lattice_, times, threadCount(), take, progress, &watch_.stopFlag(), counts);
    display.finish();
    if (watch_.stopFlag()) {
      console_.note("aerosol: interrupted, nothing is written\n");
      return true;
    }
    std::vector<grid::TemporalCurves> joined = emptyCurves(grids, times);
    for (const auto& part : curves) {
      for (std::size_t g = 0; g < part.size(); ++g) joined[g].append(part[g]);
    }
    if (!accept(grid::writeTemporal(file->path(), joined)) || !accept(file->commit())) return false;
    tell(counts, kinds, arguments_.output, describeCurves(joined), secondsSince(), true);
    return true;
  }

  const BakeArguments& arguments_;
  const Console& console_;
  InterruptWatch watch_;
  render::BakeLattice lattice_;
  std::optional<scene::SceneDescription> camera_;  ///< The scene of --frustum.
  std::optional<grid::NewFrustum> frustumInFile_;
  std::optional<shading::ShaderLibrary> library_;
  shading::GroupLibrary groups_;
  std::vector<scene::ShaderUse> layers_;
  std::unique_ptr<shading::Services> services_;
  std::shared_ptr<jit::Compiler> compiler_;
  std::unique_ptr<const render::Baker> baker_;
};

}  // namespace

ExitCode bakeCommand(const BakeArguments& arguments, const Console& console) {
  if (arguments.frames.empty()) return Bake(arguments, console).run();
  return joinFrames(arguments, console);
}

}  // namespace aerosol::app
