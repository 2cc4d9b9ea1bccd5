// SPDX-License-Identifier: Apache-2.0
#include "task_rules.h"

#include <algorithm>
#include <cmath>

#include "field_ranges.h"
#include "scene_objects.h"
#include "task_names.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/scene/event.h"
#include "trocar/scene/procedure.h"

namespace trocar::files {
namespace {

using base::ErrorCode;
using host::JsonView;

constexpr std::size_t kMaxRegions = 256, kMaxGoals = 256, kMaxErrors = 64;

class RulesReader {
 public:
  RulesReader(const scene::Scene& scene, scene::Task& task) : scene_(scene), task_(task) {}

  void ReadRegion(const JsonView& view) {
    view.AllowOnly(
        {"name", "about", "centre_mm", "at", "offset_mm", "radius_mm", "half_mm", "facing", "mark"});
    scene::Region region;
    region.name = view.Text("name");
    region.centre = ReadCentre(view);
    if (view.Has("radius_mm") == view.Has("half_mm")) {
      view.Complain("a region has either radius_mm (a ball) or half_mm (a box)", ErrorCode::kSceneInvalid);
    } else if (view.Has("radius_mm")) {
      region.radius = 0.001 * view.Number("radius_mm", range::kRegionMm);
    } else {
      region.half = ReadPointMm(view, "half_mm", range::kRegionMm);
    }
    if (view.Has("facing")) region.facing = ReadDirection(view, "facing");
    const std::string mark = view.TextOr("mark", "none");
    constexpr std::string_view kMarks[] = {"none", "ring", "cage", "ball", "band"};
    const auto* found = std::find(std::begin(kMarks), std::end(kMarks), mark);
    if (found == std::end(kMarks)) {
      view.Complain("there is no mark \"" + mark + "\"; known are none, ring, cage, ball and band",
                    ErrorCode::kUnknownName);
    } else {
      region.mark = static_cast<scene::RegionMark>(found - std::begin(kMarks));
    }
    task_.regions.push_back(std::move(region));
  }

  /// A point, or a landmark of the patient as it lies at rest.
  math::Vec3 ReadCentre(const JsonView& view) const {
    if (!view.Has("at")) return ReadPointMm(view, "centre_mm");
    if (view.Has("centre_mm"))
      view.Complain("a region lies at centre_mm or at a landmark, not both", ErrorCode::kSceneInvalid);
    const int landmark = FindName(view, scene_.patient.landmarks, view.Text("at"), "landmark");
    const math::Vec3 offset =
        view.Has("offset_mm") ? ReadPointMm(view, "offset_mm", range::kOffsetMm) : math::Vec3{};
    return landmark < 0 ? offset
                        : scene_.patient.landmarks[static_cast<std::size_t>(landmark)].position + offset;
  }

  /// What the laparoscope has to see, from where.
  void ReadView(const JsonView& view, const std::string& item, scene::Condition& c) const {
    c.regions = ReadRegions(view, item);
    c.angle = view.NumberOr("within_deg", 5.0, range::kWithinDeg) * math::kDegree;
    c.facing_angle = view.NumberOr("facing_deg", 180.0, range::kFacingDeg) * math::kDegree;
    c.near = 0.001 * view.NumberOr("near_mm", 0.0, range::kHeightMm);
    c.far = 0.001 * view.NumberOr("far_mm", 1000.0, range::kHeightMm);
    if (c.near >= c.far) view.Complain("near_mm must be below far_mm", ErrorCode::kSceneInvalid);
  }

  /// An event, and in or outside of which regions it counts.
  void ReadPlacedEvent(const JsonView& view, const std::string& item, scene::Condition& c) const {
    c.event = ReadEvent(view);
    if (view.Has("region") || view.Has("regions")) c.regions = ReadRegions(view, item);
    c.is_outside = view.BooleanOr("outside", false);
    if (!c.regions.empty() && c.event != static_cast<int>(surgery::FactKind::kClipClosed) &&
        c.event != static_cast<int>(surgery::FactKind::kTubeCut))
      view.Complain("only clip_closed and tube_cut have a place", ErrorCode::kSceneInvalid);
  }

  /// A sheet, and how far a cut may be off its line.
  void ReadCutSheet(const JsonView& view, const std::string& item, scene::Condition& c) const {
    c.sheet = FindName(view, scene_.model ? scene_.model->sheets : std::vector<scene::ModelSheet>(),
                       Fill(view.Text("sheet"), item), "sheet");
    if (c.kind == scene::ConditionKind::kCutOffLine)
      c.amount = 1e-3 * view.Number("distance_mm", range::kCutDistanceMm);
    if (c.kind == scene::ConditionKind::kCutAreaOff)
      c.amount = 1e-6 * view.Number("area_mm2", range::kCutAreaMm2);
  }

  scene::Condition ReadCondition(const JsonView& view, const std::string& item) const {
    view.AllowOnly({"kind",       "about",   "object",  "other",       "hand",    "from",    "to",
                    "region",     "regions", "seconds", "height_mm",   "fall_mm", "newtons", "within_deg",
                    "facing_deg", "near_mm", "far_mm",  "while_held",  "event",   "outside", "error",
                    "clips",      "band",    "sheet",   "distance_mm", "area_mm2"});
    scene::Condition c;
    const std::string kind = view.Text("kind");
    const auto known = FindKind(kind);
    if (!known) {
      std::string names;
      for (int i = 0; i < static_cast<int>(scene::ConditionKind::kCount); ++i)
        names +=
            (i == 0 ? "" : ", ") + std::string(scene::ConditionName(static_cast<scene::ConditionKind>(i)));
      view.Complain("there is no rule \"" + kind + "\"; known are " + names, ErrorCode::kUnknownName);
      return c;
    }
    c.kind = *known;
    c.seconds = view.NumberOr("seconds", 0.0, range::kSeconds);
    c.while_held = view.BooleanOr("while_held", false);
    if (IsOfTissue(c.kind) && !scene_.operation)
      view.Complain("\"" + kind + "\" needs tissue: give the scene a model, or an operation",
                    ErrorCode::kSceneInvalid);
    const auto object = [&] {
      c.object = FindName(view, scene_.objects, Fill(view.Text("object"), item), "object");
    };
    const auto hand = [&](const char* key) { return ReadHand(view, key); };
    switch (c.kind) {
      case scene::ConditionKind::kHeld:
        object(), c.hand = hand("hand");
        break;
      case scene::ConditionKind::kLifted:
        object(), c.hand = hand("hand");
        c.amount = 0.001 * view.Number("height_mm", range::kHeightMm);
        break;
      case scene::ConditionKind::kHandedOver:
        object(), c.hand = hand("from"), c.to = hand("to");
        c.seconds = view.NumberOr("seconds", 0.1, range::kSeconds);
        if (c.hand == c.to && c.hand != scene::kAnyHand)
          view.Complain("a thing is handed from one hand to the other: from and to must differ",
                        ErrorCode::kSceneInvalid);
        break;
      case scene::ConditionKind::kInRegion:
      case scene::ConditionKind::kPlaced:
      case scene::ConditionKind::kOutside:
        object(), c.regions = ReadRegions(view, item);
        break;
      case scene::ConditionKind::kTipInRegion:
        c.hand = hand("hand"), c.regions = ReadRegions(view, item);
        break;
      case scene::ConditionKind::kCameraSees:
        ReadView(view, item, c);
        break;
      case scene::ConditionKind::kTouches:
        object(), c.other = FindName(view, scene_.objects, Fill(view.Text("other"), item), "object");
        break;
      case scene::ConditionKind::kToolTouches:
        object(), c.hand = hand("hand");
        c.amount = view.NumberOr("newtons", 0.0, range::kNewtons);
        break;
      case scene::ConditionKind::kDropped:
        object(), c.amount = 0.001 * view.NumberOr("fall_mm", 10.0, range::kHeightMm);
        break;
      case scene::ConditionKind::kOutOfView:
        object();
        break;
      case scene::ConditionKind::kTipOutOfView:
        c.hand = hand("hand");
        break;
      case scene::ConditionKind::kForceAbove:
        c.hand = hand("hand"), c.amount = view.Number("newtons", range::kNewtons);
        break;
      case scene::ConditionKind::kEvent:
        c.hand = hand("hand");
        ReadPlacedEvent(view, item, c);
        break;
      case scene::ConditionKind::kOperationError:
        c.hand = hand("hand"), c.error = ReadOperationError(view);
        break;
      case scene::ConditionKind::kClipped:
      case scene::ConditionKind::kDivided:
        c.regions = ReadRegions(view, item);
        break;
      case scene::ConditionKind::kUnclippedCut:
        c.amount = view.Integer("clips", range::kClips);
        break;
      case scene::ConditionKind::kCutFree:
      case scene::ConditionKind::kCutOffLine:
      case scene::ConditionKind::kCutAreaOff:
        ReadCutSheet(view, item, c);
        break;
      case scene::ConditionKind::kParted:
        c.band = FindName(view, scene_.model ? scene_.model->bands : std::vector<scene::ModelBand>(),
                          Fill(view.Text("band"), item), "band");
        break;
      case scene::ConditionKind::kCount:
        break;
    }
    return c;
  }

  void ReadGoal(const JsonView& view) {
    view.AllowOnly({"name", "about", "for_each", "steps", "points", "stage"});
    for (const std::string& item : ReadItems(view)) {
      scene::Goal goal;
      goal.name = Fill(view.Text("name"), item);
      goal.points = view.NumberOr("points", 0.0, range::kPoints);
      goal.stage = view.IntegerOr("stage", 0, range::kStage);
      for (const JsonView& step : view.Array("steps")) goal.steps.push_back(ReadCondition(step, item));
      if (goal.steps.empty()) view.Complain("a goal needs at least one step", ErrorCode::kSceneInvalid);
      task_.goals.push_back(std::move(goal));
    }
  }

  void ReadError(const JsonView& view) {
    view.AllowOnly({"name", "about", "severity", "for_each", "when", "penalty", "ends_task"});
    scene::ErrorRule rule;
    rule.name = view.Text("name");
    rule.about = view.Text("about");
    const std::string severity = view.TextOr("severity", "minor");
    rule.severity = severity == "critical" ? surgery::Severity::kCritical
                    : severity == "major"  ? surgery::Severity::kMajor
                                           : surgery::Severity::kMinor;
    if (surgery::NameOf(rule.severity) != severity)
      view.Complain("severity is minor, major or critical", ErrorCode::kUnknownName);
    rule.penalty = view.NumberOr("penalty", 0.0, range::kPoints);
    rule.ends_task = view.BooleanOr("ends_task", false);
    for (const std::string& item : ReadItems(view))
      rule.when.push_back(ReadCondition(view.Object("when"), item));
    task_.errors.push_back(std::move(rule));
  }

 private:
  static std::optional<scene::ConditionKind> FindKind(std::string_view name) {
    for (int i = 0; i < static_cast<int>(scene::ConditionKind::kCount); ++i) {
      if (scene::ConditionName(static_cast<scene::ConditionKind>(i)) == name)
        return static_cast<scene::ConditionKind>(i);
    }
    return std::nullopt;
  }

  static bool IsOfTissue(scene::ConditionKind kind) {
    return kind >= scene::ConditionKind::kOperationError && kind < scene::ConditionKind::kCount;
  }

  static int ReadHand(const JsonView& view, const char* key) {
    const std::string name = view.TextOr(key, "any");
    if (name == "left") return instrument::kLeft;
    if (name == "right") return instrument::kRight;
    if (name != "any") view.Complain(std::string(key) + " is left, right or any", ErrorCode::kUnknownName);
    return scene::kAnyHand;
  }

  std::vector<int> ReadRegions(const JsonView& view, const std::string& item) const {
    std::vector<int> regions;
    if (view.Has("regions")) {
      for (const JsonView& one : view.Array("regions"))
        regions.push_back(FindName(one, task_.regions, Fill(one.AsText(), item), "region"));
    } else {
      regions.push_back(FindName(view, task_.regions, Fill(view.Text("region"), item), "region"));
    }
    return regions;
  }

  static int ReadEvent(const JsonView& view) {
    const std::string name = view.Text("event");
    std::string known;
    for (int i = 0; surgery::IsEvent(static_cast<surgery::FactKind>(i)); ++i) {
      const auto one = surgery::FactName(static_cast<surgery::FactKind>(i));
      if (one == name) return i;
      known += (i == 0 ? "" : ", ") + std::string(one);
    }
    view.Complain("there is no event \"" + name + "\"; known are " + known, ErrorCode::kUnknownName);
    return -1;
  }

  int ReadOperationError(const JsonView& view) const {
    const std::string name = view.Text("error");
    std::string known;
    const scene::Procedure* procedure = scene::ProcedureOf(scene_);
    if (procedure == nullptr) return -1;  // complained of where the rule was read
    if (const auto row = scene::FindError(*procedure, name)) return row->row;
    for (const surgery::ErrorRow& row : procedure->errors)
      known += (known.empty() ? "" : ", ") + std::string(row.name);
    view.Complain("surgery knows no error \"" + name + "\"; known are " + known, ErrorCode::kUnknownName);
    return -1;
  }

  const scene::Scene& scene_;
  scene::Task& task_;
};

}  // namespace

scene::Task ReadTaskRules(const JsonView& root, const scene::Scene& scene) {
  scene::Task task;
  RulesReader reader(scene, task);
  const auto limit = [](const JsonView& view, std::size_t count, std::size_t most, const char* what) {
    if (count > most)
      view.Complain("a task may have at most " + std::to_string(most) + " " + what, ErrorCode::kSceneInvalid);
  };
  if (root.Has("regions")) {
    for (const JsonView& view : root.Array("regions")) reader.ReadRegion(view);
  }
  limit(root, task.regions.size(), kMaxRegions, "regions");
  const JsonView rules = root.Object("rules");
  rules.AllowOnly({"order", "time_limit_s", "points_per_second_left", "reference_points", "goals", "errors"});
  const std::string order = rules.TextOr("order", "any");
  if (order != "any" && order != "listed") rules.Complain("order is any or listed", ErrorCode::kUnknownName);
  task.time_limit = rules.NumberOr("time_limit_s", task.time_limit, range::kTimeLimitS);
  task.points_per_second_left = rules.NumberOr("points_per_second_left", 0.0, range::kPoints);
  task.reference_points = rules.NumberOr("reference_points", 0.0, range::kReferencePoints);
  if (task.points_per_second_left > 0 && !std::isfinite(task.time_limit))
    rules.Complain("points_per_second_left needs a time_limit_s", ErrorCode::kSceneInvalid);
  for (const JsonView& view : rules.Array("goals")) reader.ReadGoal(view);
  limit(rules, task.goals.size(), kMaxGoals, "goals");
  if (order == "listed") {
    for (std::size_t g = 0; g < task.goals.size(); ++g) task.goals[g].stage = static_cast<int>(g);
  }
  if (task.goals.empty())
    rules.Complain("a task needs at least one goal in rules.goals; without one it could never be completed",
                   ErrorCode::kSceneInvalid);
  if (rules.Has("errors")) {
    for (const JsonView& view : rules.Array("errors")) reader.ReadError(view);
  }
  limit(rules, task.errors.size(), kMaxErrors, "errors");
  return task;
}

}  // namespace trocar::files
