#include "core/lang/fold.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

namespace aerosol::lang {

namespace {

using Ints = std::vector<std::int32_t>;
using Floats = std::vector<float>;
using Strings = std::vector<std::string>;

std::int32_t wrap(std::uint32_t bits) { return std::bit_cast<std::int32_t>(bits); }
std::uint32_t bits(std::int32_t value) { return std::bit_cast<std::uint32_t>(value); }

std::int32_t saturate(float value) {
  if (std::isnan(value)) return 0;
  if (value >= 2147483648.0f) return std::numeric_limits<std::int32_t>::max();
  if (value <= -2147483648.0f) return std::numeric_limits<std::int32_t>::min();
  return static_cast<std::int32_t>(value);
}

std::optional<std::int32_t> intArithmetic(Op op, std::int32_t a, std::int32_t b) {
  const std::uint32_t ua = bits(a), ub = bits(b);
  switch (op) {
    case Op::add:
      return wrap(ua + ub);
    case Op::subtract:
      return wrap(ua - ub);
    case Op::multiply:
      return wrap(ua * ub);
    case Op::divide:
      return b == 0 ? 0 : b == -1 ? wrap(0u - ua) : a / b;
    case Op::modulo:
      return b == 0 || b == -1 ? 0 : a % b;
    case Op::bitAnd:
      return wrap(ua & ub);
    case Op::bitOr:
      return wrap(ua | ub);
    case Op::bitXor:
      return wrap(ua ^ ub);
    case Op::shiftLeft:
      return wrap(ua << (ub & 31u));
    case Op::shiftRight:
      return a >> (ub & 31u);
    case Op::less:
      return a < b;
    case Op::lessEqual:
      return a <= b;
    case Op::greater:
      return a > b;
    case Op::greaterEqual:
      return a >= b;
    case Op::logicalAnd:
      return a != 0 && b != 0;
    case Op::logicalOr:
      return a != 0 || b != 0;
    default:
      return std::nullopt;
  }
}

std::optional<float> floatArithmetic(Op op, float a, float b) {
  switch (op) {
    case Op::add:
      return a + b;
    case Op::subtract:
      return a - b;
    case Op::multiply:
      return a * b;
    case Op::divide:
      return b == 0 ? 0.0f : a / b;
    default:
      return std::nullopt;
  }
}

std::optional<bool> floatComparison(Op op, float a, float b) {
  switch (op) {
    case Op::less:
      return a < b;
    case Op::lessEqual:
      return a <= b;
    case Op::greater:
      return a > b;
    case Op::greaterEqual:
      return a >= b;
    default:
      return std::nullopt;
  }
}

bool equalValues(const ConstantValue& a, const ConstantValue& b) {
  if (const auto* fa = std::get_if<Floats>(&a)) {
    const auto* fb = std::get_if<Floats>(&b);
    if (!fb) return false;
    // A float beside a triple stands for all three components.
    const std::size_t count = std::max(fa->size(), fb->size());
    for (std::size_t i = 0; i < count; ++i)
      if (!((fa->size() == 1 ? (*fa)[0] : (*fa)[i]) == (fb->size() == 1 ? (*fb)[0] : (*fb)[i]))) return false;
    return true;
  }
  return a == b;
}

bool isTrue(const Constant& constant) {
  if (const auto* ints = std::get_if<Ints>(&constant.value)) {
    for (const std::int32_t i : *ints)
      if (i != 0) return true;
  } else if (const auto* floats = std::get_if<Floats>(&constant.value)) {
    for (const float f : *floats)
      if (f != 0) return true;
  } else if (const auto* strings = std::get_if<Strings>(&constant.value)) {
    for (const std::string& s : *strings)
      if (!s.empty()) return true;
  }
  return false;
}

std::optional<Constant> binary(Op op, const Type& result, const Constant& a, const Constant& b) {
  if (op == Op::equal || op == Op::notEqual)
    return Constant::ofInt(equalValues(a.value, b.value) == (op == Op::equal) ? 1 : 0);
  const auto* ia = std::get_if<Ints>(&a.value);
  const auto* ib = std::get_if<Ints>(&b.value);
  if (ia && ib && ia->size() == 1 && ib->size() == 1) {
    if (const auto value = intArithmetic(op, ia->front(), ib->front())) return Constant::ofInt(*value);
    return std::nullopt;
  }
  const auto* fa = std::get_if<Floats>(&a.value);
  const auto* fb = std::get_if<Floats>(&b.value);
  if (!fa || !fb || a.type.base == BaseType::matrix || b.type.base == BaseType::matrix) return std::nullopt;
  if (a.type.isArray() || b.type.isArray()) return std::nullopt;
  if (fa->size() == 1 && fb->size() == 1)
    if (const auto truth = floatComparison(op, fa->front(), fb->front())) return Constant::ofInt(*truth ? 1 : 0);
  Floats values(std::max(fa->size(), fb->size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value =
        floatArithmetic(op, fa->size() == 1 ? (*fa)[0] : (*fa)[i], fb->size() == 1 ? (*fb)[0] : (*fb)[i]);
    if (!value) return std::nullopt;
    values[i] = *value;
  }
  return Constant{result, std::move(values)};
}

std::optional<Constant> unary(Op op, const Type& result, const Constant& a) {
  const auto* ints = std::get_if<Ints>(&a.value);
  const auto* floats = std::get_if<Floats>(&a.value);
  switch (op) {
    case Op::assign:
      return Constant{result, a.value};
    case Op::toFloat:
      return Constant::ofFloat(static_cast<float>(ints->front()));
    case Op::toInt:
      return Constant::ofInt(saturate(floats->front()));
    case Op::toTriple:
      return Constant{result, Floats(3, floats->front())};
    case Op::toMatrix: {
      Floats m(16, 0.0f);
      for (std::size_t i = 0; i < 4; ++i) m[i * 5] = floats->front();
      return Constant{result, std::move(m)};
    }
    case Op::toBool:
      return Constant::ofInt(isTrue(a) ? 1 : 0);
    case Op::logicalNot:
      return Constant::ofInt(isTrue(a) ? 0 : 1);
    case Op::bitNot:
      return Constant::ofInt(~ints->front());
    case Op::negate:
      if (ints) return Constant::ofInt(wrap(0u - bits(ints->front())));
      if (floats) {
        Floats values = *floats;
        for (float& f : values) f = -f;
        return Constant{result, std::move(values)};
      }
      return std::nullopt;
    default:
      return std::nullopt;
  }
}

/// Element `index` of `stride` leaves, when it lies inside.
std::optional<Constant> take(const Constant& from, std::int64_t index, std::size_t stride, const Type& result) {
  return std::visit(
      [&](const auto& leaves) -> std::optional<Constant> {
        if constexpr (std::is_same_v<std::decay_t<decltype(leaves)>, std::monostate>) {
          return std::nullopt;
        } else {
          if (index < 0 || (static_cast<std::size_t>(index) + 1) * stride > leaves.size()) return std::nullopt;
          const auto begin = leaves.begin() + index * static_cast<std::int64_t>(stride);
          return Constant{result, std::decay_t<decltype(leaves)>(begin, begin + static_cast<std::int64_t>(stride))};
        }
      },
      from.value);
}

std::optional<Constant> replace(Constant target, std::int64_t index, std::size_t stride, const Constant& by) {
  const bool done = std::visit(
      [&](auto& leaves) {
        using Leaves = std::decay_t<decltype(leaves)>;
        if constexpr (std::is_same_v<Leaves, std::monostate>) {
          return false;
        } else {
          const auto* source = std::get_if<Leaves>(&by.value);
          if (!source || source->size() != stride) return false;
          if (index < 0 || (static_cast<std::size_t>(index) + 1) * stride > leaves.size()) return false;
          std::copy(source->begin(), source->end(), leaves.begin() + index * static_cast<std::int64_t>(stride));
          return true;
        }
      },
      target.value);
  if (!done) return std::nullopt;
  return target;
}

std::optional<Constant> access(Op op, const Type& result, std::span<const Constant* const> a,
                               const Constant* previous) {
  const auto index = [&](std::size_t i) -> std::int64_t { return a[i]->asInt(); };
  const auto matrixIndex = [&](std::size_t i) -> std::int64_t {
    const std::int64_t row = index(i), column = index(i + 1);
    return row < 0 || row > 3 || column < 0 || column > 3 ? -1 : row * 4 + column;
  };
  switch (op) {
    case Op::component:
      return take(*a[0], index(1), 1, result);
    case Op::matrixElement:
      return take(*a[0], matrixIndex(1), 1, result);
    case Op::element:
      return take(*a[0], index(1), leafCount(result), result);
    case Op::setComponent:
      return previous ? replace(*previous, index(0), 1, *a[1]) : std::nullopt;
    case Op::setMatrixElement:
      return previous ? replace(*previous, matrixIndex(0), 1, *a[2]) : std::nullopt;
    case Op::setElement:
      return previous ? replace(*previous, index(0), leafCount(a[1]->type), *a[1]) : std::nullopt;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::size_t leafCount(const Type& type) {
  if (type.closure || type.base == BaseType::none || type.base == BaseType::structure) return 0;
  const std::size_t each = type.isTriple() ? 3 : type.base == BaseType::matrix ? 16 : 1;
  // isTriple looks at the element's kind alone.
  return type.isArray() ? each * static_cast<std::size_t>(std::max(type.arrayLength, 0)) : each;
}

void setElement(Constant& array, std::size_t index, const Constant& element) {
  std::visit(
      [&](auto& leaves) {
        using Leaves = std::decay_t<decltype(leaves)>;
        if constexpr (!std::is_same_v<Leaves, std::monostate>) {
          const auto& part = std::get<Leaves>(element.value);
          std::copy(part.begin(), part.end(), leaves.begin() + static_cast<std::ptrdiff_t>(index * part.size()));
        }
      },
      array.value);
}

Constant zeroConstant(const Type& type) {
  if (type.closure) return {type, std::monostate{}};
  const std::size_t count = leafCount(type);
  if (type.base == BaseType::integer) return {type, Ints(count, 0)};
  if (type.base == BaseType::string) return {type, Strings(count)};
  return {type, Floats(count, 0.0f)};
}

bool sameBits(const Constant& a, const Constant& b) {
  if (!(a.type == b.type) || a.value.index() != b.value.index()) return false;
  const auto* fa = std::get_if<Floats>(&a.value);
  if (!fa) return a.value == b.value;
  const auto& fb = std::get<Floats>(b.value);
  if (fa->size() != fb.size()) return false;
  for (std::size_t i = 0; i < fb.size(); ++i)
    if (std::bit_cast<std::uint32_t>((*fa)[i]) != std::bit_cast<std::uint32_t>(fb[i])) return false;
  return true;
}

std::string bitsKey(const Constant& constant) {
  std::string key = toString(constant.type) + ":";
  std::visit(
      [&](const auto& leaves) {
        using Leaves = std::decay_t<decltype(leaves)>;
        if constexpr (std::is_same_v<Leaves, std::vector<std::string>>) {
          for (const std::string& text : leaves) key += std::to_string(text.size()) + ":" + text;
        } else if constexpr (!std::is_same_v<Leaves, std::monostate>) {
          key.append(reinterpret_cast<const char*>(leaves.data()), leaves.size() * sizeof(leaves[0]));
        }
      },
      constant.value);
  return key;
}

std::optional<Constant> foldOperation(Op op, const Type& result, std::span<const Constant* const> a,
                                      const Constant* previous) {
  switch (op) {
    case Op::makeTriple:
    case Op::makeMatrix: {
      Floats values;
      for (const Constant* c : a) values.push_back(c->asFloat());
      return Constant{result, std::move(values)};
    }
    case Op::select:
      return isTrue(*a[0]) ? *a[1] : *a[2];
    case Op::component:
    case Op::matrixElement:
    case Op::element:
    case Op::setComponent:
    case Op::setMatrixElement:
    case Op::setElement:
      return access(op, result, a, previous);
    default:
      break;
  }
  if (result.closure) return std::nullopt;
  if (a.size() == 1) return unary(op, result, *a[0]);
  if (a.size() == 2) return binary(op, result, *a[0], *a[1]);
  return std::nullopt;
}

std::optional<Constant> convertConstant(const Constant& value, const Type& type) {
  if (value.type == type) return value;
  if (value.type.isArray() || type.isArray()) return std::nullopt;
  if (type.isTriple() && value.type.isTriple()) return Constant{type, value.value};
  if (!value.type.isNumber()) return std::nullopt;
  const Constant number =
      value.type.base == BaseType::integer ? Constant::ofFloat(static_cast<float>(value.asInt())) : value;
  const Constant* const argument = &number;
  if (type.base == BaseType::floating) return number;
  if (type.base == BaseType::integer) return foldOperation(Op::toInt, type, {&argument, 1});
  if (type.isTriple()) return foldOperation(Op::toTriple, type, {&argument, 1});
  if (type.base == BaseType::matrix) return foldOperation(Op::toMatrix, type, {&argument, 1});
  return std::nullopt;
}

}  // namespace aerosol::lang
