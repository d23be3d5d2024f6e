// What a command line of `aerosol shade` (testshade) asks for, as plain data.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/app/arguments.h"
#include "core/app/command_line.h"
#include "core/app/tools/typed_value.h"

namespace aerosol::app {

/// A value for a shader's parameter, or user data.
struct NamedValue {
  std::string name;
  TypedValue value;
  bool interpolated = false;  ///< User data of that name comes first.
  bool interactive = false;   ///< May change between iterations.
};

struct ShadeLayer {
  std::string shader;      ///< A name, or a file; for an expression: the name that it is given.
  std::string expression;  ///< Source of the whole shader instead.
  std::string layer;       ///< Empty: the shader's name and the layer's number.
  std::vector<NamedValue> values;
};

struct ShadeConnection {
  std::string fromLayer, fromOutput, toLayer, toInput;
};

struct ShadeOutput {
  std::string variable;  ///< "name" or "layer.name"
  std::string file;      ///< "null": not written.
};

struct ShadeReparameter {
  std::string layer;
  NamedValue value;
};

/// Points of a patch: u and v run over it, the position is (u, v, 1).
struct ShadeGrid {
  int width = 1, height = 1;
  bool pixelCentres = false;  ///< Otherwise the first and last points lie on the patch's border.
  float uScale = 1, vScale = 1, uOffset = 0, vOffset = 0;
  bool varyDP = false, varyDU = false, varyDV = false;  ///< Derivatives that differ from point to point.
};

struct ShadeArguments {
  ShadeGrid grid;
  std::vector<ShadeLayer> layers;
  std::vector<ShadeConnection> connections;
  std::string group;  ///< A group's description, or a file that holds one.
  std::string groupName;
  std::vector<ShadeOutput> outputs;
  std::string dataFormat;  ///< uint8, half or float; empty: as computed.
  bool printValues = false;
  int iterations = 1;
  int threads = 0;  ///< 0: one a processor.
  std::vector<ShadeReparameter> reparameters;
  std::string rayType = "camera";    ///< What all points' rays are.
  std::vector<NamedValue> userData;  ///< What the geometry carries, the same at all points.
  bool userDataIsConnected = false;  ///< isconnected() says so of parameters that read user data.
  std::vector<std::string> shaderPath;
  std::vector<std::string> entryLayers, entryOutputs;
  std::string archive;
  bool verbose = false, statistics = false, query = false;
  std::vector<std::string> ignored;  ///< Options that mean nothing here, as they were spelled.
  KernelArguments kernels;
};

/// The arguments behind the command's name, or help, or what is wrong with them.
std::variant<ShadeArguments, Reply> parseShadeArguments(const std::vector<std::string>& words);

std::string shadeHelp();

}  // namespace aerosol::app
