// Parameters bound to members of the description: one line gives name, type, unit, default, range, doc and setter.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/scene/description.h"
#include "core/scene/parameter.h"

namespace aerosol::scene {

/// The words of an enumeration, in the order of its values.
template <class E>
struct Words;

template <>
struct Words<DistanceSampling> {
  static constexpr std::array words = {"auto",     "marching", "null",          "relaxed",
                                       "analytic", "delta",    "decomposition", "candidates"};
};
template <>
struct Words<TransmittanceSampling> {
  static constexpr std::array words = {"auto", "marching", "ratio", "two_combs", "unbiased", "delta"};
};
template <>
struct Words<Roulette> {
  static constexpr std::array words{"auto", "throughput", "contribution"};
};
template <>
struct Words<OverlapChoice> {
  static constexpr std::array words = {"auto", "split", "partition"};
};
template <>
struct Words<FovAxis> {
  static constexpr std::array words = {"x", "y", "diagonal", "smaller", "larger"};
};
template <>
struct Words<PixelFormat> {
  static constexpr std::array words = {"rgb", "rgba", "luminance", "luminance_alpha", "xyz", "xyza"};
};
template <>
struct Words<ComponentFormat> {
  static constexpr std::array words = {"float16", "float32"};
};

/// A parameter of `T`. `set` takes a value of the spec's type that `checkValue` allows; what it returns, when not
/// empty, says why the value will not do.
template <class T>
struct Field {
  ParameterSpec spec;
  std::function<std::string(T&, const Value&)> set;
  /// Takes transforms by time in place of a single one; null where that means nothing.
  std::function<void(T&, const std::vector<MotionKey>&)> animate = {};
};

/// A parameter that other renderers know and that changes nothing here: a warning says so.
template <class T>
Field<T> fieldWithoutEffect(const char* name, ValueType type) {
  return {{.name = name, .type = type, .doc = "has no effect", .withoutEffect = true},
          [](T&, const Value&) { return std::string(); }};
}

/// The objects of one XML type.
template <class T>
struct TypeTable {
  std::string type;
  std::string doc;
  std::vector<std::string> aliases = {};  ///< Other names that mean the same.
  std::vector<Field<T>> fields = {};
  std::string nested = {};      ///< What may stand inside, for the documentation.
  std::string substitute = {};  ///< Not empty: this type is only imitated; says by what.
};

/// An affine, invertible matrix as a transform; none otherwise.
template <class To, class From>
std::optional<Transform<To, From>> toTransform(const Matrix4& matrix) {
  const auto& last = matrix[3];
  Matrix4 inverse;
  if (last[0] != 0 || last[1] != 0 || last[2] != 0 || last[3] != 1 || !invert(matrix, inverse)) return std::nullopt;
  for (const auto& row : inverse) {
    for (const double v : row) {
      if (!std::isfinite(v)) return std::nullopt;
    }
  }
  return Transform<To, From>(matrix, inverse);
}

namespace detail {

template <class M>
struct Member;  ///< How a value gets into a member of type M, and out of it for the default.

template <class M, ValueType Type>
struct PlainMember {
  static constexpr ValueType type = Type;
  static std::string set(M& member, const Value& value) {
    member = std::get<M>(value);
    return {};
  }
  static std::optional<Value> get(const M& member) { return Value(member); }
  static std::vector<std::string> choices() { return {}; }
};

template <>
struct Member<bool> : PlainMember<bool, ValueType::boolean> {};
template <>
struct Member<int> : PlainMember<int, ValueType::integer> {};
template <>
struct Member<float> : PlainMember<float, ValueType::number> {};
template <>
struct Member<std::string> : PlainMember<std::string, ValueType::string> {};
template <>
struct Member<Color> : PlainMember<Color, ValueType::color> {};

template <class Space>
struct Member<Point<Space>> {
  static constexpr ValueType type = ValueType::point;
  static std::string set(Point<Space>& member, const Value& value) {
    const auto& p = std::get<Point<Unplaced>>(value);
    member = {p.x, p.y, p.z};
    return {};
  }
  static std::optional<Value> get(const Point<Space>& p) { return Value(Point<Unplaced>(p.x, p.y, p.z)); }
  static std::vector<std::string> choices() { return {}; }
};

template <class To, class From>
struct Member<Transform<To, From>> {
  static constexpr ValueType type = ValueType::transform;
  static std::string set(Transform<To, From>& member, const Value& value) {
    const auto transform = toTransform<To, From>(std::get<Matrix4>(value));
    if (!transform) return "this transform is not affine and invertible";
    member = *transform;
    return {};
  }
  static std::optional<Value> get(const Transform<To, From>&) { return std::nullopt; }
  static std::vector<std::string> choices() { return {}; }
};

template <class To, class From>
struct Member<Placement<To, From>> : Member<Transform<To, From>> {
  static std::string set(Placement<To, From>& member, const Value& value) {
    member.keys.clear();
    return Member<Transform<To, From>>::set(member, value);
  }
  static std::optional<Value> get(const Placement<To, From>&) { return std::nullopt; }
  static void animate(Placement<To, From>& member, const std::vector<MotionKey>& keys) { member.keys = keys; }
};

template <class E>
  requires std::is_enum_v<E>
struct Member<E> {
  static constexpr ValueType type = ValueType::string;
  static std::string set(E& member, const Value& value) {
    const auto& text = std::get<std::string>(value);
    for (std::size_t i = 0; i < Words<E>::words.size(); ++i) {
      if (text == Words<E>::words[i]) member = static_cast<E>(i);
    }
    return {};
  }
  static std::optional<Value> get(E member) {
    return Value(std::string(Words<E>::words[static_cast<std::size_t>(member)]));
  }
  static std::vector<std::string> choices() { return {Words<E>::words.begin(), Words<E>::words.end()}; }
};

template <class M>
struct Member<std::optional<M>> {
  static constexpr ValueType type = Member<M>::type;
  static std::string set(std::optional<M>& member, const Value& value) {
    return Member<M>::set(member.emplace(), value);
  }
  static std::optional<Value> get(const std::optional<M>& member) {
    return member ? Member<M>::get(*member) : std::nullopt;
  }
  static std::vector<std::string> choices() { return Member<M>::choices(); }
};

template <class T>
struct MemberPointer;
template <class T, class M>
struct MemberPointer<M T::*> {
  using Object = T;
  using Type = M;
};

}  // namespace detail

/// A field for the member `pointer`; type, default and choices come from the member itself.
template <auto pointer>
auto field(ParameterSpec spec) {
  using Object = typename detail::MemberPointer<decltype(pointer)>::Object;
  using Access = detail::Member<typename detail::MemberPointer<decltype(pointer)>::Type>;
  spec.type = Access::type;
  spec.choices = Access::choices();
  if (!spec.required && spec.defaultText.empty()) spec.defaultValue = Access::get(Object{}.*pointer);
  Field<Object> result{std::move(spec),
                       [](Object& object, const Value& value) { return Access::set(object.*pointer, value); }};
  if constexpr (requires(Object& object, const std::vector<MotionKey>& keys) {
                  Access::animate(object.*pointer, keys);
                }) {
    result.animate = [](Object& object, const std::vector<MotionKey>& keys) { Access::animate(object.*pointer, keys); };
  }
  return result;
}

/// The field with this name, or null.
template <class T>
const Field<T>* findField(const std::vector<Field<T>>& fields, const std::string& name) {
  for (const Field<T>& f : fields) {
    if (f.spec.name == name) return &f;
  }
  return nullptr;
}

/// The table of this type or alias, or null.
template <class T>
const TypeTable<T>* findType(const std::vector<TypeTable<T>>& tables, const std::string& type) {
  for (const TypeTable<T>& table : tables) {
    if (table.type == type) return &table;
    for (const std::string& alias : table.aliases) {
      if (alias == type) return &table;
    }
  }
  return nullptr;
}

}  // namespace aerosol::scene
