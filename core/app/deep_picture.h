// The finished film as a deep image.
#pragma once

#include "core/app/arguments.h"
#include "core/image/deep_image.h"
#include "core/render/film.h"
#include "core/scene/description.h"

namespace aerosol::app {

/// Channels R, G, B, A, Z, ZBack, and AR, AG, AB where opacity has a colour somewhere (then A is their mean). The film
/// gathers what a deep image takes.
image::DeepImage makeDeepPicture(const render::Film& film, const scene::Film& described, double error);

/// Writes it where a file is asked for; says how large it is unless quiet.
Diagnostics writeDeepPicture(const DeepArguments& deep, const render::Film& film, const scene::Film& described,
                             std::vector<image::Metadata> metadata, std::string& note);

}  // namespace aerosol::app
