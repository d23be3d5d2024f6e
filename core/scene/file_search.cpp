#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>

#include "core/scene/reporter.h"
#include "core/scene/syntax.h"

namespace aerosol::scene {

namespace {

constexpr std::uintmax_t largestFile = std::uintmax_t{1} << 30;

bool isRegularFile(const std::filesystem::path& path) {
  std::error_code code;
  return std::filesystem::is_regular_file(path, code);
}

}  // namespace

std::optional<std::string> readFile(const std::filesystem::path& path, std::string& error) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    error = "it does not exist";
    return std::nullopt;
  }
  if (!isRegularFile(path)) {
    error = "it is not a file";
    return std::nullopt;
  }
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  if (!code && size > largestFile) {
    error = "it is larger than 1 GiB; put meshes into files of their own";
    return std::nullopt;
  }
  std::ifstream stream(path, std::ios::binary);
  std::string text(static_cast<std::size_t>(size), '\0');
  if (!stream || !stream.read(text.data(), static_cast<std::streamsize>(text.size()))) {
    error = "it cannot be read";
    return std::nullopt;
  }
  return text;
}

std::optional<std::filesystem::path> findFile(const std::string& name, const std::filesystem::path& directory,
                                              const std::vector<std::filesystem::path>& searchPath) {
  const std::filesystem::path file(name);
  if (file.is_absolute()) return isRegularFile(file) ? std::optional(file) : std::nullopt;
  if (isRegularFile(directory / file)) return (directory / file).lexically_normal();
  for (const std::filesystem::path& folder : searchPath) {
    if (isRegularFile(folder / file)) return (folder / file).lexically_normal();
  }
  return std::nullopt;
}

std::string describeSearch(const std::string& name, const std::filesystem::path& directory,
                           const std::vector<std::filesystem::path>& searchPath) {
  if (std::filesystem::path(name).is_absolute()) return "the name is absolute: no folder is searched";
  std::vector<std::string> folders = {fmt::format("'{}'", directory.empty() ? "." : directory.string())};
  for (const std::filesystem::path& folder : searchPath) folders.push_back(fmt::format("'{}'", folder.string()));
  return fmt::format("looked in {}", join(folders));
}

}  // namespace aerosol::scene
