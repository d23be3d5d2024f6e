// What files of one image have in common: what decides its samples, and what the whole of it is.
#pragma once

#include <string>
#include <vector>

#include "core/app/arguments.h"
#include "core/image/image.h"
#include "core/render/prepared_scene.h"
#include "core/scene/description.h"

namespace aerosol::app {

struct Job {
  std::string identity;   ///< A hash of the scene's texts, meshes and shaders and of the options that decide samples.
  std::string embreeIsa;  ///< Instruction set of ray queries: a change of it may change bits of the image.
  std::string code;       ///< The program's version.
  std::string aovs;       ///< What is shown beside the picture; empty: nothing.
  int sampleCount = 0;    ///< Of the whole image, each pixel.
  scene::Film film;       ///< As the scene describes it; its crop is all of the image.
};

/// `description` as the arguments have changed it, but for the crop.
Job describeJob(const RenderArguments& arguments, const scene::SceneDescription& description,
                const render::PreparedScene& scene);

/// The job as a file's metadata.
std::vector<image::Metadata> jobMetadata(const Job& job);

/// None when the picture says nothing of its job.
std::optional<Job> jobOf(const image::ImageBuffer& picture);

}  // namespace aerosol::app
