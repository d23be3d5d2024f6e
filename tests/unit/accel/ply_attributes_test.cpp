// What vertices and faces of PLY files carry beside their geometry.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/accel/ply.h"

namespace aerosol::accel {
namespace {

Result<TriangleMesh> ply(const std::string& text) {
  Diagnostics warnings;
  return parsePly("mesh.ply", text, {}, warnings);
}

std::string header(const std::string& format, const std::string& vertex, const std::string& face, int faces = 1) {
  return "ply\nformat " + format + " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" +
         vertex + "element face " + std::to_string(faces) + "\n" + face + "end_header\n";
}

const std::string list = "property list uchar int vertex_indices\n";

const MeshAttribute& attribute(const TriangleMesh& mesh, const std::string& name) {
  static const MeshAttribute none;
  const auto found = std::ranges::find(mesh.attributes, name, &MeshAttribute::name);
  EXPECT_NE(found, mesh.attributes.end()) << name;
  return found == mesh.attributes.end() ? none : *found;
}

TEST(PlyAttributes, AreGroupedByTheirNames) {
  const std::string vertex =
      "property float tint_r\nproperty float tint_g\nproperty float tint_b\nproperty float age\n"
      "property float flow_x\nproperty float flow_y\nproperty float pair_1\nproperty float pair_2\n"
      "property float vertex_wet\nproperty float odd_y\n";
  const auto mesh = ply(header("ascii", vertex, list) +
                        "0 0 0 1 2 3 4 5 6 7 8 9 10\n1 0 0 0 0 0 0 0 0 0 0 0 0\n1 1 0 0 0 0 0 0 0 0 0 0 0\n"
                        "0 1 0 0 0 0 0 0 0 0 0 0 0\n4 0 1 2 3\n");
  ASSERT_TRUE(mesh) << format(mesh.errors());
  EXPECT_EQ(mesh->attributes.size(), 6u);
  EXPECT_EQ(findDefect(*mesh), std::nullopt);
  const auto starts = [&](const std::string& name, const std::vector<float>& values) {
    const MeshAttribute& found = attribute(*mesh, name);
    EXPECT_EQ(found.channels, static_cast<int>(values.size())) << name;
    EXPECT_FALSE(found.isPerFace);
    ASSERT_EQ(found.values.size(), 4 * values.size()) << name;
    EXPECT_TRUE(std::equal(values.begin(), values.end(), found.values.begin())) << name;
  };
  starts("vertex_tint", {1, 2, 3});
  starts("vertex_age", {4});
  starts("vertex_flow", {5, 6});
  starts("vertex_pair", {7, 8});
  starts("vertex_wet", {9});
  starts("vertex_odd_y", {10});
}

TEST(PlyAttributes, ColoursWithoutANameAreDecodedWhereTheyAreBytes) {
  const std::string bytes = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
  const auto mesh =
      ply(header("ascii", bytes, list) + "0 0 0 255 128 0 51\n1 0 0 0 0 0 0\n1 1 0 0 0 0 0\n0 1 0 0 0 0 0\n3 0 1 2\n");
  ASSERT_TRUE(mesh) << format(mesh.errors());
  const MeshAttribute& color = attribute(*mesh, "vertex_color");
  ASSERT_EQ(color.channels, 4);
  EXPECT_FLOAT_EQ(color.values[0], 1);
  EXPECT_FLOAT_EQ(color.values[1], static_cast<float>(std::pow((128 / 255.0 + 0.055) / 1.055, 2.4)));
  EXPECT_FLOAT_EQ(color.values[3], 0.2f);
  const auto floats = ply(header("ascii", "property float r\nproperty float g\nproperty float b\n", list) +
                          "0 0 0 0.5 2 -1\n1 0 0 0 0 0\n1 1 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n");
  ASSERT_TRUE(floats) << format(floats.errors());
  EXPECT_EQ(std::vector(attribute(*floats, "vertex_color").values.begin(),
                        attribute(*floats, "vertex_color").values.begin() + 3),
            (std::vector<float>{0.5f, 2, -1}));
}

/// Appends values in a byte order.
class Bytes {
 public:
  explicit Bytes(bool isBig) : isBig_(isBig) {}
  template <class T>
  Bytes& add(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (isBig_ == (std::endian::native == std::endian::little)) std::reverse(bytes, bytes + sizeof(T));
    text.append(bytes, sizeof(T));
    return *this;
  }
  std::string text;

 private:
  bool isBig_;
};

TEST(PlyAttributes, OfFacesBelongToEveryTriangleOfTheFaceInBothByteOrders) {
  for (const bool isBig : {false, true}) {
    Bytes data(isBig);
    data.text = header(isBig ? "binary_big_endian" : "binary_little_endian", "property double age\n",
                       "property short group\n" + list + "property float tint_0\nproperty float tint_1\n", 2);
    const float x[] = {0, 1, 1, 0}, y[] = {0, 0, 1, 1};
    for (int i = 0; i < 4; ++i) data.add(x[i]).add(y[i]).add(0.0f).add(0.5 * i);
    data.add(std::int16_t{-7}).add(std::uint8_t{4}).add(0).add(1).add(2).add(3).add(0.25f).add(0.75f);
    data.add(std::int16_t{9}).add(std::uint8_t{3}).add(0).add(1).add(3).add(1.5f).add(2.5f);
    const auto mesh = ply(data.text);
    ASSERT_TRUE(mesh) << format(mesh.errors());
    EXPECT_EQ(findDefect(*mesh), std::nullopt);
    ASSERT_EQ(mesh->triangles.size(), 3u);
    EXPECT_EQ(attribute(*mesh, "vertex_age").values, (std::vector<float>{0, 0.5f, 1, 1.5f}));
    EXPECT_TRUE(attribute(*mesh, "face_group").isPerFace);
    EXPECT_EQ(attribute(*mesh, "face_group").values, (std::vector<float>{-7, -7, 9}));
    EXPECT_EQ(attribute(*mesh, "face_tint").values, (std::vector<float>{0.25f, 0.75f, 0.25f, 0.75f, 1.5f, 2.5f}));
    const std::size_t body = data.text.find("end_header\n") + 11;
    for (std::size_t size = body; size < data.text.size(); ++size) EXPECT_FALSE(ply(data.text.substr(0, size)));
  }
}

TEST(PlyAttributes, AreInterpolatedOverTriangles) {
  TriangleMesh mesh;
  mesh.positions.resize(4);
  mesh.triangles = {{0, 1, 2}, {3, 2, 1}};
  mesh.attributes = {{"vertex_pair", 2, false, {1, 10, 2, 20, 3, 30, 4, 40}}, {"face_number", 1, true, {5, 6}}};
  EXPECT_EQ(findDefect(mesh), std::nullopt);
  EXPECT_EQ(valueAt(mesh, mesh.attributes[0], {1, 0.25f, 0.5f}), (std::array<float, 4>{2.75f, 27.5f, 0, 0}));
  EXPECT_EQ(valueAt(mesh, mesh.attributes[1], {1, 0.25f, 0.5f}), (std::array<float, 4>{6, 0, 0, 0}));
  mesh.attributes[1].values.push_back(7);
  EXPECT_EQ(findDefect(mesh), "the attribute 'face_number' of the mesh has 3 numbers for 2 triangles");
}

TEST(PlyAttributes, ThatAreNotFiniteAreErrorsAtTheirPlace) {
  const auto mesh = ply(header("ascii", "property float age\n", list) + "0 0 0 1e99\n1 0 0 0\n1 1 0 0\n0 1 0 0\n");
  ASSERT_FALSE(mesh);
  const Diagnostic& error = mesh.errors().entries()[0];
  EXPECT_EQ(error.location.line, 11);
  EXPECT_EQ(error.location.column, 7);
  EXPECT_EQ(error.message, "'age' is not a finite number");
}

}  // namespace
}  // namespace aerosol::accel
