// Emission: the closure's weight is the radiance in every direction.

#include "core/render/closure.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

class Emission final : public Closure {
 public:
  std::string_view name() const override { return "emission"; }
  std::string_view doc() const override { return "Emits its weight as radiance, alike in every direction"; }
  std::span<const DescribedField> fields() const override { return {}; }
  ClosureKind kind() const override { return ClosureKind::emission; }

  Color emitted(std::span<const float>, const ClosurePoint&) const override { return Color(1); }
};

}  // namespace

void registerClosure_emission(Registry& registry) { registry.add(std::make_unique<Emission>()); }

}  // namespace aerosol::render
