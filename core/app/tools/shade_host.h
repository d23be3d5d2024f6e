// What shaders on a grid may ask the renderer, answered as OSL's testshade does.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "core/app/tools/shade_arguments.h"
#include "core/app/tools/shade_group.h"
#include "core/shading/attributes.h"
#include "core/shading/services.h"
#include "core/shading/shading_point.h"

namespace aerosol::app {

/// For all points of a grid. Safe to read from all threads.
struct ShadeHost {
  /// What the geometry carries, the same at all points.
  struct UserData {
    lang::Type type;
    std::vector<float> values;
  };
  shading::SceneAttributes attributes;
  std::unique_ptr<shading::Services> services;
  std::map<std::uint64_t, UserData> userData;  ///< By the hash of its name.
  std::uint32_t rayTypes = 0;
  shading::AttributeTable traced;  ///< Of what rays hit.
};

/// A camera of 90 degrees, the names of the last layer and of the group, and files along the path.
std::shared_ptr<const ShadeHost> makeShadeHost(const ShadeArguments& arguments,
                                               std::vector<std::filesystem::path> searchPath, const ShadeGroup& group);

/// Of a batch of points that lie one after the other in the grid's rows. Besides what the command line gives, their
/// user data is testshade's: s and t are u and v; red is u where P.x > 0.5, green is v where P.x < 0.5, blue is 1 - u
/// in every second twelfth of P.y; "shading:index" is the point's number.
class GridFacts final : public shading::PointFacts {
 public:
  GridFacts(const ShadeGrid& grid, const ShadeHost& host) : grid_(grid), host_(host) {}

  /// The number of the batch's first point.
  void begin(int first) { first_ = first; }

  std::uint32_t rayTypes(std::uint32_t) const override { return host_.rayTypes; }
  std::uint64_t randomKey(std::uint32_t point) const override { return static_cast<std::uint64_t>(number(point)); }
  float surfaceArea(std::uint32_t) const override { return 1; }
  std::optional<lang::Type> userData(std::uint32_t point, std::uint64_t nameHash,
                                     std::span<float, maximumUserData> values) const override;
  /// As testshade has it, where nothing can be hit: yes if u / dot(P, R) > 0.5. What it tells of the hit follows from u
  /// and v, and there is something to tell where u > 0.5.
  bool trace(std::uint32_t point, const shading::TraceRequest& request, shading::TraceAnswer& answer) const override;
  void userDataChange(std::uint32_t point, std::uint64_t nameHash, int axis,
                      std::span<float, maximumUserData> values) const override;

 private:
  int number(std::uint32_t point) const { return first_ + static_cast<int>(point); }
  shading::ShadingPoint at(std::uint32_t point) const;

  const ShadeGrid& grid_;
  const ShadeHost& host_;
  int first_ = 0;
};

}  // namespace aerosol::app
