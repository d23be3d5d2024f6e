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

// Text: 1 where pixel (s, t) belongs to a letter of str, else 0. A letter is 8 pixels wide and 14 high, the first one
// begins at (0, 0), and t grows downwards. With wrap_s or wrap_t the text repeats in that direction, with room of a
// line's height between; there, four bits of jitter (the lowest, and those above 16) shift it. Codes 33 to 126 have a
// form of 5 x 7 dots, each two pixels high: dots of three columns and of two, a column's top dot in its lowest bit.
float draw_string(string str, float s, float t, int wrap_s, int wrap_t, int jitter) {
  int columns[188] = {
    1556480, 0, 896, 7, 343956, 2687, 2086180, 2346, 133539, 12644, 1402038, 10274, 49792, 0, 560640, 65, 565376, 28,
    464136, 1066, 1016840, 1032, 796672, 0, 132104, 1032, 1585152, 0, 133152, 260, 1206462, 8005, 2089216, 64,
    1339586, 9033, 1138849, 6347, 297496, 2175, 1139367, 7365, 1205564, 6217, 161921, 389, 1205430, 6985, 1205382,
    3881, 891648, 0, 895744, 0, 328704, 8354, 330260, 2580, 332097, 8, 1327234, 777, 1991858, 8001, 280830, 16145,
    1205503, 6985, 1073342, 4417, 1073407, 3618, 1205503, 8393, 148735, 129, 1073342, 6481, 132223, 16264, 2089088,
    65, 1073184, 191, 328831, 8354, 1056895, 8256, 65919, 16258, 131711, 16272, 1073342, 8001, 148735, 777, 1335486,
    12065, 410879, 9001, 1205446, 6345, 2080897, 129, 1056831, 8128, 1052703, 4000, 397439, 16288, 133731, 12692,
    1966595, 388, 1206497, 8645, 2080768, 8385, 131586, 4112, 2089153, 0, 16644, 514, 1056832, 8256, 32896, 4,
    1387040, 15444, 1123455, 7236, 1122872, 4164, 1122872, 16328, 1387064, 3156, 163592, 257, 1378824, 7764, 66687,
    15364, 2056704, 64, 1122336, 61, 278400, 8744, 2089088, 64, 393852, 15364, 66684, 15364, 1122872, 7236, 330364,
    1044, 330248, 15896, 66684, 1028, 1387080, 4180, 1122180, 4160, 1056828, 15904, 1052700, 3616, 794684, 7744,
    267332, 8744, 1320972, 7760, 1389124, 8780, 885760, 65, 2080768, 0, 893056, 8, 131592, 1040
  };
  int length = 8 * strlen(str);
  float across = wrap_s ? mod(floor(s) + (jitter & 15), length + 14.0) : floor(s);
  float down = wrap_t ? mod(floor(t) + (jitter >> 16 & 15), 28.0) : floor(t);
  if (across < 0 || across >= length || down < 0 || down > 13) return 0;
  int x = (int)across;
  int code = getchar(str, x / 8) - 33, column = x % 8 - 1;
  if (code < 0 || code > 93 || column < 0 || column > 4) return 0;
  int dots = columns[2 * code + column / 3] >> (7 * (column % 3) + (int)down / 2);
  return dots & 1;
}

#endif
