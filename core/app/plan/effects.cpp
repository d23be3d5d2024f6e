#include "core/app/plan/effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <set>

#include "core/app/plan/names.h"
#include "core/app/quantity.h"
#include "core/render/medium_facts.h"

namespace aerosol::app {

namespace {

using render::Work;
using render::WorkerStatistics;
using volume::DistanceMethod;

/// Of the time in which threads were seen.
double shareOf(const WorkerStatistics& s, std::initializer_list<Phase> phases) {
  double all = 0, part = 0;
  for (const std::uint64_t count : s.phases) all += static_cast<double>(count);
  for (const Phase phase : phases) part += static_cast<double>(s.phases[static_cast<std::size_t>(phase)]);
  return all > 0 ? part / all : 0;
}

/// Of the shaders' part: kernels of these variants.
double shaderShare(const WorkerStatistics& s, const std::function<bool(std::size_t variant)>& isCounted) {
  double all = 0, part = 0;
  for (std::size_t i = 0; i < s.kernels.size(); ++i) {
    const auto time = static_cast<double>(s.kernels[i].nanoseconds);
    all += time;
    if (isCounted(i % shading::variantCount)) part += time;
  }
  return all > 0 ? part / all * shareOf(s, {Phase::shaders, Phase::gathering}) : 0;
}

/// Of the shaders' part: volume variants of these families.
std::function<double(const WorkerStatistics&)> shareOfFamilies(std::set<std::size_t> families) {
  return [families = std::move(families)](const WorkerStatistics& s) {
    double all = 0, part = 0;
    for (std::size_t i = 0; i < s.kernels.size(); ++i) {
      const auto time = static_cast<double>(s.kernels[i].nanoseconds);
      all += time;
      if (families.contains(i / shading::variantCount)) part += time;
    }
    return all > 0 ? part / all * shareOf(s, {Phase::shaders, Phase::gathering}) : 0;
  };
}

std::uint64_t pointsOf(const WorkerStatistics& s, shading::Variant variant) {
  std::uint64_t points = 0;
  for (std::size_t i = static_cast<std::size_t>(variant); i < s.kernels.size(); i += shading::variantCount) {
    points += s.kernels[i].points;
  }
  return points;
}

/// Of all segments of paths, those that begin at such an event.
std::function<double(const WorkerStatistics&)> shareOfSegments(Work event) {
  return [event](const WorkerStatistics& s) {
    const auto segments = static_cast<double>(s.samples + s.pathVertices);
    return segments > 0 ? static_cast<double>(s.work.of(event)) / segments : 0;
  };
}

/// Points at which shaders ran that hold code for an effect: there is none of it in others.
std::function<std::uint64_t(const WorkerStatistics&)> pointsOfFamilies(std::vector<std::size_t> families) {
  return [families = std::move(families)](const WorkerStatistics& s) {
    std::uint64_t points = 0;
    for (const std::size_t family : families) {
      for (std::size_t variant = 0; variant < shading::variantCount; ++variant) {
        const std::size_t at = family * shading::variantCount + variant;
        if (at < s.kernels.size()) points += s.kernels[at].points;
      }
    }
    return points;
  };
}

bool isVolume(std::size_t variant) { return variant <= static_cast<std::size_t>(shading::Variant::extinction); }

class EffectList {
 public:
  EffectList(const scene::SceneDescription& description, const render::PreparedScene& scene)
      : description_(description), scene_(scene) {}

  std::vector<Effect> run() {
    addCamera();
    addMotionEffects(description_, scene_, effects_);
    addLights();
    addSurfaces();
    addVolumes();
    addMedia();
    addPaths();
    addShaders();
    addLayers();
    return std::move(effects_);
  }

 private:
  using Counter = std::function<std::uint64_t(const WorkerStatistics&)>;
  using Share = std::function<double(const WorkerStatistics&)>;

  void add(std::string name, bool isOn, std::string reason, Counter work, Share share = {}) {
    effects_.push_back({std::move(name), std::move(reason), isOn, std::move(work), std::move(share)});
  }
  void add(std::string name, const Names& names, const std::string& offReason, Counter work, Share share = {}) {
    add(std::move(name), names.count() > 0, names.count() > 0 ? names.text() : offReason, std::move(work),
        std::move(share));
  }

  void addCamera() {
    const scene::Sensor& sensor = description_.sensor;
    const bool hasLens = scene_.camera->hasLens();
    add("depth-of-field", hasLens,
        hasLens ? fmt::format("thinlens with aperture_radius {}{}", sensor.apertureRadius,
                              at(sensor.origin.of("aperture_radius")))
                : "the camera has no lens",
        countOf(Work::lens));
  }

  void addLights() {
    const Share sampling = [](const WorkerStatistics& s) { return shareOf(s, {Phase::lights}); };
    add(
        "light-sampling", scene_.lights.hasSampled(),
        scene_.lights.hasSampled() ? formatCount(scene_.lights.size(), "light")
        : scene_.lights.size() > 0 ? "paths find the light in the directions that they take"
                                   : "there are no lights",
        [](const WorkerStatistics& s) { return s.accel.occlusionQueries; }, sampling);
    addLightEffects(description_, scene_, effects_);
  }

  void addSurfaces() {
    Names opaque, boundaries;
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      const scene::Shape& shape = description_.shapes[i];
      const std::string& name = scene_.shading.family(scene_.objects[i].material).program->name;
      (scene_.objects[i].isBoundary ? boundaries : opaque).add(name, shape.origin.location);
    }
    add(
        "surfaces", opaque, "no shape stops or scatters light",
        [](const WorkerStatistics& s) { return pointsOf(s, shading::Variant::surface); },
        [](const WorkerStatistics& s) { return shaderShare(s, [](std::size_t v) { return !isVolume(v); }); });
    Names displaced;
    std::uint64_t displacedTriangles = 0;
    for (std::size_t i = 0; i < description_.shapes.size(); ++i) {
      const scene::Shape& shape = description_.shapes[i];
      if (!shape.displacement) continue;
      const std::size_t triangles = scene_.geometry->mesh(static_cast<accel::ObjectId>(i))->triangles.size();
      displacedTriangles += triangles;
      displaced.add(fmt::format("{}, {}", description_.displacements[*shape.displacement].shader.name,
                                formatCount(triangles, "triangle")),
                    shape.origin.location);
    }
    add("displacement", displaced, "no shape has a displacement shader",
        [displacedTriangles](const WorkerStatistics&) { return displacedTriangles; });
    add("medium-boundaries", boundaries, "no surface is there for media alone", countOf(Work::mediumBoundary));
    Names bodies;
    for (std::size_t i = 0; i < scene_.objects.size() && scene_.hasSubsurface; ++i) {
      const auto& closures = scene_.objects[i].closures;
      const bool hasBody = std::any_of(closures.begin(), closures.end(), [](const render::Closure* c) {
        return c && c->kind() == render::ClosureKind::subsurface;
      });
      if (hasBody) {
        bodies.add(scene_.shading.family(scene_.objects[i].material).program->name,
                   description_.shapes[i].origin.location);
      }
    }
    add("subsurface", bodies, "no surface shader lets light into its body",
        [](const WorkerStatistics& s) { return s.bodyEntries; });
    Names dielectrics;
    for (std::size_t i = 0; i < scene_.objects.size() && scene_.nestsMedia; ++i) {
      const auto& closures = scene_.objects[i].closures;
      const bool hasInterior = std::any_of(closures.begin(), closures.end(), [](const render::Closure* c) {
        return c && c->kind() == render::ClosureKind::interior;
      });
      if (hasInterior || scene_.objects[i].separatesMedia()) {
        dielectrics.add(scene_.shading.family(scene_.objects[i].material).program->name,
                        description_.shapes[i].origin.location);
      }
    }
    add("nested-media", dielectrics, "no two interiors meet, nor one the camera: paths keep no stack of media",
        countOf(Work::nesting));
  }

  void addVolumes() {
    Names volumes;
    for (const scene::Volume& volume : description_.volumes) {
      volumes.add(volume.type + " of " + description_.media[volume.medium].shader.name, volume.origin.location);
    }
    add(
        "volumes", volumes, "there is no volume primitive",
        [](const WorkerStatistics& s) { return s.accel.volumeTests + s.accel.spans; },
        [](const WorkerStatistics& s) { return shareOf(s, {Phase::intervals}); });
    const std::string pair = findOverlap();
    add("overlap", !pair.empty(),
        !pair.empty()                     ? pair
        : description_.volumes.size() < 2 ? "there are no two volume primitives"
                                          : "bounds of volume primitives are disjoint",
        countOf(Work::overlap));
  }

  /// The first two volume primitives whose bounds overlap.
  std::string findOverlap() const {
    const auto count = scene_.geometry->volumeCount();
    std::vector<std::pair<float, accel::VolumeId>> byStart;
    for (accel::VolumeId i = 0; i < count; ++i)
      byStart.emplace_back(scene_.geometry->volume(i).worldBounds().lower.x, i);
    std::sort(byStart.begin(), byStart.end());
    for (std::size_t a = 0; a < byStart.size(); ++a) {
      const Box<World> p = scene_.geometry->volume(byStart[a].second).worldBounds();
      for (std::size_t b = a + 1; b < byStart.size() && byStart[b].first < p.upper.x; ++b) {
        const Box<World> q = scene_.geometry->volume(byStart[b].second).worldBounds();
        if (q.lower.y >= p.upper.y || p.lower.y >= q.upper.y || q.lower.z >= p.upper.z || p.lower.z >= q.upper.z)
          continue;
        const auto name = [&](accel::VolumeId id) {
          const scene::Volume& volume = description_.volumes[id];
          return description_.media[volume.medium].shader.name + at(volume.origin.location);
        };
        return name(byStart[a].second) + " and " + name(byStart[b].second);
      }
    }
    return {};
  }

  void addMedia() {
    Names closed, voxels, null, marched, scattering, emitting, chromatic, trees;
    std::set<std::size_t> nullFamilies, marchedFamilies;
    for (std::size_t i = 0; i < scene_.media.size(); ++i) {
      const volume::Medium& medium = scene_.media[i];
      const std::string& name = scene_.mediumNames[i];
      const SourceLocation& place = scene_.mediumLocations[i];
      const DistanceMethod method = medium.method;
      (method == DistanceMethod::closedForm ? closed
       : method == DistanceMethod::analytic ? voxels
       : method == DistanceMethod::marching ? marched
                                            : null)
          .add(name, place);
      if (method == DistanceMethod::marching) marchedFamilies.insert(scene_.mediumShaders[i].family);
      if (method == DistanceMethod::nullScattering) nullFamilies.insert(scene_.mediumShaders[i].family);
      const render::MediumFacts facts = render::factsOf(scene_, medium);
      const auto note = [&](render::Answer answer, Names& names) {
        if (answer == render::Answer::no) return;
        names.add(answer == render::Answer::yes ? name : name + " (not ruled out)", place);
      };
      // What stands for a hole ends paths.
      if (!medium.isHoldout) note(facts.scatters, scattering);
      note(facts.emits, emitting);
      note(facts.isColoured, chromatic);
      if (medium.tree) trees.add(name, place);
    }
    const bool hasMedia = !scene_.media.empty();
    const std::string none = "there is no medium";
    const Counter points = [](const WorkerStatistics& s) { return s.trackers.points; };
    const Share shading = [](const WorkerStatistics& s) { return shaderShare(s, isVolume); };
    Names varying;
    for (std::size_t i = 0; i < scene_.media.size(); ++i) {
      if (!scene_.media[i].constant) varying.add(scene_.mediumNames[i], scene_.mediumLocations[i]);
    }
    add("heterogeneity", varying, hasMedia ? "all media are constant: no shader is run along rays" : none, points,
        shading);
    add("constant-media", closed, hasMedia ? "no medium is constant" : none, countOf(Work::closedForm));
    add("analytic-voxels", voxels, hasMedia ? "no medium is voxels times constants" : none, countOf(Work::voxels));
    add("null-scattering", null, hasMedia ? "no medium is sampled so" : none, countOf(Work::nullScattering),
        shareOfFamilies(std::move(nullFamilies)));
    add("ray-marching", marched, hasMedia ? "no medium is sampled so" : none, countOf(Work::marching),
        shareOfFamilies(std::move(marchedFamilies)));
    add("bound-trees", trees, hasMedia ? "no medium varies below a bound" : none, countOf(Work::tree));
    add("volume-scattering", scattering, hasMedia ? "no medium scatters" : none, countOf(Work::mediumScattering),
        shareOfSegments(Work::mediumScattering));
    add("volume-emission", emitting, hasMedia ? "no medium emits" : none, countOf(Work::mediumEmission));
    add("chromatic-extinction", chromatic, hasMedia ? "extinction is the same in all channels" : none,
        countOf(Work::chromatic));
    addLevelOfDetail();
    Names looks;
    for (std::size_t i = 0; i < scene_.looks.size(); ++i) {
      // Those of constant media are part of the constants.
      if (scene_.looks[i] && !scene_.media[i].constant) looks.add(scene_.mediumNames[i], scene_.mediumLocations[i]);
    }
    add("volume-looks", looks, "no volume changes what a shader says that varies", countOf(Work::look));
  }

  void addLevelOfDetail() {
    const scene::Integrator& integrator = description_.integrator;
    std::string reason = "neither lod_pixels nor lod_depth is set";
    if (integrator.lodPixels > 0) reason = "no voxel is seen smaller than lod_pixels";
    if (integrator.lodDepth > 0) reason = "no medium reads voxels";
    if (scene_.hasCoarseVolumes) {
      reason = fmt::format("paths longer than {}{} see voxels of half the resolution, {} over", integrator.lodDepth,
                           at(integrator.origin.of("lod_depth")), integrator.lodLevels);
    }
    add("level-of-detail", scene_.hasCoarseVolumes, reason, countOf(Work::coarseVoxels));
  }

  void addPaths() {
    const scene::Integrator& integrator = description_.integrator;
    const bool isMultiple = integrator.maxDepth < 0 || integrator.maxDepth > 2;
    const std::string depth =
        integrator.maxDepth < 0 ? "max_depth is unbounded" : fmt::format("max_depth {}", integrator.maxDepth);
    add("multiple-scattering", isMultiple, depth + at(integrator.origin.of("max_depth")),
        countOf(Work::laterScattering), shareOfSegments(Work::laterScattering));
    const bool mayBeLongEnough = integrator.maxDepth < 0 || integrator.maxDepth > integrator.rrDepth;
    const bool plays = mayBeLongEnough && integrator.rrDepth < std::numeric_limits<int>::max();
    add("russian-roulette", plays,
        plays ? fmt::format("from path length {}", integrator.rrDepth) : "no path gets long enough for it",
        countOf(Work::roulette));
    const bool clamps = scene_.path.clampsIndirect.isCalledFor();
    add("clamped-indirect", clamps,
        clamps ? fmt::format("clamp_indirect {:g}{}: the picture gets darker", integrator.clampIndirect,
                             at(integrator.origin.of("clamp_indirect")))
               : "no light is dimmed",
        countOf(Work::clamping));
    const bool knows = !scene_.contributions.isEmpty();
    add("contribution-roulette", knows,
        knows ? "by what paths may still bring to their pixels, as a small render tells"
              : "roulette goes by throughput: no media scatter many times, or the picture is small, or the scene asks "
                "for it",
        countOf(Work::contribution));
    add(
        "ray-tracing", true, formatCount(scene_.objects.size() + scene_.volumes.size(), "object"),
        [](const WorkerStatistics& s) { return s.accel.closestHitQueries + s.accel.occlusionQueries; },
        [](const WorkerStatistics& s) { return shareOf(s, {Phase::tracing}); });
  }

  void addShaders() {
    Names textures, derivatives, messages;
    std::vector<std::size_t> texturing, deriving, speaking;
    for (std::size_t index = 0; index < scene_.shading.families().size(); ++index) {
      const shading::Family& family = scene_.shading.families()[index];
      const lang::Program& program = *family.program;
      const SourceLocation place = program.locations.empty() ? SourceLocation{} : program.locations.front();
      bool readsTextures = false, readsDerivatives = false, speaks = false;
      for (const auto& kernel : family.kernels) {
        if (!kernel) continue;
        const jit::KernelInterface& interface = kernel->interface();
        readsDerivatives = readsDerivatives || render::readsFootprints(interface);
        speaks =
            speaks || std::any_of(interface.sites.begin(), interface.sites.end(), [](const jit::MessageSite& site) {
              return site.kind == AEROSOL_MESSAGE_PRINT || site.kind == AEROSOL_MESSAGE_FILE;
            });
      }
      for (const lang::FunctionUse& use : program.functions) {
        readsTextures = readsTextures || (use.host && (use.symbol.find("texture") != std::string::npos ||
                                                       use.symbol.find("environment") != std::string::npos));
      }
      const auto note = [&](bool does, Names& names, std::vector<std::size_t>& families) {
        if (!does) return;
        names.add(program.name, place);
        families.push_back(index);
      };
      note(readsTextures, textures, texturing);
      note(readsDerivatives, derivatives, deriving);
      note(speaks, messages, speaking);
    }
    const Share ofTexturing = shareOfFamilies({texturing.begin(), texturing.end()});
    add("textures", textures, "no shader reads a texture or voxels", pointsOfFamilies(std::move(texturing)),
        ofTexturing);
    const std::string reason =
        derivatives.count() == 0
            ? "no shader asks how its inputs change from pixel to pixel: paths keep no differentials of their rays"
        : scene_.keepsFootprints.isCalledFor() ? derivatives.text()
                                               : "left out: " + derivatives.text();
    add("derivatives", scene_.keepsFootprints.isCalledFor(), reason, countOf(Work::footprint),
        shareOfFamilies({deriving.begin(), deriving.end()}));
    const Share ofSpeaking = shareOfFamilies({speaking.begin(), speaking.end()});
    add("shader-messages", messages, "no shader prints", pointsOfFamilies(std::move(speaking)), ofSpeaking);
  }

  void addLayers() {
    add("layers", scene_.aovs != nullptr,
        scene_.aovs ? scene_.aovs->layout.toText() : "nothing is gathered beside the picture", countOf(Work::layers));
    const bool isDeep = scene_.aovs && scene_.aovs->layout.deep.isWanted();
    add("deep-output", isDeep,
        isDeep ? formatCount(scene_.aovs->layout.deep.slices(), "slice") : "no deep image is asked for",
        countOf(Work::deep));
  }

  const scene::SceneDescription& description_;
  const render::PreparedScene& scene_;
  std::vector<Effect> effects_;
};

}  // namespace

std::vector<Effect> listEffects(const scene::SceneDescription& description, const render::PreparedScene& scene) {
  return EffectList(description, scene).run();
}

}  // namespace aerosol::app
