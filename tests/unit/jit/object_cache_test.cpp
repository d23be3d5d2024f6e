#include "core/jit/object_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "tests/support/scratch_folder.h"
#include "tests/unit/jit/kernel_runner.h"
#include "tests/unit/jit/program_builder.h"

namespace aerosol::jit::test {

namespace fs = std::filesystem;

namespace {

/// A folder that goes with the test.
class ObjectCacheTest : public testing::Test {
 protected:
  std::shared_ptr<ObjectCache> open(std::uint64_t bytes = 1u << 20) {
    auto cache = ObjectCache::open(root_ / "aerosol", bytes);
    EXPECT_TRUE(cache) << format(cache.errors());
    return *cache;
  }
  std::size_t fileCount() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(root_ / "aerosol"), {}));
  }

  aerosol::test::ScratchFolder scratch_;
  fs::path root_ = scratch_.path();
};

TEST_F(ObjectCacheTest, givesBackWhatWasPut) {
  const auto cache = open();
  EXPECT_FALSE(cache->get("kernel-1"));
  const std::string bytes("code\0with\0zeros", 15);
  cache->put("kernel-1", bytes);
  cache->put("kernel-2", "");
  EXPECT_EQ(cache->get("kernel-1"), bytes);
  EXPECT_EQ(cache->get("kernel-2"), "");
  cache->put("kernel-1", "other");
  EXPECT_EQ(open()->get("kernel-1"), "other") << "another process sees the same";
  EXPECT_EQ(cache->statistics().written, 3u);
}

TEST_F(ObjectCacheTest, makesAPrivateFolder) {
  open();
  struct stat status{};
  ASSERT_EQ(::stat((root_ / "aerosol").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0700u);
}

TEST_F(ObjectCacheTest, closesAFolderThatIsOpenToOthers) {
  fs::create_directory(root_ / "aerosol");
  fs::permissions(root_ / "aerosol", fs::perms::all);
  open();
  EXPECT_EQ(fs::status(root_ / "aerosol").permissions(), fs::perms::owner_all);
}

TEST_F(ObjectCacheTest, refusesAFolderOfAnotherUser) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give folders away";
  fs::create_directory(root_ / "aerosol");
  ASSERT_EQ(::chown((root_ / "aerosol").c_str(), 12345, 12345), 0);
  const auto cache = ObjectCache::open(root_ / "aerosol");
  ASSERT_FALSE(cache);
  EXPECT_NE(cache.errors().entries()[0].message.find("another user"), std::string::npos);
}

TEST_F(ObjectCacheTest, refusesWhatIsNoFolder) {
  std::ofstream(root_ / "aerosol") << "a file";
  EXPECT_FALSE(ObjectCache::open(root_ / "aerosol"));
  EXPECT_FALSE(ObjectCache::open(root_ / "aerosol" / "below"));
}

TEST_F(ObjectCacheTest, dropsDamagedEntries) {
  const auto cache = open();
  const std::string bytes(1000, 'x');
  const fs::path file = root_ / "aerosol" / "kernel-1";
  const auto damage = [&](const std::function<void(std::string&)>& change) {
    cache->put("kernel-1", bytes);
    std::string text;
    {
      std::ifstream in(file, std::ios::binary);
      text.assign(std::istreambuf_iterator<char>(in), {});
    }
    change(text);
    std::ofstream(file, std::ios::binary | std::ios::trunc) << text;
    EXPECT_FALSE(cache->get("kernel-1"));
    EXPECT_FALSE(fs::exists(file));
  };
  damage([](std::string& text) { text.back() ^= 1; });
  damage([](std::string& text) { text[0] ^= 1; });
  damage([](std::string& text) { text.resize(text.size() - 1); });
  damage([](std::string& text) { text += 'x'; });
  damage([](std::string& text) { text.clear(); });
  EXPECT_EQ(cache->statistics().damaged, 5u);
  cache->put("kernel-1", bytes);
  EXPECT_EQ(cache->get("kernel-1"), bytes) << "replaced";
}

TEST_F(ObjectCacheTest, knowsAnEntryUnderAnothersName) {
  const auto cache = open();
  cache->put("kernel-1", "one");
  fs::copy(root_ / "aerosol" / "kernel-1", root_ / "aerosol" / "kernel-2");
  EXPECT_FALSE(cache->get("kernel-2"));
}

TEST_F(ObjectCacheTest, doesNotFollowLinks) {
  const auto cache = open();
  cache->put("kernel-1", "one");
  fs::create_symlink("kernel-1", root_ / "aerosol" / "kernel-2");
  EXPECT_FALSE(cache->get("kernel-2"));
}

TEST_F(ObjectCacheTest, staysBoundedAndKeepsWhatIsUsed) {
  const auto cache = open(20000);
  for (int i = 0; i < 100; ++i) {
    cache->put("kernel-" + std::to_string(i), std::string(1000, 'x'));
    // Entries of a minute ago and more; the first one was read just now.
    const auto age = std::chrono::minutes(i == 0 ? 0 : 200 - i);
    fs::last_write_time(root_ / "aerosol" / ("kernel-" + std::to_string(i)), fs::file_time_type::clock::now() - age);
    EXPECT_TRUE(cache->get("kernel-0")) << "after " << i;
  }
  std::uint64_t total = 0;
  for (const auto& entry : fs::directory_iterator(root_ / "aerosol")) total += entry.file_size();
  EXPECT_LE(total, 20000u + 20000u / 16 + 1100u);
  EXPECT_FALSE(cache->get("kernel-1"));
  EXPECT_TRUE(cache->get("kernel-99"));
  cache->put("kernel-huge", std::string(30000, 'x'));
  EXPECT_FALSE(cache->get("kernel-huge"));
}

TEST_F(ObjectCacheTest, clearsAwayAbandonedWrites) {
  open();
  const fs::path abandoned = root_ / "aerosol" / ".writing-1-0-kernel-1";
  const fs::path current = root_ / "aerosol" / ".writing-2-0-kernel-2";
  std::ofstream(abandoned) << "half";
  std::ofstream(current) << "half";
  fs::last_write_time(abandoned, fs::file_time_type::clock::now() - std::chrono::hours(2));
  open()->put("kernel-3", "x");
  EXPECT_FALSE(fs::exists(abandoned));
  EXPECT_TRUE(fs::exists(current));
}

TEST_F(ObjectCacheTest, servesManyWritersAndReaders) {
  const auto one = open(50000);
  const auto other = open(50000);
  std::vector<std::thread> threads;
  std::atomic<int> wrong{0}, found{0};
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&, t] {
      ObjectCache& cache = t % 2 ? *one : *other;
      for (int i = 0; i < 400; ++i) {
        const std::string key = "kernel-" + std::to_string(i % 7);
        const char letter = static_cast<char>('a' + (t + i) % 26);
        cache.put(key, std::string(2000, letter));
        const auto bytes = cache.get(key);
        if (!bytes) continue;
        ++found;
        if (bytes->size() != 2000 || bytes->find_first_not_of((*bytes)[0]) != std::string::npos) ++wrong;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(found, 0);
  EXPECT_EQ(one->statistics().damaged + other->statistics().damaged, 0u);
  EXPECT_EQ(fileCount(), 7u) << "no temporary files are left";
}

TEST_F(ObjectCacheTest, defaultFolderFollowsTheStandard) {
  const char* const before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before ? before : "";
  ::setenv("XDG_CACHE_HOME", "/somewhere/cache", 1);
  EXPECT_EQ(ObjectCache::defaultFolder(), "/somewhere/cache/aerosol");
  ::setenv("XDG_CACHE_HOME", "relative", 1);
  EXPECT_EQ(ObjectCache::defaultFolder(), fs::path(std::getenv("HOME")) / ".cache" / "aerosol");
  before ? ::setenv("XDG_CACHE_HOME", kept.c_str(), 1) : ::unsetenv("XDG_CACHE_HOME");
}

TEST_F(ObjectCacheTest, kernelsComeBackFromIt) {
  ProgramBuilder b;
  const VariableId noise = b.call("perlin_f_v", lang::types::floating, {b.global(Global::P)});
  b.message(lang::MessageKind::print, "%g", {noise});
  b.output(noise);
  b.output(b.text("some text"));
  const auto program = b.build();
  KernelRequest request = requestFor(program, 8);
  const auto open = [&] {
    auto made = Compiler::create({runtimeFolder(), this->open()});
    EXPECT_TRUE(made);
    return *made;
  };
  EXPECT_FALSE(open()->load(request));
  const auto cold = open()->compile(request);
  ASSERT_TRUE(cold);
  EXPECT_FALSE(cold->times().fromCache);
  const auto warm = open()->compile(request);
  ASSERT_TRUE(warm);
  EXPECT_TRUE(warm->times().fromCache);
  EXPECT_EQ(serialise(warm->interface()), serialise(cold->interface()));
  EXPECT_EQ(warm->interface().sites, cold->interface().sites);

  request.programHash = hashProgram(*program);
  request.program.reset();
  auto loaded = open()->load(request);
  ASSERT_TRUE(loaded);
  const Batch batch = Batch::random(30, 5);
  EXPECT_EQ(run(*loaded, batch).outputs, run(*cold, batch).outputs);
  EXPECT_EQ(run(*loaded, batch).records, run(*cold, batch).records);
  EXPECT_EQ(loaded->interface().strings.at(run(*loaded, batch).outputs[1][0]), "some text");

  // Whatever decides the code is in the key.
  const auto differs = [&](const std::function<void(KernelRequest&)>& change) {
    KernelRequest other = request;
    change(other);
    return !open()->load(other);
  };
  EXPECT_TRUE(differs([](KernelRequest& r) { r.target.width = 4; }));
  EXPECT_TRUE(differs([](KernelRequest& r) { r.outputs.pop_back(); }));
  EXPECT_TRUE(differs([](KernelRequest& r) { r.messages = false; }));
  EXPECT_TRUE(differs([](KernelRequest& r) { r.counters = true; }));
  EXPECT_TRUE(differs([](KernelRequest& r) { r.severalInstances = true; }));
  EXPECT_TRUE(differs([](KernelRequest& r) { r.domain = Domain::range; }));
  EXPECT_TRUE(differs([](KernelRequest& r) { r.folded.push_back({0, std::vector<float>{1}}); }));
  EXPECT_TRUE(differs([](KernelRequest& r) { r.programHash += "0"; }));
  EXPECT_FALSE(differs([](KernelRequest&) {}));

  // A damaged entry is compiled anew and replaced.
  for (const auto& entry : fs::directory_iterator(root_ / "aerosol")) {
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(200);
    file.put('!');
  }
  request.program = program;
  const auto again = open()->compile(request);
  ASSERT_TRUE(again);
  EXPECT_FALSE(again->times().fromCache);
  EXPECT_TRUE(open()->load(request));
}

}  // namespace

}  // namespace aerosol::jit::test
