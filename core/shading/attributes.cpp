#include "core/shading/attributes.h"

#include <algorithm>

#include "core/base/hash.h"

namespace aerosol::shading {

void AttributeTable::set(std::string_view name, lang::Constant value) {
  values_.insert_or_assign(hashString(name), std::move(value));
}

const lang::Constant* AttributeTable::find(std::uint64_t nameHash) const {
  const auto found = values_.find(nameHash);
  return found == values_.end() ? nullptr : &found->second;
}

AttributeTable& SceneAttributes::object(std::string_view name) { return objects_[hashString(name)]; }

const AttributeTable* SceneAttributes::find(std::uint64_t nameHash) const {
  const auto found = objects_.find(nameHash);
  return found == objects_.end() ? nullptr : &found->second;
}

std::uint32_t PointFacts::rayTypes(std::uint32_t) const { return 0; }
bool PointFacts::isBackfacing(std::uint32_t) const { return false; }
std::uint64_t PointFacts::randomKey(std::uint32_t point) const { return point; }
float PointFacts::surfaceArea(std::uint32_t) const { return 0; }
const AttributeTable* PointFacts::attributes(std::uint32_t) const { return nullptr; }
std::optional<lang::Type> PointFacts::userData(std::uint32_t, std::uint64_t, std::span<float, maximumUserData>) const {
  return std::nullopt;
}
bool PointFacts::trace(std::uint32_t, const TraceRequest&, TraceAnswer&) const { return false; }
void PointFacts::userDataChange(std::uint32_t, std::uint64_t, int, std::span<float, maximumUserData> values) const {
  std::ranges::fill(values, 0.0f);
}

}  // namespace aerosol::shading
