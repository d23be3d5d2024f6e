// A colour and an alpha.
#pragma once
#define COLOR4_H

struct color4 {
  color rgb;
  float a;
};

int __operator__eq__(color4 a, color4 b) { return a.rgb == b.rgb && a.a == b.a; }

#define TUPLE color4
#define TUPLE_OF(x) color4(color(x), x)
#define TUPLE_MAP1(f, p_) color4(f((p_).rgb), f((p_).a))
#define TUPLE_MAP2(f, p_, q_) color4(f((p_).rgb, (q_).rgb), f((p_).a, (q_).a))
#define TUPLE_MAP3(f, p_, q_, s_) color4(f((p_).rgb, (q_).rgb, (s_).rgb), f((p_).a, (q_).a, (s_).a))
#include "tuple_functions.h"

float dot(color4 a, color b) { return dot(vector(a.rgb), vector(b)); }
color4 transformc(string from, string to, color4 c) { return color4(transformc(from, to, c.rgb), c.a); }
