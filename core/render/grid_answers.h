// Grids of a volume's own file as attributes of it: what its shader gets by getattribute("density", value).
#pragma once

#include <map>
#include <memory>
#include <string>
#include <tuple>

#include "core/lang/grid_reads.h"
#include "core/render/registry.h"
#include "core/shading/group_library.h"

namespace aerosol::render {

class GridAnswers {
 public:
  /// Lets the grids of these files answer what the shader asks. Nothing changes for shaders that ask for none.
  void bind(shading::BoundGroup& bound, const VolumeFiles& files, shading::Services& services);

 private:
  struct Known {
    std::shared_ptr<const lang::Program> original;  ///< Keeps what the key tells by address.
    std::shared_ptr<const lang::Program> program;   ///< Null where nothing is asked.
    std::vector<lang::GridRead> reads;
    std::uint32_t blend = 0;
  };
  const Known& programOf(const std::shared_ptr<const lang::Program>& program, const lang::GridReadOptions& options);

  /// Programs stay the same for equal questions, so that instances share kernels.
  std::map<std::tuple<const lang::Program*, bool, bool>, Known> known_;
};

}  // namespace aerosol::render
