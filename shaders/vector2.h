// A vector in the plane.
#pragma once
#define VECTOR2_H

struct vector2 {
  float x;
  float y;
};

int __operator__eq__(vector2 a, vector2 b) { return a.x == b.x && a.y == b.y; }

#define TUPLE vector2
#define TUPLE_OF(x) vector2(x, x)
#define TUPLE_MAP1(f, p_) vector2(f((p_).x), f((p_).y))
#define TUPLE_MAP2(f, p_, q_) vector2(f((p_).x, (q_).x), f((p_).y, (q_).y))
#define TUPLE_MAP3(f, p_, q_, s_) vector2(f((p_).x, (q_).x, (s_).x), f((p_).y, (q_).y, (s_).y))
#include "tuple_functions.h"

float dot(vector2 a, vector2 b) { return a.x * b.x + a.y * b.y; }
float length(vector2 a) { return hypot(a.x, a.y); }
vector2 normalize(vector2 a) { return a / length(a); }
// Turned by an angle in radians about a centre.
vector2 rotate2d(vector2 p, float angle, vector2 center) {
  float s, c;
  sincos(angle, s, c);
  vector2 arm = p - center;
  return center + vector2(arm.x * c - arm.y * s, arm.y * c + arm.x * s);
}
