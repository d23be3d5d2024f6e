#include "core/app/tools/shade_grid.h"

#include <algorithm>
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

struct Vec {
  float x, y, z;
};

/// How u or v and the position change to the next point in x and in y.
struct Steps {
  float u, v;  ///< Of one cell of the grid.
  Vec px, py;
};

Steps stepsOf(const ShadeGrid& grid) {
  const auto intervals = [](int count) { return static_cast<float>(std::max(1, count - 1)); };
  const float dx = grid.uScale / intervals(grid.width), dy = grid.vScale / intervals(grid.height);
  Steps steps{dx, dy, {dx, 0, 0}, {0, dy, 0}};
  if (grid.pixelCentres) {
    steps.u = grid.uScale / static_cast<float>(grid.width);
    steps.v = grid.vScale / static_cast<float>(grid.height);
  }
  return steps;
}

}  // namespace

shading::ShadingPoint gridPoint(const ShadeGrid& grid, int x, int y) {
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
  const Steps steps = stepsOf(grid);
  point.set(Global::dudx, grid.varyDU ? 1 - u : steps.u);
  point.set(Global::dudy, grid.varyDU ? u : 0);
  point.set(Global::dvdx, grid.varyDV ? 1 - v : 0);
  point.set(Global::dvdy, grid.varyDV ? v : steps.v);
  point.set(Global::dPdx, grid.varyDP ? Vec{1 - u, 1 - v, u * 0.5f} : steps.px);
  point.set(Global::dPdy, grid.varyDP ? Vec{1 - v, 1 - u, v * 0.5f} : steps.py);
  return point;
}

Transform<World, Object> gridObjectSpace() { return turnedAndMoved(std::numbers::pi_v<float> / 2, 0, 1); }
Transform<World, Object> gridShaderSpace() { return turnedAndMoved(std::numbers::pi_v<float> / 4, 1, 0); }

shading::NamedSpaces gridSpaces(const ShadeGrid& grid) {
  shading::NamedSpaces spaces;
  const Matrix4 identity = identityMatrix();
  spaces.add("camera", identity, identity);
  const double depth = double{farClip} / (double{farClip} - double{nearClip});
  shading::CameraProjection camera;
  camera.toScreen = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, depth, -depth * double{nearClip}}, {0, 0, 1, 0}}};
  camera.screenToNdc = {{{0.5, 0, 0, 0.5}, {0, 0.5, 0, 0.5}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  camera.width = grid.width;
  camera.height = grid.height;
  spaces.addCamera(identity, camera);
  Matrix4 tall = identity, low = identity;
  tall[1][1] = 2;
  low[1][1] = 0.5;
  spaces.add("myspace", tall, low);
  return spaces;
}

}  // namespace aerosol::app
