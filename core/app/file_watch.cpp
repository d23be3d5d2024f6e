#include "core/app/file_watch.h"

namespace aerosol::app {

FileWatch::State FileWatch::stateOf(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  return {true, std::filesystem::last_write_time(file, ignored), std::filesystem::file_size(file, ignored)};
}

void FileWatch::watch(const std::set<std::string>& files) {
  std::map<std::string, State> states;
  for (const std::string& file : files) {
    const auto known = files_.find(file);
    states[file] = known == files_.end() ? stateOf(file) : known->second;
  }
  files_ = std::move(states);
}

bool FileWatch::hasChanged() {
  bool changed = false;
  for (auto& [file, state] : files_) {
    const State now = stateOf(file);
    changed = changed || !(now == state);
    state = now;
  }
  return changed;
}

}  // namespace aerosol::app
