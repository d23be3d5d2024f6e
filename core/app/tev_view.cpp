#include "core/app/tev_view.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace aerosol::app {

namespace {

enum class PacketType : std::uint8_t { createImage = 4, updateImage = 6 };

/// Values one after the other.
class Packet {
 public:
  explicit Packet(PacketType type) {
    add(std::uint32_t{0});
    add(static_cast<std::uint8_t>(type));
    add(std::uint8_t{0});  // The viewer keeps its focus.
  }
  template <class T>
  void add(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void addText(std::string_view text) {
    bytes_ += text;
    bytes_ += '\0';
  }
  std::string finish() {
    const auto length = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &length, sizeof length);
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

constexpr const char* channelNames[] = {"R", "G", "B", "A"};
std::int32_t channelCount(bool hasAlpha) { return hasAlpha ? 4 : 3; }

void addChannels(Packet& packet, bool hasAlpha) {
  for (std::int32_t c = 0; c < channelCount(hasAlpha); ++c) packet.addText(channelNames[c]);
}

/// The socket, or -1 with what went wrong.
int openSocket(const std::string& host, const std::string& port, std::string& problem) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), port.c_str(), &hints, &found); error != 0) {
    problem = gai_strerror(error);
    return -1;
  }
  int connected = -1;
  for (const addrinfo* each = found; each && connected < 0; each = each->ai_next) {
    connected = socket(each->ai_family, each->ai_socktype | SOCK_CLOEXEC, each->ai_protocol);
    if (connected >= 0 && ::connect(connected, each->ai_addr, each->ai_addrlen) == 0) break;
    problem = std::system_category().message(errno);
    if (connected >= 0) close(connected);
    connected = -1;
  }
  freeaddrinfo(found);
  return connected;
}

}  // namespace

std::string tevCreateImage(std::string_view name, int width, int height, bool hasAlpha) {
  Packet packet(PacketType::createImage);
  packet.addText(name);
  packet.add(static_cast<std::int32_t>(width));
  packet.add(static_cast<std::int32_t>(height));
  packet.add(channelCount(hasAlpha));
  addChannels(packet, hasAlpha);
  return packet.finish();
}

std::string tevUpdateImage(std::string_view name, const render::PixelRect& area, const std::vector<float>& rgba,
                           bool hasAlpha) {
  Packet packet(PacketType::updateImage);
  packet.addText(name);
  packet.add(channelCount(hasAlpha));
  addChannels(packet, hasAlpha);
  for (const int value : {area.x0, area.y0, area.width(), area.height()}) packet.add(static_cast<std::int32_t>(value));
  for (std::int64_t c = 0; c < channelCount(hasAlpha); ++c) packet.add(c);
  for (std::int64_t c = 0; c < channelCount(hasAlpha); ++c) packet.add(std::int64_t{4});
  // As many values as the last channel's last pixel needs.
  const std::size_t used = rgba.size() - (hasAlpha ? 0 : 1);
  for (std::size_t i = 0; i < used; ++i) packet.add(rgba[i]);
  return packet.finish();
}

Result<std::unique_ptr<TevView>> TevView::connect(const std::string& address, std::string imageName, int width,
                                                  int height, bool hasAlpha) {
  const std::size_t colon = address.rfind(':');
  const std::string host = address.substr(0, colon);
  const std::string port = colon == std::string::npos ? usualPort : address.substr(colon + 1);
  std::string problem;
  const int connected = openSocket(host, port, problem);
  if (connected < 0) {
    return Diagnostic{Severity::error,
                      {},
                      "nobody answers at " + host + ":" + port + ": " + problem,
                      {},
                      {"tev has to run there; it listens at " + std::string(usualPort) + " unless told otherwise"}};
  }
  std::unique_ptr<TevView> view(new TevView(connected, std::move(imageName), hasAlpha));
  view->isLost_ = !view->send(tevCreateImage(view->imageName_, width, height, hasAlpha));
  view->thread_ = std::thread([raw = view.get()] { raw->run(); });
  return view;
}

TevView::TevView(int socket, std::string imageName, bool hasAlpha)
    : socket_(socket), imageName_(std::move(imageName)), hasAlpha_(hasAlpha) {}

TevView::~TevView() {
  finish();
  close(socket_);
}

void TevView::show(const render::Film& film, const render::PixelRect& area) {
  Part part{area, {}};
  part.rgba.reserve(4 * area.pixelCount());
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const render::PixelEstimate pixel = film.estimate(x, y);
      part.rgba.insert(part.rgba.end(), {pixel.color.r, pixel.color.g, pixel.color.b, pixel.alpha});
    }
  }
  const std::scoped_lock lock(mutex_);
  if (isLost_) return;
  const auto same = std::find_if(waiting_.begin(), waiting_.end(), [&](const Part& each) { return each.area == area; });
  if (same == waiting_.end()) {
    waiting_.push_back(std::move(part));
  } else {
    *same = std::move(part);
  }
  changed_.notify_one();
}

bool TevView::finish() {
  {
    const std::scoped_lock lock(mutex_);
    isEnding_ = true;
    changed_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
  return !isLost_;
}

void TevView::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return isEnding_ || !waiting_.empty(); });
    if (waiting_.empty() || isLost_) return;
    const std::vector<Part> parts = std::exchange(waiting_, {});
    lock.unlock();
    const bool isSent = std::all_of(parts.begin(), parts.end(), [this](const Part& part) {
      return send(tevUpdateImage(imageName_, part.area, part.rgba, hasAlpha_));
    });
    lock.lock();
    isLost_ = isLost_ || !isSent;
    if (isLost_) return;
  }
}

bool TevView::send(const std::string& packet) {
  for (std::size_t at = 0; at < packet.size();) {
    const ssize_t sent = ::send(socket_, packet.data() + at, packet.size() - at, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += static_cast<std::size_t>(sent);
  }
  return true;
}

}  // namespace aerosol::app
