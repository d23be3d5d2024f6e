// What one path works with: its frames, its random numbers, its scratch, and the door to the shaders.
#pragma once

#include <coroutine>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/accel/scene.h"
#include "core/render/optional_effects.h"
#include "core/render/path_spans.h"
#include "core/render/ray_footprint.h"
#include "core/render/sample_stream.h"
#include "core/render/statistics.h"
#include "core/render/surface_answer.h"
#include "core/shading/ray_type.h"
#include "core/shading/shading_point.h"
#include "core/shading/shading_system.h"
#include "core/volume/medium.h"
#include "core/volume/medium_stack.h"
#include "core/volume/segment_stream.h"
#include "core/volume/trackers/marching_table.h"

namespace aerosol::render {

struct PilotPath;
struct PreparedScene;
class PathContext;
class PathRecord;

/// Who runs the kernels for the paths in flight.
class QuestionSink {
 public:
  virtual ~QuestionSink() = default;
  /// Takes the questions of a path that has just suspended; resumes it when all are answered. One call a suspension.
  virtual void post(PathContext& path) = 0;
};

/// What a question about a medium is after; all but coefficients is for the path's record.
enum class MediumFact : std::uint8_t { coefficients, outputs, velocity };

/// A question about one point. `medium` is set for volumes, otherwise `surface` names the shader instance.
struct Question {
  const volume::Medium* medium = nullptr;
  volume::Quantity quantity = volume::Quantity::coefficients;
  Point<World> point;
  shading::InstanceRef surface;
  const shading::ShadingPoint* surfacePoint = nullptr;  ///< Outlives the suspension.
  std::uint32_t rayTypes = shading::ray::camera;        ///< Of the ray on which the point lies.
  MediumFact fact = MediumFact::coefficients;
};

/// Which sample of which pixel a path is for.
struct PathId {
  int x = 0, y = 0;  ///< Pixel of the whole film.
  std::uint32_t sample = 0;

  /// Orders by (row, column, sample).
  friend bool operator<(const PathId& a, const PathId& b) {
    return std::tie(a.y, a.x, a.sample) < std::tie(b.y, b.x, b.sample);
  }
  friend bool operator==(const PathId&, const PathId&) = default;
};

/// One path slot of a worker. Fulfils volume::Evaluator.
class PathContext {
 public:
  PathContext(const PreparedScene& scene, QuestionSink& sink, WorkerStatistics& statistics);
  PathContext(const PathContext&) = delete;
  PathContext& operator=(const PathContext&) = delete;

  volume::FrameStack& frames() { return frames_; }
  const PreparedScene& scene() const { return scene_; }
  SampleStream& random() { return random_; }
  WorkerStatistics& statistics() { return statistics_; }
  volume::TrackerStatistics& trackerStatistics() { return statistics_.trackers; }

  /// Starts a new path.
  void restart(const PathId& id, const SampleStream& random) {
    id_ = id;
    random_ = random;
    questionsBefore_ = 0;
    questions_.clear();
    answered_ = true;
    waiting_ = nullptr;
    rayTypes_ = shading::ray::camera;
    length_ = 1;
  }

  /// The path's ray, on which the following questions lie: shaders see its direction as I, and its time.
  void setRay(const Ray<World>& ray) {
    direction_ = ray.direction;
    time_ = ray.time;
    if (keepsFootprints()) [[unlikely]]
      askedFootprint_ = footprint_;
  }
  /// The same with a ray that leaves the path's for another reason.
  void setRayBeside(const Ray<World>& ray) {
    setRay(ray);
    if (keepsFootprints()) [[unlikely]]
      askedFootprint_ = footprintBeside(footprint_, ray);
  }
  /// Whether shaders read how their inputs change from pixel to pixel: the path then has a footprint, otherwise nothing
  /// of it is ever touched.
  bool keepsFootprints() const { return hasOptionalEffects && keepsFootprints_; }
  /// Of the path's ray, from the next `setRay` on.
  const RayFootprint& footprint() const { return footprint_; }
  void setFootprint(const RayFootprint& footprint) { footprint_ = footprint; }
  /// Of the ray on which questions lie.
  const RayFootprint& askedFootprint() const { return askedFootprint_; }
  /// What kind of ray it is (shading::ray).
  void setRayTypes(std::uint32_t types) { rayTypes_ = types; }
  std::uint32_t rayTypes() const { return rayTypes_; }
  /// Segments of the path so far, that of the ray included.
  void setLength(int length) { length_ = length; }
  int length() const { return length_; }
  Vector<World> direction() const { return direction_; }
  float time() const { return time_; }

  void ask(const volume::Medium& medium, Point<World> point, volume::Quantity quantity) {
    beginQuestions();
    Question& question = questions_.emplace_back();
    question.medium = &medium;
    question.quantity = quantity;
    question.point = point;
    question.rayTypes = rayTypes_;
  }

  /// Suspends until the questions are answered. Without a question the path goes on at once.
  auto answers() {
    struct Awaiter {
      PathContext& path;
      bool await_ready() const { return path.questions_.empty() || path.answered_; }
      void await_suspend(std::coroutine_handle<> waiting) const {
        path.waiting_ = waiting;
        path.unanswered_ = static_cast<std::uint32_t>(path.questions_.size());
        if (path.answers_.size() < path.questions_.size()) path.answers_.resize(path.questions_.size());
        path.sink_.post(path);
      }
      std::span<const volume::Coefficients> await_resume() const {
        if (path.questions_.empty() || path.answered_) return {};
        path.answered_ = true;
        return {path.answers_.data(), path.questions_.size()};
      }
    };
    return Awaiter{*this};
  }

  /// Asks for what AOVs show of a medium, and nothing beside it.
  auto askAbout(const volume::Medium& medium, Point<World> point, MediumFact fact) {
    ask(medium, point, volume::Quantity::coefficients);
    questions_.back().fact = fact;
    return answers();
  }

  /// The closures of a surface at a point that stays valid until then.
  auto shade(shading::InstanceRef surface, const shading::ShadingPoint& point) {
    struct Awaiter {
      PathContext& path;
      bool await_ready() const { return false; }
      void await_suspend(std::coroutine_handle<> waiting) const {
        path.waiting_ = waiting;
        path.unanswered_ = 1;
        path.sink_.post(path);
      }
      const SurfaceAnswer& await_resume() const {
        path.answered_ = true;
        return path.surfaceAnswer_;
      }
    };
    beginQuestions();
    questions_.push_back(
        {nullptr, volume::Quantity::coefficients, {}, surface, &point, rayTypes_, MediumFact::coefficients});
    return Awaiter{*this};
  }

  // For the worker:
  /// Makes room for the answer to a single question that no coroutine asked.
  void prepareAnswer(const Question& question) {
    questions_.assign(1, question);
    answers_.resize(1);
  }
  /// The same for the extinction at several points.
  void prepareAnswers(const volume::Medium& medium, std::span<const Point<World>> points) {
    questions_.clear();
    for (const Point<World>& p : points)
      questions_.push_back({.medium = &medium, .quantity = volume::Quantity::extinction, .point = p});
    answers_.assign(points.size(), {});
  }
  std::span<const Question> questions() const { return questions_; }
  volume::Coefficients& answer(std::size_t question) { return answers_[question]; }
  SurfaceAnswer& surfaceAnswer() { return surfaceAnswer_; }
  const PathId& id() const { return id_; }
  /// Takes note of one answer; true when it was the last one that the path waits for.
  bool answered() { return --unanswered_ == 0; }
  /// Runs on up to the next suspension; false when the path has come to its end.
  bool resume() {
    std::exchange(waiting_, nullptr).resume();
    return waiting_ != nullptr;
  }
  bool isWaiting() const { return waiting_ != nullptr; }
  /// Fetches what `resume` needs.
  void prefetch() const {
    const char* const frame = static_cast<const char*>(waiting_.address());
    for (int line = 0; line < 6; ++line) __builtin_prefetch(frame + 64 * line);
  }
  /// Questions asked so far.
  std::uint32_t questionCount() const { return questionsBefore_ + static_cast<std::uint32_t>(questions_.size()); }
  /// Counts the questions of a path in the order of asking; `question` is an index into `questions`.
  std::uint32_t questionNumber(std::uint32_t question) const { return questionsBefore_ + question; }

 private:
  /// Answers stay readable until the next question.
  void beginQuestions() {
    if (answered_) {
      questionsBefore_ += static_cast<std::uint32_t>(questions_.size());
      questions_.clear();
    }
    answered_ = false;
  }

  // What every question needs lies close together.
  std::coroutine_handle<> waiting_;
  std::uint32_t unanswered_ = 0;
  std::uint32_t questionsBefore_ = 0;
  std::vector<Question> questions_;
  std::vector<volume::Coefficients> answers_;
  bool answered_ = true;
  bool keepsFootprints_ = false;
  float time_ = 0;
  std::uint32_t rayTypes_ = shading::ray::camera;
  int length_ = 1;
  Vector<World> direction_;
  SampleStream random_;
  PathId id_;
  const PreparedScene& scene_;
  QuestionSink& sink_;
  WorkerStatistics& statistics_;
  volume::FrameStack frames_;
  SurfaceAnswer surfaceAnswer_;
  RayFootprint footprint_, askedFootprint_;

 public:
  EffectPointer<PilotPath> pilot;    ///< Of a pilot takes note of its vertices; null otherwise.
  EffectPointer<PathRecord> record;  ///< Of what AOVs gather; null when there are none.

  // Scratch, reused from ray to ray.
  accel::SpanBuffer spans;
  accel::InterfaceBuffer interfaces;
  PathSpans mediumSpans;
  volume::SegmentStream segments;
  volume::MarchingTable marchingTable;
  volume::LightColumns lightColumns;  ///< Of the ray, where lights are tabulated,
  volume::TabulatedLight tabulated;   ///< and what was found.

  volume::MediumStack media;        ///< Surface-defined interiors around the path; only where media nest.
  volume::MediumStack shadowMedia;  ///< The same along a shadow ray.
  volume::MediumStack mediaBehind;  ///< The same behind the surface that was met last.

  /// A face with what is inside of it.
  struct Face {
    accel::SurfaceHit hit;
    volume::Interior interior;
  };
  /// Room for the media along a shadow ray that crosses so many surfaces.
  void beginShadowMedia(std::size_t surfaces) {
    shadowOwnMedia.clear();
    shadowOwnMedia.reserve(surfaces);
  }
  /// The medium of an interior along a shadow ray. One that closures describe is kept as the ray goes on.
  const volume::Medium* keepShadowMedium(const volume::Interior& interior) {
    if (interior.scene || !interior.own) return interior.scene;
    return &shadowOwnMedia.emplace_back(*interior.own);
  }

  std::vector<Face> faces;  ///< That coincide.
  /// A surface that does not stop a shadow ray, though others would meet it.
  struct StraightCrossing {
    Color through;                             ///< What it lets through.
    std::optional<volume::Interior> interior;  ///< What is inside of it.
  };
  std::vector<StraightCrossing> straight;      ///< By interface, where some surface lets shadow rays pass.
  bool wentStraight = false;                   ///< Whether the last shadow ray went through such a surface.
  std::vector<volume::Medium> shadowOwnMedia;  ///< Along it.
  std::vector<accel::SurfaceHit> probed;       ///< Above where a path begins.
};

}  // namespace aerosol::render
