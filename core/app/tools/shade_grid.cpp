#include "core/app/tools/shade_grid.h"

#include <cmath>
#include <numbers>

namespace aerosol::app {

namespace {

/// u or v of point `i` of `count`, without offset and scale.
float parameterAt(int i, int count, bool pixelCentres) {
  if (pixelCentres) return (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
  return count == 1 ? 0.5f : static_cast<float>(i) / static_cast<float>(count - 1);
}

/// A turn about z by `angle` (a float, as its sine and cosine are), then a move.
Transform<World, Object> turnedAndMoved(float angle, double x, double y) {
  const auto c = static_cast<double>(std::cos(angle)), s = static_cast<double>(std::sin(angle));
  Matrix4 forward = identityMatrix();
  forward[0] = {c, -s, 0, x};
  forward[1] = {s, c, 0, y};
  Matrix4 inverse = identityMatrix();
  invert(forward, inverse);
  return {forward, inverse};
}

}  // namespace

shading::ShadingPoint gridPoint(const ShadeGrid& grid, int x, int y) {
  struct Vec {
    float x, y, z;
  };
  using lang::Global;
  shading::ShadingPoint point;
  const float u = grid.uScale * parameterAt(x, grid.width, grid.pixelCentres) + grid.uOffset;
  const float v = grid.vScale * parameterAt(y, grid.height, grid.pixelCentres) + grid.vOffset;
  point.set(Global::u, u);
  point.set(Global::v, v);
  point.set(Global::P, Vec{u, v, 1});
  point.set(Global::N, Vec{0, 0, 1});
  point.set(Global::Ng, Vec{0, 0, 1});
  point.set(Global::dPdu, Vec{1, 0, 0});
  point.set(Global::dPdv, Vec{0, 1, 0});
  return point;
}

Transform<World, Object> gridObjectSpace() { return turnedAndMoved(std::numbers::pi_v<float> / 2, 0, 1); }
Transform<World, Object> gridShaderSpace() { return turnedAndMoved(std::numbers::pi_v<float> / 4, 1, 0); }

shading::NamedSpaces gridSpaces() {
  shading::NamedSpaces spaces;
  const Matrix4 identity = identityMatrix();
  spaces.add("camera", identity, identity);
  Matrix4 tall = identity, low = identity;
  tall[1][1] = 2;
  low[1][1] = 0.5;
  spaces.add("myspace", tall, low);
  return spaces;
}

}  // namespace aerosol::app
