// Notices when files change.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace aerosol::app {

class FileWatch {
 public:
  /// From now on these files count; names of things that are no files are fine.
  void watch(const std::set<std::string>& files);
  /// Whether one of them was written, made or removed since `watch` or the last `hasChanged` that said so.
  bool hasChanged();

 private:
  struct State {
    bool exists = false;
    std::filesystem::file_time_type time{};
    std::uintmax_t size = 0;

    bool operator==(const State&) const = default;
  };
  static State stateOf(const std::filesystem::path& file);

  std::map<std::string, State> files_;
};

}  // namespace aerosol::app
