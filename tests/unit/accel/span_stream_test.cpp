// The two designs of finding volume spans give the same; the partition finds no more than is asked for.

#include "core/accel/span_stream.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "tests/unit/accel/random.h"

namespace {

std::size_t& allocations() {
  thread_local std::size_t count = 0;
  return count;
}

}  // namespace

// Counts what the thread allocates; the memory is the C library's.
// ThreadSanitizer brings operators of its own, which cannot be replaced: there nothing is counted.
#if !__has_feature(thread_sanitizer)
void* operator new(std::size_t size) {
  ++allocations();
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

namespace aerosol::accel {
namespace {

struct Element {
  bool isBall = false;
  Transform<World, Object> toWorld;
};

/// The same volumes in a scene of each design.
class Designs {
 public:
  explicit Designs(std::span<const Element> elements)
      : split_(build(elements, OverlapDesign::split)), partition_(build(elements, OverlapDesign::partition)) {}

  const Scene& split() const { return split_; }
  Scene& partition() { return partition_; }

  SpanBuffer bySplit(const Ray<World>& ray) {
    SpanBuffer spans;
    EXPECT_FALSE(split_.closestHit(ray, spans, counters));
    return spans;
  }
  SpanBuffer byPartition(const Ray<World>& ray) {
    stream.begin(partition_, ray, std::fmax(static_cast<double>(ray.tMin), 0.0), static_cast<double>(ray.tMax),
                 counters);
    SpanBuffer spans;
    for (; const Span* span = stream.peek(); stream.pop()) spans.push_back(*span);
    return spans;
  }

  SpanStream stream;
  Counters counters;

 private:
  static Scene build(std::span<const Element> elements, OverlapDesign design) {
    SceneBuilder builder;
    for (const Element& element : elements) {
      std::unique_ptr<const VolumeShape> shape;
      if (element.isBall) {
        shape = std::make_unique<SphereVolume>(element.toWorld);
      } else {
        shape = std::make_unique<BoxVolume>(element.toWorld);
      }
      EXPECT_TRUE(builder.addVolume(std::move(shape)));
    }
    auto scene = builder.build({.overlap = design});
    EXPECT_TRUE(scene);
    return std::move(*scene);
  }

  Scene split_, partition_;
};

Ray<World> randomRay(Random& random, double reach, int k) {
  Ray<World> ray{random.point(reach), random.direction()};
  if (k % 3 == 0) ray.tMin = random.uniformFloat(0, reach);
  if (k % 2 == 0) ray.tMax = ray.tMin + random.uniformFloat(0, 2 * reach);
  return ray;
}

TEST(SpanStream, BothDesignsGiveTheSameSpans) {
  Random random("SpanStream.Same");
  std::size_t total = 0;
  for (int round = 0; round < 40; ++round) {
    std::vector<Element> elements;
    const int count = 1 + static_cast<int>(random.bits() % 300);
    for (int i = 0; i < count; ++i)
      elements.push_back({i % 2 == 1, randomTransform(random, 8, random.uniform(0.05, 2))});
    Designs designs(elements);
    for (int k = 0; k < 500; ++k) {
      const Ray<World> ray = randomRay(random, 12, k);
      const SpanBuffer expected = designs.bySplit(ray);
      ASSERT_EQ(designs.byPartition(ray), expected) << round << ' ' << k;
      total += expected.size();
    }
  }
  EXPECT_GT(total, 15'000u);
}

/// Boxes on an integer lattice: faces coincide with each other, with the planes of the partition and with the rays.
TEST(SpanStream, CoplanarFacesAndRaysAlongThem) {
  Random random("SpanStream.Coplanar");
  std::vector<Element> elements;
  for (int i = 0; i < 400; ++i) {
    const auto place = [&] { return static_cast<double>(random.bits() % 13) - 6; };
    const auto size = [&] { return static_cast<double>(1 + random.bits() % 2); };
    elements.push_back({false, translateScale(place(), place(), place(), size(), size(), size())});
  }
  Designs designs(elements);
  std::size_t total = 0;
  for (int k = 0; k < 20'000; ++k) {
    const auto place = [&] { return static_cast<float>(random.bits() % 17) - 8; };
    Ray<World> ray{{place(), place(), place()}, {}};
    if (k % 2 == 0) {
      ray.direction[static_cast<int>(random.bits() % 3)] = random.bits() % 2 == 0 ? 1.0f : -1.0f;
      if (k % 4 == 0) ray.direction = -ray.direction;  // Some zeros become -0.
    } else {
      const Vector<World> diagonal(place(), place(), place());
      if (length(diagonal) == 0) continue;
      ray.direction = normalize(diagonal);
    }
    const SpanBuffer expected = designs.bySplit(ray);
    ASSERT_EQ(designs.byPartition(ray), expected) << k;
    total += expected.size();
  }
  EXPECT_GT(total, 20'000u);
}

TEST(SpanStream, FarAndNearAndTiny) {
  Random random("SpanStream.Scales");
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const double offset : {0.0, 1e7}) {
      std::vector<Element> elements;
      for (int i = 0; i < 60; ++i) {
        const auto place = [&] { return scale * (offset + random.uniform(-4, 4)); };
        elements.push_back({i % 2 == 0, translateScale(place(), place(), place(), scale * random.uniform(1, 3))});
      }
      Designs designs(elements);
      std::size_t total = 0;
      for (int k = 0; k < 500; ++k) {
        const Vector<World> d = random.direction();
        const double distance = k % 2 == 0 ? 10 : 1e5;
        Ray<World> ray{{}, d};
        for (int i = 0; i < 3; ++i)
          ray.origin[i] =
              static_cast<float>(scale * (offset + random.uniform(-3, 3) - distance * static_cast<double>(d[i])));
        const SpanBuffer expected = designs.bySplit(ray);
        ASSERT_EQ(designs.byPartition(ray), expected) << scale << ' ' << offset << ' ' << k;
        total += expected.size();
      }
      EXPECT_GT(total, 500u);
    }
  }
}

TEST(SpanStream, AThousandIdentical) {
  Designs designs(std::vector<Element>(1000, {false, translateScale(0, 0, 5, 1)}));
  const Ray<World> ray{{0.1f, 0.2f, 0}, {0, 0, 1}};
  const SpanBuffer spans = designs.byPartition(ray);
  EXPECT_EQ(spans, designs.bySplit(ray));
  EXPECT_EQ(spans.size(), 1000u);
}

TEST(SpanStream, AThousandNested) {
  std::vector<Element> elements;
  for (int i = 0; i < 1000; ++i) elements.push_back({i % 2 == 0, translateScale(0, 0, 5, 1 + 0.001 * i)});
  Designs designs(elements);
  Random random("SpanStream.Nested");
  for (int k = 0; k < 20; ++k) {
    const Ray<World> ray{random.point(5), random.direction()};
    ASSERT_EQ(designs.byPartition(ray), designs.bySplit(ray));
  }
}

std::vector<Element> row(int count) {
  std::vector<Element> elements;
  for (int i = 0; i < count; ++i) elements.push_back({false, translateScale(0, 0, 2.0 * i, 1)});
  return elements;
}

TEST(SpanStream, TenThousandDisjoint) {
  Designs designs(row(10'000));
  const Ray<World> ray{{0.1f, 0.2f, -10}, {0, 0, 1}};
  const SpanBuffer spans = designs.byPartition(ray);
  EXPECT_EQ(spans, designs.bySplit(ray));
  EXPECT_EQ(spans.size(), 10'000u);
}

TEST(SpanStream, FindsNoMoreThanIsAskedFor) {
  Designs designs(row(10'000));
  const Ray<World> ray{{0.1f, 0.2f, -10}, {0, 0, 1}};
  designs.stream.begin(designs.partition(), ray, 0, 1e30, designs.counters);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(designs.stream.peek());
    designs.stream.pop();
  }
  EXPECT_LT(designs.counters.volumeTests, 20u);
  EXPECT_EQ(designs.stream.peek(15), nullptr);
}

TEST(SpanStream, WhatIsKnownToBeEmptyIsNotEvenTested) {
  Designs designs(row(100));
  std::vector<Box<World>> occupied;
  for (VolumeId i = 0; i < 100; ++i) occupied.push_back(designs.partition().volume(i).worldBounds());
  occupied[3] = {};                                  // Nothing at all,
  occupied[4].lower.z = occupied[4].upper.z - 0.5f;  // and something in its last quarter.
  designs.partition().refinePartition(occupied, [](VolumeId volume, const Box<World>&) { return volume == 7; });
  const SpanBuffer spans = designs.byPartition({{0.1f, 0.2f, -10}, {0, 0, 1}});
  ASSERT_EQ(spans.size(), 98u);
  EXPECT_EQ(spans[2].volume, 2u);
  EXPECT_EQ(spans[3].volume, 4u);
  EXPECT_NEAR(spans[3].t1, 19, 1e-9);
  EXPECT_LE(spans[3].t0, 18.5);
  EXPECT_EQ(spans[5].volume, 6u);
  EXPECT_EQ(spans[6].volume, 8u);
}

TEST(SpanStream, UnboundedVolumesAreThereToo) {
  std::vector<Element> elements = row(5);
  elements.push_back({false, translateScale(0, 0, 0, 1e25)});
  Designs designs(elements);
  const Ray<World> ray{{0.1f, 0.2f, -10}, {0, 0, 1}};
  EXPECT_EQ(designs.byPartition(ray), designs.bySplit(ray));
  EXPECT_EQ(designs.byPartition(ray).size(), 6u);
}

TEST(SpanStream, AllocatesNothingOnceItHasGrown) {
  Random random("SpanStream.Memory");
  std::vector<Element> elements;
  for (int i = 0; i < 500; ++i) elements.push_back({i % 2 == 1, randomTransform(random, 5, 0.6)});
  Designs designs(elements);
  std::vector<Ray<World>> rays;
  for (int k = 0; k < 2000; ++k) rays.push_back(randomRay(random, 12, k));
  const auto walkAll = [&] {
    std::size_t spans = 0;
    for (const Ray<World>& ray : rays) {
      designs.stream.begin(designs.partition(), ray, 0, 1e30, designs.counters);
      for (; designs.stream.peek(); designs.stream.pop()) ++spans;
    }
    return spans;
  };
  const std::size_t first = walkAll(), before = allocations();
  EXPECT_EQ(walkAll(), first);
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(first, 2000u);
}

TEST(OverlapDesign, FollowsTheOverlap) {
  std::vector<Box<World>> many(50, {{-1, -1, -1}, {1, 1, 1}});
  EXPECT_EQ(chooseOverlapDesign(many), OverlapDesign::partition);
  EXPECT_EQ(chooseOverlapDesign({many.data(), 2}), OverlapDesign::split);
  EXPECT_EQ(chooseOverlapDesign({}), OverlapDesign::split);
  EXPECT_NEAR(expectedOverlap(many), 50, 1e-9);
}

}  // namespace
}  // namespace aerosol::accel
