// One channel of colour and an alpha.
#pragma once
#define COLOR2_H

struct color2 {
  float r;
  float a;
};

int __operator__eq__(color2 a, color2 b) { return a.r == b.r && a.a == b.a; }

#define TUPLE color2
#define TUPLE_OF(x) color2(x, x)
#define TUPLE_MAP1(f, p_) color2(f((p_).r), f((p_).a))
#define TUPLE_MAP2(f, p_, q_) color2(f((p_).r, (q_).r), f((p_).a, (q_).a))
#define TUPLE_MAP3(f, p_, q_, s_) color2(f((p_).r, (q_).r, (s_).r), f((p_).a, (q_).a, (s_).a))
#include "tuple_functions.h"
