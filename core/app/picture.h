// The finished film as a picture with its history.
#pragma once

#include <cstdint>
#include <vector>

#include "core/app/arguments.h"
#include "core/image/image.h"
#include "core/jit/target.h"
#include "core/render/film.h"
#include "core/render/prepared_scene.h"
#include "core/render/renderer.h"
#include "core/scene/description.h"

namespace aerosol::app {

/// The pixels that a scene's film has rendered: its crop.
render::PixelRect cropOf(const scene::Film& film);

/// How many finite samples the pixels of a film have.
struct SampleCounts {
  std::uint64_t total = 0;
  std::uint32_t minimum = 0, maximum = 0;  ///< Of one pixel.
  double mean = 0;
};
SampleCounts countSamples(const render::Film& film);

/// How a film came about.
struct RenderRecord {
  const RenderArguments& arguments;
  const scene::SceneDescription& description;
  const render::PreparedScene& scene;
  const render::RenderReport& report;
  jit::Target target;
  SampleRange range;         ///< Asked for.
  double secondsBefore = 0;  ///< Of the render that was carried on.
};

/// What the file says about itself: program, scene, options, samples asked for and reached, seed, time.
std::vector<image::Metadata> describeRender(const RenderRecord& record, const SampleCounts& counts);

/// Channels R, G, B and, where the scene's film asks for it, A; placed within the whole film.
image::ImageBuffer makePicture(const render::Film& film, const scene::Film& described);

/// What the film has gathered beside the picture.
std::vector<image::ImageLayer> makeLayers(const render::Film& film);

}  // namespace aerosol::app
