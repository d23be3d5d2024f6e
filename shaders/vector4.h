// Four numbers with the operations of a vector.
#pragma once
#define VECTOR4_H

struct vector4 {
  float x;
  float y;
  float z;
  float w;
};

int __operator__eq__(vector4 a, vector4 b) { return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w; }

#define TUPLE vector4
#define TUPLE_OF(x) vector4(x, x, x, x)
#define TUPLE_MAP1(f, p_) vector4(f((p_).x), f((p_).y), f((p_).z), f((p_).w))
#define TUPLE_MAP2(f, p_, q_) vector4(f((p_).x, (q_).x), f((p_).y, (q_).y), f((p_).z, (q_).z), f((p_).w, (q_).w))
#define TUPLE_MAP3(f, p_, q_, s_) vector4(f((p_).x, (q_).x, (s_).x), f((p_).y, (q_).y, (s_).y), f((p_).z, (q_).z, (s_).z), f((p_).w, (q_).w, (s_).w))
#include "tuple_functions.h"

float dot(vector4 a, vector4 b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }
float length(vector4 a) { return sqrt(dot(a, a)); }
vector4 normalize(vector4 a) { return a / length(a); }
vector vec4ToVec3(vector4 v) { return vector(v.x, v.y, v.z) / v.w; }
vector4 transform(matrix m, vector4 p) {
  float row(int i) { return m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z + m[i][3] * p.w; }
  return vector4(row(0), row(1), row(2), row(3));
}
vector4 transform(string from, string to, vector4 p) { return transform(matrix(from, to), p); }
