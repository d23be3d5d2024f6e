// Mitsuba's file of a dense grid (.vol). Internal to the module.
#pragma once

#include <openvdb/openvdb.h>

#include <istream>

namespace aerosol::grid {

/// Whether the stream, which stays where it is, begins as such a file.
bool isDenseFile(std::istream& stream);

/// The grid without a name. Throws std::exception with a reason.
///
/// "VOL", a byte of version (3), then little-endian: an int of encoding (1: float32), ints of the size along x, y, z
/// and of channels, six floats of the box (least and greatest corner), and the values, channels fastest, then x, y, z.
/// A voxel is a cell of the box. One layer of inactive copies around makes interpolation near the faces read the
/// outermost voxels, as Mitsuba clamps.
openvdb::GridBase::Ptr readDenseFile(std::istream& stream);

}  // namespace aerosol::grid
