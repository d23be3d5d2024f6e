// One program run on all points of a grid.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/app/toolchain.h"
#include "core/app/tools/shade_arguments.h"
#include "core/app/tools/shade_host.h"
#include "core/base/result.h"
#include "core/shading/shading_system.h"

namespace aerosol::app {

/// An output parameter of all points, rows from the top, components one after the other.
struct ShadedOutput {
  std::string name;
  lang::Type type;
  int components = 1;
  std::variant<std::vector<float>, std::vector<std::int32_t>, std::vector<std::string>> values;
};

/// What a point said.
struct ShadedMessage {
  std::uint32_t kind = AEROSOL_MESSAGE_PRINT;
  SourceLocation location;
  std::string text;
  std::vector<AerosolRecordValue> values;  ///< Of reports: see abi.h.
  std::string file;                        ///< Where the text goes, of fprintf.
};

struct Shaded {
  std::vector<ShadedOutput> outputs;
  std::vector<ShadedMessage> messages;  ///< Point after point, of each in the order of its calls.
};

class GridShader {
 public:
  /// Compiles the program with the parameters given; `host` answers what shaders ask.
  static Result<GridShader> create(const Toolchain& toolchain, std::shared_ptr<const lang::Program> program,
                                   std::vector<shading::ParameterValue> values, std::shared_ptr<const ShadeHost> host);

  /// `threads` 0: one a processor. The result does not depend on it.
  Shaded run(const ShadeGrid& grid, int threads) const;

  /// The outputs that `run` fills, all zero.
  Shaded emptyOutputs(const ShadeGrid& grid) const;

 private:
  const lang::Program& program() const { return *family().program; }
  struct Block;
  const shading::Family& family() const { return system_.families().front(); }
  void shadeBlock(const ShadeGrid& grid, Block& block, Shaded& shaded) const;

  shading::ShadingSystem system_;
  std::shared_ptr<const ShadeHost> host_;
};

}  // namespace aerosol::app
