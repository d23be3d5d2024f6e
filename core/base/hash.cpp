#include "core/base/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <fstream>
#include <iterator>
#include <new>

namespace aerosol {

std::uint64_t hashString(std::string_view text) { return text.empty() ? 0 : XXH3_64bits(text.data(), text.size()); }

StrongHash::StrongHash() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(static_cast<XXH3_state_t*>(state_));
}

StrongHash::~StrongHash() { XXH3_freeState(static_cast<XXH3_state_t*>(state_)); }

StrongHash& StrongHash::add(std::string_view piece) {
  add(static_cast<std::uint64_t>(piece.size()));
  if (!piece.empty()) XXH3_128bits_update(static_cast<XXH3_state_t*>(state_), piece.data(), piece.size());
  return *this;
}

StrongHash& StrongHash::add(std::uint64_t value) {
  XXH3_128bits_update(static_cast<XXH3_state_t*>(state_), &value, sizeof(value));
  return *this;
}

std::string StrongHash::hex() const {
  const XXH128_hash_t h = XXH3_128bits_digest(static_cast<XXH3_state_t*>(state_));
  return fmt::format("{:016x}{:016x}", h.high64, h.low64);
}

std::optional<std::string> hashFile(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return {};
  const std::string content{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) return {};
  return StrongHash().add(content).hex();
}

}  // namespace aerosol
