#include "core/shading/runtime_strings.h"

#include <algorithm>

#include "core/base/hash.h"

namespace aerosol::shading {

namespace {

/// Beyond this the strings of earlier runs are forgotten.
constexpr std::size_t keptBytes = std::size_t{1} << 20;
constexpr std::size_t bytesBesideText = 80;

}  // namespace

void RuntimeStrings::begin(const jit::KernelInterface& interface, const StringList* ofInstances, std::size_t count) {
  interface_ = &interface;
  ofInstances_ = ofInstances;
  count_ = count;
  charged_.clear();
  if (madeBytes_ <= keptBytes) return;
  made_.clear();
  madeBytes_ = 0;
}

std::string_view RuntimeStrings::text(std::uint64_t hash) const {
  if (hash == 0) return {};
  if (const auto made = made_.find(hash); made != made_.end()) return made->second;
  if (interface_) {
    if (const auto known = interface_->strings.find(hash); known != interface_->strings.end()) return known->second;
  }
  if (ofInstances_) {
    const auto known =
        std::find_if(ofInstances_->begin(), ofInstances_->end(), [&](const auto& one) { return one.first == hash; });
    if (known != ofInstances_->end()) return known->second;
  }
  return {};
}

std::uint64_t RuntimeStrings::add(std::string_view text) {
  const std::uint64_t hash = hashString(text);
  if (hash != 0 && made_.try_emplace(hash, text).second) madeBytes_ += text.size() + bytesBesideText;
  return hash;
}

RuntimeStrings::Room RuntimeStrings::charge(std::size_t point, std::size_t bytes) {
  if (charged_.empty()) charged_.resize(count_, 0);
  if (point >= charged_.size() || charged_[point] > roomOfPoint) return Room::usedUpBefore;
  charged_[point] = static_cast<std::uint32_t>(std::min(roomOfPoint + 1, charged_[point] + bytes + bytesBesideText));
  return charged_[point] <= roomOfPoint ? Room::enough : Room::usedUp;
}

}  // namespace aerosol::shading
