// The `$name` constants of a scene: `<default>` and `-D name=value`.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/scene/value.h"

namespace aerosol::scene {

/// Constants by name. What the command line defines wins over `<default>`; of several defaults the first one wins, so
/// that a scene can choose before it includes a file.
class Definitions {
 public:
  explicit Definitions(const std::map<std::string, std::string>& commandLine);

  void setDefault(const std::string& name, std::string value, const SourceLocation& location);

  /// `text` with each `$name` and `${name}` replaced and `$$` made `$`. Without a value, `error` says why.
  std::optional<std::string> substitute(std::string_view text, TextError& error);

  std::vector<std::string> names() const;
  /// Command-line names that nothing asked for.
  std::vector<std::string> unusedFromCommandLine() const;
  /// Names of defaults that nothing asked for, with their places.
  std::map<std::string, SourceLocation> unusedDefaults() const;

  /// A letter or underscore, then letters, digits and underscores.
  static bool isName(std::string_view name);

 private:
  struct Definition {
    std::string value;
    bool fromCommandLine = false;
    bool used = false;
    std::optional<SourceLocation> defaultLocation;
  };

  std::map<std::string, Definition, std::less<>> definitions_;
};

}  // namespace aerosol::scene
