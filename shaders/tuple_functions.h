// Operators and functions of a structure of numbers, element by element. Included with these macros defined, which it
// undefines: TUPLE the structure; TUPLE_OF(x) one with x everywhere; TUPLE_MAP1(f, a), TUPLE_MAP2(f, a, b) and
// TUPLE_MAP3(f, a, b, c) one of f applied to the elements.

#define TUPLE_ADD(x, y) (x) + (y)
#define TUPLE_SUB(x, y) (x) - (y)
#define TUPLE_MUL(x, y) (x) * (y)
#define TUPLE_DIV(x, y) (x) / (y)
#define TUPLE_NEG(x) -(x)
#define TUPLE_OPERATOR(name, of)                                                  \
  TUPLE name(TUPLE a, TUPLE b) { return TUPLE_MAP2(of, a, b); }                   \
  TUPLE name(TUPLE a, int b) { return TUPLE_MAP2(of, a, TUPLE_OF((float)b)); }    \
  TUPLE name(TUPLE a, float b) { return TUPLE_MAP2(of, a, TUPLE_OF(b)); }         \
  TUPLE name(int a, TUPLE b) { return TUPLE_MAP2(of, TUPLE_OF((float)a), b); }    \
  TUPLE name(float a, TUPLE b) { return TUPLE_MAP2(of, TUPLE_OF(a), b); }
TUPLE_OPERATOR(__operator__add__, TUPLE_ADD)
TUPLE_OPERATOR(__operator__sub__, TUPLE_SUB)
TUPLE_OPERATOR(__operator__mul__, TUPLE_MUL)
TUPLE_OPERATOR(__operator__div__, TUPLE_DIV)
#undef TUPLE_OPERATOR
TUPLE __operator__neg__(TUPLE a) { return TUPLE_MAP1(TUPLE_NEG, a); }
int __operator__neq__(TUPLE a, TUPLE b) { return !(a == b); }

#define TUPLE_DEFINE(f) \
  TUPLE f(TUPLE a) { return TUPLE_MAP1(f, a); }
TUPLE_DEFINE(abs)
TUPLE_DEFINE(ceil)
TUPLE_DEFINE(floor)
TUPLE_DEFINE(sqrt)
TUPLE_DEFINE(exp)
TUPLE_DEFINE(log)
TUPLE_DEFINE(log2)
TUPLE_DEFINE(sign)
TUPLE_DEFINE(sin)
TUPLE_DEFINE(cos)
TUPLE_DEFINE(tan)
TUPLE_DEFINE(asin)
TUPLE_DEFINE(acos)
#undef TUPLE_DEFINE

#define TUPLE_DEFINE(f)                                       \
  TUPLE f(TUPLE a, TUPLE b) { return TUPLE_MAP2(f, a, b); }   \
  TUPLE f(TUPLE a, float b) { return TUPLE_MAP2(f, a, TUPLE_OF(b)); }
TUPLE_DEFINE(max)
TUPLE_DEFINE(min)
TUPLE_DEFINE(fmod)
TUPLE_DEFINE(mod)
TUPLE_DEFINE(pow)
TUPLE_DEFINE(atan2)
#undef TUPLE_DEFINE

TUPLE mix(TUPLE a, TUPLE b, TUPLE x) { return TUPLE_MAP3(mix, a, b, x); }
TUPLE mix(TUPLE a, TUPLE b, float x) { return TUPLE_MAP3(mix, a, b, TUPLE_OF(x)); }
TUPLE smoothstep(TUPLE low, TUPLE high, TUPLE x) { return TUPLE_MAP3(smoothstep, low, high, x); }
TUPLE smoothstep(float low, float high, TUPLE x) {
  return TUPLE_MAP3(smoothstep, TUPLE_OF(low), TUPLE_OF(high), x);
}
TUPLE clamp(TUPLE x, TUPLE low, TUPLE high) { return TUPLE_MAP3(clamp, x, low, high); }
TUPLE clamp(TUPLE x, float low, float high) { return TUPLE_MAP3(clamp, x, TUPLE_OF(low), TUPLE_OF(high)); }

#undef TUPLE_ADD
#undef TUPLE_SUB
#undef TUPLE_MUL
#undef TUPLE_DIV
#undef TUPLE_NEG
#undef TUPLE
#undef TUPLE_OF
#undef TUPLE_MAP1
#undef TUPLE_MAP2
#undef TUPLE_MAP3
