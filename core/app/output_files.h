// The image files of a render: checked before it, written after it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/image/image.h"
#include "core/scene/description.h"

namespace aerosol::app {

/// The files asked for, or else the scene's name with .png in the current folder.
std::vector<std::string> outputNames(const std::vector<std::string>& asked, const std::filesystem::path& scene);

/// What no render could mend: names whose extension is no image format, and names that stand there twice.
Diagnostics checkOutputNames(const std::vector<std::string>& names);

/// Whether the files could be written here and now.
Diagnostics checkOutputPlaces(const std::vector<std::string>& names);

/// Writes and removes one pixel in each format beside the file to come: finds what is wrong with the image libraries or
/// the display's configuration before hours of rendering do.
Diagnostics tryOutputs(const std::vector<std::string>& names, const scene::Film& film,
                       const image::DisplayOptions& display = {});

/// Writes the picture to every file; a file that fails does not keep the others from being written.
Diagnostics writeOutputs(const std::vector<std::string>& names, const image::ImageBuffer& picture,
                         const scene::Film& film, const image::DisplayOptions& display = {});

/// A text file, complete or not at all.
Diagnostics writeTextFile(const std::string& name, const std::string& text);

}  // namespace aerosol::app
