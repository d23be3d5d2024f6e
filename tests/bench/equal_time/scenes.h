// The six scenes, and the methods that each is rendered with.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aerosol::bench {

/// Parameters of the integrator, as elements of the scene.
struct Method {
  std::string name;
  std::string parameters;
};

struct BenchScene {
  std::string name;
  std::string integrator;  ///< What all methods have in common.
  std::string content;     ///< Everything but integrator and sensor.
  double fov = 26;         ///< Degrees.
  bool varies = true;      ///< False where closed forms hold everywhere: methods differ in what they do for lights.
};

/// The name of the automatic choice and of the one that it is compared with first.
inline constexpr const char* automaticName = "automatic";
inline constexpr const char* simplestName = "simplest";

/// All methods, the automatic one first. Those that come to the same in a scene are measured once.
const std::vector<Method>& allMethods();

/// The halves of a scene's reference.
Method firstReference(const BenchScene& scene);
Method secondReference(const BenchScene& scene);

/// `voxels` is the file of the baked cloud.
std::vector<BenchScene> allScenes(const std::filesystem::path& voxels);

/// The shader whose voxels are baked.
inline constexpr const char* bakedShader = "cumulus";

}  // namespace aerosol::bench
