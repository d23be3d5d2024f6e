// Where a function is not differentiable the derivative is that of the branch which the value comes from; where the
// language defines a value for what mathematics leaves undefined (x / 0, sqrt(-1), log(0), pow(0, -1) …), it is zero.
#include "core/lang/derivative_rules.h"

#include <algorithm>
#include <array>

namespace aerosol::lang {

namespace {

using B = DerivativeBuilder;
using V = VariableId;
using Call = DifferentiatedCall;

constexpr V zero = DerivativeBuilder::zero;
constexpr float ln2 = 0.693147181f, ln10 = 2.30258509f, smallestNormal = 1.17549435e-38f;

// One argument: the factor of dx.

V sine(B& b, const Call& c) { return b.multiply(b.call("cos", c.x[0]), c.dx[0]); }
V cosine(B& b, const Call& c) { return b.negate(b.multiply(b.call("sin", c.x[0]), c.dx[0])); }
V tangent(B& b, const Call& c) { return b.multiply(b.add(b.square(c.y), b.number(1)), c.dx[0]); }
/// 1 / sqrt(1 - x^2), 0 outside of (-1, 1).
V arcSine(B& b, const Call& c) {
  return b.multiply(b.call("inversesqrt", b.subtract(b.number(1), b.square(c.x[0]))), c.dx[0]);
}
V arcCosine(B& b, const Call& c) { return b.negate(arcSine(b, c)); }
V arcTangent(B& b, const Call& c) { return b.divide(c.dx[0], b.add(b.square(c.x[0]), b.number(1))); }
V arcTangent2(B& b, const Call& c) {
  const V turn = b.subtract(b.multiply(c.x[1], c.dx[0]), b.multiply(c.x[0], c.dx[1]));
  return b.divide(turn, b.add(b.square(c.x[0]), b.square(c.x[1])));
}
V hyperbolicSine(B& b, const Call& c) { return b.multiply(b.call("cosh", c.x[0]), c.dx[0]); }
V hyperbolicCosine(B& b, const Call& c) { return b.multiply(b.call("sinh", c.x[0]), c.dx[0]); }
V hyperbolicTangent(B& b, const Call& c) { return b.multiply(b.subtract(b.number(1), b.square(c.y)), c.dx[0]); }
V degrees(B& b, const Call& c) { return b.multiply(c.dx[0], b.number(57.2957795f)); }
V radians(B& b, const Call& c) { return b.multiply(c.dx[0], b.number(0.0174532925f)); }
V exponential(B& b, const Call& c) { return b.multiply(c.y, c.dx[0]); }
V exponential2(B& b, const Call& c) { return b.multiply(b.multiply(c.y, b.number(ln2)), c.dx[0]); }
V exponentialMinus1(B& b, const Call& c) { return b.multiply(b.add(c.y, b.number(1)), c.dx[0]); }

/// dx / x where the logarithm of x is not clamped.
V relativeChange(B& b, V x, V dx) {
  if (dx == zero) return zero;
  return b.select(b.compare(Op::less, x, b.number(smallestNormal)), zero, b.divide(dx, x));
}
V logarithm(B& b, const Call& c) {
  const V change = relativeChange(b, c.x[0], c.dx[0]);
  if (c.x.size() == 1) return change;
  const V baseChange = b.multiply(c.y, relativeChange(b, c.x[1], c.dx[1]));
  return b.divide(b.subtract(change, baseChange), b.call("log", c.x[1]));
}
V logarithm2(B& b, const Call& c) { return b.multiply(relativeChange(b, c.x[0], c.dx[0]), b.number(1 / ln2)); }
V logarithm10(B& b, const Call& c) { return b.multiply(relativeChange(b, c.x[0], c.dx[0]), b.number(1 / ln10)); }
V squareRoot(B& b, const Call& c) { return b.divide(b.multiply(c.dx[0], b.number(0.5f)), c.y); }
V inverseSquareRoot(B& b, const Call& c) {
  return b.multiply(b.divide(b.multiply(c.y, b.number(-0.5f)), c.x[0]), c.dx[0]);
}
V cubeRoot(B& b, const Call& c) { return b.divide(c.dx[0], b.multiply(b.square(c.y), b.number(3))); }
V errorFunction(B& b, const Call& c) {
  const V bell = b.call("exp", b.negate(b.square(c.x[0])));
  return b.multiply(b.multiply(bell, b.number(1.12837917f)), c.dx[0]);
}
V errorFunctionComplement(B& b, const Call& c) { return b.negate(errorFunction(b, c)); }
V absolute(B& b, const Call& c) {
  if (c.dx[0] == zero) return zero;
  return b.select(b.compare(Op::less, c.x[0], b.number(0)), b.negate(c.dx[0]), c.dx[0]);
}

/// x^n: n x^(n-1) dx + log(x) x^n dn. The first factor is n y / x, or for x = 0: 1 where n is 1, otherwise 0. The
/// second is zero for x <= 0, where powers do not vary smoothly with the exponent.
V power(B& b, const Call& c) {
  const V x = c.x[0], n = c.x[1], null = b.number(0);
  V byBase = zero;
  if (c.dx[0] != zero) {
    const V isOne = b.compare(Op::equal, n, b.number(1));
    const V factor = b.select(b.compare(Op::equal, x, null), b.emit(Op::toFloat, types::floating, {isOne}),
                              b.divide(b.multiply(n, c.y), x));
    byBase = b.multiply(b.isNumber(n, 2) ? b.add(x, x) : factor, c.dx[0]);
  }
  if (c.dx[1] == zero) return byBase;
  const V byExponent = b.multiply(b.multiply(b.call("log", x), c.y), c.dx[1]);
  return b.add(byBase, b.select(b.compare(Op::less, null, x), byExponent, zero));
}

V hypotenuse(B& b, const Call& c) {
  V sum = zero;
  for (std::size_t i = 0; i < c.x.size(); ++i) sum = b.add(sum, b.multiply(c.x[i], c.dx[i]));
  return b.divide(sum, c.y);
}

// Remainders: the number of times that the divisor is taken off is constant.

V floatRemainder(B& b, const Call& c) {
  const V times = b.call("trunc", b.divide(c.x[0], c.x[1]));
  const V change = b.subtract(c.dx[0], b.multiply(times, c.dx[1]));
  const bool isSafe = b.isConstant(c.x[1]) && !b.isNumber(c.x[1], 0);
  if (isSafe || change == zero) return change;
  return b.select(b.compare(Op::equal, c.x[1], b.number(0)), zero, change);
}
V floorRemainder(B& b, const Call& c) {
  if (c.dx[1] == zero) return c.dx[0];
  const V times = b.call("floor", b.divide(c.x[0], c.x[1]));
  return b.subtract(c.dx[0], b.multiply(times, c.dx[1]));
}

// Choice and ramps

V choose(B& b, V condition, V yes, V no) { return yes == zero && no == zero ? zero : b.select(condition, yes, no); }
// Of equal values, min has the change of the first one and max that of the second.
V minimum(B& b, const Call& c) { return choose(b, b.compare(Op::less, c.x[1], c.x[0]), c.dx[1], c.dx[0]); }
V maximum(B& b, const Call& c) { return choose(b, b.compare(Op::less, c.x[1], c.x[0]), c.dx[0], c.dx[1]); }
V clamped(B& b, const Call& c) {
  const V below = choose(b, b.compare(Op::less, c.x[2], c.x[0]), c.dx[2], c.dx[0]);
  const V upper = b.call("min", types::floating, {c.x[0], c.x[2]});
  return choose(b, b.compare(Op::less, c.x[1], upper), below, c.dx[1]);
}
V mixed(B& b, const Call& c) {
  const V first = b.multiply(c.dx[0], b.subtract(b.number(1), c.x[2]));
  const V second = b.multiply(c.dx[1], c.x[2]);
  const V share = c.dx[2] == zero ? zero : b.multiply(b.subtract(c.x[1], c.x[0]), c.dx[2]);
  return b.add(b.add(first, second), share);
}
/// Change of t = (x - low) / (high - low) for the arguments (low, high, x), given t.
V rampChange(B& b, const Call& c, V t) {
  const V width = b.subtract(c.x[1], c.x[0]);
  const V stretch = b.multiply(t, b.subtract(c.dx[1], c.dx[0]));
  return b.divide(b.subtract(b.subtract(c.dx[2], c.dx[0]), stretch), width);
}
V isInside(B& b, const Call& c) {
  return b.compare(Op::logicalAnd, b.compare(Op::less, c.x[0], c.x[2]), b.compare(Op::lessEqual, c.x[2], c.x[1]));
}
V smoothRamp(B& b, const Call& c) {
  const V t = b.divide(b.subtract(c.x[2], c.x[0]), b.subtract(c.x[1], c.x[0]));
  const V slope = b.multiply(b.multiply(b.number(6), t), b.subtract(b.number(1), t));
  return choose(b, isInside(b, c), b.multiply(slope, rampChange(b, c, t)), zero);
}
V linearRamp(B& b, const Call& c) { return choose(b, isInside(b, c), rampChange(b, c, c.y), zero); }
V fusedMultiplyAdd(B& b, const Call& c) {
  return b.add(b.add(b.multiply(c.dx[0], c.x[1]), b.multiply(c.x[0], c.dx[1])), c.dx[2]);
}

// Geometry

V dot(B& b, V u, V v) { return u == zero || v == zero ? zero : b.call("dot", types::floating, {u, v}); }
V cross(B& b, V u, V v) { return u == zero || v == zero ? zero : b.call("cross", types::vector, {u, v}); }
V innerProduct(B& b, const Call& c) { return b.add(dot(b, c.dx[0], c.x[1]), dot(b, c.x[0], c.dx[1])); }
V vectorProduct(B& b, const Call& c) { return b.add(cross(b, c.dx[0], c.x[1]), cross(b, c.x[0], c.dx[1])); }
V length(B& b, const Call& c) { return b.divide(dot(b, c.x[0], c.dx[0]), c.y); }
V distance(B& b, const Call& c) {
  const V apart = b.subtract(c.x[0], c.x[1]);
  return b.divide(dot(b, apart, b.subtract(c.dx[0], c.dx[1])), c.y);
}
/// What is left of dv / |v| perpendicular to v.
V normalized(B& b, const Call& c) {
  const V along = b.multiply(c.y, dot(b, c.y, c.dx[0]));
  return b.divide(b.subtract(c.dx[0], along), b.call("length", c.x[0]));
}

// Matrices, for row vectors: arguments (matrix, triple).

V vectorBy(B& b, V matrix, V vector) {
  return matrix == zero || vector == zero ? zero : b.call("transformv", types::vector, {matrix, vector});
}
V transformedVector(B& b, const Call& c) { return b.add(vectorBy(b, c.x[0], c.dx[1]), vectorBy(b, c.dx[0], c.x[1])); }
/// (p, 1) M divided by its fourth coordinate w: the change of the numerator less y dw, divided by w.
V transformedPoint(B& b, const Call& c) {
  const V matrix = c.x[0], p = c.x[1], dMatrix = c.dx[0], dp = c.dx[1];
  if (dMatrix == zero && b.isAffine(matrix)) return vectorBy(b, matrix, dp);
  const auto column3 = [&](V m) {
    return b.triple(b.matrixElement(m, 0, 3), b.matrixElement(m, 1, 3), b.matrixElement(m, 2, 3));
  };
  V top = vectorBy(b, matrix, dp);
  V weight = dot(b, column3(matrix), dp);
  if (dMatrix != zero) {
    const V moved =
        b.triple(b.matrixElement(dMatrix, 3, 0), b.matrixElement(dMatrix, 3, 1), b.matrixElement(dMatrix, 3, 2));
    top = b.add(top, b.add(vectorBy(b, dMatrix, p), moved));
    weight = b.add(weight, b.add(dot(b, column3(dMatrix), p), b.matrixElement(dMatrix, 3, 3)));
  }
  const V w = b.add(dot(b, column3(matrix), p), b.matrixElement(matrix, 3, 3));
  return b.divide(b.subtract(top, b.multiply(c.y, weight)), w);
}
V inverse(B& b, V matrix) { return b.emit(Op::divide, types::matrix, {b.number(1), matrix}); }
V transposed(B& b, V matrix) { return matrix == zero ? zero : b.call("transpose", types::matrix, {matrix}); }
V transformedNormal(B& b, const Call& c) {
  const V byNormal = c.dx[1] == zero ? zero : b.call("transformn", types::vector, {c.x[0], c.dx[1]});
  if (c.dx[0] == zero) return byNormal;
  const V inverted = inverse(b, c.x[0]);
  const V change = b.negate(b.multiply(b.multiply(inverted, c.dx[0]), inverted));
  return b.add(byNormal, vectorBy(b, transposed(b, change), c.x[1]));
}
V transposedMatrix(B& b, const Call& c) { return transposed(b, c.dx[0]); }
/// A determinant is linear in each of its rows.
V determinant(B& b, const Call& c) {
  if (c.dx[0] == zero) return zero;
  V sum = zero;
  for (int changed = 0; changed < 4; ++changed) {
    std::vector<V> elements;
    for (int i = 0; i < 16; ++i) elements.push_back(b.matrixElement(i / 4 == changed ? c.dx[0] : c.x[0], i / 4, i % 4));
    sum = b.add(sum, b.call("determinant", types::floating, {b.emit(Op::makeMatrix, types::matrix, elements)}));
  }
  return sum;
}

// What is written to arguments

/// sincos(x, sine, cosine): the values written are not at hand here.
V sineAndCosine(B& b, const Call& c, std::size_t output) { return output == 1 ? sine(b, c) : cosine(b, c); }

constexpr std::array rules = {
    FunctionRule{"sin", sine},
    FunctionRule{"cos", cosine},
    FunctionRule{"tan", tangent},
    FunctionRule{"asin", arcSine},
    FunctionRule{"acos", arcCosine},
    FunctionRule{"atan", arcTangent},
    FunctionRule{"atan2", arcTangent2},
    FunctionRule{"sinh", hyperbolicSine},
    FunctionRule{"cosh", hyperbolicCosine},
    FunctionRule{"tanh", hyperbolicTangent},
    FunctionRule{"sincos", nullptr, sineAndCosine},
    FunctionRule{"degrees", degrees},
    FunctionRule{"radians", radians},
    FunctionRule{"pow", power},
    FunctionRule{"exp", exponential},
    FunctionRule{"exp2", exponential2},
    FunctionRule{"expm1", exponentialMinus1},
    FunctionRule{"log", logarithm},
    FunctionRule{"log2", logarithm2},
    FunctionRule{"log10", logarithm10},
    FunctionRule{"logb"},
    FunctionRule{"sqrt", squareRoot},
    FunctionRule{"inversesqrt", inverseSquareRoot},
    FunctionRule{"cbrt", cubeRoot},
    FunctionRule{"hypot", hypotenuse},
    FunctionRule{"erf", errorFunction},
    FunctionRule{"erfc", errorFunctionComplement},
    FunctionRule{"abs", absolute},
    FunctionRule{"sign"},
    FunctionRule{"floor"},
    FunctionRule{"ceil"},
    FunctionRule{"round"},
    FunctionRule{"trunc"},
    FunctionRule{"fmod", floatRemainder},
    FunctionRule{"mod", floorRemainder},
    FunctionRule{"min", minimum},
    FunctionRule{"max", maximum},
    FunctionRule{"clamp", clamped},
    FunctionRule{"mix", mixed},
    FunctionRule{"step"},
    FunctionRule{"smoothstep", smoothRamp},
    FunctionRule{"linearstep", linearRamp},
    FunctionRule{"fma", fusedMultiplyAdd},
    FunctionRule{"isnan"},
    FunctionRule{"isinf"},
    FunctionRule{"isfinite"},
    FunctionRule{"dot", innerProduct},
    FunctionRule{"cross", vectorProduct},
    FunctionRule{"length", length},
    FunctionRule{"distance", distance},
    FunctionRule{"normalize", normalized},
    FunctionRule{"transformp", transformedPoint},
    FunctionRule{"transformv", transformedVector},
    FunctionRule{"transformn", transformedNormal},
    FunctionRule{"determinant", determinant},
    FunctionRule{"transpose", transposedMatrix},
    FunctionRule{"getmatrix"},
    FunctionRule{"perlin", nullptr, nullptr, "gperlin"},
    FunctionRule{"uperlin", nullptr, nullptr, "guperlin"},
    FunctionRule{"pperlin", nullptr, nullptr, "gpperlin", true},
    FunctionRule{"puperlin", nullptr, nullptr, "gpuperlin", true},
    FunctionRule{"simplex", nullptr, nullptr, "gsimplex"},
    FunctionRule{"usimplex", nullptr, nullptr, "gusimplex"},
    FunctionRule{"cell"},
    FunctionRule{"pcell"},
    FunctionRule{"hash"},
    FunctionRule{"phash"},
    // Derivatives of derivatives
    FunctionRule{"dx"},
    FunctionRule{"dy"},
    FunctionRule{"dz"},
    FunctionRule{"filterwidth"},
    FunctionRule{"area"},
    FunctionRule{"calculatenormal"},
};

}  // namespace

SymbolParts takeApart(std::string_view symbol) {
  // The base may contain an underscore; result and arguments do not.
  const std::size_t last = symbol.rfind('_');
  if (last == std::string_view::npos || last < 2) return {symbol, 'x', {}};
  return {symbol.substr(0, last - 2), symbol[last - 1], symbol.substr(last + 1)};
}

static const FunctionRule* findRuleOfBase(std::string_view base) {
  const auto* const found =
      std::find_if(rules.begin(), rules.end(), [&](const FunctionRule& rule) { return rule.base == base; });
  return found == rules.end() ? nullptr : found;
}

const FunctionRule* findFunctionRule(std::string_view symbol) { return findRuleOfBase(takeApart(symbol).base); }

const FunctionRule* findFunctionRule(const FunctionUse& function) {
  return function.host ? findRuleOfBase(function.symbol) : findFunctionRule(function.symbol);
}

}  // namespace aerosol::lang
