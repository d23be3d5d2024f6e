#include "core/scene/transform_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace aerosol::scene {

namespace {

using Triple = std::array<double, 3>;

Triple cross(const Triple& a, const Triple& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Unit length; none when the length is zero or not finite.
std::optional<Triple> normalized(const Triple& v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return Triple{v[0] / length, v[1] / length, v[2] / length};
}

/// Three numbers (one stands for all) of an attribute.
std::optional<Triple> tripleOf(const Attributes& attributes, const Attribute& attribute) {
  TextError error;
  const auto numbers = parseNumbers(attribute.value, error);
  if (numbers && numbers->size() == 3) return Triple{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  if (numbers && numbers->size() == 1) return Triple{(*numbers)[0], (*numbers)[0], (*numbers)[0]};
  if (numbers) error = {0, fmt::format("1 or 3 numbers are needed, not {}", numbers->size())};
  attributes.report(attribute, error);
  return std::nullopt;
}

/// A triple from the attribute `whole`, or from x, y and z with a default for those not written.
std::optional<Triple> readTriple(const XmlElement& xml, const Attributes& attributes, const char* whole, double missing,
                                 Reporter& reporter) {
  const bool split = attributes.has("x") || attributes.has("y") || attributes.has("z");
  const Attribute* value = attributes.find(whole);
  if (split == (value != nullptr)) {
    reporter.error(value ? value->nameLocation : attributes.at(whole),
                   fmt::format("<{}> needs either '{}' or some of 'x', 'y' and 'z'", xml.tag, whole));
    return std::nullopt;
  }
  if (value) return tripleOf(attributes, *value);
  Triple result{missing, missing, missing};
  const char* const names[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    const Attribute* attribute = attributes.find(names[i]);
    if (!attribute) continue;
    TextError error;
    const auto number = parseNumber(attribute->value, error);
    if (!number) {
      attributes.report(*attribute, error);
      return std::nullopt;
    }
    result[i] = *number;
  }
  return result;
}

Matrix4 translation(const Triple& t) {
  Matrix4 m = identityMatrix();
  for (std::size_t i = 0; i < 3; ++i) m[i][3] = t[i];
  return m;
}

Matrix4 scaling(const Triple& s) {
  Matrix4 m = identityMatrix();
  for (std::size_t i = 0; i < 3; ++i) m[i][i] = s[i];
  return m;
}

/// Rotation by an angle about a unit axis (Rodrigues 1840): R = cos I + sin [a]x + (1 - cos) a a^T. Quarter turns
/// come out exact.
Matrix4 rotation(const Triple& a, double degrees) {
  const double turn = std::remainder(degrees, 360.0);
  double c = std::cos(turn * std::numbers::pi / 180);
  double s = std::sin(turn * std::numbers::pi / 180);
  if (std::fabs(turn) == 90) c = 0;
  if (std::fabs(turn) == 180) s = 0;
  const Triple cross[3] = {{0, -a[2], a[1]}, {a[2], 0, -a[0]}, {-a[1], a[0], 0}};
  Matrix4 m = identityMatrix();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) m[i][j] = (i == j ? c : 0) + s * cross[i][j] + (1 - c) * a[i] * a[j];
  }
  return m;
}

/// Reads one step of a transform.
class StepReader {
 public:
  StepReader(const XmlElement& xml, ReadContext context) : xml_(xml), context_(context) {}

  std::optional<Matrix4> read() {
    if (xml_.tag == "translate") return translate();
    if (xml_.tag == "scale") return scale();
    if (xml_.tag == "rotate") return rotate();
    if (xml_.tag == "lookat") return lookAt();
    if (xml_.tag == "matrix") return matrix();
    context_.reporter.error(
        context_.source.at(xml_.offset), fmt::format("<{}> is not a step of a transform", xml_.tag),
        alternatives(xml_.tag, {"translate", "rotate", "scale", "lookat", "matrix"}, "valid here:"));
    return std::nullopt;
  }

 private:
  std::optional<Matrix4> translate() {
    const Attributes a(xml_, {}, {"x", "y", "z", "value"}, context_);
    if (!a.valid()) return std::nullopt;
    const auto t = readTriple(xml_, a, "value", 0, context_.reporter);
    return t ? std::optional(translation(*t)) : std::nullopt;
  }

  std::optional<Matrix4> scale() {
    const Attributes a(xml_, {}, {"x", "y", "z", "value"}, context_);
    if (!a.valid()) return std::nullopt;
    const auto s = readTriple(xml_, a, "value", 1, context_.reporter);
    if (!s) return std::nullopt;
    if ((*s)[0] == 0 || (*s)[1] == 0 || (*s)[2] == 0) {
      context_.reporter.error(context_.source.at(xml_.offset), "a scale of zero makes the transform not invertible");
      return std::nullopt;
    }
    return scaling(*s);
  }

  std::optional<Matrix4> rotate() {
    const Attributes a(xml_, {"angle"}, {"x", "y", "z", "value", "axis"}, context_);
    if (!a.valid()) return std::nullopt;
    if (a.has("value") && a.has("axis")) {
      context_.reporter.error(a.find("axis")->nameLocation, "'axis' and 'value' both give the axis: write one of them");
      return std::nullopt;
    }
    const auto given = readTriple(xml_, a, a.has("axis") ? "axis" : "value", 0, context_.reporter);
    if (!given) return std::nullopt;
    TextError error;
    const auto angle = parseNumber(a.text("angle"), error);
    if (!angle) {
      a.report(*a.find("angle"), error);
      return std::nullopt;
    }
    const auto axis = normalized(*given);
    if (!axis) {
      context_.reporter.error(context_.source.at(xml_.offset), "the axis of a rotation has no length");
      return std::nullopt;
    }
    return rotation(*axis, *angle);
  }

  /// Columns: left, up, the viewing direction, the origin (camera space looks along +z, +x to the left).
  std::optional<Matrix4> lookAt() {
    const Attributes a(xml_, {"origin", "target"}, {"up"}, context_);
    if (!a.valid()) return std::nullopt;
    const auto origin = tripleOf(a, *a.find("origin"));
    const auto target = tripleOf(a, *a.find("target"));
    std::optional<Triple> up;
    if (const Attribute* given = a.find("up"); given && !(up = tripleOf(a, *given))) return std::nullopt;
    if (!origin || !target) return std::nullopt;
    const auto direction =
        normalized({(*target)[0] - (*origin)[0], (*target)[1] - (*origin)[1], (*target)[2] - (*origin)[2]});
    if (!direction) {
      context_.reporter.error(a.at("target"), "the target of a lookat lies at its origin");
      return std::nullopt;
    }
    if (!up) up = std::fabs((*direction)[1]) < 0.999 ? Triple{0, 1, 0} : Triple{0, 0, 1};
    const auto upward = normalized(*up);
    const Triple side = upward ? cross(*upward, *direction) : Triple{0, 0, 0};
    const auto left = std::hypot(side[0], side[1], side[2]) > 1e-7 ? normalized(side) : std::nullopt;
    if (!left) {
      context_.reporter.error(a.at("up"), "'up' of a lookat is zero or points along the view");
      return std::nullopt;
    }
    const Triple columns[4] = {*left, cross(*direction, *left), *direction, *origin};
    Matrix4 m = identityMatrix();
    for (std::size_t column = 0; column < 4; ++column) {
      for (std::size_t row = 0; row < 3; ++row) m[row][column] = columns[column][row];
    }
    return m;
  }

  std::optional<Matrix4> matrix() {
    const Attributes a(xml_, {"value"}, {}, context_);
    if (!a.valid()) return std::nullopt;
    TextError error;
    const auto m = parseMatrix(a.text("value"), error);
    if (!m) a.report(*a.find("value"), error);
    return m;
  }

  const XmlElement& xml_;
  ReadContext context_;
};

void reportChildren(const XmlElement& step, ReadContext context) {
  for (const XmlElement& child : step.children) {
    context.reporter.error(context.source.at(child.offset),
                           fmt::format("<{}> does not belong in <{}>, which has no children", child.tag, step.tag));
  }
}

}  // namespace

namespace {

/// Squares of lengths have to fit into floats; null where they do.
const char* problemOfSize(const Matrix4& m) {
  for (std::size_t i = 0; i < 4; ++i) {
    const double length = std::hypot(m[0][i], m[1][i], m[2][i]);
    if (length > 1e18) return "this transform leads beyond 1e18 scene units: write lengths in a larger unit";
    if (i < 3 && length > 0 && length < 1e-18)
      return "this transform makes lengths less than 1e-18 of what they were: write lengths in a smaller unit";
  }
  return nullptr;
}

}  // namespace

std::optional<Matrix4> readTransform(const XmlElement& xml, ReadContext context) {
  Matrix4 product = identityMatrix();
  bool valid = true;
  for (const XmlElement& child : xml.children) {
    const auto step = StepReader(child, context).read();
    reportChildren(child, context);
    valid = valid && step && child.children.empty();
    if (step) product = multiply(*step, product);
  }
  if (!valid) return std::nullopt;
  for (const auto& row : product) {
    for (const double v : row) {
      if (std::isfinite(v)) continue;
      context.reporter.error(context.source.at(xml.offset), "the numbers of this transform overflow");
      return std::nullopt;
    }
  }
  if (const char* const problem = problemOfSize(product)) {
    context.reporter.error(context.source.at(xml.offset), problem);
    return std::nullopt;
  }
  return product;
}

std::optional<std::vector<MotionKey>> readAnimation(const XmlElement& xml, ReadContext context) {
  std::vector<MotionKey> keys;
  std::vector<SourceLocation> places;
  bool valid = true;
  for (const XmlElement& child : xml.children) {
    if (child.tag != "transform") {
      context.reporter.error(context.source.at(child.offset),
                             fmt::format("<{}> does not belong in <animation>", child.tag),
                             {"it holds <transform time=\"…\"> elements"});
      valid = false;
      continue;
    }
    const Attributes attributes(child, {"time"}, {}, context);
    const auto matrix = readTransform(child, context);
    TextError error;
    const auto time = attributes.valid() ? parseNumber(attributes.text("time"), error) : std::nullopt;
    if (attributes.valid() && !time) attributes.report(*attributes.find("time"), error);
    valid = valid && matrix && time;
    if (!matrix || !time) continue;
    keys.push_back({*time, *matrix});
    places.push_back(context.source.at(child.offset));
  }
  if (!valid) return std::nullopt;
  if (const auto problem = Motion::findProblem(keys)) {
    const bool isOfKey = problem->key < places.size();
    context.reporter.error(isOfKey ? places[problem->key] : context.source.at(xml.offset), problem->message);
    return std::nullopt;
  }
  std::ranges::sort(keys, {}, &MotionKey::time);
  return keys;
}

}  // namespace aerosol::scene
