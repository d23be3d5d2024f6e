// The image of a running render in tev, a viewer that shows what is sent to it.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/render/film.h"

namespace aerosol::app {

/// Packets of tev's protocol: their length in bytes (uint32, itself included), a byte that says what it is, then values
/// without padding; texts end with a zero. Little-endian, as hosts are.
std::string tevCreateImage(std::string_view name, int width, int height, bool hasAlpha);
/// Rows of red, green, blue and alpha, of which the last is sent where the image has it.
std::string tevUpdateImage(std::string_view name, const render::PixelRect& area, const std::vector<float>& rgba,
                           bool hasAlpha);

/// Sends from a thread of its own, so that a slow viewer holds up nothing. A connection that breaks ends the sending,
/// not the render.
class TevView {
 public:
  static constexpr const char* usualPort = "14158";

  /// `address` is HOST or HOST:PORT. An error when nobody answers there.
  static Result<std::unique_ptr<TevView>> connect(const std::string& address, std::string imageName, int width,
                                                  int height, bool hasAlpha);
  ~TevView();
  TevView(const TevView&) = delete;
  TevView& operator=(const TevView&) = delete;

  /// Takes the pixels of a part as they are now. From any thread that may read them.
  void show(const render::Film& film, const render::PixelRect& area);
  bool isConnected() {
    const std::scoped_lock lock(mutex_);
    return !isLost_;
  }
  /// Waits until all is sent. False when the connection was lost on the way.
  bool finish();

 private:
  struct Part {
    render::PixelRect area;
    std::vector<float> rgba;
  };

  TevView(int socket, std::string imageName, bool hasAlpha);
  void run();
  bool send(const std::string& packet);

  int socket_;
  std::string imageName_;
  bool hasAlpha_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Part> waiting_;  ///< One an area: a later state takes an earlier one's place.
  bool isEnding_ = false, isLost_ = false;
  std::thread thread_;
};

}  // namespace aerosol::app
