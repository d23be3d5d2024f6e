// Where a tree of bounds says that there is something of a medium.
#pragma once

#include "core/volume/bounds/bound_tree.h"

namespace aerosol::volume {

/// The box around all parts of the tree's domain that are not proven to be empty; an empty box when there are none.
/// World space, rounded outwards.
Box<World> occupiedBounds(const BoundTree& tree);

/// Whether there is surely nothing of the medium in a part of the tree's domain: within the box, and wherever else the
/// box around it in object space reaches.
bool isEmptyIn(const BoundTree& tree, const Box<World>& box);

}  // namespace aerosol::volume
