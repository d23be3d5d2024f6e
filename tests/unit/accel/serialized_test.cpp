// Mitsuba's binary meshes: what is read, and that no damage does more than give an error.
#include "core/accel/serialized.h"

#include <gtest/gtest.h>

#include "tests/support/serialized_writer.h"

namespace aerosol::accel {
namespace {

using test::serializedFile;
using test::SerializedMesh;

SerializedMesh square(double z) {
  SerializedMesh mesh;
  mesh.positions = {0, 0, z, 1, 0, z, 1, 1, z, 0, 1, z};
  mesh.corners = {0, 1, 2, 0, 2, 3};
  return mesh;
}

SerializedMesh richTriangle() {
  SerializedMesh mesh;
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0.5};
  mesh.normals = {0, 0, 2, 0, 1, 0, 1, 0, 0};
  mesh.texCoords = {0, 0.25, 0.5, 0.75, 1, 0};
  mesh.colors = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  mesh.corners = {0, 1, 2};
  return mesh;
}

Result<TriangleMesh> parse(const std::string& data, int index = 0) {
  return parseSerialized("mesh.serialized", data, index, {});
}

std::string problem(const std::string& data, int index = 0) {
  const auto mesh = parse(data, index);
  return mesh ? "" : mesh.errors().entries().at(0).message;
}

TEST(Serialized, ReadsEveryMeshOfAFile) {
  for (const int version : {3, 4}) {
    SCOPED_TRACE(version);
    SerializedMesh last = square(3);
    last.hasFaceNormals = true;
    const std::string file = serializedFile({square(1), richTriangle(), last}, version);
    const auto first = parse(file);
    ASSERT_TRUE(first) << format(first.errors());
    EXPECT_EQ(first->positions.size(), 4u);
    EXPECT_EQ(first->positions[2], (Point<World>{1, 1, 1}));
    EXPECT_TRUE(first->normals.empty());
    EXPECT_TRUE(first->uvs.empty());
    EXPECT_FALSE(first->faceNormals);
    ASSERT_EQ(first->triangles.size(), 2u);
    EXPECT_EQ(first->triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
    const auto third = parse(file, 2);
    ASSERT_TRUE(third) << format(third.errors());
    EXPECT_EQ(third->positions[0].z, 3);
    EXPECT_TRUE(third->faceNormals);
  }
}

TEST(Serialized, ReadsNormalsAndTextureCoordinatesInBothPrecisions) {
  for (const bool isDouble : {false, true}) {
    SerializedMesh mesh = richTriangle();
    mesh.isDouble = isDouble;
    const auto read = parse(serializedFile({mesh}, 4));
    ASSERT_TRUE(read) << format(read.errors());
    EXPECT_EQ(read->positions[2], (Point<World>{0, 1, 0.5f}));
    EXPECT_EQ(read->normals[0], (Normal<World>{0, 0, 1}));
    EXPECT_EQ(read->normals[2], (Normal<World>{1, 0, 0}));
    EXPECT_EQ(read->uvs[1].u, 0.5f);
    EXPECT_EQ(read->uvs[1].v, 0.75f);
    ASSERT_EQ(read->triangles.size(), 1u);
    ASSERT_EQ(read->attributes.size(), 1u);
    EXPECT_EQ(read->attributes[0].name, "vertex_color");
    EXPECT_EQ(valueAt(*read, read->attributes[0], {0, 0.25f, 0.5f}), (std::array<float, 4>{0.25f, 0.25f, 0.5f, 0}));
  }
}

TEST(Serialized, AppliesTheTransform) {
  const Matrix4 mirror{{{-2, 0, 0, 5}, {0, 2, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}}};
  Matrix4 inverse;
  ASSERT_TRUE(invert(mirror, inverse));
  const auto mesh = parseSerialized("m", serializedFile({square(0)}, 3), 0, {mirror, inverse});
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->positions[1], (Point<World>{3, 0, 0}));
  const auto& t = mesh->triangles[0];
  EXPECT_GT(cross(mesh->positions[t[1]] - mesh->positions[t[0]], mesh->positions[t[2]] - mesh->positions[t[0]]).z, 0);
}

TEST(Serialized, NamesTheByteOfWhatIsWrong) {
  const std::string good = serializedFile({square(0), square(1)}, 4);
  EXPECT_EQ(problem(good, 2), "at byte " + std::to_string(good.size() - 4) +
                                  ": there is no mesh number 2: the file has 2, counted from 0");
  EXPECT_EQ(problem(""), "at byte 0: the file ends too early");
  EXPECT_EQ(problem("ply\nformat ascii 1.0\n"), "at byte 0: this is no mesh of Mitsuba's binary format");
  std::string other = good;
  other[2] = 5;
  EXPECT_EQ(problem(other), "at byte 2: version 5 of the format is not known: 3 and 4 are");
  other = good;
  other[other.size() - 1] = 127;
  EXPECT_NE(problem(other).find("at byte " + std::to_string(good.size() - 4) + ": the file cannot hold"),
            std::string::npos);
  other = good;
  other[other.size() - 5] = 1;
  EXPECT_NE(problem(other, 1).find("at byte " + std::to_string(good.size() - 12) + ": mesh 1 cannot be at byte"),
            std::string::npos);

  SerializedMesh wrong = square(0);
  wrong.corners[4] = 4;
  EXPECT_EQ(problem(serializedFile({wrong}, 4)), "at byte 0: in the mesh: triangle 1 names vertex 4, but there are 4");
  wrong = square(0);
  wrong.positions[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(problem(serializedFile({wrong}, 4)), "at byte 0: in the mesh: number 5 of its positions is not finite");
  wrong = square(0);
  wrong.isDouble = true;
  wrong.positions[5] = 1e300;
  EXPECT_EQ(problem(serializedFile({wrong}, 4)), "at byte 0: in the mesh: number 5 of its positions is not finite");
  wrong = square(0);
  wrong.extraFlags = 0x2000;
  EXPECT_EQ(problem(serializedFile({wrong}, 4)), "at byte 0: in the mesh: its flags 12288 mean nothing");

  const auto missing = loadSerialized("/nowhere/mesh.serialized", 0, {});
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.errors().entries()[0].message.find("No such file"), std::string::npos);
}

TEST(Serialized, CountsThatLieTakeNoMemory) {
  std::string content = square(0).content(4);
  const std::uint64_t many = 0xFFFFFFF0u;
  content.replace(11, sizeof many, reinterpret_cast<const char*>(&many), sizeof many);
  EXPECT_NE(problem(serializedFile(std::vector{content}, 4)).find("end too early or are damaged in its positions"),
            std::string::npos);
  const std::uint64_t tooMany = 1ull << 40;
  content.replace(11, sizeof tooMany, reinterpret_cast<const char*>(&tooMany), sizeof tooMany);
  EXPECT_NE(problem(serializedFile(std::vector{content}, 4)).find("at most 2^32 - 1"), std::string::npos);
}

TEST(Serialized, EveryTruncationAndEveryFlippedBitIsAnErrorOrASoundMesh) {
  int refused = 0;
  for (const int version : {3, 4}) {
    const std::string good = serializedFile({square(0), richTriangle()}, version);
    for (std::size_t length = 0; length < good.size(); ++length) {
      for (const int index : {0, 1}) EXPECT_FALSE(parse(good.substr(0, length), index)) << length;
    }
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      std::string bad = good;
      bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << bit % 8));
      for (const int index : {0, 1}) {
        const auto mesh = parse(bad, index);
        refused += !mesh;
        if (mesh) EXPECT_EQ(findDefect(*mesh), std::nullopt) << bit;
      }
    }
    // Past the check sums: damage in the content itself.
    const std::string content = richTriangle().content(version);
    for (std::size_t bit = 0; bit < 8 * content.size(); ++bit) {
      std::string bad = content;
      bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << bit % 8));
      const auto mesh = parse(serializedFile(std::vector{bad}, version));
      if (mesh) EXPECT_EQ(findDefect(*mesh), std::nullopt) << bit;
    }
  }
  // A flip in one mesh is not seen by who reads the other.
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace aerosol::accel
