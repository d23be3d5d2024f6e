#include "core/base/module.h"

#include <gtest/gtest.h>

namespace aerosol {
namespace {

std::string messageOf(const Diagnostics& errors) { return errors.entries().at(0).message; }

TEST(Module, FindsTypedFunctions) {
  const auto library = Module::open("libm.so.6");
  ASSERT_TRUE(library);
  const auto cosine = library->function<double(double)>("cos");
  ASSERT_TRUE(cosine);
  EXPECT_EQ((*cosine)(0.0), 1.0);
}

TEST(Module, NamesAMissingFunction) {
  const auto library = Module::open("libm.so.6");
  ASSERT_TRUE(library);
  const auto missing = library->function<void()>("aerosolHasNoSuchFunction");
  ASSERT_FALSE(missing);
  EXPECT_NE(messageOf(missing.errors()).find("'aerosolHasNoSuchFunction'"), std::string::npos);
}

TEST(Module, NamesAMissingFile) {
  const auto module = openModule("aerosol_no_such_module");
  ASSERT_FALSE(module);
  const auto file = module.errors().entries().at(0).location.file;
  EXPECT_NE(file.find("/lib/aerosol/aerosol_no_such_module.so"), std::string::npos) << file;
}

TEST(Module, RefusesAFileThatIsNoModule) {
  const auto module = Module::open("/proc/self/status");
  ASSERT_FALSE(module);
  EXPECT_EQ(module.errors().entries().at(0).location.file, "/proc/self/status");
}

}  // namespace
}  // namespace aerosol
