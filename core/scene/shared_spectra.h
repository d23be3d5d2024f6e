// `<spectrum id="…">`: values by wavelength that several objects refer to.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/scene/attributes.h"
#include "core/scene/element.h"
#include "core/scene/spectrum.h"

namespace aerosol::scene {

/// Spectra by id. What one is as a colour depends on who asks (light or a factor of light), so each reference reads it.
class SharedSpectra {
 public:
  /// An element with an id, of a file that outlives this. Two with the same id are reported.
  void add(const XmlElement& xml, ReadContext context);
  /// Makes values out of the references below `tree.scene` that mean a spectrum, and reports spectra nothing refers to,
  /// references without a name and ids that objects have as well. Aliases of spectra are taken out of the tree.
  void resolve(SceneTree& tree, Definitions& definitions, Reporter& reporter);

 private:
  struct Entry {
    XmlElement xml;
    const SourceText* source = nullptr;
    SourceLocation location;
    bool isReferredTo = false;
    bool standsAlone = false;  ///< Not a value of an object itself.
  };

  void takeAliases(SceneTree& tree);
  void resolveBelow(Element& object, const std::vector<std::filesystem::path>& searchPath, Definitions& definitions,
                    Reporter& reporter);

  std::map<std::string, Entry> entries_;
  std::map<std::string, std::string> aliases_;
};

/// Which colour of a spectrum a parameter of an object with this tag means.
SpectrumUse spectrumUseIn(const std::string& tag);

}  // namespace aerosol::scene
