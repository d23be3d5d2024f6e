// Light passes straight on. The language has two names for it.
#pragma once

#include "core/render/closure.h"

namespace aerosol::render {

class StraightOn final : public Closure {
 public:
  /// `name` outlives the closure.
  explicit StraightOn(std::string_view name) : name_(name) {}

  std::string_view name() const override { return name_; }
  std::string_view doc() const override { return "Lets light pass straight on"; }
  std::span<const DescribedField> fields() const override { return {}; }
  ClosureKind kind() const override { return ClosureKind::transparent; }

  std::optional<ClosureSample> sample(std::span<const float>, const ClosurePoint& point,
                                      const ClosureUniforms&) const override {
    return ClosureSample{
        .direction = -point.toViewer, .weight = Color(1), .pdf = 1, .isDelta = true, .isPassing = true};
  }

  Color albedo(std::span<const float>, const ClosurePoint&) const override { return Color(1); }

 private:
  std::string_view name_;
};

}  // namespace aerosol::render
