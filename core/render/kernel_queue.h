// Requests of the paths in flight, gathered by kernel and answered in full batches.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/render/path_context.h"
#include "core/render/question_facts.h"
#include "core/render/volume_look.h"
#include "core/shading/batch.h"

namespace aerosol::render {

class MessageLog;

/// Where a question came from.
struct PendingQuestion {
  std::uint32_t slot = 0;
  std::uint32_t question = 0;
};

/// One thread's queues, one a kernel.
class KernelQueues {
 public:
  KernelQueues(const PreparedScene& scene, WorkerStatistics& statistics, int batchSize);

  void push(const Question& question, const PathContext& path, PendingQuestion from);
  bool empty() const { return waiting_ == 0; }

  /// Runs the kernel with the most questions on at most a batch of them and writes the answers into the paths.
  /// `paths[slot]` is the path of a slot. Returns the questions answered, valid until the next call: none when the
  /// kernel found out where to ask on.
  std::span<const PendingQuestion> runFullest(std::span<PathContext* const> paths);

  shading::KernelHost& host() { return host_; }

 private:
  /// Where an output of a surface shader goes, and what becomes of it on the way.
  struct SurfaceParameter {
    std::size_t output = 0;
    std::size_t destination = 0;  ///< Float of the answer.
    lang::BaseType type = lang::BaseType::floating;
    std::vector<std::uint64_t> choices;  ///< Strings: hashes of the known texts; the place among them is the float.
  };
  struct Queue {
    std::uint32_t family = 0;
    shading::Variant variant{};
    std::vector<PendingQuestion> questions;
    shading::PointArrays points;                    ///< Of the questions.
    std::vector<std::size_t> destinations;          ///< Float of the answer that each output goes to.
    std::vector<float> least;                       ///< By output: what is below is wrong.
    std::array<std::size_t, 3> sigmaT{}, sigmaS{};  ///< Volumes: outputs of the channels.
    bool copiesSigmaS = false;                      ///< One lobe: its σs is the sum.
    std::uint32_t lobes = 0;
    std::uint32_t sites = 0;
    std::vector<SurfaceParameter> parameters;             ///< Surfaces: where the outputs go instead.
    std::vector<std::pair<std::size_t, float>> defaults;  ///< Surfaces: floats of the answer that no output sets.
  };

  Queue& queueOf(shading::InstanceRef shader, shading::Variant variant) {
    return queues_[shader.family * shading::variantCount + static_cast<std::size_t>(variant)];
  }
  void pushMedium(const Question& question, const PathContext& path, Point<World> point, PendingQuestion from);
  void pushPoint(Queue& queue, const PathContext& path, Point<World> point, std::uint32_t instance);
  void moveQuestions(std::span<PathContext* const> paths);
  void prepareLayout(Queue& queue) const;
  void prepareSurfaceLayout(Queue& queue) const;
  bool allSound(const Queue& queue) const;
  bool someAmplify(const Queue& queue) const;
  void scatterExtinction(const Queue& queue, std::span<PathContext* const> paths);
  void scatterCoefficients(const Queue& queue, std::span<PathContext* const> paths);
  void scatterSurfaces(const Queue& queue, std::span<PathContext* const> paths);
  void scatterOutputs(std::span<PathContext* const> paths);
  const std::optional<VolumeLook>& lookOf(const PathContext& path, const PendingQuestion& from) const;
  void checkAlbedo(const volume::Coefficients& answer, std::uint32_t index, const PathContext& path);
  void checkCoefficients(volume::Coefficients& answer, std::uint32_t index, PathContext& path);
  void count(const Queue& queue, int points, int width, std::uint64_t nanoseconds);

  const PreparedScene& scene_;
  WorkerStatistics& statistics_;
  shading::KernelHost host_;
  QuestionFacts facts_;
  shading::Batch batch_;
  std::vector<Queue> queues_;  ///< family · variantCount + variant
  std::vector<PendingQuestion> running_;
  std::vector<PendingQuestion> settled_;  ///< Answered without their media: velocities led to where nothing was.
  std::size_t waiting_ = 0;
};

}  // namespace aerosol::render
