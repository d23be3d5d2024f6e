// What a shader shows beside the picture: `debug("name")` gives its weight to the AOV of that name.

#include "core/render/closure.h"
#include "core/render/registry.h"

namespace aerosol::render {

namespace {

/// Which output it is has been read from the program: the value itself counts for nothing here.
constexpr DescribedField debugFields[] = {
    {.name = "outputname", .type = FieldType::choice, .unit = "", .doc = "Of the AOV: --aov NAME=debug:OUTPUT"}};

class Debug final : public Closure {
 public:
  std::string_view name() const override { return "debug"; }
  std::string_view doc() const override { return "Adds its weight to an AOV, nothing to the picture"; }
  std::span<const DescribedField> fields() const override { return debugFields; }
  ClosureKind kind() const override { return ClosureKind::output; }
};

}  // namespace

void registerClosure_debug(Registry& registry) { registry.add(std::make_unique<Debug>()); }

}  // namespace aerosol::render
