// SPDX-License-Identifier: Apache-2.0
#include "trocar/core/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace trocar::core {
namespace {

using testing::HasSubstr;

TEST(JsonDocument, ReadsNestedFields) {
  auto document = JsonDocument::Parse(R"({"a": {"b": [1, 2.5]}, "name": "liver", "n": 3})", "f");
  ASSERT_TRUE(document.ok());
  const JsonView root = document->Root();
  EXPECT_EQ(root.Object("a").Numbers("b", 2), (std::vector<double>{1, 2.5}));
  EXPECT_EQ(root.Text("name"), "liver");
  EXPECT_EQ(root.Integer("n"), 3);
  EXPECT_DOUBLE_EQ(root.NumberOr("absent", 4.0), 4.0);
  EXPECT_TRUE(document->Check().ok());
}

TEST(JsonDocument, FirstComplaintNamesFileAndField) {
  auto document = JsonDocument::Parse(R"({"slices": [{"x": 1}, {"x": "one"}]})", "points.json");
  ASSERT_TRUE(document.ok());
  for (const JsonView& slice : document->Root().Array("slices")) (void)slice.Number("x");
  const Status status = document->Check();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kJsonField);
  EXPECT_THAT(status.error().message, HasSubstr("points.json: at slices[1].x: must be a number"));
}

TEST(JsonDocument, RefusesRangeWholeNumberAndMisspeltFields) {
  const auto complaint = [](const char* text, auto read) {
    auto document = JsonDocument::Parse(text, "f");
    read(document->Root());
    return document->Check().ok() ? std::string() : document->Check().error().message;
  };
  EXPECT_THAT(complaint(R"({"k": -1})",
                        [](JsonView v) {
                          (void)v.Number("k", {0, 10});
                        }),
              HasSubstr("between 0.0 and 10.0"));
  EXPECT_THAT(complaint(R"({"k": 1.5})", [](JsonView v) { (void)v.Integer("k"); }),
              HasSubstr("whole number"));
  EXPECT_THAT(complaint(R"({"k": 1, "kk": 2})", [](JsonView v) { v.AllowOnly({"k"}); }), HasSubstr("at kk"));
}

TEST(JsonDocument, RefusesBrokenText) {
  for (const char* text : {"", "{", "[1,]", "{\"a\": NaN}", "{\"a\": 1e999}", "{\"a\": 01}", "\xff"}) {
    const auto document = JsonDocument::Parse(text, "f");
    ASSERT_FALSE(document.ok()) << text;
    EXPECT_EQ(document.error().code, ErrorCode::kJsonSyntax) << text;
  }
}

// the parser alone would keep the last of them without a word
TEST(JsonDocument, RefusesAFieldThatAnObjectGivesTwice) {
  const auto text_of = [](const char* text) {
    const auto document = JsonDocument::Parse(text, "f");
    return document.ok() ? std::string() : document.error().Text();
  };
  EXPECT_THAT(text_of(R"({"a": 1, "b": 2, "a": 1})"), HasSubstr("E-IO-004 f: the field a is given twice"));
  EXPECT_THAT(text_of(R"({"settings": {"tolerance": 1, "tolerance": 0}})"), HasSubstr("settings.tolerance"));
  EXPECT_THAT(text_of(R"({"list": [{"x": 1}, {"x": 1, "y": {"x": 1}, "x": 2}]})"), HasSubstr("list.x"));
  EXPECT_THAT(text_of(R"({"a": 1, "\u0061": 2})"), HasSubstr("the field a is given twice"))
      << "written otherwise";
  EXPECT_EQ(text_of(R"({"a": {"a": {"a": 1}}, "b": [{"a": 1}, {"a": 2}]})"), "")
      << "the control: other objects";
}

TEST(JsonDocument, RefusesEveryTruncationOfAGoodText) {
  const std::string text = R"({"a": [1, {"b": "c\"d"}], "e": 2})";
  for (std::size_t length = 0; length < text.size(); ++length) {
    EXPECT_FALSE(JsonDocument::Parse(text.substr(0, length), "f").ok()) << length;
  }
}

TEST(JsonDocument, RefusesAMillionLevelsWithoutFallingOver) {
  EXPECT_EQ(JsonDocument::Parse(std::string(1'000'000, '['), "f").error().code, ErrorCode::kJsonSyntax);
}

}  // namespace
}  // namespace trocar::core
