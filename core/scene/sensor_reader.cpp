#include "core/scene/sensor_reader.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include "core/scene/checks.h"
#include "core/scene/property_reader.h"
#include "core/scene/tables.h"

namespace aerosol::scene {

namespace {

/// Reads one sensor into the description.
class SensorReader {
 public:
  SensorReader(IdTable& ids, ShaderBuilder& shaders, Reporter& reporter, SceneDescription& scene)
      : ids_(ids), shaders_(shaders), reporter_(reporter), scene_(scene) {}

  void read(const Element& element, bool isTaken) {
    Sensor& sensor = scene_.sensor;
    const int before = reporter_.errorCount();
    if (const auto* type = readTyped(element, sensorTypes(), sensor, reporter_))
      sensor.type = static_cast<SensorType>(type - sensorTypes().data());
    if (sensor.origin.has("fov") && sensor.origin.has("focal_length")) {
      reporter_.error(sensor.origin.of("focal_length"),
                      "'fov' and 'focal_length' both give the angle: write one of them");
    }
    if (reporter_.errorCount() == before) checkSensor(sensor, reporter_);
    const std::vector<Child> children = ids_.children(element, {"film", "sampler", "medium"}, reporter_);
    const Child film = IdTable::single(children, "film", reporter_);
    const Child sampler = IdTable::single(children, "sampler", reporter_);
    const Child medium = IdTable::single(children, "medium", reporter_);
    scene_.film.origin.location = scene_.film.filter.origin.location = element.location;
    scene_.sampler.origin.location = element.location;
    if (film.object) readFilm(*film.object);
    if (sampler.object) readSampler(*sampler.object, isTaken);
    if (medium.object && isTaken) sensor.medium = shaders_.medium(*medium.object);
  }

 private:
  void readFilm(const Element& element) {
    Film& film = scene_.film;
    const int before = reporter_.errorCount();
    readTyped(element, filmTypes(), film, reporter_);
    if (reporter_.errorCount() == before) checkFilm(film, reporter_);
    film.filter.origin.location = element.location;
    const Child filter = IdTable::single(ids_.children(element, {"rfilter"}, reporter_), "rfilter", reporter_);
    if (!filter.object) return;
    if (const auto* type = readTyped(*filter.object, filterTypes(), film.filter, reporter_))
      film.filter.type = static_cast<FilterType>(type - filterTypes().data());
    completeFilter(film.filter);
    ids_.children(*filter.object, {}, reporter_);
  }

  void readSampler(const Element& element, bool isTaken) {
    const TypeTable<Sampler>* table = readTyped(element, samplerTypes(), scene_.sampler, reporter_);
    ids_.children(element, {}, reporter_);
    if (!table) return;
    scene_.sampler.type = table->type == "independent" ? SamplerType::independent : SamplerType::sobol;
    if (table->substitute.empty() || !isTaken) return;
    reporter_.warning(element.typeLocation,
                      fmt::format("instead of the sampler '{}' the low-discrepancy sampler '{}' is used", table->type,
                                  table->substitute),
                      {fmt::format("write '{}' to choose it, or 'independent'", table->substitute)});
  }

  IdTable& ids_;
  ShaderBuilder& shaders_;
  Reporter& reporter_;
  SceneDescription& scene_;
};

/// Ids come before numbers.
const Element* choose(const std::vector<const Element*>& sensors, const std::string& wanted) {
  for (const Element* sensor : sensors) {
    if (!wanted.empty() && sensor->id == wanted) return sensor;
  }
  std::size_t number = 0;
  const char* const end = wanted.data() + wanted.size();
  const bool isNumber = wanted.empty() || std::from_chars(wanted.data(), end, number).ptr == end;
  return isNumber && number < sensors.size() ? sensors[number] : nullptr;
}

std::vector<std::string> namesOf(const std::vector<const Element*>& sensors) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const std::string& id = sensors[i]->id;
    names.push_back(
        fmt::format("{}{}: {}", i, id.empty() ? "" : fmt::format(" ('{}')", id), format(sensors[i]->location)));
  }
  return names;
}

}  // namespace

void readSensors(const SceneTree& tree, const std::string& wanted, IdTable& ids, ShaderBuilder& shaders,
                 Reporter& reporter, SceneDescription& scene) {
  std::vector<const Element*> sensors;
  for (const Element& element : tree.scene.children) {
    if (element.tag == "sensor") sensors.push_back(&element);
  }
  if (sensors.empty()) {
    reporter.error(tree.scene.location, "the scene has no sensor", {"write a <sensor type=\"perspective\"> into it"});
    return;
  }
  const Element* taken = choose(sensors, wanted);
  if (!taken) {
    reporter.error({"--sensor", 0, 0}, fmt::format("the scene has no sensor '{}'", wanted), namesOf(sensors));
    taken = sensors.front();
  } else if (sensors.size() > 1 && wanted.empty()) {
    std::vector<std::string> notes{"choose one by its number or its id: --sensor 1"};
    for (std::string& name : namesOf(sensors)) notes.push_back(std::move(name));
    reporter.warning(sensors[1]->location, fmt::format("of {} sensors the first one is used", sensors.size()),
                     std::move(notes));
  }
  // What is wrong with the others is told as well.
  SensorReader reader(ids, shaders, reporter, scene);
  for (const Element* sensor : sensors) {
    if (sensor == taken) continue;
    reader.read(*sensor, false);
    scene.sensor = {};
    scene.film = {};
    scene.sampler = {};
  }
  reader.read(*taken, true);
}

}  // namespace aerosol::scene
