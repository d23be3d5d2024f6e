// A hole in the image: nothing is seen, nothing is covered, and what lies behind is hidden.

#include "core/render/closure.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

class Holdout final : public Closure {
 public:
  std::string_view name() const override { return "holdout"; }
  std::string_view doc() const override { return "Cuts a hole into the image: its weight is taken from the coverage"; }
  std::span<const DescribedField> fields() const override { return {}; }
  ClosureKind kind() const override { return ClosureKind::holdout; }
};

}  // namespace

void registerClosure_holdout(Registry& registry) { registry.add(std::make_unique<Holdout>()); }

}  // namespace aerosol::render
