#include "tests/render/film_checks.h"

namespace aerosol::test {
namespace {

TEST(DepthIntegrator, MeasuresFromTheNearClipPlane) {
  const TestScene scene(R"(<scene version="3.0.0"><integrator type="depth"/>
      <sensor type="perspective"><float name="fov" value="40"/><float name="near_clip" value="2"/>
        <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/><rfilter type="box"/></film>
        <sampler type="independent"/></sensor>
      <shape type="rectangle"><transform name="to_world"><scale value="10"/><rotate y="1" angle="180"/>
        <translate z="5"/></transform></shape></scene>)");
  EXPECT_TRUE(shows(scene, *scene.render(256), [](const Ray<World>& ray) { return Color(3 / ray.direction.z); }));
}

}  // namespace
}  // namespace aerosol::test
