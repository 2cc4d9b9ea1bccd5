// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/trace_file.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "trocar/base/to_integer.h"
#include "trocar/host/json.h"

namespace trocar::training {

using math::Vec3;

namespace {

using host::JsonView;
using nlohmann::ordered_json;

constexpr const char* kFormat = "trocar-trace";
constexpr int kVersion = 1;
constexpr const char* kHandNames[] = {"left", "right"};
/// Two hours at some 500 Hz; the same as text of columns may be longer.
constexpr host::JsonLimits kLimits{std::size_t{2} << 30, 16, 100'000'000, 1000, 1u << 20};
constexpr host::NumberRange kNotNegative{0.0, 1e300};
constexpr host::NumberRange kLength{1e-9, 1e300};

struct NumberColumn {
  const char* name;
  double ToolSample::*member;
};
constexpr NumberColumn kNumbers[] = {{"insertion", &ToolSample::insertion},
                                     {"spin", &ToolSample::spin},
                                     {"jaw", &ToolSample::jaw},
                                     {"force", &ToolSample::force},
                                     {"press", &ToolSample::press},
                                     {"duct_distance", &ToolSample::duct_distance}};
struct IndexColumn {
  const char* name;
  std::int16_t ToolSample::*member;
};
constexpr IndexColumn kIndices[] = {{"tool", &ToolSample::tool}, {"organ", &ToolSample::organ}};
struct FlagColumn {
  const char* name;
  bool ToolSample::*member;
};
constexpr FlagColumn kFlags[] = {
    {"in_view", &ToolSample::in_view},       {"grasping", &ToolSample::grasping},
    {"in_contact", &ToolSample::in_contact}, {"touching_tool", &ToolSample::touching_tool},
    {"pedal", &ToolSample::pedal},           {"has_current", &ToolSample::has_current}};

// --- writing

ordered_json VectorJson(const Vec3& v) {
  return {v.x, v.y, v.z};
}

void WriteOptional(ordered_json& object, const char* name, const std::optional<double>& value) {
  if (value) object[name] = *value;
}

/// A column, unless every value is the default.
template <typename Sample, typename Get>
void WriteColumn(ordered_json& object, const char* name, const std::vector<Sample>& samples, Get&& get) {
  const ordered_json usual = get(Sample{});
  ordered_json column = ordered_json::array();
  bool is_usual = true;
  for (const Sample& sample : samples) {
    column.push_back(get(sample));
    is_usual = is_usual && column.back() == usual;
  }
  if (!is_usual) object[name] = std::move(column);
}

ordered_json HandJson(const std::vector<ToolSample>& samples) {
  ordered_json hand = ordered_json::object();
  WriteColumn(hand, "tip", samples, [](const ToolSample& s) { return VectorJson(s.tip); });
  WriteColumn(hand, "axis", samples, [](const ToolSample& s) { return VectorJson(s.axis); });
  for (const auto& column : kNumbers)
    WriteColumn(hand, column.name, samples,
                [&](const ToolSample& s) { return ordered_json(s.*column.member); });
  for (const auto& column : kIndices)
    WriteColumn(hand, column.name, samples,
                [&](const ToolSample& s) { return ordered_json(s.*column.member); });
  for (const auto& column : kFlags)
    WriteColumn(hand, column.name, samples,
                [&](const ToolSample& s) { return ordered_json(s.*column.member ? 1 : 0); });
  return hand;
}

ordered_json EventsJson(const AttemptTrace& trace) {
  ordered_json list = ordered_json::array();
  for (const AttemptEvent& event : trace.events) {
    ordered_json entry = {
        {"time", event.time}, {"kind", event.kind}, {"hand", event.hand}, {"organ", event.organ}};
    if (event.force != 0.0) entry["force"] = event.force;
    if (event.position) entry["position"] = VectorJson(*event.position);
    if (event.is_error) {
      entry["severity"] = surgery::NameOf(event.severity);
      entry["is_rule"] = event.is_rule;
    }
    if (!event.text.empty()) entry["text"] = event.text;
    list.push_back(std::move(entry));
  }
  return list;
}

ordered_json FactsJson(const AttemptTrace& trace) {
  ordered_json list = ordered_json::array();
  for (const FactSpan& span : trace.facts) {
    ordered_json entry = {{"kind", span.kind}, {"hand", span.hand}, {"start", span.start}, {"end", span.end}};
    if (!span.part.empty()) entry["part"] = span.part;
    if (span.amount != 0.0) entry["amount"] = span.amount;
    list.push_back(std::move(entry));
  }
  return list;
}

ordered_json EndJson(const AttemptTrace& trace) {
  ordered_json json = {{"stones_spilled", trace.stones_spilled},
                       {"stones_lost", trace.stones_lost},
                       {"is_operation", trace.is_operation}};
  WriteOptional(json, "critical_view_time", trace.critical_view_time);
  const AttemptOutcome& outcome = trace.outcome;
  json["outcome"] = {
      {"phase", outcome.phase}, {"is_completed", outcome.is_completed}, {"task_time", outcome.task_time}};
  WriteOptional(json["outcome"], "score", outcome.score);
  if (outcome.penalty > 0.0) json["outcome"]["penalty"] = outcome.penalty;
  for (std::size_t hand = 0; hand < trace.ideal_path.size(); ++hand) {
    if (trace.ideal_path[hand]) json["ideal_path"][kHandNames[hand]] = *trace.ideal_path[hand];
  }
  return json;
}

// --- reading

Vec3 ReadVector(const JsonView& view) {
  const std::vector<double> x = view.AsNumbers(3);
  return {x[0], x[1], x[2]};
}

/// Elements of a column that is there; complains where there are not as many as ticks.
template <typename Read>
void ReadColumn(const JsonView& object, const char* name, std::size_t ticks, Read&& read) {
  if (!object.Has(name)) return;
  const std::vector<JsonView> elements = object.Array(name);
  if (elements.size() != ticks) {
    object.Complain(std::string(name) + " has " + std::to_string(elements.size()) +
                    " values, but there are " + std::to_string(ticks) + " ticks");
    return;
  }
  for (std::size_t i = 0; i < ticks; ++i) read(i, elements[i]);
}

std::vector<ToolSample> ReadHand(const JsonView& view, std::size_t ticks, std::size_t tools,
                                 std::size_t organs) {
  view.AllowOnly({"tip", "axis", "insertion", "spin", "jaw", "force", "press", "duct_distance", "tool",
                  "organ", "in_view", "grasping", "in_contact", "touching_tool", "pedal", "has_current"});
  std::vector<ToolSample> hand(ticks);
  ReadColumn(view, "tip", ticks, [&](std::size_t i, const JsonView& v) { hand[i].tip = ReadVector(v); });
  ReadColumn(view, "axis", ticks, [&](std::size_t i, const JsonView& v) { hand[i].axis = ReadVector(v); });
  for (const auto& column : kNumbers) {
    ReadColumn(view, column.name, ticks,
               [&](std::size_t i, const JsonView& v) { hand[i].*column.member = v.AsNumber(); });
  }
  for (const auto& column : kIndices) {
    const bool is_tool = column.member == &ToolSample::tool;
    const host::NumberRange range{is_tool ? 0.0 : -1.0, static_cast<double>(is_tool ? tools : organs) - 1.0};
    ReadColumn(view, column.name, ticks, [&](std::size_t i, const JsonView& v) {
      hand[i].*column.member = base::TruncateTo<std::int16_t>(v.AsNumber(range));
    });
  }
  for (const auto& column : kFlags) {
    ReadColumn(view, column.name, ticks, [&](std::size_t i, const JsonView& v) {
      hand[i].*column.member = v.AsNumber({0, 1}) != 0.0;
    });
  }
  return hand;
}

surgery::Severity ReadSeverity(const JsonView& view) {
  const std::string text = view.Text("severity");
  for (const surgery::Severity severity :
       {surgery::Severity::kMinor, surgery::Severity::kMajor, surgery::Severity::kCritical}) {
    if (text == surgery::NameOf(severity)) return severity;
  }
  view.Complain("severity must be minor, major or critical");
  return surgery::Severity::kMinor;
}

int ReadHandIndex(const JsonView& view) {
  return view.IntegerOr("hand", -1, {-1, instrument::kHandCount - 1});
}

AttemptEvent ReadEvent(const JsonView& view, std::size_t organs) {
  view.AllowOnly({"time", "kind", "hand", "organ", "force", "position", "severity", "is_rule", "text"});
  AttemptEvent event;
  event.time = view.Number("time", kNotNegative);
  event.kind = view.Text("kind");
  event.hand = ReadHandIndex(view);
  event.organ = view.IntegerOr("organ", -1, {-1, static_cast<double>(organs) - 1.0});
  event.force = view.NumberOr("force", 0.0);
  if (view.Has("position")) {
    const std::vector<double> x = view.Numbers("position", 3);
    event.position = Vec3{x[0], x[1], x[2]};
  }
  event.is_error = view.Has("severity");
  if (event.is_error) event.severity = ReadSeverity(view);
  event.is_rule = view.BooleanOr("is_rule", false);
  event.text = view.TextOr("text", "");
  return event;
}

FactSpan ReadFact(const JsonView& view) {
  view.AllowOnly({"kind", "hand", "start", "end", "part", "amount"});
  return {view.Text("kind"),
          ReadHandIndex(view),
          view.TextOr("part", ""),
          view.Number("start", kNotNegative),
          view.Number("end", kNotNegative),
          view.NumberOr("amount", 0.0)};
}

ClipRecord ReadClip(const JsonView& view) {
  view.AllowOnly({"time", "hand", "vessel", "is_lost", "is_misplaced", "gap", "angle"});
  ClipRecord clip;
  clip.time = view.Number("time", kNotNegative);
  clip.hand = ReadHandIndex(view);
  clip.vessel = view.TextOr("vessel", "");
  clip.is_lost = view.BooleanOr("is_lost", false);
  clip.is_misplaced = view.BooleanOr("is_misplaced", false);
  if (view.Has("gap")) clip.gap = view.Number("gap", kNotNegative);
  if (view.Has("angle")) clip.angle = view.Number("angle", {0.0, 1.5707963267948968});
  return clip;
}

std::vector<std::string> ReadNames(const JsonView& root, const char* key) {
  std::vector<std::string> names;
  if (!root.Has(key)) return names;
  for (const JsonView& name : root.Array(key)) names.push_back(name.AsText());
  return names;
}

void ReadHappenings(const JsonView& root, AttemptTrace& trace) {
  const auto list = [&](const char* key) {
    return root.Has(key) ? root.Array(key) : std::vector<JsonView>();
  };
  for (const JsonView& view : list("events"))
    trace.events.push_back(ReadEvent(view, trace.organ_names.size()));
  for (const JsonView& view : list("facts")) trace.facts.push_back(ReadFact(view));
  for (const JsonView& view : list("phases")) {
    view.AllowOnly({"name", "start", "end"});
    trace.phases.push_back(
        {view.Text("name"), view.Number("start", kNotNegative), view.Number("end", kNotNegative)});
  }
  for (const JsonView& view : list("clips")) trace.clips.push_back(ReadClip(view));
  for (const JsonView& view : list("fluids")) {
    view.AllowOnly({"time", "blood", "bile"});
    trace.fluids.push_back({view.Number("time", kNotNegative), view.Number("blood", kNotNegative),
                            view.Number("bile", kNotNegative)});
  }
  for (const JsonView& view : list("goals")) {
    view.AllowOnly({"name", "time", "points"});
    GoalRecord goal{view.Text("name"), std::nullopt, view.NumberOr("points", 0.0)};
    if (view.Has("time")) goal.time = view.Number("time", kNotNegative);
    trace.goals.push_back(std::move(goal));
  }
}

void ReadOutcome(const JsonView& root, AttemptTrace& trace) {
  trace.stones_spilled = root.IntegerOr("stones_spilled", 0, {0, 1e6});
  trace.stones_lost = root.IntegerOr("stones_lost", 0, {0, 1e6});
  if (root.Has("critical_view_time"))
    trace.critical_view_time = root.Number("critical_view_time", kNotNegative);
  trace.is_operation = root.BooleanOr("is_operation", false);
  if (root.Has("ideal_path")) {
    const JsonView view = root.Object("ideal_path");
    view.AllowOnly({"left", "right"});
    for (std::size_t hand = 0; hand < trace.ideal_path.size(); ++hand) {
      if (view.Has(kHandNames[hand])) trace.ideal_path[hand] = view.Number(kHandNames[hand], kLength);
    }
  }
  if (!root.Has("outcome")) return;
  const JsonView view = root.Object("outcome");
  view.AllowOnly({"phase", "is_completed", "score", "task_time", "penalty"});
  trace.outcome.phase = view.TextOr("phase", "");
  trace.outcome.is_completed = view.BooleanOr("is_completed", false);
  if (view.Has("score")) trace.outcome.score = view.Number("score");
  trace.outcome.task_time = view.NumberOr("task_time", 0.0, kNotNegative);
  trace.outcome.penalty = view.NumberOr("penalty", 0.0, kNotNegative);
}

// --- CSV

void AppendNumber(std::string& line, double value) {
  line += "," + ordered_json(value).dump();
}
void AppendVector(std::string& line, const Vec3& v) {
  for (int axis = 0; axis < 3; ++axis) AppendNumber(line, v[axis]);
}

std::string CsvHeading() {
  std::string heading = "time_s";
  for (const char* hand : kHandNames) {
    for (const char* column :
         {"tip_x_m", "tip_y_m", "tip_z_m", "axis_x", "axis_y", "axis_z", "insertion_m", "spin_rad", "jaw_rad",
          "force_n", "press_m", "duct_distance_m", "tool", "organ"})
      heading += "," + std::string(hand) + "_" + column;
    for (const FlagColumn& column : kFlags) heading += "," + std::string(hand) + "_" + column.name;
  }
  return heading + ",lens_x_m,lens_y_m,lens_z_m,direction_x,direction_y,direction_z,roll_rad\n";
}

/// Names in a table: a comma or a quotation mark would break it.
std::string PlainName(const std::vector<std::string>& names, int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= names.size()) return "";
  std::string name = names[static_cast<std::size_t>(index)];
  for (char& c : name) {
    if (c == ',' || c == '"' || c == '\n' || c == '\r') c = ' ';
  }
  return name;
}

}  // namespace

std::string FormatTraceJson(const AttemptTrace& trace) {
  ordered_json json = {{"format", kFormat},
                       {"version", kVersion},
                       {"dt", trace.dt},
                       {"ticks", trace.Ticks()},
                       {"tool_names", trace.tool_names},
                       {"organ_names", trace.organ_names}};
  for (std::size_t hand = 0; hand < trace.hands.size(); ++hand)
    json["hands"][kHandNames[hand]] = HandJson(trace.hands[hand]);
  json["camera"] = ordered_json::object();
  if (!trace.camera.empty()) {
    // the lens stands there even where it never moved: without it there is no camera
    ordered_json& lens = json["camera"]["lens"];
    for (const CameraSample& sample : trace.camera) lens.push_back(VectorJson(sample.lens));
    WriteColumn(json["camera"], "direction", trace.camera,
                [](const CameraSample& s) { return VectorJson(s.direction); });
    WriteColumn(json["camera"], "roll", trace.camera,
                [](const CameraSample& s) { return ordered_json(s.roll); });
  }
  json["events"] = EventsJson(trace);
  if (!trace.facts.empty()) json["facts"] = FactsJson(trace);
  for (const PhaseSpan& span : trace.phases)
    json["phases"].push_back({{"name", span.name}, {"start", span.start}, {"end", span.end}});
  for (const ClipRecord& clip : trace.clips) {
    ordered_json entry = {{"time", clip.time},
                          {"hand", clip.hand},
                          {"vessel", clip.vessel},
                          {"is_lost", clip.is_lost},
                          {"is_misplaced", clip.is_misplaced}};
    WriteOptional(entry, "gap", clip.gap);
    WriteOptional(entry, "angle", clip.angle);
    json["clips"].push_back(std::move(entry));
  }
  for (const FluidSample& f : trace.fluids)
    json["fluids"].push_back({{"time", f.time}, {"blood", f.blood}, {"bile", f.bile}});
  for (const GoalRecord& goal : trace.goals) {
    ordered_json entry = {{"name", goal.name}, {"points", goal.points}};
    WriteOptional(entry, "time", goal.time);
    json["goals"].push_back(std::move(entry));
  }
  json.update(EndJson(trace));
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

base::Result<AttemptTrace> ParseTraceJson(std::string_view text, const std::string& name) {
  auto document = host::JsonDocument::Parse(text, name, kLimits);
  if (!document.ok()) return document.error();
  const JsonView root = document->Root();
  AttemptTrace trace;
  if (root.Text("format") != kFormat || root.Integer("version") != kVersion)
    root.Complain("format must be \"trocar-trace\" and version 1");
  root.AllowOnly({"format",
                  "version",
                  "dt",
                  "ticks",
                  "tool_names",
                  "organ_names",
                  "hands",
                  "camera",
                  "events",
                  "facts",
                  "phases",
                  "clips",
                  "fluids",
                  "goals",
                  "stones_spilled",
                  "stones_lost",
                  "critical_view_time",
                  "is_operation",
                  "outcome",
                  "ideal_path"});
  trace.dt = root.Number("dt", {1e-6, 10.0});
  // two hours at 1 kHz
  const auto ticks = static_cast<std::size_t>(root.Integer("ticks", {0, 7.2e6}));
  // samples are made before their columns are read: a short text must not ask for gigabytes of them
  constexpr std::size_t kFewTicks = 10'000, kLeastBytes = 2;  // of a value in a column
  if (ticks > kFewTicks && ticks > text.size() / kLeastBytes)
    root.Complain("there are " + std::to_string(ticks) + " ticks, but no column is that long");
  trace.tool_names = ReadNames(root, "tool_names");
  trace.organ_names = ReadNames(root, "organ_names");
  const JsonView hands = root.Object("hands");
  for (std::size_t hand = 0; hand < trace.hands.size(); ++hand) {
    if (const auto status = document->Check(); !status.ok()) return status.error();
    trace.hands[hand] = ReadHand(hands.Object(kHandNames[hand]), ticks,
                                 std::max<std::size_t>(1, trace.tool_names.size()), trace.organ_names.size());
  }
  if (root.Has("camera") && !root.Object("camera").Keys().empty()) {
    const JsonView view = root.Object("camera");
    view.AllowOnly({"lens", "direction", "roll"});
    trace.camera.resize(ticks);
    ReadColumn(view, "lens", ticks,
               [&](std::size_t i, const JsonView& v) { trace.camera[i].lens = ReadVector(v); });
    ReadColumn(view, "direction", ticks,
               [&](std::size_t i, const JsonView& v) { trace.camera[i].direction = ReadVector(v); });
    ReadColumn(view, "roll", ticks,
               [&](std::size_t i, const JsonView& v) { trace.camera[i].roll = v.AsNumber(); });
  }
  ReadHappenings(root, trace);
  ReadOutcome(root, trace);
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return trace;
}

std::string FormatTraceCsv(const AttemptTrace& trace) {
  std::string text = CsvHeading();
  for (std::size_t i = 0; i < trace.Ticks(); ++i) {
    text += ordered_json(static_cast<double>(i) * trace.dt).dump();
    for (const auto& hand : trace.hands) {
      const ToolSample& s = hand[i];
      AppendVector(text, s.tip);
      AppendVector(text, s.axis);
      for (const NumberColumn& column : kNumbers) AppendNumber(text, s.*column.member);
      text += "," + PlainName(trace.tool_names, s.tool) + "," + PlainName(trace.organ_names, s.organ);
      for (const FlagColumn& column : kFlags) text += s.*column.member ? ",1" : ",0";
    }
    const CameraSample camera = i < trace.camera.size() ? trace.camera[i] : CameraSample{};
    AppendVector(text, camera.lens);
    AppendVector(text, camera.direction);
    AppendNumber(text, camera.roll);
    text += "\n";
  }
  return text;
}

}  // namespace trocar::training
