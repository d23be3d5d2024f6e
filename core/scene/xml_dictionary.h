// XML documents as dictionaries, searched by XPath 1.0.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/dictionary_source.h"

namespace aerosol::scene {

/// Files are looked for in the folders. Each document is read once.
std::unique_ptr<DictionarySource> openDictionaries(std::vector<std::filesystem::path> searchPath);

}  // namespace aerosol::scene
