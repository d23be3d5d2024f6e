// What shaders may ask about the points of a batch of questions.
#pragma once

#include <span>

#include "core/render/path_context.h"
#include "core/shading/attributes.h"

namespace aerosol::render {

struct PendingQuestion;

class QuestionFacts final : public shading::PointFacts {
 public:
  explicit QuestionFacts(const PreparedScene& scene) : scene_(scene) {}

  /// The batch's points are those of these questions; both must stay while it runs.
  void begin(std::span<const PendingQuestion> questions, std::span<PathContext* const> paths) {
    questions_ = questions;
    paths_ = paths;
  }

  std::uint32_t rayTypes(std::uint32_t point) const override;
  bool isBackfacing(std::uint32_t point) const override;
  std::uint64_t randomKey(std::uint32_t point) const override;
  float surfaceArea(std::uint32_t point) const override;
  const shading::AttributeTable* attributes(std::uint32_t point) const override;
  std::optional<lang::Type> userData(std::uint32_t point, std::uint64_t nameHash,
                                     std::span<float, maximumUserData> values) const override;
  bool trace(std::uint32_t point, const shading::TraceRequest& request, shading::TraceAnswer& answer) const override;

 private:
  const Question& question(std::uint32_t point) const;
  const shading::Instance& instance(std::uint32_t point) const;

  const PreparedScene& scene_;
  std::span<const PendingQuestion> questions_;
  std::span<PathContext* const> paths_;
};

}  // namespace aerosol::render
