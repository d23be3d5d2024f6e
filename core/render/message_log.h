// Messages of shaders and reports about them, in the order (pixel, sample, call), whatever thread and batch they came
// from. A call is known by the number of its question within the path: batches may answer questions in any order.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/render/kernel_queue.h"
#include "core/shading/message.h"

namespace aerosol::render {

/// A shader's message about one point of one path.
struct Message {
  PathId path;
  std::uint32_t question = 0;  ///< Of the path, in the order of asking.
  std::uint32_t call = 0;      ///< Counts the messages of the question.
  std::uint32_t kind = AEROSOL_MESSAGE_PRINT;
  SourceLocation location;
  std::string text;
  std::string file;  ///< Where it goes, of AEROSOL_MESSAGE_FILE.
};

/// Thread-safe. Keeps the first `maximum` messages in the order above, and the count of the others.
class MessageLog {
 public:
  explicit MessageLog(std::size_t maximum = 10000) : maximum_(maximum) {}

  /// Takes the records of the batch that has just run.
  void collect(shading::KernelHost& host, const shading::Batch& batch, std::span<const PendingQuestion> lanes,
               std::span<PathContext* const> paths);

  /// Takes one that was said before the render: the pixel of its path is (-1, -1), and it comes before all others.
  void add(Message message);

  /// A shader gave NaN, infinite or negative coefficients. Kept once a medium: for the first (pixel, sample, question).
  void reportInvalid(const volume::Medium& medium, Point<World> point, const volume::Coefficients& given,
                     const PathId& path, std::uint32_t question = 0);
  /// The reported medium is the same everywhere.
  void markInvalidEverywhere(const volume::Medium& medium);
  /// A shader gave scattering above extinction: an albedo above 1. Kept likewise.
  void reportAmplifying(const volume::Medium& medium, Point<World> point, const volume::Coefficients& given,
                        const PathId& path, std::uint32_t question = 0);
  /// A surface shader gave closures with weights or parameters that are NaN or infinite. Kept once an object.
  void reportInvalidSurface(std::uint32_t object, std::uint32_t site, Point<World> point, const PathId& path);

  struct Invalid {
    PathId path;
    std::uint32_t question = 0;
    Point<World> point;
    volume::Coefficients given;
    std::uint64_t count = 0;
    bool isEverywhere = false;  ///< Of a constant medium: asked once, when the scene was prepared.
  };

  struct InvalidSurface {
    PathId path;
    std::uint32_t site = 0;  ///< Index of the closure's call site.
    Point<World> point;
    std::uint64_t count = 0;
  };

  std::vector<Message> sorted() const;
  std::uint64_t dropped() const;
  /// By medium index.
  std::map<std::uint32_t, Invalid> invalid() const;
  std::map<std::uint32_t, Invalid> amplifying() const;
  /// By object.
  std::map<std::uint32_t, InvalidSurface> invalidSurfaces() const;

 private:
  struct Order {
    bool operator()(const Message& a, const Message& b) const {
      return std::tie(a.path, a.question, a.call) < std::tie(b.path, b.question, b.call);
    }
  };

  void insert(Message message);
  static void note(Invalid& entry, Point<World> point, const volume::Coefficients& given, const PathId& path,
                   std::uint32_t question);

  const std::size_t maximum_;
  mutable std::mutex mutex_;
  std::set<Message, Order> messages_;
  std::uint64_t dropped_ = 0;
  std::map<std::uint32_t, Invalid> invalid_, amplifying_;
  std::map<std::uint32_t, InvalidSurface> invalidSurfaces_;
};

}  // namespace aerosol::render
