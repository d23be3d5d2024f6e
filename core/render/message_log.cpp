#include "core/render/message_log.h"

namespace aerosol::render {

void MessageLog::collect(shading::KernelHost& host, const shading::Batch& batch, std::span<const PendingQuestion> lanes,
                         std::span<PathContext* const> paths) {
  const jit::KernelInterface& interface = batch.interface();
  const auto text = [&](std::uint64_t hash) { return host.calls().strings().text(hash); };
  std::vector<std::uint32_t> calls(lanes.size(), 0);
  const std::lock_guard lock(mutex_);
  for (const shading::Record& record : host.records()) {
    if (record.lane >= lanes.size()) continue;
    const PendingQuestion& from = lanes[record.lane];
    const PathContext& path = *paths[from.slot];
    insert({path.id(), path.questionNumber(from.question), calls[record.lane]++, record.kind,
            shading::locationOf(record, interface), shading::describe(record, interface, text),
            record.kind == AEROSOL_MESSAGE_FILE ? shading::fileOf(record, text) : std::string()});
  }
  host.records().clear();
}

void MessageLog::add(Message message) {
  const std::lock_guard lock(mutex_);
  insert(std::move(message));
}

void MessageLog::insert(Message message) {
  messages_.insert(std::move(message));
  if (messages_.size() <= maximum_) return;
  messages_.erase(std::prev(messages_.end()));
  ++dropped_;
}

void MessageLog::reportInvalid(const volume::Medium& medium, Point<World> point, const volume::Coefficients& given,
                               const PathId& path, std::uint32_t question) {
  const std::lock_guard lock(mutex_);
  note(invalid_[medium.index], point, given, path, question);
}

void MessageLog::reportAmplifying(const volume::Medium& medium, Point<World> point, const volume::Coefficients& given,
                                  const PathId& path, std::uint32_t question) {
  const std::lock_guard lock(mutex_);
  note(amplifying_[medium.index], point, given, path, question);
}

void MessageLog::note(Invalid& entry, Point<World> point, const volume::Coefficients& given, const PathId& path,
                      std::uint32_t question) {
  ++entry.count;
  if (entry.count == 1 || std::tie(path, question) < std::tie(entry.path, entry.question)) {
    entry = {path, question, point, given, entry.count, false};
  }
}

void MessageLog::reportInvalidSurface(std::uint32_t object, std::uint32_t site, Point<World> point,
                                      const PathId& path) {
  const std::lock_guard lock(mutex_);
  InvalidSurface& entry = invalidSurfaces_[object];
  ++entry.count;
  const auto order = [](const PathId& id, Point<World> p, std::uint32_t s) {
    return std::tuple(id.y, id.x, id.sample, p.x, p.y, p.z, s);
  };
  if (entry.count == 1 || order(path, point, site) < order(entry.path, entry.point, entry.site)) {
    entry = {path, site, point, entry.count};
  }
}

void MessageLog::markInvalidEverywhere(const volume::Medium& medium) {
  const std::lock_guard lock(mutex_);
  for (auto* entries : {&invalid_, &amplifying_})
    if (const auto known = entries->find(medium.index); known != entries->end()) known->second.isEverywhere = true;
}

std::vector<Message> MessageLog::sorted() const {
  const std::lock_guard lock(mutex_);
  return {messages_.begin(), messages_.end()};
}

std::uint64_t MessageLog::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

std::map<std::uint32_t, MessageLog::InvalidSurface> MessageLog::invalidSurfaces() const {
  const std::lock_guard lock(mutex_);
  return invalidSurfaces_;
}

std::map<std::uint32_t, MessageLog::Invalid> MessageLog::amplifying() const {
  const std::lock_guard lock(mutex_);
  return amplifying_;
}

std::map<std::uint32_t, MessageLog::Invalid> MessageLog::invalid() const {
  const std::lock_guard lock(mutex_);
  return invalid_;
}

}  // namespace aerosol::render
