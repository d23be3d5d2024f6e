// Derivatives by forward differentiation of programs, before any number domain sees them.
//
// A program asks for derivatives by calls of the functions `dx`, `dy`, `dz` (of any float, triple or matrix),
// `filterwidth`, `area` and `calculatenormal`; a lookup that filters over its footprint asks by such calls too.
// Expanding them gives every variable whose derivative is wanted, and is not zero, a variable beside it for each of the
// axes wanted, and every instruction that writes it the instructions of the rule of differentiation. Derivatives start
// from the globals (dPdx …: `Global`); parameters are constant over a surface. A derivative of a derivative is zero.
#pragma once

#include <string_view>

#include "core/lang/program.h"

namespace aerosol::lang {

/// Whether anything in the program asks for a derivative.
bool readsDerivatives(const Program& program);

/// The same program with those calls replaced by what computes them. All other values keep every bit. What was only
/// there for the calls is left for `slice` to drop. A pure function without a rule (of a plugin) is differentiated by
/// the difference of its values over the derivatives of its arguments; impure ones have derivative zero.
Program expandDerivatives(Program program);

/// Voxels are looked up at points, whatever a footprint covers: where a call of texture3d names a file of voxels, its
/// derivatives become constants. True when there were some that were none; what computed them is left for `slice`.
bool dropVoxelFootprints(Program& program);

/// Whether the derivatives of the library function are known: every function of the language has to.
bool hasDerivativeRule(std::string_view symbol);

}  // namespace aerosol::lang
