// The radiance of surroundings; on a surface, of a painted backdrop.

#include "core/render/closure.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

class Background final : public Closure {
 public:
  std::string_view name() const override { return "background"; }
  std::string_view doc() const override { return "Shows its weight as radiance, as the surroundings do"; }
  std::span<const DescribedField> fields() const override { return {}; }
  ClosureKind kind() const override { return ClosureKind::emission; }

  Color emitted(std::span<const float>, const ClosurePoint&) const override { return Color(1); }
};

}  // namespace

void registerClosure_background(Registry& registry) { registry.add(std::make_unique<Background>()); }

}  // namespace aerosol::render
