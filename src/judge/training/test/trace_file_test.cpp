// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/trace_file.h"

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "attempt_traces.h"

namespace trocar::training {
namespace {

/// Everything in it differs from its default.
AttemptTrace MakeFullTrace() {
  AttemptTrace trace = MakeTrace(
      0.1,
      [](double t) {
        ToolSample s = TipAt({t, 0.1 / 3, -t});
        s.axis = {0, 0.6, -0.8};
        s.insertion = 0.1 + t, s.spin = -t, s.jaw = 0.2, s.force = 1.5, s.press = 1e-4,
        s.duct_distance = 0.02;
        s.tool = 1, s.organ = 0;
        s.in_view = t < 0.05;
        s.grasping = s.in_contact = s.touching_tool = s.pedal = s.has_current = t > 0.03;
        return s;
      },
      [](double t) {
        return TipAt({0, t, 0});
      });
  for (std::size_t i = 0; i < trace.Ticks(); ++i)
    trace.camera.push_back({{0.001 * static_cast<double>(i), 0, 0}, {0, 1, 0}, 0.1});
  trace.organ_names = {"liver", "cystic_duct"};
  trace.events.resize(2);
  trace.events[0] = {0.05,  "grasp", 1, 1, 2.5, math::Vec3{1, 2, 3}, false, surgery::Severity::kMinor,
                     false, ""};
  trace.events[1] = {0.06, "wire_touched",    -1, -1, 0.0, {}, true, surgery::Severity::kMajor,
                     true, "The ring touched"};
  trace.facts = {{"current_into", 1, "bed_strand", 0.02, 0.05, 0.0}, {"rinse", 0, "", 0.05, 0.1, 2e-6}};
  trace.phases = {{"Preparation", 0, 0.05}, {"ClippingCutting", 0.05, 0.1}};
  trace.clips = {{0.05, 1, "cystic_duct", false, true, 0.003, 1.2}, {0.06, 0, "", true, false, {}, {}}};
  trace.fluids = {{0, 0, 0}, {0.1, 1e-6, 2e-6}};
  trace.goals = {{"clip", 0.05, 10}, {"cut", {}, 5}};
  trace.stones_lost = 1, trace.stones_spilled = 2;
  trace.critical_view_time = 0.07;
  trace.is_operation = true;
  trace.outcome = {"completed", true, 88.5, 0.1};
  return trace;
}

TEST(TraceFile, KeepsEverything) {
  const AttemptTrace trace = MakeFullTrace();
  const std::string text = FormatTraceJson(trace);
  const auto read = ParseTraceJson(text, "trace");
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(FormatTraceJson(*read), text);
  EXPECT_EQ(read->hands[0][4].tip, trace.hands[0][4].tip) << "to the last bit";
  EXPECT_EQ(read->hands[0][8].in_view, false);
  EXPECT_EQ(read->hands[0][8].tool, 1);
  EXPECT_EQ(read->camera.back().lens, trace.camera.back().lens);
  EXPECT_EQ(read->events[0].position, trace.events[0].position);
  EXPECT_TRUE(read->events[1].is_rule);
  ASSERT_EQ(read->facts.size(), 2u);
  EXPECT_EQ(read->facts[0].part, "bed_strand");
  EXPECT_EQ(read->facts[1].amount, 2e-6);
  EXPECT_EQ(read->clips[0].angle, trace.clips[0].angle);
  EXPECT_EQ(read->goals[1].time, std::nullopt);
  EXPECT_EQ(read->outcome.score, trace.outcome.score);
  EXPECT_EQ(Measure(*read).values, Measure(trace).values);
}

TEST(TraceFile, RefusesWhatIsNoTrace) {
  using Json = nlohmann::json;
  const Json good = Json::parse(FormatTraceJson(MakeFullTrace()));
  const std::function<void(Json&)> spoils[] = {
      [](Json& j) { j["format"] = "trocar-scene"; },
      [](Json& j) { j["version"] = 2; },
      [](Json& j) { j["dt"] = 0; },
      [](Json& j) { j["ticks"] = 5; },
      [](Json& j) { j["ticks"] = -1; },
      [](Json& j) { j["hands"].erase("left"); },
      [](Json& j) { j["hands"]["left"]["tip"][3] = "far"; },
      [](Json& j) { j["hands"]["left"]["tool"][3] = 9; },
      [](Json& j) { j["hands"]["left"]["speed"] = 1; },
      [](Json& j) { j["events"][0].erase("kind"); },
      [](Json& j) { j["events"][1]["severity"] = "awful"; },
      [](Json& j) { j["facts"][0].erase("kind"); },
      [](Json& j) { j["facts"][1]["start"] = -1; },
      [](Json& j) { j["clips"][0]["angle"] = 7; },
      [](Json& j) { j["goals"][0].erase("name"); },
      [](Json& j) { j["fluids"][0]["blood"] = -1; },
      [](Json& j) { j["remark"] = "?"; },
  };
  for (const auto& spoil : spoils) {
    Json bad = good;
    spoil(bad);
    const auto read = ParseTraceJson(bad.dump(), "trace");
    ASSERT_FALSE(read.ok()) << bad.dump().substr(0, 200);
    EXPECT_EQ(read.error().code, base::ErrorCode::kJsonField);
  }
  const std::string text = good.dump();
  for (std::size_t length = 0; length < text.size(); length += 97)
    EXPECT_FALSE(ParseTraceJson(text.substr(0, length), "trace").ok());
}

// two hours of samples are more than two gigabytes: some hundred bytes must not ask for them
TEST(TraceFile, RefusesMoreTicksThanItsColumnsHave) {
  const auto read = [](int ticks) {
    nlohmann::json json = nlohmann::json::parse(FormatTraceJson(MakeFullTrace()));
    json["ticks"] = ticks;
    json["hands"] = {{"left", nlohmann::json::object()}, {"right", nlohmann::json::object()}};
    json["camera"] = nlohmann::json::object();
    return ParseTraceJson(json.dump(), "trace");
  };
  ASSERT_FALSE(read(7'200'000).ok());
  EXPECT_NE(read(7'200'000).error().message.find("7200000 ticks, but no column is that long"),
            std::string::npos);
  EXPECT_EQ(read(100).value().Ticks(), 100u)
      << "the control: columns that hold nothing but defaults are left out";
}

TEST(TraceFile, WritesATableWithALineForEachTick) {
  const AttemptTrace trace = MakeFullTrace();
  const std::string text = FormatTraceCsv(trace);
  EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')), trace.Ticks() + 1);
  const auto columns = [&](std::size_t from) {
    const std::string line = text.substr(from, text.find('\n', from) - from);
    return std::count(line.begin(), line.end(), ',');
  };
  const std::size_t second = text.find('\n') + 1;
  EXPECT_EQ(columns(0), columns(second));
  EXPECT_NE(text.find("left_tip_x_m"), std::string::npos);
  EXPECT_NE(text.find(",hook,liver,"), std::string::npos);
}

}  // namespace
}  // namespace trocar::training
