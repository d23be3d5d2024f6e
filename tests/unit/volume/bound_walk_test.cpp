#include "core/volume/bounds/bound_walk.h"

#include <gtest/gtest.h>

#include <random>

namespace aerosol::volume {
namespace {

/// Leaves tell where they are: majorant, control and limit are the box's lower corner in lattice cells plus 1.
class Fixture {
 public:
  explicit Fixture(std::uint64_t seed, Transform<World, Object> place = {}) : random_(seed) {
    tree_.domain = {{-1, -1, -1}, {1, 1, 1}};
    tree_.objectToWorld = place;
    tree_.levels = 3;
    tree_.nodes.resize(BoundTree::parts);
    fill(0, 4, {0, 0, 0});
    tree_.outside = {0, 0, 0, BoundNode::makeLink(LeafKind::empty, Provenance::estimated, 0)};
    medium_.tree = &tree_;
  }

  const BoundTree& tree() const { return tree_; }
  BoundWalk walk(const Ray<World>& ray, double t) const { return {medium_, ray, t}; }
  std::mt19937_64& random() { return random_; }

 private:
  void fill(std::uint32_t first, int shift, std::array<int, 3> origin) {
    for (std::uint32_t i = 0; i < BoundTree::parts; ++i) {
      const std::array<int, 3> at{origin[0] + (static_cast<int>(i & 3u) << shift),
                                  origin[1] + (static_cast<int>(i >> 2 & 3u) << shift),
                                  origin[2] + (static_cast<int>(i >> 4) << shift)};
      if (shift > 0 && random_() % 3 == 0) {
        const auto parts = static_cast<std::uint32_t>(tree_.nodes.size());
        tree_.nodes.resize(parts + BoundTree::parts);
        fill(parts, shift - 2, at);
        tree_.nodes[first + i].link = BoundNode::makeLink(LeafKind::inner, Provenance::proven, parts);
      } else {
        tree_.nodes[first + i] = {static_cast<float>(at[0] + 1), static_cast<float>(at[1] + 1),
                                  static_cast<float>(at[2] + 1),
                                  BoundNode::makeLink(LeafKind::bounded, static_cast<Provenance>(shift / 2), 0)};
      }
    }
  }

  std::mt19937_64 random_;
  BoundTree tree_;
  Medium medium_;
};

bool isOutside(const BoundNode& leaf) { return leaf.kind() == LeafKind::empty; }

/// Follows a ray from `t`: leaves follow one another without gaps, each holds the middle of its stretch up to rounding,
/// and inside the box nothing is missed. Gives how many leaves there were.
int expectRightWay(const Fixture& fixture, const Ray<World>& ray, double t, double slack = 1e-9) {
  const BoundTree& tree = fixture.tree();
  const double cells = tree.cellsPerSide();
  const auto lattice = [&](double at, std::size_t i) {
    const auto along = [&](float o, float d) { return static_cast<double>(o) + at * static_cast<double>(d); };
    const std::array<double, 3> p{along(ray.origin.x, ray.direction.x), along(ray.origin.y, ray.direction.y),
                                  along(ray.origin.z, ray.direction.z)};
    const Matrix4& m = tree.objectToWorld.inverseMatrix();
    return (m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3] + 1) / 2 * cells;
  };
  int leaves = 0;
  BoundWalk walk = fixture.walk(ray, t);
  for (int step = 0; step < 1000; ++step) {
    const double end = std::min(walk.end(), t + 1e4);
    EXPECT_GE(end, t);
    const double middle = 0.5 * (t + end);
    const BoundNode& leaf = walk.leaf();
    if (!isOutside(leaf)) ++leaves;
    const double side = 1 << 2 * static_cast<int>(leaf.provenance());
    const std::array<double, 3> low{static_cast<double>(leaf.majorant) - 1, static_cast<double>(leaf.control) - 1,
                                    static_cast<double>(leaf.limit) - 1};
    bool isInLeaf = true, isInBox = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const double x = lattice(middle, i);
      isInLeaf = isInLeaf && x >= low[i] - slack && x <= low[i] + side + slack;
      isInBox = isInBox && x > slack && x < cells - slack;
    }
    if (isOutside(leaf) ? isInBox && end > t : !isInLeaf) {
      ADD_FAILURE() << "the wrong leaf at " << middle << ", step " << step;
      return leaves;
    }
    if (std::isinf(walk.end())) return leaves;
    t = walk.end();
    walk.next();
  }
  ADD_FAILURE() << "no end";
  return leaves;
}

Ray<World> rayFrom(Point<World> origin, Vector<World> direction) {
  Ray<World> ray;
  ray.origin = origin;
  ray.direction = direction;
  return ray;
}

TEST(BoundWalk, RandomRays) {
  Fixture fixture(1);
  std::uniform_real_distribution<float> place(-2, 2);
  const auto next = [&] { return place(fixture.random()); };
  int leaves = 0;
  for (int i = 0; i < 20000; ++i) {
    const Point<World> origin(next(), next(), next());
    const Vector<World> direction = normalize(Vector<World>(next(), next(), next()));
    leaves += expectRightWay(fixture, rayFrom(origin, direction), i % 2 == 0 ? 0.0 : -5.0);
  }
  EXPECT_GT(leaves, 50000);
}

/// Along faces, edges and diagonals of the lattice, up and down, with zeros of both signs.
TEST(BoundWalk, FacesEdgesAndCorners) {
  Fixture fixture(2);
  const std::array<float, 4> steps{0.0f, -0.0f, 1.0f, -1.0f};
  const std::array<float, 7> places{-1, -0.5f, -0.03125f, 0, 0.25f, 0.96875f, 1};
  for (const float x : steps) {
    for (const float y : steps) {
      for (const float z : steps) {
        if (x == 0 && y == 0 && z == 0) continue;
        for (const float a : places) {
          for (const float b : places) {
            for (const float c : places) expectRightWay(fixture, rayFrom({a, b, c}, {x, y, z}), -3);
          }
        }
      }
    }
  }
}

TEST(BoundWalk, TurnedAndShearedBoxes) {
  Matrix4 m{{{0.5, 0.7, 0, 3}, {-0.9, 0.2, 0.1, -2}, {0, 0.3, 2, 5}, {0, 0, 0, 1}}}, inverse;
  ASSERT_TRUE(invert(m, inverse));
  Fixture fixture(3, Transform<World, Object>(m, inverse));
  std::uniform_real_distribution<float> place(-2, 2);
  const auto next = [&] { return place(fixture.random()); };
  int leaves = 0;
  for (int i = 0; i < 10000; ++i) {
    const Point<World> origin(3 + next(), -2 + next(), 5 + next());
    leaves += expectRightWay(fixture, rayFrom(origin, normalize(Vector<World>(next(), next(), next()))), -6);
  }
  EXPECT_GT(leaves, 20000);
}

/// From far away the walk begins where the ray comes in.
TEST(BoundWalk, AMillionSizesAway) {
  Fixture fixture(4);
  std::uniform_real_distribution<double> inside(-0.9, 0.9);
  for (const double far : {1e5, 1e6, 1e7}) {
    for (int i = 0; i < 2000; ++i) {
      const Vector<World> towards(static_cast<float>(inside(fixture.random())),
                                  static_cast<float>(inside(fixture.random())), 1);
      const Vector<World> direction = normalize(towards);
      const Point<World> origin(static_cast<float>(-far * static_cast<double>(direction.x)),
                                static_cast<float>(-far * static_cast<double>(direction.y)),
                                static_cast<float>(-far * static_cast<double>(direction.z)));
      expectRightWay(fixture, rayFrom(origin, direction), far - 3, 1e-6);
      expectRightWay(fixture, rayFrom(origin, direction), 0, 1e-4);
    }
  }
}

TEST(BoundWalk, AMediumWithoutATreeIsOneLeaf) {
  Medium medium;
  medium.bound = {3, Provenance::declared};
  const BoundWalk walk(medium, rayFrom({0, 0, 0}, {0, 0, 1}), 0);
  EXPECT_EQ(walk.leaf().majorant, 3);
  EXPECT_EQ(walk.leaf().provenance(), Provenance::declared);
  EXPECT_EQ(walk.known(), nullptr);
  EXPECT_TRUE(std::isinf(walk.end()));
}

TEST(BoundWalk, AConstantMediumIsOneUniformLeaf) {
  Medium medium;
  medium.constant = Coefficients{.sigmaT = Color(1, 2, 3)};
  const BoundWalk walk(medium, rayFrom({0, 0, 0}, {0, 0, 1}), 0);
  EXPECT_EQ(walk.leaf().majorant, 3);
  ASSERT_NE(walk.known(), nullptr);
  EXPECT_EQ(walk.known()->sigmaT, Color(1, 2, 3));
}

}  // namespace
}  // namespace aerosol::volume
