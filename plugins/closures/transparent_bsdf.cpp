// Light passes straight on; the name that MaterialX has for it.

#include "core/render/closure.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

class TransparentBsdf final : public Closure {
 public:
  std::string_view name() const override { return "transparent_bsdf"; }
  std::string_view doc() const override { return "Lets light pass straight on"; }
  std::span<const DescribedField> fields() const override { return {}; }
  ClosureKind kind() const override { return ClosureKind::transparent; }

  std::optional<ClosureSample> sample(std::span<const float>, const ClosurePoint& point,
                                      const ClosureUniforms&) const override {
    return ClosureSample{
        .direction = -point.toViewer, .weight = Color(1), .pdf = 1, .isDelta = true, .isPassing = true};
  }

  Color albedo(std::span<const float>, const ClosurePoint&) const override { return Color(1); }
};

}  // namespace

void registerClosure_transparent_bsdf(Registry& registry) { registry.add(std::make_unique<TransparentBsdf>()); }

}  // namespace aerosol::render
