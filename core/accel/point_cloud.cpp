#include "core/accel/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <span>

namespace aerosol::accel {

namespace {

/// The nearest points so far, as a heap with the farthest on top. nanoflann asks it while it walks the tree.
class Nearest {
 public:
  using DistanceType = double;

  Nearest(double radiusSquared, std::size_t maximum, std::vector<FoundPoint>& found)
      : radiusSquared_(radiusSquared), maximum_(maximum), found_(found) {}

  std::size_t size() const { return found_.size(); }
  bool full() const { return found_.size() == maximum_; }

  bool addPoint(double distanceSquared, std::uint32_t index) {
    const FoundPoint point{distanceSquared, index};
    if (!(distanceSquared <= radiusSquared_) || (full() && !(point < found_.front()))) return true;
    if (full()) {
      std::pop_heap(found_.begin(), found_.end());
      found_.pop_back();
    }
    found_.push_back(point);
    std::push_heap(found_.begin(), found_.end());
    return true;
  }

  /// Only what is nearer is looked at: a little more than the worst, for the points of equal distance.
  double worstDist() const {
    const double worst = full() ? found_.front().distanceSquared : radiusSquared_;
    return std::nextafter(worst, std::numeric_limits<double>::infinity());
  }

 private:
  double radiusSquared_;
  std::size_t maximum_;
  std::vector<FoundPoint>& found_;
};

class Cloud final : public PointCloud {
 public:
  explicit Cloud(std::vector<PointAttribute> attributes)
      : attributes_(std::move(attributes)), tree_(3, *this, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}

  const std::vector<PointAttribute>& attributes() const override { return attributes_; }

  void search(const float* position, float radius, std::size_t maximum, std::vector<FoundPoint>& found) const override {
    found.clear();
    const double at[3] = {static_cast<double>(position[0]), static_cast<double>(position[1]),
                          static_cast<double>(position[2])};
    const bool isFinite = std::isfinite(at[0]) && std::isfinite(at[1]) && std::isfinite(at[2]);
    if (maximum == 0 || size() == 0 || !isFinite || !(radius >= 0)) return;
    const double distance = std::min(static_cast<double>(radius), 1e150);
    Nearest nearest(distance * distance, maximum, found);
    tree_.findNeighbors(nearest, at, nanoflann::SearchParams());
    std::sort(found.begin(), found.end());
  }

  // What nanoflann asks of its points.
  std::size_t kdtree_get_point_count() const { return size(); }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return static_cast<double>(attributes_.front().floats[3 * index + axis]);
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }

 private:
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud, double, std::uint32_t>,
                                                   Cloud, 3, std::uint32_t>;
  std::vector<PointAttribute> attributes_;
  Tree tree_;
};

/// The name of the attribute that a column belongs to, and which component it is; -1: it stands alone.
struct ColumnPlace {
  std::string attribute;
  int component = -1;
};

ColumnPlace placeOf(const std::string& name) {
  static const std::vector<std::pair<std::string, ColumnPlace>> known = {
      {"x", {"position", 0}},  {"y", {"position", 1}}, {"z", {"position", 2}},  {"nx", {"normal", 0}},
      {"ny", {"normal", 1}},   {"nz", {"normal", 2}},  {"vx", {"velocity", 0}}, {"vy", {"velocity", 1}},
      {"vz", {"velocity", 2}}, {"red", {"color", 0}},  {"green", {"color", 1}}, {"blue", {"color", 2}},
      {"r", {"color", 0}},     {"g", {"color", 1}},    {"b", {"color", 2}}};
  for (const auto& [column, place] : known)
    if (name == column) return place;
  std::string stem = name;
  int component = -1;
  if (stem.size() > 3 && stem.back() == ']' && stem[stem.size() - 3] == '[') {
    component = stem[stem.size() - 2] - '0';
    stem.resize(stem.size() - 3);
  } else if (stem.size() > 2 && std::string_view("._:").find(stem[stem.size() - 2]) != std::string_view::npos) {
    const char last = stem.back();
    component = last >= 'x' && last <= 'z' ? last - 'x' : last - '0';
    stem.resize(stem.size() - 2);
  }
  if (component < 0 || component > 9) return {name, -1};
  if (stem == "P" || stem == "Points") stem = "position";
  return {stem, component};
}

PointAttribute joined(const std::string& name, std::span<const PointColumn> columns) {
  PointAttribute attribute;
  attribute.name = name;
  attribute.components = static_cast<int>(columns.size());
  using Base = PointAttribute::Base;
  const bool anyText = std::ranges::any_of(columns, &PointColumn::isText);
  const bool allIntegers = std::ranges::all_of(columns, &PointColumn::isInteger);
  attribute.base = anyText ? Base::string : allIntegers && name != "position" ? Base::integer : Base::floating;
  const std::size_t count = anyText ? columns[0].texts.size() : columns[0].numbers.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (const PointColumn& column : columns) {
      if (attribute.base == Base::string) {
        attribute.strings.push_back(column.texts[i]);
      } else if (attribute.base == Base::integer) {
        attribute.integers.push_back(static_cast<std::int32_t>(column.numbers[i]));
      } else {
        attribute.floats.push_back(static_cast<float>(column.numbers[i]));
      }
    }
  }
  return attribute;
}

}  // namespace

std::optional<std::vector<PointAttribute>> attributesOf(std::vector<PointColumn> columns) {
  std::vector<PointAttribute> attributes;
  bool hasPosition = false;
  for (std::size_t first = 0; first < columns.size();) {
    const ColumnPlace place = placeOf(columns[first].name);
    std::size_t count = 1;
    if (place.component == 0) {
      for (; first + count < columns.size(); ++count) {
        const ColumnPlace next = placeOf(columns[first + count].name);
        const bool goesOn = next.attribute == place.attribute && next.component == static_cast<int>(count) &&
                            columns[first + count].isText == columns[first].isText;
        if (!goesOn) break;
      }
    }
    const bool isJoined = place.component == 0 && count > 1;
    PointAttribute attribute =
        joined(isJoined ? place.attribute : columns[first].name, std::span(columns).subspan(first, count));
    first += count;
    if (attribute.name == "position" && attribute.components == 3 && !hasPosition &&
        attribute.base == PointAttribute::Base::floating) {
      hasPosition = true;
      attributes.insert(attributes.begin(), std::move(attribute));
    } else {
      attributes.push_back(std::move(attribute));
    }
  }
  if (!hasPosition) return {};
  return attributes;
}

std::shared_ptr<const PointCloud> makePointCloud(std::vector<PointAttribute> attributes) {
  return std::make_shared<const Cloud>(std::move(attributes));
}

}  // namespace aerosol::accel
