// A scene as plain data with the places it was written at: all that the renderer reads.
//
// Positions without another word are in world space and scene units; colours are linear Rec.709.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/color.h"
#include "core/base/diagnostic.h"
#include "core/base/geometry.h"
#include "core/scene/placement.h"
#include "core/scene/source_text.h"
#include "core/scene/value.h"

namespace aerosol::scene {

/// Where an object and its parameters are written. An object that the scene leaves to its default has the place of
/// the object that lacks it.
struct Origin {
  std::string id;                                    ///< Empty when the scene gives none.
  SourceLocation location;                           ///< Of the element.
  std::map<std::string, SourceLocation> parameters;  ///< Of the values written.

  bool has(const std::string& parameter) const { return parameters.contains(parameter); }
  /// The place of a parameter's value, or of the object when it is not written.
  const SourceLocation& of(const std::string& parameter) const;
};

/// One written parameter of a shader. Its type is that of its element; `convertTo` gives what the shader asks for.
struct ShaderParameter {
  std::string name;
  Value value;
  SourceLocation location;       ///< Of the name, for "has no parameter …".
  SourceLocation valueLocation;  ///< Of the value, for "is not …".
  bool untyped = false;          ///< Came without a type, from `--set`.

  /// The value as a `type` where that loses nothing; none when it does not fit (see `convert` in value.h).
  std::optional<Value> convertTo(ValueType type) const { return convert(value, type, untyped); }
};

/// Index into `SceneDescription::materials`, `media`, `displacements` or `layers`.
using Index = std::size_t;

/// A layer connected to a parameter: a nested `<texture>`, or a `<ref>` to one.
struct ShaderInput {
  std::string parameter;  ///< Or a part of one, `c.r`; empty: the first closure parameter that is not connected yet.
  std::string output;     ///< Of the layer; empty: the first that fits.
  Index layer = 0;        ///< Into `SceneDescription::layers`.
  SourceLocation location;
  SourceLocation outputLocation;
};

/// What a shader does, given by the scene instead of a name on the search path.
struct ShaderCode {
  bool isGroup = false;  ///< The text of a shader group; otherwise a source.
  std::string text;
  std::filesystem::path file;  ///< Of a source: instead of the text, when not empty.
  SourceLocation location;     ///< Of the text's first byte.
};

/// A shader by name with its parameters, which its own interface decides about later. Parameters of layers of a group
/// are called `layer.parameter`.
struct ShaderUse {
  std::string name;
  std::vector<ShaderParameter> parameters;
  std::vector<ShaderInput> inputs;
  std::optional<ShaderCode> code;
  bool isMaterial = false;  ///< A `<bsdf>`: as a layer it feeds a closure.
  Origin origin;
  SourceLocation nameLocation;

  /// Null when not written.
  const ShaderParameter* find(const std::string& parameter) const;
};

/// How distances in a medium are sampled.
enum class DistanceSampling : std::uint8_t {
  automatic,       ///< The renderer chooses, by what it knows of the density's bound.
  marching,        ///< Ray marching.
  nullScattering,  ///< Delta tracking against a bound.
  relaxed,         ///< The same against max(bound, 1 / step size): more steps, less noise in thin media.
  analytic,        ///< Closed forms; an error where there is none.
  delta,           ///< Analogue delta tracking under one bound for the whole medium: the yardstick.
  decomposition,   ///< Null scattering with the least extinction of a leaf as control.
  candidates       ///< Null scattering all the way, one of the tentative collisions chosen in the end.
};

/// How the transmittance of a medium to a light is estimated.
enum class TransmittanceSampling : std::uint8_t {
  automatic,  ///< As distances are sampled.
  marching,   ///< Ray marching.
  ratio,      ///< Residual ratio tracking against a bound.
  twoCombs,   ///< Two jittered marches of twice the step.
  unbiased,   ///< Unbiased ray marching.
  delta       ///< Delta tracking: all of the light or none.
};

/// What a medium or volume says about its sampling; what it does not say is decided later.
struct MediumSampling {
  std::optional<DistanceSampling> distance;
  std::optional<TransmittanceSampling> transmittance;
  std::optional<float> stepSize;      ///< Ray marching step, scene units, > 0.
  std::optional<float> densityBound;  ///< Declared upper bound of the extinction, per scene unit, > 0.

  /// This, completed by what only `other` says.
  MediumSampling orElse(const MediumSampling& other) const;
};

enum class PhaseType : std::uint8_t { hg, isotropic, rayleigh, draine, mie, tabphase, blendphase };

/// A phase function.
struct Phase {
  PhaseType type = PhaseType::isotropic;
  float g = 0;                    ///< Of hg: mean cosine; of draine: of its lobe.
  float alpha = 1;                ///< Of draine.
  float particleDiameter_um = 8;  ///< Of mie: water droplets.
  float weight = 0.5f;            ///< Of blendphase: share of the second part, in [0, 1].
  std::vector<float> values;      ///< Of tabphase: over the cosine from -1 to 1, two at least, not all zero.
  bool isWeightFed = false;       ///< Of blendphase: the medium's shader gives the weight, in the place of g.
  std::vector<Phase> parts;       ///< Of blendphase: two.
  Origin origin;
};

/// A medium: a volume shader and its sampling.
struct Medium {
  ShaderUse shader;
  std::optional<Phase> phase;  ///< Takes the place of what the shader says of directions.
  MediumSampling sampling;
};

/// How volume primitives along a ray are found (accel::OverlapDesign).
enum class OverlapChoice : std::uint8_t { automatic, split, partition };

/// By what Russian roulette decides.
enum class Roulette : std::uint8_t { automatic, throughput, contribution };

/// A quantity to be shown beside the picture.
struct AovRequest {
  std::string name;             ///< Of the layer.
  std::string quantity;         ///< What the renderer knows it by, or a light path expression.
  SourceLocation location;      ///< Nothing: the command line.
  bool isSecondMoment = false;  ///< The mean of its square.
};

struct Integrator {
  std::string type = "path";
  int maxDepth = -1;  ///< Longest path: 1 shows emitters, 2 direct light …; -1 is unbounded.
  int rrDepth = 5;    ///< Path length from which Russian roulette is played, at least 1.
  bool hideEmitters = false;
  bool transparentShadows =
      false;                       ///< Points and directions shine through what lets part of their light pass straight.
  float clampIndirect = 0;         ///< Largest value of a path's light after its first scattering; 0: none.
  bool lowerPriorityWins = false;  ///< Of surface-defined media that overlap.
  DistanceSampling distance = DistanceSampling::automatic;                 ///< For media that do not choose.
  TransmittanceSampling transmittance = TransmittanceSampling::automatic;  ///< For media that do not choose.
  bool equiangular = true;     ///< Distances in media are also chosen for the lights beside a ray.
  float splitLights = 0.25f;   ///< Clusters of lights are split whose spread is a larger part of all light; 0: none.
  bool volumeLights = true;    ///< Media that glow are sampled as lights.
  bool jointLights = false;    ///< Places along rays for lights come from the tables of marching.
  bool lampDirections = true;  ///< Directions out of media are also chosen towards lamps inside of media.
  bool footprints = true;      ///< Shaders are told how their inputs change from pixel to pixel.
  OverlapChoice overlap = OverlapChoice::automatic;
  Roulette roulette = Roulette::automatic;
  float stepScale = 1;       ///< Factor on all ray marching steps, > 0.
  float lodPixels = 0;       ///< Voxels that the camera sees smaller than so many pixels are made coarser; 0: none.
  int lodDepth = 0;          ///< Paths longer than this see volumes with coarser voxels; 0: none does.
  int lodLevels = 1;         ///< By so many halvings.
  int boundBoxes = 1 << 16;  ///< Boxes over which bounds of all media together may be evaluated, at least 0.
  int boundMegabytes = 256;  ///< Memory for the bounds of all media together.
  std::string aovList;       ///< As written; of an integrator around another one.
  std::vector<AovRequest> aovs;
  Origin origin;
};

enum class FilterType : std::uint8_t { box, tent, gaussian, mitchell, catmullrom, lanczos };

struct ReconstructionFilter {
  FilterType type = FilterType::gaussian;
  float radius = 2;     ///< Pixels, > 0; of a gaussian, where it is cut off.
  float stddev = 0.5f;  ///< Pixels, > 0; of a gaussian.
  float b = 1.0f / 3;   ///< Of mitchell: blur.
  float c = 1.0f / 3;   ///< Of mitchell: ringing.
  int lobes = 3;        ///< Of lanczos: the radius in pixels.
  Origin origin;
};

enum class PixelFormat : std::uint8_t { rgb, rgba, luminance, luminanceAlpha, xyz, xyza };
/// Whether there is a channel of coverage.
constexpr bool hasAlpha(PixelFormat format) {
  return format == PixelFormat::rgba || format == PixelFormat::luminanceAlpha || format == PixelFormat::xyza;
}
enum class ComponentFormat : std::uint8_t { float16, float32 };

/// Pixels. The crop lies within the film.
struct Film {
  int width = 768;
  int height = 576;
  int cropOffsetX = 0;
  int cropOffsetY = 0;
  std::optional<int> cropWidth;   ///< Up to the right edge when not given.
  std::optional<int> cropHeight;  ///< Down to the lower edge when not given.
  PixelFormat pixelFormat = PixelFormat::rgb;
  ComponentFormat componentFormat = ComponentFormat::float32;  ///< Of channels written to a file.
  ReconstructionFilter filter;
  Origin origin;

  int croppedWidth() const { return cropWidth.value_or(width - cropOffsetX); }
  int croppedHeight() const { return cropHeight.value_or(height - cropOffsetY); }
};

enum class SamplerType : std::uint8_t { independent, sobol };

struct Sampler {
  SamplerType type = SamplerType::sobol;
  int sampleCount = 16;  ///< Per pixel, at least 1.
  int seed = 0;          ///< At least 0.
  Origin origin;
};

enum class SensorType : std::uint8_t { perspective, thinlens, orthographic };
enum class FovAxis : std::uint8_t { x, y, diagonal, smaller, larger };

/// An angle of view (degrees, 0 to 180 excluded) across one axis of the film.
struct FieldOfView {
  float degrees = 0;
  FovAxis axis = FovAxis::x;
};

struct Sensor {
  SensorType type = SensorType::perspective;
  Placement<World, Camera>
      toWorld;               ///< May mirror. Without scale, but of an orthographic one, which sees [-1, 1] in x.
  std::optional<float> fov;  ///< Degrees; see `fieldOfView`.
  FovAxis fovAxis = FovAxis::x;
  std::string focalLength;    ///< "50mm", of a film of 36 × 24 mm; see `fieldOfView`.
  float principalPointX = 0;  ///< Where the view's axis meets the film, from its centre: in its widths to the right,
  float principalPointY = 0;  ///< and in its heights downwards.
  float nearClip = 0.01f;
  float farClip = 10000;
  float apertureRadius = 0;            ///< Of a thinlens, scene units.
  std::optional<float> focusDistance;  ///< Of a thinlens, scene units along the view; `farClip` when not given.
  float shutterOpen = 0;               ///< Seconds.
  std::optional<float> shutterClose;   ///< Seconds, not before `shutterOpen`; at the same time when not given.
  std::optional<Index> medium;         ///< What the camera stands in.
  Origin origin;

  Shutter shutter() const { return {shutterOpen, shutterClose.value_or(shutterOpen)}; }

  /// From `fov` and `fovAxis`, or from `focalLength` (default 50mm) across the diagonal.
  FieldOfView fieldOfView() const;
};

enum class EmitterType : std::uint8_t {
  point,
  directional,
  constant,
  area,
  envmap,
  spot,
  projector,
  sunsky,
  background
};

/// Where a sun stands: in a direction, or as it is seen from a place on earth at a time.
struct SunPlace {
  std::optional<Vector<World>> direction;  ///< Towards it, unit; goes before the rest.
  float latitude = 35.6894f;               ///< Degrees north.
  float longitude = 139.6917f;             ///< Degrees east.
  float timezone = 9;                      ///< Hours ahead of universal time.
  int year = 2010, month = 7, day = 10;
  float hour = 15, minute = 0, second = 0;
};

/// How fine the mesh of a displaced surface is. What decides is the first of these that is given.
struct Tessellation {
  std::optional<int> levels;        ///< Every edge is halved so many times.
  std::optional<float> edgeLength;  ///< Scene units, > 0: no edge is longer.
  float edgePixels = 2;             ///< > 0: no edge is longer than that as the camera sees it.
};

/// A displacement shader.
struct Displacement {
  ShaderUse shader;
  Tessellation tessellation;
};

struct Emitter {
  EmitterType type = EmitterType::constant;
  /// Point, spot: radiant intensity (W/sr). Directional: irradiance (W/m²) at right angles. Constant, area: radiance.
  Color emitted{1, 1, 1};
  Point<World> position;             ///< Of a point.
  float radius = 0;                  ///< Of a point: no ray comes nearer; 0: only rays that meet it are kept off.
  Vector<World> direction{0, 0, 1};  ///< Of a directional light: where it travels; unit length.
  Placement<World, Object> toWorld;  ///< Of an envmap, a sunsky, and of what shines along +z; of a point if it moves.
  std::filesystem::path file;        ///< Of an envmap: an existing image.
  float scale = 1;                   ///< Of an envmap, of a projector.
  float cutoffAngle = 20;            ///< Of a spot: degrees from its axis.
  std::optional<float> beamWidth;    ///< Of a spot: degrees to where it begins to fall off.
  std::optional<float> fov;          ///< Of a projector, as of a sensor.
  FovAxis fovAxis = FovAxis::x;
  std::string focalLength;
  std::optional<float> aspect;  ///< Of a projector's picture: width over height; that of the bitmap when not given.
  SunPlace sun;                 ///< Of a sunsky, like the rest.
  float turbidity = 3;
  float sunScale = 1;
  float skyScale = 1;
  float sunAperture = 0.5358f;  ///< Degrees across the disc.
  bool complexSun = false;      ///< Darker towards the limb.
  Color groundAlbedo{0.3f, 0.3f, 0.3f};
  int resolution = 512;  ///< Of a background: columns of the picture that its shader gives.
  /// A shader among the materials, of which the weight of the only closure multiplies what is emitted; of a background
  /// the one that tells its radiance.
  std::optional<std::size_t> texture;
  std::string lightGroup;  ///< The picture of its light alone; empty: none.
  Origin origin;
};

/// A named value: a parameter of a plugin's object, checked against its table and present when written or given a
/// default there; or a value for shaders, written with a name that begins with "user:".
struct NamedValue {
  std::string name;
  Value value;
};

/// Rays by what they are for, as bits.
struct RayKind {
  static constexpr std::uint32_t camera = 1;
  static constexpr std::uint32_t shadow = 2;       ///< From what is lit to lights.
  static constexpr std::uint32_t diffuse = 4;      ///< Scattered by surfaces that are no mirrors, and by media.
  static constexpr std::uint32_t reflection = 16;  ///< Mirrored.
  static constexpr std::uint32_t refraction = 32;  ///< Bent.
  static constexpr std::uint32_t all = ~0u;
};

enum class ShapeType : std::uint8_t {
  obj,
  ply,
  serialized,
  sphere,
  cube,
  rectangle,
  disk,
  cylinder,
  linearcurve,
  bsplinecurve,
  shapegroup,  ///< These two stand in scene files alone: an instance becomes the shapes of its group.
  instance
};

/// Canonical forms, before `toWorld`: a sphere of `radius` about `center`; a cube from -1 to 1; a rectangle from -1 to
/// 1 in x and y at z = 0; a disk of radius 1 at z = 0; the normals of these two point along +z. A cylinder of `radius`
/// around the line from `center` to `end`, without caps.
struct Shape {
  ShapeType type = ShapeType::sphere;
  Placement<World, Object> toWorld;
  std::filesystem::path file;  ///< Of obj, ply, serialized and curves: an existing file.
  std::string faces;           ///< Of obj: which of its faces, as accel::loadObj takes them; empty: all.
  int shapeIndex = 0;          ///< Of serialized: which of the meshes in the file.
  Point<Object> center;
  Point<Object> end{0, 0, 1};  ///< Of a cylinder.
  float radius = 1;
  bool flipNormals = false;
  bool facesViewer = false;  ///< Shaders are told N and Ng turned towards the viewer.
  bool faceNormals = false;
  bool repair = true;  ///< Of meshes that bound a medium: turn faces and close holes.
  std::optional<bool>
      flipTexCoords;  ///< Of meshes from files: v of the file counts from below. Not given: of obj it does.
  Index material = 0;
  std::optional<Index> displacement;  ///< Then it is a mesh, whatever its type.
  std::optional<Index> interior;      ///< Surface-defined, exclusive medium on the side away from the normal.
  std::optional<Index> exterior;
  int priority = 0;                        ///< Of what is inside, where the material does not say; 0: off.
  bool clipVolumes = false;                ///< Where the inside rules there are no volume primitives.
  std::optional<Emitter> emitter;          ///< An area light.
  std::string lightGroup;                  ///< Of all that shines from it, but for a light with its own; empty: none.
  std::string lights;                      ///< Ids of what lights it, with commas; empty: all; "none".
  std::uint32_t visibleTo = RayKind::all;  ///< Bits of RayKind.
  std::vector<NamedValue> attributes;      ///< For shaders that ask: "user:…".
  Origin origin;

  /// A mesh in a file.
  bool isFromFile() const { return type <= ShapeType::serialized; }
  bool isCurves() const { return type == ShapeType::linearcurve || type == ShapeType::bsplinecurve; }
};

/// How a volume's medium moves while the shutter is open: what is at x at the reference time is at x + (t - reference)
/// v at time t.
struct VelocityBlur {
  std::string output;        ///< Of the medium's shader; empty: none.
  std::string grid;          ///< A vector grid instead; empty: none.
  std::string file;          ///< Of the grid; empty: the volume's own.
  float scale = 1;           ///< Factor on velocities.
  std::optional<float> fps;  ///< Velocities are per frame, of which so many make a second; none: per second.
  float referenceTime = 0;   ///< Seconds.

  bool isWanted() const { return !output.empty() || !grid.empty(); }
  /// To scene units per second.
  float factor() const { return scale * fps.value_or(1.0f); }
};

/// What an artist sets on a volume on top of its medium. Its lights are given by `lights`.
struct VolumeControls {
  float density = 1;        ///< Factor on extinction and scattering, at least 0.
  Color color{1, 1, 1};     ///< Factor on scattering, from 0 to 1.
  float emission = 1;       ///< Factor on emission, at least 0.
  std::string densityRamp;  ///< "place: value; …": factor on extinction by the medium's extinction there.
  std::string colorRamp;    ///< "place: r g b; …": factor on scattering, likewise.
  float stepScale = 1;      ///< Factor on the ray marching step, > 0.
  float shadowDensity = 1;  ///< Factor on extinction along shadow rays, at least 0.
  bool holdout = false;     ///< The camera sees a hole where the volume is.
  std::string lights;       ///< Ids of what lights it, with commas; empty: all; "none".
};

/// An additive volume primitive without boundary.
struct Volume {
  std::string type;
  Placement<World, Object> toWorld;
  std::vector<NamedValue> parameters;
  Index medium = 0;
  MediumSampling sampling;  ///< Goes before the medium's own.
  VelocityBlur velocity;
  VolumeControls controls;
  std::vector<NamedValue> attributes;  ///< For shaders that ask: "user:…".
  Origin origin;

  /// Null when neither written nor given a default.
  const Value* find(const std::string& parameter) const;
  /// The value of a parameter that the type's table gives a default or requires.
  template <class T>
  const T& get(const std::string& parameter) const {
    return std::get<T>(*find(parameter));
  }
};

struct SceneDescription {
  Integrator integrator;
  Sensor sensor;
  Film film;
  Sampler sampler;
  std::vector<ShaderUse> materials;
  std::vector<Medium> media;
  std::vector<Displacement> displacements;
  std::vector<ShaderUse> layers;  ///< Textures and other shaders that are connected to parameters.
  std::vector<Shape> shapes;
  std::vector<Volume> volumes;
  std::vector<Emitter> emitters;                  ///< All but area lights.
  std::vector<std::filesystem::path> searchPath;  ///< The scene's folder, then those of `<path>`.
  std::shared_ptr<const SourceTexts> sources;     ///< For the source lines of later messages.

  /// The sampling of a volume: its own words, then its medium's.
  MediumSampling samplingOf(const Volume& volume) const {
    return volume.sampling.orElse(media[volume.medium].sampling);
  }
};

}  // namespace aerosol::scene
