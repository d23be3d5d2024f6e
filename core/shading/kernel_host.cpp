#include "core/shading/kernel_host.h"

#include <algorithm>

#include "core/base/hash.h"

namespace aerosol::shading {

void NamedSpaces::add(const std::string& name, const Matrix4& toWorld, const Matrix4& fromWorld) {
  Space space;
  for (std::size_t i = 0; i < 12; ++i) {
    space.toWorld[i] = static_cast<float>(toWorld[i / 4][i % 4]);
    space.fromWorld[i] = static_cast<float>(fromWorld[i / 4][i % 4]);
  }
  spaces_[hashString(name)] = space;
}

const NamedSpaces::Space* NamedSpaces::find(std::uint64_t nameHash) const {
  const auto found = spaces_.find(nameHash);
  return found == spaces_.end() ? nullptr : &found->second;
}

const AerosolHostServices KernelHost::services_{sizeof(AerosolHostServices), &KernelHost::record,
                                                &KernelHost::spaceToWorld, &KernelHost::worldToSpace,
                                                &KernelHost::call};

KernelHost::KernelHost(const NamedSpaces& spaces, std::uint32_t loopBudget, Services* services)
    : context_{{&services_, {0, 0}, loopBudget}, this},
      spaces_(spaces),
      calls_(
          [this](std::uint32_t site, std::uint32_t point, std::string_view text) {
            AerosolRecordValue value;
            value.s = calls_.strings().add(text);
            records_.push_back({AEROSOL_REPORT_HOST, site, point, {value}});
          },
          services) {}

void KernelHost::call(AerosolKernelContext* context, const AerosolHostCall* call) { of(context).calls_.call(*call); }

void KernelHost::record(AerosolKernelContext* context, std::uint32_t kind, std::uint32_t site, std::uint32_t lane,
                        const AerosolRecordValue* arguments, std::uint32_t count) {
  of(context).records_.push_back({kind, site, lane, {arguments, arguments + count}});
}

std::int32_t KernelHost::spaceToWorld(AerosolKernelContext* context, std::uint64_t name, std::uint32_t, float,
                                      float* matrix) {
  const NamedSpaces::Space* space = of(context).spaces_.find(name);
  if (space) std::copy_n(space->toWorld, 12, matrix);
  return space != nullptr;
}

std::int32_t KernelHost::worldToSpace(AerosolKernelContext* context, std::uint64_t name, std::uint32_t, float,
                                      float* matrix) {
  const NamedSpaces::Space* space = of(context).spaces_.find(name);
  if (space) std::copy_n(space->fromWorld, 12, matrix);
  return space != nullptr;
}

}  // namespace aerosol::shading
