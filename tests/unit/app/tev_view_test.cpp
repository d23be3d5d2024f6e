#include "core/app/tev_view.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>

namespace aerosol::app {
namespace {

using testing::HasSubstr;

/// A viewer that keeps what it is sent.
class Viewer {
 public:
  Viewer() : listening_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(listening_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(listening_, 1), 0);
    socklen_t size = sizeof address;
    getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~Viewer() { close(listening_); }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  /// Everything up to the end of the connection.
  std::string receive() const {
    const int connection = accept(listening_, nullptr, nullptr);
    std::string all;
    char buffer[4096];
    for (ssize_t n = 0; (n = read(connection, buffer, sizeof buffer)) > 0;)
      all.append(buffer, static_cast<std::size_t>(n));
    close(connection);
    return all;
  }
  /// Hangs up at once.
  void refuse() const { close(accept(listening_, nullptr, nullptr)); }

 private:
  int listening_;
  int port_ = 0;
};

/// Takes packets apart as tev does.
class Reader {
 public:
  explicit Reader(std::string bytes) : bytes_(std::move(bytes)) {}
  template <class T>
  T get() {
    T value{};
    EXPECT_LE(at_ + sizeof value, bytes_.size());
    if (at_ + sizeof value <= bytes_.size()) std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::string text() {
    const std::string found = bytes_.c_str() + at_;
    at_ += found.size() + 1;
    return found;
  }
  std::size_t at() const { return at_; }
  bool isAtEnd() const { return at_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

/// A film of 3 x 2 pixels at (1, 0); pixel (x, y) is (x, y, 9) with alpha 0.5.
std::unique_ptr<render::Film> makeFilm() {
  const render::PixelRect area{1, 0, 4, 2};
  auto film = std::make_unique<render::Film>(area);
  render::FilmTile tile(area, 0, 1);
  for (int y = 0; y < 2; ++y) {
    for (int x = 1; x < 4; ++x) tile.add(x, y, 0, Color(static_cast<float>(x), static_cast<float>(y), 9), 0.5f);
  }
  film->commit(tile);
  return film;
}

void expectCreated(Reader& reader, int channels) {
  const std::size_t start = reader.at();
  const auto length = reader.get<std::uint32_t>();
  EXPECT_EQ(reader.get<std::uint8_t>(), 4);
  EXPECT_EQ(reader.get<std::uint8_t>(), 0);
  EXPECT_EQ(reader.text(), "cloud.exr");
  EXPECT_EQ(reader.get<std::int32_t>(), 8);
  EXPECT_EQ(reader.get<std::int32_t>(), 6);
  EXPECT_EQ(reader.get<std::int32_t>(), channels);
  for (int c = 0; c < channels; ++c) EXPECT_EQ(reader.text(), std::string(1, "RGBA"[c]));
  EXPECT_EQ(reader.at() - start, length);
}

void expectUpdated(Reader& reader, int channels) {
  const std::size_t start = reader.at();
  const auto length = reader.get<std::uint32_t>();
  EXPECT_EQ(reader.get<std::uint8_t>(), 6);
  EXPECT_EQ(reader.get<std::uint8_t>(), 0);
  EXPECT_EQ(reader.text(), "cloud.exr");
  ASSERT_EQ(reader.get<std::int32_t>(), channels);
  for (int c = 0; c < channels; ++c) EXPECT_EQ(reader.text(), std::string(1, "RGBA"[c]));
  const std::array<std::int32_t, 4> area = {reader.get<std::int32_t>(), reader.get<std::int32_t>(),
                                            reader.get<std::int32_t>(), reader.get<std::int32_t>()};
  EXPECT_EQ(area, (std::array<std::int32_t, 4>{1, 0, 3, 2}));
  for (std::int64_t c = 0; c < channels; ++c) EXPECT_EQ(reader.get<std::int64_t>(), c);
  for (std::int64_t c = 0; c < channels; ++c) EXPECT_EQ(reader.get<std::int64_t>(), 4);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(reader.get<float>(), static_cast<float>(1 + i % 3));
    EXPECT_EQ(reader.get<float>(), static_cast<float>(i / 3));
    EXPECT_EQ(reader.get<float>(), 9);
    if (i < 5 || channels == 4) {
      EXPECT_EQ(reader.get<float>(), 0.5f);
    }
  }
  EXPECT_EQ(reader.at() - start, length);
}

TEST(TevView, SendsTheImageAsTevReadsIt) {
  for (const bool hasAlpha : {false, true}) {
    const Viewer viewer;
    std::string received;
    std::thread thread([&] { received = viewer.receive(); });
    const auto film = makeFilm();
    {
      auto view = TevView::connect(viewer.address(), "cloud.exr", 8, 6, hasAlpha);
      ASSERT_TRUE(view) << format(view.errors());
      (*view)->show(*film, film->area());
      EXPECT_TRUE((*view)->finish());
    }
    thread.join();
    Reader reader(received);
    expectCreated(reader, hasAlpha ? 4 : 3);
    expectUpdated(reader, hasAlpha ? 4 : 3);
    EXPECT_TRUE(reader.isAtEnd());
  }
}

TEST(TevView, SaysWhenNobodyAnswers) {
  std::string address;
  {
    const Viewer viewer;
    address = viewer.address();
  }
  const auto view = TevView::connect(address, "cloud.exr", 8, 6, false);
  ASSERT_FALSE(view);
  EXPECT_THAT(format(view.errors()), HasSubstr("nobody answers at " + address));
}

TEST(TevView, SurvivesAViewerThatLeaves) {
  const Viewer viewer;
  std::thread thread([&] { viewer.refuse(); });
  auto view = TevView::connect(viewer.address(), "cloud.exr", 8, 6, false);
  ASSERT_TRUE(view);
  thread.join();
  const auto film = makeFilm();
  // What is sent at first may still find room on the way.
  while ((*view)->isConnected()) (*view)->show(*film, film->area());
  EXPECT_FALSE((*view)->finish());
}

}  // namespace
}  // namespace aerosol::app
