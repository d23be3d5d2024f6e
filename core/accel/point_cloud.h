// Points with attributes in a k-d tree.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/point_cloud.h"
#include "core/base/result.h"

namespace aerosol::accel {

/// A named column of a table of points: numbers or texts.
struct PointColumn {
  std::string name;
  bool isInteger = false;  ///< Every number is a whole one, within the range of an int.
  bool isText = false;
  std::vector<double> numbers;
  std::vector<std::string> texts;
};

/// Attributes of columns: "x", "y", "z" are the position, "nx" … the "normal", "vx" … the "velocity", "red", "green",
/// "blue" (or r, g, b) the "color". Columns whose names differ in an end of one of the forms .x _x [0] .0 _0 :0 alone,
/// in this order, make one attribute; "P" and "Points" stand for "position". Nothing when there is no position.
std::optional<std::vector<PointAttribute>> attributesOf(std::vector<PointColumn> columns);

/// Reads a .ply file (the vertices' properties that are no lists; bytes of colours are scaled to [0, 1]) or a .csv file
/// (a line of column names, then a line a point; separated by commas, texts may be quoted). Errors name file and line.
Result<std::shared_ptr<const PointCloud>> readPoints(const std::string& path);

/// A cloud of attributes, of which the first is "position" with three floats.
std::shared_ptr<const PointCloud> makePointCloud(std::vector<PointAttribute> attributes);

}  // namespace aerosol::accel
