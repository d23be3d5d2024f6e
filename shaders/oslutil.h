// Helper functions of shaders that are no part of the language: #include "oslutil.h".
#ifndef OSLUTIL_H
#define OSLUTIL_H

#include "stdosl.h"

// How much of the point lies on an edge of the geometry: 0 to 1, with soft borders. `edge_type` is "triangles",
// "polygons" or "patches"; lines are as wide as `line_width` pixels (raster) or units of "common" space. The corners come
// from the renderer, as attributes "geom:trianglevertices", or "geom:numpolyvertices" and "geom:polyvertices".
float wireframe(string edge_type, float line_width, int raster) {
  point corners[64];
  int count = 0;
  if (edge_type == "triangles") {
    point triangle[3];
    if (!getattribute("geom:trianglevertices", triangle)) return 0;
    for (count = 0; count < 3; ++count) corners[count] = triangle[count];
  } else if (edge_type == "polygons" || edge_type == "patches") {
    getattribute("geom:numpolyvertices", count);
    if (count < 3 || count > 64 || !getattribute("geom:polyvertices", corners)) return 0;
  }
  float pixel = raster ? 0.5 * (length(Dx(P)) + length(Dy(P))) : filterwidth(length(P - corners[0]));
  float half = 0.5 * (raster ? line_width * pixel : line_width);
  float covered = 0;
  for (int i = 0; i < count; ++i) {
    float away = distance(corners[i], corners[(i + 1) % count], P);
    covered = max(covered, pixel > 0 ? clamp((half - away) / pixel + 0.5, 0.0, 1.0) : away <= half ? 1.0 : 0.0);
  }
  return covered;
}
float wireframe(string edge_type, float line_width) { return wireframe(edge_type, line_width, 1); }
float wireframe(string edge_type) { return wireframe(edge_type, 1.0, 1); }
float wireframe() { return wireframe("polygons", 1.0, 1); }

#endif
