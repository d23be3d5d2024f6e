// The cache of compiled code hands out what was put there or nothing, whatever the bytes of its files are; and what is
// read out of entries bears any bytes too. The first byte chooses: an entry as it lies on disk, one that was damaged,
// the interface of a kernel, a program.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "core/jit/kernel_interface.h"
#include "core/jit/object_cache.h"
#include "core/lang/serialize.h"

namespace {

using namespace aerosol;
namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("aerosol_fuzz_cache_" + std::to_string(getpid()));
  std::shared_ptr<jit::ObjectCache> cache;

  Folder() {
    auto opened = jit::ObjectCache::open(path);
    if (!opened) std::abort();
    cache = *opened;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

void writeRaw(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

std::string readRaw(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Folder folder;
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const fs::path file = folder.path / "entry";
  switch (data[0] % 4) {
    case 0: {
      writeRaw(file, bytes);
      const auto got = folder.cache->get("entry");
      if (got && got->size() > bytes.size()) std::abort();
      break;
    }
    case 1: {
      folder.cache->put("entry", bytes);
      if (folder.cache->get("entry") != bytes) std::abort();
      // One byte differs, at a place that the input chooses.
      std::string stored = readRaw(file);
      const std::size_t at = (bytes.empty() ? 0 : static_cast<unsigned char>(bytes[0]) * 131u) % stored.size();
      stored[at] = static_cast<char>(stored[at] ^ 1);
      writeRaw(file, stored);
      if (folder.cache->get("entry")) std::abort();
      break;
    }
    case 2:
      if (const auto interface = jit::deserialiseInterface(bytes)) {
        const auto again = jit::deserialiseInterface(jit::serialise(*interface));
        if (!again) std::abort();
      }
      break;
    default:
      if (const auto program = lang::deserialiseProgram(bytes)) {
        const auto again = lang::deserialiseProgram(lang::serialise(*program));
        if (!again) std::abort();
      }
      break;
  }
  return 0;
}
