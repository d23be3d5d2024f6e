#include "core/render/preparation/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/medium_preparation.h"
#include "core/render/moving_light.h"
#include "core/render/picture_aspect.h"
#include "core/render/preparation/shapes.h"
#include "core/render/surface_closures.h"
#include "core/render/volume_light.h"

namespace aerosol::render {

namespace {

/// Lets shaders find what the meshes that they are on carry.
void giveMeshAttributes(Preparation& state) {
  std::size_t light = state.description.emitters.size();
  for (std::size_t i = 0; i < state.description.shapes.size(); ++i) {
    const auto object = static_cast<accel::ObjectId>(i);
    state.scene->giveAttributes(state.scene->objects[i].material, object);
    if (!state.description.shapes[i].emitter) continue;
    if (const auto& texture = state.lightTextures[light++]) state.scene->giveAttributes(*texture, object);
  }
}

/// What a light's texture is in the mean, by a grid of its coordinates and over its mesh.
Color meanTexture(const Preparation& state, shading::InstanceRef texture) {
  constexpr int side = 8;
  Color sum;
  for (int i = 0; i < side * side; ++i) {
    shading::ShadingPoint point;
    point.set(lang::Global::u, (static_cast<float>(i % side) + 0.5f) / side);
    point.set(lang::Global::v, (static_cast<float>(i) / side + 0.5f) / side);
    if (const accel::TriangleMesh* mesh = state.scene->meshWithAttributes(texture); mesh && !mesh->triangles.empty()) {
      const std::size_t triangle = static_cast<std::size_t>(i) * mesh->triangles.size() / (side * side);
      point.setPlace({static_cast<std::uint32_t>(triangle), 1.0f / 3, 1.0f / 3});
    }
    sum += lightTextureOf(askSurface(*state.scene, texture, point));
  }
  // Where the grid finds nothing light may be all the same.
  return maximum(abs(sum)) > 0 ? sum / (side * side) : Color(1e-3f);
}

/// What the shader of a background says by direction. It stands nowhere: all but I is zero.
SkyPicture skyPicture(Preparation& state, const scene::Emitter& emitter, shading::InstanceRef shader) {
  SkyPicture picture{emitter.resolution, emitter.resolution / 2 + 1, {}};
  std::vector<shading::ShadingPoint> points;
  for (int y = 0; y < picture.height; ++y) {
    const double theta = std::numbers::pi * y / (picture.height - 1), sine = std::sin(theta);
    for (int x = 0; x < picture.width; ++x) {
      const double phi = 2 * std::numbers::pi * (x + 0.5) / picture.width;
      points.emplace_back().set(
          lang::Global::I, Vector<World>(static_cast<float>(std::sin(phi) * sine), static_cast<float>(std::cos(theta)),
                                         static_cast<float>(-std::cos(phi) * sine)));
    }
  }
  const auto& closures = state.scene->siteClosures[shader.family];
  bool isSound = true;
  askSurfaces(*state.scene, shader, points, [&](const SurfaceAnswer& answer) {
    Color sum;
    for (std::uint32_t i = 0; i < answer.siteCount(); ++i) {
      if (closures[i] && closures[i]->kind() == ClosureKind::emission)
        sum += answer.sites[i].weight * closures[i]->emitted(answer.sites[i].parameters, {});
    }
    isSound = isSound && isFinite(sum);
    picture.texels.push_back(isFinite(sum) ? sum : Color());
  });
  if (!isSound)
    state.warnings.warning(emitter.origin.location,
                           "the shader of this background is NaN or infinite in some directions, which stay black",
                           {"a division by 0, or a root or logarithm of a negative number: bound what it is taken of"});
  return picture;
}

/// The light as it stands when the shutter opens, or in the space that moves.
scene::Emitter standing(const Preparation& state, const scene::Emitter& emitter, bool moves) {
  scene::Emitter still = emitter;
  if (emitter.toWorld.keys.empty()) return still;
  still.toWorld = moves ? Transform<World, Object>() : state.atOpening(emitter.toWorld);
  still.position = still.toWorld(Point<Object>(0, 0, 0));
  return still;
}

}  // namespace

void bindLightTextures(Preparation& state) {
  const auto bind = [&](const scene::Emitter& emitter, const scene::Placement<World, Object>& toWorld) {
    state.lightTextures.emplace_back();
    if (!emitter.texture) return;
    auto bound = bindShader(state.description.materials[*emitter.texture], "surface", state.atOpening(toWorld),
                            state.shaderSources(), state.scene->shading, state.warnings);
    if (!bound) return state.appendNew(bound.errors());
    state.lightTextures.back() = *bound;
    if (const auto motion = state.motionOf(toWorld)) state.scene->shading.setMotion(*bound, MovingPlace(motion));
  };
  for (const scene::Emitter& emitter : state.description.emitters) bind(emitter, emitter.toWorld);
  for (const scene::Shape& shape : state.description.shapes) {
    if (shape.emitter) bind(*shape.emitter, shape.toWorld);
  }
}

/// Whether rays that are scattered meet just what weakens light on shadow rays.
bool directionsMeetTheSame(const PreparedScene& scene) {
  const bool weakensLess = std::any_of(scene.objects.begin(), scene.objects.end(), [](const PreparedObject& object) {
    return object.passesShadows || !object.castsShadows;
  });
  return !weakensLess && !scene.hidesSurfaces && scene.shadowVolumes == scene.volumes;
}

void addLights(Preparation& state) {
  giveMeshAttributes(state);
  std::vector<std::unique_ptr<const Light>> lights;
  std::size_t next = 0;
  const auto add = [&](const scene::Emitter& emitter, const scene::Placement<World, Object>& toWorld,
                       std::shared_ptr<const LightSurface> surface) {
    const std::optional<shading::InstanceRef> texture = state.lightTextures[next++];
    const auto motion = state.motionOf(toWorld);
    scene::Emitter shown = standing(state, emitter, motion != nullptr);
    if (!shown.aspect) shown.aspect = pictureAspect(state.description, emitter, *state.scene->services);
    const bool isSky = emitter.type == scene::EmitterType::background;
    if (isSky && !texture) return false;
    const SkyPicture sky = isSky ? skyPicture(state, emitter, *texture) : SkyPicture();
    auto light = makeLight(state.registry, shown, std::move(surface),
                           texture && !isSky ? meanTexture(state, *texture) : Color(1), isSky ? &sky : nullptr);
    if (light) state.scene->lightTextures.push_back(isSky ? std::nullopt : texture);
    if (!light) {
      state.errors.append(light.errors());
      return false;
    }
    state.scene->hasMovingLights = state.scene->hasMovingLights.isCalledFor() || motion;
    lights.push_back(motion ? makeMovingLight(std::move(*light), MovingPlace(motion), state.scene->shutter)
                            : std::move(*light));
    return true;
  };
  for (const scene::Emitter& emitter : state.description.emitters) add(emitter, emitter.toWorld, nullptr);
  for (std::size_t i = 0; i < state.description.shapes.size(); ++i) {
    const scene::Shape& shape = state.description.shapes[i];
    if (!shape.emitter) continue;
    std::shared_ptr<const LightSurface> surface = lightSurface(state, shape, static_cast<accel::ObjectId>(i));
    if (!surface) {
      state.errors.error(shape.origin.location, "a shape without area cannot emit");
      ++next;
      continue;
    }
    if (add(*shape.emitter, shape.toWorld, surface))
      state.scene->objects[i].light = static_cast<std::uint32_t>(lights.size() - 1);
  }
  std::vector<std::uint32_t> glowing;
  for (const volume::Medium& medium : state.scene->media) {
    if (!state.description.integrator.volumeLights) break;
    const shading::InstanceRef shader = state.scene->mediumShaders[medium.index];
    const std::optional<Box<Object>>& domain = state.placements[medium.index].place.domain;
    std::unique_ptr<const Light> glow;
    if (!medium.constant) {
      if (medium.tree) glow = VolumeLight::make(*medium.tree);
    } else if (domain) {
      const auto& instance = state.scene->shading.family(shader).instances[shader.index];
      glow = VolumeLight::make(*domain, instance.objectToWorld, medium.constant->emission);
    }
    if (!glow) continue;
    lights.push_back(std::move(glow));
    glowing.push_back(medium.index);
  }
  if (state.errors.hasErrors()) return;
  state.scene->lights = LightSet(std::move(lights), 0.5f * state.sceneExtent(), !directionsMeetTheSame(*state.scene));
  state.links.makeSets(glowing, 0.5f * state.sceneExtent());
  state.scene->phase = state.registry.phase("henyey_greenstein");
}

}  // namespace aerosol::render
