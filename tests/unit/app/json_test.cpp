#include "core/app/json.h"

#include <gtest/gtest.h>

#include <limits>

namespace aerosol::app {
namespace {

TEST(Json, NestsAndEscapes) {
  JsonWriter json;
  json.beginObject()
      .text("a \"b\"\n", "c\\\x01")
      .number("n", 0.5)
      .number("inf", std::numeric_limits<double>::infinity());
  json.key("list").beginArray().count(1).boolean(false).endArray();
  json.key("empty").beginArray().endArray().endObject();
  EXPECT_EQ(json.finish(),
            "{\n  \"a \\\"b\\\"\\n\": \"c\\\\\\u0001\",\n  \"n\": 0.5,\n  \"inf\": null,\n  \"list\": [\n    1,\n    "
            "false\n  ],\n  \"empty\": []\n}\n");
}

}  // namespace
}  // namespace aerosol::app
