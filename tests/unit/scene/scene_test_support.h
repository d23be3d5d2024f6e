// Short scenes for tests.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/scene/loader.h"

namespace aerosol::scene {

/// `body` with a scene around it, and a sensor unless it has one of its own.
inline std::string wrap(const std::string& body) {
  const bool hasSensor = body.find("<sensor") != std::string::npos;
  return "<scene version=\"3.0.0\">\n" + body + (hasSensor ? "" : "\n<sensor type=\"perspective\"/>") + "\n</scene>\n";
}

/// The body of a scene, read without an error; `warnings`, when given, gets the warnings, otherwise there must be none.
inline SceneDescription read(const std::string& body, const LoadOptions& options = {},
                             Diagnostics* warnings = nullptr) {
  Diagnostics own;
  auto scene = loadString(wrap(body), "test.xml", {}, options, warnings ? *warnings : own);
  EXPECT_TRUE(scene) << format(scene.errors());
  EXPECT_EQ(format(own), "");
  return scene ? *scene : SceneDescription{};
}

/// All messages of a scene that cannot be read.
inline std::string readErrors(const std::string& body, const LoadOptions& options = {}) {
  Diagnostics warnings;
  const auto scene = loadString(wrap(body), "test.xml", {}, options, warnings);
  EXPECT_FALSE(scene);
  return format(scene.errors());
}

}  // namespace aerosol::scene
