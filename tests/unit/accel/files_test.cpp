// OBJ and PLY: what is read, and where errors are reported.

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "core/accel/obj.h"
#include "core/accel/ply.h"
#include "core/accel/triangulate.h"

namespace aerosol::accel {
namespace {

Result<TriangleMesh> obj(const std::string& text) {
  Diagnostics warnings;
  return parseObj("mesh.obj", text, {}, warnings);
}
Result<TriangleMesh> ply(const std::string& text) {
  Diagnostics warnings;
  return parsePly("mesh.ply", text, {}, warnings);
}

void expectError(const Result<TriangleMesh>& mesh, int line, int column, const std::string& part) {
  ASSERT_FALSE(mesh) << part;
  const Diagnostic& error = mesh.errors().entries().at(0);
  EXPECT_EQ(error.location.line, line) << error.message;
  EXPECT_EQ(error.location.column, column) << error.message;
  EXPECT_NE(error.message.find(part), std::string::npos) << error.message;
}

TEST(Obj, ReadsPolygonsAndSharedVertices) {
  const auto mesh =
      obj("# a square and a triangle\r\nmtllib none.mtl\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv +0 1e0 0\nvt 0 "
          "0\nvt 1 0\nvt "
          "1 1\nvt 0 1 0\nvn 0 0 2\ng square\nf 1/1/1 2/2/1 3/3/1 \\\n 4/4/1 # four\nf -4//-1 -3//1 -2//1\n");
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->triangles.size(), 3u);
  EXPECT_EQ(mesh->positions.size(), 7u);  // three corners of the triangle have no texture coordinates
  EXPECT_EQ(mesh->normals[0], (Normal<World>{0, 0, 1}));
  EXPECT_EQ(mesh->positions[3], (Point<World>{0, 1, 0}));
  EXPECT_EQ(mesh->uvs[2].u, 1);
  EXPECT_EQ(mesh->uvs[2].v, 1);
}

TEST(Obj, KeepsTheWordOutOfWhatIsAbsent) {
  const auto mesh = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3");
  ASSERT_TRUE(mesh);
  EXPECT_TRUE(mesh->normals.empty());
  EXPECT_TRUE(mesh->uvs.empty());
  EXPECT_EQ(mesh->triangles.size(), 1u);
}

TEST(Obj, TakesTheFacesOfSomeMaterialsOrObjects) {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\no ball\nusemtl gold\nf 1 2 4\nf 1 3 4\ng lid\nf 2 3 4\nusemtl\n"
      "f 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";
  const auto count = [&](const char* faces) {
    Diagnostics warnings;
    const auto mesh = parseObj("m.obj", text, {}, warnings, faces);
    return mesh ? mesh->triangles.size() : 1000;
  };
  EXPECT_EQ(count(""), 8u);
  EXPECT_EQ(count("usemtl gold"), 3u);
  EXPECT_EQ(count("not usemtl gold"), 5u);
  EXPECT_EQ(count("o ball"), 2u);
  EXPECT_EQ(count(" o  lid ball "), 7u);
  EXPECT_EQ(count("not o lid ball"), 1u);
  EXPECT_EQ(count("usemtl silver"), 0u);
}

TEST(Obj, AppliesTheTransform) {
  Diagnostics warnings;
  const Matrix4 mirror{{{-2, 0, 0, 5}, {0, 2, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}}};
  Matrix4 inverse;
  ASSERT_TRUE(invert(mirror, inverse));
  const auto mesh = parseObj("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {mirror, inverse}, warnings);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->positions[1], (Point<World>{3, 0, 0}));
  const auto& t = mesh->triangles[0];
  EXPECT_GT(cross(mesh->positions[t[1]] - mesh->positions[t[0]], mesh->positions[t[2]] - mesh->positions[t[0]]).z, 0);
}

TEST(Obj, LocatesErrors) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expectError(obj(three + "f 1 2 4\n"), 4, 7, "index 4 is out of range");
  expectError(obj(three + "f 1 2 -4\n"), 4, 7, "index -4 is out of range");
  expectError(obj(three + "f 1 2 0\n"), 4, 7, "not an index");
  expectError(obj(three + "f 1 2 3x\n"), 4, 7, "'3x' is not an index");
  expectError(obj(three + "f 1 2 99999999999999999999\n"), 4, 7, "not an index");
  expectError(obj(three + "f 1/1 2 3\n"), 4, 5, "0 'vt' come before");
  expectError(obj(three + "f 1/ 2 3\n"), 4, 5, "not an index");
  expectError(obj(three + "f 1//1 2 3\n"), 4, 6, "0 'vn' come before");
  expectError(obj(three + "f 1 2\n"), 4, 1, "three corners");
  expectError(obj("v 0 0\n"), 1, 1, "3 to 7 numbers, not 2");
  expectError(obj("\nv 0 zero 0\n"), 2, 5, "'zero' is not a finite number");
  expectError(obj("v 0 nan 0\n"), 1, 5, "finite");
  expectError(obj("v 0 0 1e39\n"), 1, 7, "finite");
  expectError(obj("vx 0 0 0\n"), 1, 1, "'vx' is not a polygonal OBJ statement");
  expectError(obj("curv 0 1 1 2\n"), 1, 1, "'curv'");
  expectError(obj("vn 1 0\n"), 1, 1, "'vn' takes");
  Diagnostics warnings;
  expectError(loadObj("/nowhere/mesh.obj", {}, warnings), 0, 0, "No such file");
}

TEST(Obj, WarnsAboutWhatCannotBeSeen) {
  Diagnostics warnings;
  const auto mesh = parseObj("m.obj", "v 0 0 0\nv 1 0 0\np 1\nl 1 2\nl 2 1\n", {}, warnings);
  ASSERT_TRUE(mesh);
  ASSERT_EQ(warnings.entries().size(), 3u);
  EXPECT_EQ(warnings.entries()[0].location.line, 3);
  EXPECT_EQ(warnings.entries()[1].location.line, 4);
  EXPECT_EQ(warnings.entries()[2].message, "the file has no faces");
}

double areaOf(const std::vector<Point<World>>& corners, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  double sum = 0;
  for (const auto& t : triangles) {
    const auto n = cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]);
    EXPECT_GE(n.y, 0);  // wound like the polygon
    sum += 0.5 * static_cast<double>(length(n));
  }
  return sum;
}

TEST(Polygons, ConcaveOnesAreCutRight) {
  // In the xz plane, seen from +y: an L, and a comb with collinear corners.
  const std::vector<Point<World>> ell = {{0, 0, 0}, {0, 0, 2}, {1, 0, 2}, {1, 0, 1}, {2, 0, 1}, {2, 0, 0}};
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangulate(ell, triangles);
  EXPECT_EQ(triangles.size(), 4u);
  EXPECT_DOUBLE_EQ(areaOf(ell, triangles), 3);

  std::vector<Point<World>> comb = {{0, 0, 0}};
  for (int i = 0; i < 8; ++i) {
    const auto x = static_cast<float>(2 * i);
    comb.insert(comb.end(), {{x, 0, 3}, {x + 1, 0, 3}, {x + 1, 0, 1}, {x + 2, 0, 1}});
  }
  comb.push_back({16, 0, 0});
  triangles.clear();
  triangulate(comb, triangles);
  EXPECT_EQ(triangles.size(), comb.size() - 2);
  EXPECT_NEAR(areaOf(comb, triangles), 16 + 8 * 2, 1e-5);
}

TEST(Polygons, DegenerateOnesGetTheirCountOfTriangles) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const std::vector<Point<World>> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1, 0, 0}};
  triangulate(line, triangles);
  EXPECT_EQ(triangles.size(), 3u);
  triangles.clear();
  const std::vector<Point<World>> bow = {{0, 0, 0}, {1, 0, 1}, {1, 0, 0}, {0, 0, 1}};
  triangulate(bow, triangles);
  EXPECT_EQ(triangles.size(), 2u);
}

constexpr const char* asciiPly =
    "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty double y\nproperty float z\n"
    "property uchar red\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\n"
    "element edge 1\nproperty int a\nend_header\n";

TEST(Ply, ReadsAscii) {
  const auto mesh = ply(std::string(asciiPly) + "0 0 0 255 0 0\n1 0 0 7 1 0\n1 1 0 0 1 1\n0 1 0 9 0 1\n4 0 1 2 3\n5\n");
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->positions[2], (Point<World>{1, 1, 0}));
  EXPECT_EQ(mesh->uvs[1].u, 1);
  EXPECT_EQ(mesh->triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_TRUE(mesh->normals.empty());
}

/// Appends values in a byte order.
class Bytes {
 public:
  explicit Bytes(bool isBig) : isBig_(isBig) {}
  template <class T>
  Bytes& add(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (isBig_) std::reverse(bytes, bytes + sizeof(T));
    text.append(bytes, sizeof(T));
    return *this;
  }
  std::string text;

 private:
  bool isBig_;
};

template <class Index>
void testBinary(bool isBig, const char* indexType) {
  Bytes data(isBig);
  data.text =
      std::string("ply\nformat ") + (isBig ? "binary_big_endian" : "binary_little_endian") +
      " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty double z\nproperty float nx\nproperty "
      "float ny\nproperty float nz\nelement face 1\nproperty list ushort " +
      indexType + " vertex_index\nproperty short flags\nend_header\n";
  const float x[] = {0, 1, 0}, y[] = {0, 0, 1};
  for (int i = 0; i < 3; ++i) data.add(x[i]).add(y[i]).add(0.1).add(0.0f).add(0.0f).add(4.0f);
  data.add(std::uint16_t{3}).add(Index{2}).add(Index{0}).add(Index{1}).add(std::int16_t{-1});
  const auto mesh = ply(data.text);
  ASSERT_TRUE(mesh) << format(mesh.errors());
  EXPECT_EQ(mesh->positions[1], (Point<World>{1, 0, 0.1f}));
  EXPECT_EQ(mesh->normals[0], (Normal<World>{0, 0, 1}));
  EXPECT_EQ(mesh->triangles, (std::vector<std::array<std::uint32_t, 3>>{{2, 0, 1}}));
  // Every shortening of the data is an error and never a crash.
  const std::size_t header = data.text.find("end_header\n") + 11;
  for (std::size_t size = 0; size < data.text.size() - 1; ++size) EXPECT_FALSE(ply(data.text.substr(0, size))) << size;
  // An index beyond the vertices.
  std::string bad = data.text;
  bad[header + 3 * 28 + 2 + (isBig ? sizeof(Index) - 1 : 0)] = 3;
  const auto error = ply(bad);
  ASSERT_FALSE(error);
  EXPECT_NE(error.errors().entries()[0].message.find("vertex 3 is out of range"), std::string::npos);
  EXPECT_NE(error.errors().entries()[0].message.find("at byte " + std::to_string(header + 3 * 28 + 2)),
            std::string::npos);
}

TEST(Ply, ReadsBothByteOrdersAndEveryIndexType) {
  for (const bool isBig : {false, true}) {
    testBinary<std::int8_t>(isBig, "char");
    testBinary<std::uint8_t>(isBig, "uint8");
    testBinary<std::int16_t>(isBig, "short");
    testBinary<std::uint16_t>(isBig, "ushort");
    testBinary<std::int32_t>(isBig, "int");
    testBinary<std::uint32_t>(isBig, "uint32");
  }
}

TEST(Ply, LocatesErrors) {
  expectError(ply("plyx\n"), 1, 1, "not a PLY file");
  expectError(ply(""), 1, 1, "not a PLY file");
  expectError(ply("ply\nformat ascii 2.0\nend_header\n"), 2, 1, "format NAME 1.0");
  expectError(ply("ply\nformat utf8 1.0\nend_header\n"), 2, 8, "'utf8' is not a format");
  expectError(ply("ply\nelement vertex 0\nend_header\n"), 3, 1, "no 'format'");
  expectError(ply("ply\nformat ascii 1.0\nelement vertex many\n"), 3, 16, "'many' is not a count");
  expectError(ply("ply\nformat ascii 1.0\nelement vertex 0\nproperty half x\n"), 4, 10, "'half' is not a type");
  expectError(ply("ply\nformat ascii 1.0\nproperty float x\n"), 3, 1, "before the first element");
  expectError(ply("ply\nformat ascii 1.0\nvertices 3\n"), 3, 1, "not a header word");
  expectError(ply("ply\nformat ascii 1.0\n"), 3, 1, "ends before 'end_header'");
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  expectError(ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"), 3, 16, "x, y and z");
  expectError(ply(header + "end_header\n0 0 0\n1 0 zero\n0 1 0\n"), 9, 5, "expected a number");
  expectError(ply(header + "end_header\n0 0 0\n1 0 0\n0 1\n   "), 11, 4, "too early");
  expectError(ply(header + "end_header\n0 0 0\n1 0 1e300\n0 1 0\n"), 9, 5, "'z' is not a finite number");
  const std::string faces =
      header + "element face 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  expectError(ply(faces + "3 0 1 3\n"), 13, 7, "vertex 3 is out of range");
  expectError(ply(faces + "3 0 1 -1\n"), 13, 7, "vertex -1 is out of range");
  expectError(ply(faces + "3 0 1 1.5\n"), 13, 7, "expected a number of the declared type");
  expectError(ply(faces + "2 0 1\n"), 13, 1, "a face has 3 to");
  expectError(ply(faces + "1000000000 0 1\n"), 13, 1, "too short for a list");
  expectError(ply(faces + "-3 0 1 2\n"), 13, 1, "too short for a list");
  expectError(ply("ply\nformat ascii 1.0\nelement vertex 9223372036854775807\nproperty float x\nend_header\n"), 3, 16,
              "too short for 9223372036854775807 of 'vertex'");
  expectError(ply("ply\nformat ascii 1.0\nelement face 0\nproperty list int int vertex_indices\nend_header\n"), 3, 14,
              "before the vertices");
  Diagnostics warnings;
  expectError(loadPly("/nowhere/mesh.ply", {}, warnings), 0, 0, "No such file");
}

}  // namespace
}  // namespace aerosol::accel
