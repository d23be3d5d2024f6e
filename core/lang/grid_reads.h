// Values of voxel grids that a volume shader asks for by their names: getattribute("density", value).
#pragma once

#include <vector>

#include "core/lang/program.h"

namespace aerosol::lang {

/// A voxel file that answers such questions; two of them are two frames, between which values are mixed.
struct GridReadOptions {
  bool isBlended = false;      ///< There is a second file.
  bool changesInTime = false;  ///< Grids are read at the time of the point.
};

/// One question, and the parameters that the program has for its answer: strings that name a file, empty where its
/// grids do not answer.
struct GridRead {
  VariableId name = noVariable;  ///< A constant, or a parameter that is nowhere written.
  bool isTriple = false;         ///< What is asked for.
  struct Files {
    std::uint32_t scalar = 0;  ///< Where the grid has one channel.
    std::uint32_t vector = 0;  ///< Where it has three; of triples alone.
  };
  Files first, second;  ///< `second` where two files are blended.
};

struct GridReads {
  Program program;
  std::vector<GridRead> reads;
  std::uint32_t blend = 0;  ///< Parameter: the part of the second file, from 0 to 1. Where files are blended.
};

/// Lets grids answer what the shader asks of its own object by getattribute, in floats and triples: a lookup at P, in
/// the space "object", comes before the question to the host, which stays for the case that no file is given. Nothing
/// to do: no reads.
GridReads bindGrids(const Program& program, const GridReadOptions& options);

}  // namespace aerosol::lang
