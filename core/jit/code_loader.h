// Objects in memory to functions that can be called.
#pragma once

#include <memory>
#include <string>

#include "core/base/result.h"
#include "core/lang/abi.h"

namespace aerosol::jit {

namespace detail {
struct LoadedCode;
}

/// An ORC session. Loads from many threads at once.
class CodeLoader : public std::enable_shared_from_this<CodeLoader> {
 public:
  static Result<std::shared_ptr<CodeLoader>> create();
  ~CodeLoader();
  CodeLoader(const CodeLoader&) = delete;
  CodeLoader& operator=(const CodeLoader&) = delete;

  struct Loaded {
    std::shared_ptr<const detail::LoadedCode> code;  ///< Keeps the function in memory.
    AerosolKernel function = nullptr;
  };
  /// Links the object, whose function is called `kernel`.
  Result<Loaded> load(const std::string& object);

 private:
  friend struct detail::LoadedCode;
  struct State;
  explicit CodeLoader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace aerosol::jit
