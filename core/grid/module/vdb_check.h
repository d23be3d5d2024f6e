// Whether the bytes of an OpenVDB file are what OpenVDB takes them for. Internal to the module.
#pragma once

#include <istream>

namespace aerosol::grid {

/// OpenVDB believes what a file says of itself: a size that is wrong makes it write beyond its buffers or ask for more
/// memory than there is. So the file is walked before it sees it: every string, every piece of metadata, the map, the
/// masks of all nodes and the size of every block of values have to fit to each other and into the file. Values
/// themselves are not looked at; decompressing them is safe once their sizes are right.
///
/// Throws std::exception with what is wrong; otherwise the stream stands where it was, its beginning. What cannot be
/// checked is handed on as it is: files older than format version 222 (2013), whatever follows a grid of another type
/// than numbers, vectors and truth values, and what the libraries of compression do with damaged content of the right
/// size.
void checkVdb(std::istream& stream);

}  // namespace aerosol::grid
