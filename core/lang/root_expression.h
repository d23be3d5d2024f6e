// What an expression picks from.
#pragma once

#include "core/lang/ast.h"

namespace aerosol::lang {

/// The expression without its indices and fields: `a` of `a[1].b[2]`. What remains of one that can be assigned to is a
/// name.
inline const Expression& rootOf(const Expression& expression) {
  const Expression* root = &expression;
  for (;;) {
    if (const auto* index = std::get_if<Index>(&root->node)) {
      root = index->base.get();
    } else if (const auto* field = std::get_if<Field>(&root->node)) {
      root = field->base.get();
    } else {
      return *root;
    }
  }
}

}  // namespace aerosol::lang
