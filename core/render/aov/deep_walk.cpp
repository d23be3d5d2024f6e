#include "core/render/aov/deep_walk.h"

#include <cmath>

#include "core/render/aov/path_record.h"
#include "core/render/media_probe.h"
#include "core/render/medium_walk.h"
#include "core/render/nesting.h"
#include "core/render/prepared_scene.h"
#include "core/render/surface_closures.h"
#include "core/volume/trackers/transmittance.h"

namespace aerosol::render {

namespace {

using volume::Medium;
using volume::MediumSpan;
using volume::Segment;
using volume::Task;

/// Below it nothing is left to be seen.
constexpr float negligible = 1e-6f;

/// What one slice of a segment does to light: how much it lets through, and which part of what it stops shows.
struct SlicePass {
  Color transmittance{1.0f};
  Color shown{1.0f};  ///< Of holdouts it does not.
};

class DeepWalk {
 public:
  DeepWalk(PathContext& path, const Ray<World>& ray)
      : path_(path), ray_(ray), deep_(*path.record->deep()), stream_(path.random().branch(numbers)), random_(stream_) {}

  volume::FrameStack& frames() { return path_.frames(); }

  Task<> run() {
    const PreparedScene& scene = path_.scene();
    if (scene.nestsMedia) path_.media = scene.initialMedia;
    if (scene.probesMedia) co_await probeMedia(path_, ray_.at(ray_.tMin), ray_.time);
    const Medium* medium = ruler(scene.cameraMedium);
    std::optional<accel::HitKey> passed;
    while (maximum(left_) > negligible) {
      const auto hit = scene.geometry->closestHit(ray_, path_.spans, path_.statistics().accel,
                                                  passed ? &*passed : nullptr, shading::ray::camera);
      const double begin = passed ? passed->t : static_cast<double>(ray_.tMin);
      const double end = hit ? hit->t : static_cast<double>(ray_.tMax);
      path_.setRay(ray_);
      path_.setRayTypes(shading::ray::camera);
      findSegments(path_, ray_, begin, end, medium, path_.media);
      co_await walkSegments();
      if (!hit) {
        const bool isSeen = !scene.path.hideEmitters && !scene.lights.infinite().empty();
        if (isSeen) deep_.addBackground(average(left_));
        co_return;
      }
      const PreparedObject& object = scene.objects[hit->object];
      if (object.isBoundary) {
        medium = behindBoundary(*hit, medium);
        passed = hit->key();
        continue;
      }
      const shading::ShadingPoint point = shadingPointOf(scene, *hit, ray_);
      if (scene.nestsMedia) {
        const Nesting nesting = co_await findNesting(path_, ray_, *hit);
        if (nesting.isInterface && !nesting.crossing.isHit) {
          crossNesting(path_, nesting);
          medium = ruler(scene.objects[nesting.face->object].exterior);
          passed = nesting.last;
          continue;
        }
      }
      deep_.addSurface(static_cast<float>(hit->t), left_ * co_await opacityOf(*hit, point));
      co_return;
    }
  }

 private:
  static constexpr std::uint64_t numbers = 0x64656570;  ///< Of the branch of the path's random numbers.

  const Medium* ruler(const Medium* outside) const {
    const bool nests = path_.scene().nestsMedia;
    return !nests || path_.media.empty() ? outside : path_.media.medium();
  }

  /// Goes through a surface that only bounds media; gives the medium behind it.
  const Medium* behindBoundary(const accel::SurfaceHit& hit, const Medium* before) {
    const PreparedScene& scene = path_.scene();
    const PreparedObject& object = scene.objects[hit.object];
    if (!scene.nestsMedia) return object.behind(hit.entering, before);
    const auto interior = boundaryInterior(scene, hit.object);
    if (!interior) return before;
    path_.media.cross(*interior, hit.entering, path_.statistics().media);
    return ruler(object.exterior);
  }

  /// 1 but for holdouts, which the picture shows as holes.
  Task<float> opacityOf(accel::SurfaceHit hit, const shading::ShadingPoint& point) {
    const PreparedObject& object = path_.scene().objects[hit.object];
    const bool mayHoldOut = std::any_of(object.closures.begin(), object.closures.end(), [](const Closure* closure) {
      return closure && closure->kind() == ClosureKind::holdout;
    });
    if (!mayHoldOut) co_return 1.0f;
    const SurfaceAnswer& answer = co_await path_.shade(object.material, point);
    const SurfaceClosures closures(object, answer, hit, ray_.direction);
    co_return 1 - std::clamp(average(closures.mix().holdout()), 0.0f, 1.0f);
  }

  Task<> walkSegments() {
    const AovDeep& layout = deep_.deep();
    const auto cosine = static_cast<double>(deep_.cosine());
    for (Segment segment; maximum(left_) > negligible && path_.segments.next(segment);) {
      double t = segment.t0;
      while (t < segment.t1 && maximum(left_) > negligible) {
        const std::size_t slice = layout.sliceOf(static_cast<float>(t * cosine));
        const bool isLast = slice + 1 == layout.slices();
        double end =
            isLast ? segment.t1 : std::fmin(segment.t1, static_cast<double>(layout.depths[slice + 1]) / cosine);
        // Rounding may leave t on the end of its slice.
        if (!(end > t)) end = std::fmin(segment.t1, std::nextafter(static_cast<float>(t), 1e30f));
        co_await walkSlice(segment, t, end, slice);
        t = end;
      }
    }
  }

  Task<> walkSlice(Segment segment, double begin, double end, std::size_t slice) {
    SlicePass pass;
    Color held(1.0f);
    for (const Medium* medium : segment.media) {
      const MediumSpan span{begin, end, medium};
      if (medium->mayEmit) {
        const double t = begin + (end - begin) * static_cast<double>(random_.next());
        Color emission;
        if (medium->constant) {
          emission = medium->constant->emission;
        } else {
          path_.ask(*medium, accel::pointAt(ray_, t), volume::Quantity::coefficients);
          emission = (co_await path_.answers())[0].emission;
        }
        deep_.expectEmission(slice, left_ * emission * static_cast<float>(std::fmin(end - begin, 1e30)));
      }
      const Color through = co_await volume::estimateTransmittance(medium->transmittance, path_, ray_, span, random_);
      pass.transmittance *= through;
      if (medium->isHoldout) held *= through;
    }
    for (int c = 0; c < 3; ++c) {
      // Of an optical depth that is the sum of both kinds', the share of what shows.
      const float all = -std::log(std::clamp(pass.transmittance[c], 1e-30f, 1.0f));
      const float hidden = -std::log(std::clamp(held[c], 1e-30f, 1.0f));
      pass.shown[c] = hidden > 0 && all > 0 ? std::clamp(1 - hidden / all, 0.0f, 1.0f) : 1.0f;
    }
    deep_.addOpacity(slice, left_ * (Color(1.0f) - pass.transmittance) * pass.shown);
    left_ *= pass.transmittance;
  }

  PathContext& path_;
  Ray<World> ray_;
  DeepRecord& deep_;
  SampleStream stream_;
  HashSource random_;
  Color left_{1.0f};  ///< Of the light that sets out from here for the camera.
};

}  // namespace

Task<> recordDeep(PathContext& path, Ray<World> ray) {
  path.statistics().work.add(Work::deep);
  DeepWalk walk(path, ray);
  co_await walk.run();
}

}  // namespace aerosol::render
