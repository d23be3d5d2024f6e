// Takes the written parameters of one object against the tables of what it knows.
#pragma once

#include <string>
#include <vector>

#include "core/scene/element.h"
#include "core/scene/field.h"
#include "core/scene/reporter.h"

namespace aerosol::scene {

/// Each table takes its own; `finish` reports what none of them knows. The origin gets the place of each value.
class PropertyReader {
 public:
  PropertyReader(const Element& element, Origin& origin, Reporter& reporter);

  template <class T>
  void apply(const std::vector<Field<T>>& fields, T& object) {
    for (const Field<T>& field : fields) {
      const Taken taken = take(field.spec);
      if (!taken.value) continue;
      if (const std::string problem = field.set(object, *taken.value); !problem.empty()) {
        reporter_.error(taken.property->valueLocation, problem);
      } else if (!taken.property->keys.empty() && (field.animate || refuseMotion(*taken.property))) {
        field.animate(object, taken.property->keys);
      }
    }
  }
  /// Written values, and defaults for the others where there are any.
  void apply(const std::vector<ParameterSpec>& specs, std::vector<NamedValue>& values);

  /// Takes what is written for shaders: names that begin with "user:".
  void applyAttributes(std::vector<NamedValue>& attributes);

  /// What no table took so far.
  std::vector<const Property*> rest() const;
  /// Reports all that no table took.
  void finish();

 private:
  struct Taken {
    const Property* property = nullptr;
    std::optional<Value> value;
  };

  /// The converted and checked value of a parameter; reports when it is wrong or missing though required.
  Taken take(const ParameterSpec& spec);
  /// Reports an animation where only one transform is possible. False.
  bool refuseMotion(const Property& property) const;

  const Element& element_;
  Origin& origin_;
  Reporter& reporter_;
  std::vector<const Property*> open_;
  std::vector<std::string> known_;
};

/// "sphere shape", as messages call an object.
std::string describe(const Element& element);

/// "parameter 'fov' is a float, not a string".
std::string wrongType(const ParameterSpec& spec, std::string_view given);

/// "unknown shape type 'spere'", with the known ones; nothing when no type is written, which has been reported.
void reportUnknownType(const Element& element, const std::vector<std::string>& types, Reporter& reporter);

/// Reads the parameters of an object by the table of its type. Null when the type is unknown, which is reported.
template <class T>
const TypeTable<T>* readTyped(const Element& element, const std::vector<TypeTable<T>>& tables, T& object,
                              Reporter& reporter) {
  const TypeTable<T>* table = findType(tables, element.type);
  if (!table) {
    std::vector<std::string> types;
    for (const TypeTable<T>& t : tables) {
      types.push_back(t.type);
      types.insert(types.end(), t.aliases.begin(), t.aliases.end());
    }
    reportUnknownType(element, types, reporter);
    return nullptr;
  }
  PropertyReader reader(element, object.origin, reporter);
  reader.apply(table->fields, object);
  if constexpr (requires { object.attributes; }) reader.applyAttributes(object.attributes);
  reader.finish();
  return table;
}

}  // namespace aerosol::scene
