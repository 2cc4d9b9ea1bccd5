// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "trocar/host/printable.h"

namespace trocar::host {
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
  const base::Status status = document->Check();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, base::ErrorCode::kJsonField);
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
    EXPECT_EQ(document.error().code, base::ErrorCode::kJsonSyntax) << text;
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
  EXPECT_THAT(text_of(R"({"list": [{"x": 1}, {"x": 1, "y": {"x": 1}, "x": 2}]})"), HasSubstr("list[1].x"));
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
  const std::string deep(1'000'000, '[');
  const base::Error error = JsonDocument::Parse(deep, "f").error();
  EXPECT_EQ(error.code, base::ErrorCode::kFileTooLarge);
  EXPECT_THAT(error.message, HasSubstr("nested deeper than 64 levels"));
  EXPECT_LT(error.message.size(), 400u) << "its path has a million places";
}

template <class Json>
std::string FailureOf(std::string_view text, const JsonLimits& limits = {}) {
  const auto json = ParseJson<Json>(text, "f", limits);
  return json.ok() ? std::string() : json.error().Text();
}

template <class Json>
class ParsedJson : public testing::Test {};
using BothKinds = testing::Types<nlohmann::json, nlohmann::ordered_json>;
TYPED_TEST_SUITE(ParsedJson, BothKinds);

TYPED_TEST(ParsedJson, IsWhatTheLibraryReads) {
  const std::string text = R"({"b": [1, -2, 2.5e3, 18446744073709551615, true, null, {"x": "é\n"}, [], {}],
                              "a": {"c": {"d": []}, "c2": -0.0}, "": ""})";
  const auto json = ParseJson<TypeParam>(text, "f");
  ASSERT_TRUE(json.ok()) << json.error().Text();
  EXPECT_EQ(*json, TypeParam::parse(text));
  EXPECT_EQ(json->dump(), TypeParam::parse(text).dump()) << "the order of the fields, too";
  for (const char* single : {"1", "\"a\"", "null", " [ ] "}) {
    EXPECT_EQ(*ParseJson<TypeParam>(single, "f"), TypeParam::parse(single));
  }
  EXPECT_EQ(*ParseJson<TypeParam>("\xEF\xBB\xBF[1]", "f"), TypeParam::parse("[1]"))
      << "as Windows' editors begin";
}

TYPED_TEST(ParsedJson, KeepsEachLimitToTheUnit) {
  const JsonLimits limits{60, 3, 8, 2, 5};
  const auto failure = [&](std::string_view text) { return FailureOf<TypeParam>(text, limits); };
  EXPECT_EQ(failure("[[[1]]]"), "");
  EXPECT_EQ(failure("[[[[]]]]"), "E-IO-007 f: at [0][0][0]: nested deeper than 3 levels");
  EXPECT_EQ(failure("[1,2,3,4,5,6,7]"), "");
  EXPECT_EQ(failure("[1,2,3,4,5,6,7,8]"), "E-IO-007 f: at [7]: more than 8 values");
  EXPECT_EQ(failure(R"({"a":1,"b":2})"), "");
  EXPECT_EQ(failure(R"([{"a":1,"b":2,"c":3}])"), "E-IO-007 f: at [0].b: an object of more than 2 fields");
  EXPECT_EQ(failure(R"({"abcde":"abcde"})"), "");
  EXPECT_EQ(failure(R"({"a":"abcdef"})"), "E-IO-007 f: at a: a text of more than 5 bytes");
  EXPECT_EQ(failure(R"({"abcdef":1})"), "E-IO-007 f: at the top: a text of more than 5 bytes");
  EXPECT_EQ(failure("[" + std::string(58, ' ') + "]"), "");
  EXPECT_THAT(failure("[" + std::string(59, ' ') + "]"), HasSubstr("E-IO-007 f: longer than 60 bytes"));
}

TYPED_TEST(ParsedJson, RefusesNumbersThatNoVariableHolds) {
  EXPECT_EQ(FailureOf<TypeParam>("[1, 18446744073709551616]"),
            "E-IO-004 f: at [1]: the whole number 18446744073709551616 does not fit into 64 bits; write "
            "it with a "
            "decimal point");
  EXPECT_EQ(FailureOf<TypeParam>("[18446744073709551616.0]"), "") << "the control";
  EXPECT_THAT(FailureOf<TypeParam>(R"({"a": 1e999})"),
              HasSubstr("E-IO-004 f: at a: the number 1e999 is beyond"));
  EXPECT_THAT(FailureOf<TypeParam>("[1, 2, -1e999]"), HasSubstr("at [2]: the number -1e999 is beyond"));
  EXPECT_THAT(FailureOf<TypeParam>("0." + std::string(200, '1')), HasSubstr("E-IO-007"));
  for (const char* text : {"NaN", "Infinity", "-Infinity", "+1", "1.", ".5", "0x10", "--1", "1e", "01"})
    EXPECT_THAT(FailureOf<TypeParam>(text), HasSubstr("E-IO-004 f: not valid JSON: line 1, column")) << text;
}

TYPED_TEST(ParsedJson, RefusesTextsThatAreNone) {
  const std::string zero("[1]\0[2]", 7);
  EXPECT_THAT(FailureOf<TypeParam>(zero), HasSubstr("zero byte")) << "the library ends there";
  EXPECT_THAT(FailureOf<TypeParam>(R"(["a\u0000b"])"), HasSubstr("U+0000"));
  EXPECT_THAT(FailureOf<TypeParam>(R"({"a\u0000b": 1})"), HasSubstr("U+0000"));
  for (const char* text :
       {"\"\xff\"", "\"\xc0\xaf\"", "\"\xed\xa0\x80\"", "\"\xf5\x80\x80\x80\"", "\"\xe2\x82\"", R"("\ud800")",
        R"("\udc00\ud800")", "\"\n\"", "\"\x1b[2J\"", "[1] 2", "[1],", "{\"a\" 1}", "{a: 1}", "{'a': 1}",
        "[1 /* 2 */]", "\xFE\xFF[", "\xEF\xBB[1]"}) {
    const std::string failure = FailureOf<TypeParam>(text);
    EXPECT_THAT(failure, HasSubstr("E-IO-004 f: not valid JSON: line ")) << text;
    EXPECT_EQ(failure, "E-IO-004 " + Printable(failure.substr(9), 1000)) << "fit for a terminal";
  }
}

TYPED_TEST(ParsedJson, FindsTheSecondOfManyFieldsAtOnce) {
  std::string text = "{";
  for (int i = 0; i < 20'000; ++i) text += "\"" + std::to_string(i) + "\": 0,";
  EXPECT_EQ(FailureOf<TypeParam>(text + "\"x\": 0}"), "");
  for (const char* twice : {"0", "14", "15", "16", "17", "19999"})
    EXPECT_EQ(
        FailureOf<TypeParam>(text + "\"" + twice + "\": 0}"),
        "E-IO-004 f: the field " + std::string(twice) + " is given twice in one object; keep one of them");
}

TYPED_TEST(ParsedJson, MessagesOfLongTextsAreShort) {
  for (const std::string& text :
       {"\"" + std::string(100'000, 'a'), std::string(100'000, '1'), "[" + std::string(100'000, 'x'),
        "{\"" + std::string(1000, 'k') + "\": 1e999}"}) {
    const std::string failure = FailureOf<TypeParam>(text);
    EXPECT_LT(failure.size(), 400u);
    EXPECT_GT(failure.size(), 20u);
  }
}

/// Writes down what comes.
class Listener : public nlohmann::json_sax<nlohmann::json> {
 public:
  bool null() override { return Add("null"); }
  bool boolean(bool value) override { return Add(value ? "true" : "false"); }
  bool number_integer(number_integer_t value) override { return Add(std::to_string(value)); }
  bool number_unsigned(number_unsigned_t value) override { return Add(std::to_string(value)); }
  bool number_float(number_float_t, const string_t& text) override { return Add(text); }
  bool string(string_t& text) override { return Add('"' + text); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return Add("{"); }
  bool key(string_t& name) override { return Add(name + ':'); }
  bool end_object() override { return Add("}"); }
  bool start_array(std::size_t) override { return Add("["); }
  bool end_array() override { return Add("]"); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

  std::string heard;
  std::string last = "none";

 private:
  bool Add(const std::string& what) {
    heard += what + ' ';
    return what != last;
  }
};

std::string ListenTo(const std::string& text, Listener& listener, const JsonLimits& limits = {}) {
  std::istringstream stream(text);
  const base::Status heard =
      ParseJsonEvents<nlohmann::json_sax<nlohmann::json>>(stream, "f", listener, limits);
  return heard.ok() ? std::string() : heard.error().Text();
}

TEST(JsonEvents, OfAStreamComeInOrder) {
  Listener listener;
  EXPECT_EQ(ListenTo(R"({"a": [1, -2, 2.5, "x", true, null], "b": {}})", listener), "");
  EXPECT_EQ(listener.heard, "{ a: [ 1 -2 2.5 \"x true null ] b: { } } ");
  Listener stopping;
  stopping.last = "1";
  EXPECT_EQ(ListenTo("[1, 2]", stopping), "") << "it knows itself why";
  EXPECT_EQ(stopping.heard, "[ 1 ");
}

TEST(JsonEvents, OfAStreamKeepTheLimits) {
  const auto failure = [](const std::string& text, const JsonLimits& limits = {}) {
    Listener listener;
    return ListenTo(text, listener, limits);
  };
  EXPECT_THAT(failure(std::string(100'000, '[')), HasSubstr("E-IO-007 f: at"));
  EXPECT_THAT(failure(R"({"a": 1, "a": 2})"), HasSubstr("the field a is given twice"));
  EXPECT_THAT(failure(std::string("[1]\0", 4)), HasSubstr("zero byte"));
  EXPECT_THAT(failure("[1"), HasSubstr("E-IO-004 f: not valid JSON: line 1, column 3"));
  JsonLimits limits;
  limits.text = 1000;
  EXPECT_EQ(failure("[\"" + std::string(1000, 'a') + "\"]", limits), "");
  EXPECT_THAT(failure("[\"" + std::string(1001, 'a') + "\"]", limits),
              HasSubstr("a text of more than 1000 bytes"));
  EXPECT_THAT(failure("[\"" + std::string(100'000, 'a'), limits), HasSubstr("E-IO-007 f: longer than"))
      << "before it is gathered";
  EXPECT_THAT(failure("[" + std::string(100'000, ' ') + "]", limits), HasSubstr("E-IO-007"));
  std::string many = "[0";
  for (int i = 0; i < 20'000; ++i) many += ",100000000";
  limits.bytes = 0;
  EXPECT_EQ(failure(many + "]", limits), "") << "any number of short ones";
  limits.bytes = 1000;
  EXPECT_THAT(failure(many + "]", limits), HasSubstr("E-IO-007 f: longer than 1000 bytes"));
}

}  // namespace
}  // namespace trocar::host
