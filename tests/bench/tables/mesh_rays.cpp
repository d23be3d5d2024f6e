// How many rays a second whole paths trace through a mesh of a million triangles, beside what Embree does with the very
// same rays when nothing else is done with them.
//
// mesh_rays [SAMPLES]: 640 x 360 pixels (default: 4 samples), on one thread, by processor time. The mesh is a sphere
// with a relief; it has an image for a texture and stands under an environment map. Embree's calls are overheard, and
// the rays that they are about are traced once more through a plain scene of the same triangles: without filters, all
// of them for the closest hit.
#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <vector>

#include "core/accel/embree.h"
#include "core/image/image.h"
#include "tests/support/rendering.h"
#include "tests/support/scratch_folder.h"

namespace {

struct Overheard {
  bool isListening = false;
  std::vector<RTCRay> rays;
  std::size_t shadowRays = 0;
} overheard;

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

void keep(const RTCRay& ray, bool isShadow) {
  if (!overheard.isListening) return;
  overheard.rays.push_back(ray);
  overheard.shadowRays += isShadow;
}

}  // namespace

// Stand before the library's own: the program's calls come here.
extern "C" {
#if RTC_VERSION_MAJOR >= 4
void rtcIntersect1(RTCScene scene, RTCRayHit* ray, RTCIntersectArguments* arguments) {
  static const auto own = next<decltype(&rtcIntersect1)>("rtcIntersect1");
  keep(ray->ray, false);
  own(scene, ray, arguments);
}
void rtcOccluded1(RTCScene scene, RTCRay* ray, RTCOccludedArguments* arguments) {
  static const auto own = next<decltype(&rtcOccluded1)>("rtcOccluded1");
  keep(*ray, true);
  own(scene, ray, arguments);
}
#else
void rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* ray) {
  static const auto own = next<decltype(&rtcIntersect1)>("rtcIntersect1");
  keep(ray->ray, false);
  own(scene, context, ray);
}
void rtcOccluded1(RTCScene scene, RTCIntersectContext* context, RTCRay* ray) {
  static const auto own = next<decltype(&rtcOccluded1)>("rtcOccluded1");
  keep(*ray, true);
  own(scene, context, ray);
}
#endif
}

namespace aerosol::test {
namespace {

/// Of processor time: all is done on one thread, and other programs on the machine do not count.
double secondsSince(std::clock_t start) {
  return static_cast<double>(std::clock() - start) / static_cast<double>(CLOCKS_PER_SEC);
}

/// 1,000 x 500 quadrangles.
void writeMesh(const std::filesystem::path& file) {
  constexpr std::int32_t around = 1000, down = 500;
  std::ofstream out(file, std::ios::binary);
  out << fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property float u\nproperty float v\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      (around + 1) * (down + 1), 2 * around * down);
  const auto put = [&](const auto& value) { out.write(reinterpret_cast<const char*>(&value), sizeof value); };
  for (std::int32_t j = 0; j <= down; ++j) {
    for (std::int32_t i = 0; i <= around; ++i) {
      const double u = static_cast<double>(i % around) / around, v = static_cast<double>(j) / down;
      const double phi = 2 * 3.14159265358979 * u, theta = 3.14159265358979 * v;
      const double r =
          1 + 0.05 * std::sin(8 * phi) * std::sin(9 * theta) + 0.01 * std::sin(55 * phi) * std::sin(60 * theta);
      for (const double x : {r * std::sin(theta) * std::cos(phi), r * std::cos(theta),
                             r * std::sin(theta) * std::sin(phi), static_cast<double>(i) / around, v})
        put(static_cast<float>(x));
    }
  }
  const auto at = [](std::int32_t i, std::int32_t j) { return j * (around + 1) + i; };
  for (std::int32_t j = 0; j < down; ++j) {
    for (std::int32_t i = 0; i < around; ++i) {
      for (const auto& t : {std::array{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
                            std::array{at(i, j), at(i + 1, j + 1), at(i, j + 1)}}) {
        put(std::uint8_t{3});
        for (const std::int32_t corner : t) put(corner);
      }
    }
  }
}

void writePicture(const std::filesystem::path& file, int width, int height, double contrast) {
  image::ImageBuffer picture;
  picture.width = width;
  picture.height = height;
  picture.channels = {"R", "G", "B"};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double wave = std::sin(0.07 * x) * std::cos(0.05 * y);
      for (const double phase : {0.0, 1.0, 2.0})
        picture.pixels.push_back(
            static_cast<float>(0.5 + 0.4 * std::sin(6 * wave + phase) + contrast * std::exp(20 * wave - 19)));
    }
  }
  const auto written = image::writeImage(file.string(), picture);
  if (!written) throw std::runtime_error(format(written.errors()));
}

std::string sceneOf(const std::filesystem::path& folder) {
  return fmt::format(R"(<scene version="3.0.0"><integrator type="path"/>
    <sensor type="perspective"><transform name="to_world"><lookat origin="0, 1, -3.2" target="0, -0.1, 0" up="0, 1, 0"/></transform>
      <float name="fov" value="50"/><film type="hdrfilm"><integer name="width" value="640"/><integer name="height" value="360"/>
      </film></sensor>
    <emitter type="envmap"><string name="filename" value="{0}/sky.exr"/></emitter>
    <shape type="ply"><string name="filename" value="{0}/million.ply"/><bsdf type="diffuse">
      <texture type="bitmap" name="reflectance"><string name="filename" value="{0}/paint.exr"/></texture></bsdf></shape>
    <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="6"/><translate y="-1.1"/></transform>
      <bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="{0}/paint.exr"/></texture>
      </bsdf></shape></scene>)",
                     folder.string());
}

/// Nanoseconds a ray, of all rays for the closest hit; the least of three runs.
double plainNanoseconds(const TestScene& scene, const std::vector<RTCRay>& rays) {
  const RTCDevice device = rtcNewDevice(("isa=" + scene.scene()->geometry->isa()).c_str());
  const RTCScene plain = rtcNewScene(device);
  for (accel::ObjectId i = 0; i < scene.scene()->geometry->objectCount(); ++i) {
    const accel::TriangleMesh& mesh = *scene.scene()->geometry->mesh(i);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0,
                               sizeof(mesh.positions[0]), mesh.positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof(mesh.triangles[0]), mesh.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(plain, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(plain);
  double best = std::numeric_limits<double>::infinity();
  std::size_t hits = 0;
  for (int run = 0; run < 3; ++run) {
    const auto start = std::clock();
    for (const RTCRay& ray : rays) {
      RTCRayHit traced{};
      traced.ray = ray;
      traced.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      accel::EmbreeContext context;
      accel::initContext(context);
      accel::intersectRay(plain, context, traced);
      hits += traced.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    best = std::min(best, secondsSince(start) * 1e9 / static_cast<double>(rays.size()));
  }
  fmt::print("{:.0f} % of the rays hit something\n",
             100.0 * static_cast<double>(hits) / 3 / static_cast<double>(rays.size()));
  rtcReleaseScene(plain);
  rtcReleaseDevice(device);
  return best;
}

int run(std::uint32_t samples) {
  const ScratchFolder scratch;
  writeMesh(scratch.path() / "million.ply");
  writePicture(scratch.path() / "paint.exr", 1024, 1024, 0);
  writePicture(scratch.path() / "sky.exr", 1024, 512, 40);
  const auto start = std::clock();
  const TestScene scene(sceneOf(scratch.path()));
  if (!scene.scene()) return 1;
  fmt::print("made ready in {:.2f} s\n", secondsSince(start));

  double seconds = std::numeric_limits<double>::infinity();
  for (int repetition = 0; repetition < 3; ++repetition) {
    const auto film = scene.film();
    const std::clock_t begin = std::clock();
    scene.renderInto(*film, {.threads = 1, .endSample = samples});
    seconds = std::min(seconds, secondsSince(begin));
  }
  const auto film = scene.film();
  overheard.isListening = true;
  scene.renderInto(*film, {.threads = 1, .endSample = samples});
  overheard.isListening = false;

  const auto count = static_cast<double>(overheard.rays.size());
  const double whole = seconds * 1e9 / count, plain = plainNanoseconds(scene, overheard.rays);
  fmt::print("{:.0f} rays, {:.0f} % of them shadow rays, for {} samples of 640 x 360 pixels\n", count,
             100 * static_cast<double>(overheard.shadowRays) / count, samples);
  fmt::print("whole paths   {:7.0f} ns a ray, {:.2f} million rays a second\n", whole, 1e3 / whole);
  fmt::print("Embree alone  {:7.0f} ns a ray, {:.2f} million rays a second\n", plain, 1e3 / plain);
  fmt::print("the whole path runs at {:.0f} % of the rate of bare rays\n", 100 * plain / whole);
  return 0;
}

}  // namespace
}  // namespace aerosol::test

int main(int count, char** arguments) {
  return aerosol::test::run(count > 1 ? static_cast<std::uint32_t>(std::atoi(arguments[1])) : 4);
}
