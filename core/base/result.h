// A value or the diagnostics that say why there is none.
#pragma once

#include <cassert>
#include <optional>
#include <utility>

#include "core/base/diagnostic.h"

namespace aerosol {

/// Either a `T` or at least one error. What a user caused is a `Result`; a broken invariant asserts.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Diagnostics errors) : errors_(std::move(errors)) { assert(errors_.hasErrors()); }
  Result(Diagnostic error) { errors_.add(std::move(error)); }

  explicit operator bool() const { return value_.has_value(); }
  T& operator*() { return *value_; }
  const T& operator*() const { return *value_; }
  T* operator->() { return &*value_; }
  const T* operator->() const { return &*value_; }

  /// Empty when there is a value.
  const Diagnostics& errors() const { return errors_; }

 private:
  std::optional<T> value_;
  Diagnostics errors_;
};

}  // namespace aerosol
