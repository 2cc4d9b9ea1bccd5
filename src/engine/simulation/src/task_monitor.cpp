// SPDX-License-Identifier: Apache-2.0
#include "task_monitor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/math/elementary.h"
#include "trocar/math/state_fields.h"

namespace trocar::simulation {

using instrument::kHandCount;
using instrument::kLeft;
using instrument::kRight;
using math::Vec3;
using scene::Condition;
using scene::ConditionKind;
using scene::ErrorRule;
using scene::Goal;
using scene::GoalSnapshot;
using scene::kAnyHand;
using scene::ModelBand;
using scene::Region;
using scene::Scene;
using scene::Task;
using scene::TaskError;
using scene::TaskPhase;
using scene::TaskSnapshot;
using surgery::FactKind;

namespace {

/// The clock starts when a tip, or the lens, has gone this far [m].
constexpr double kFirstMovement = 0.002;
constexpr std::uint8_t kBothHands = 3;

bool IsOneOf(const Task& task, const std::vector<int>& regions, const Vec3& p_world) noexcept {
  return std::any_of(regions.begin(), regions.end(), [&](int region) {
    return task.regions[static_cast<std::size_t>(region)].Contains(p_world);
  });
}

/// Whether the mask of hands has the wanted one, or any.
bool HasHand(std::uint8_t mask, int hand) noexcept {
  return hand == kAnyHand ? mask != 0 : ((mask >> hand) & 1) != 0;
}

std::int32_t FirstHand(std::uint8_t mask) noexcept {
  return (mask & 1) != 0 ? kLeft : (mask & 2) != 0 ? kRight : -1;
}

bool IsSeen(const Region& region, const Condition& c, const math::Pose& X_world_laparoscope) noexcept {
  const Vec3 p = math::Inverse(X_world_laparoscope) * region.centre;
  const double distance = math::Norm(p);
  if (!(distance >= c.near && distance <= c.far) || !(-p.z >= math::Cos(c.angle) * distance)) return false;
  if (!region.facing) return true;
  const Vec3 to_lens = (X_world_laparoscope.translation - region.centre) / distance;
  return math::Dot(to_lens, *region.facing) >= math::Cos(c.facing_angle);
}

/// True in one tick only.
bool IsMoment(ConditionKind kind) noexcept {
  return kind == ConditionKind::kHandedOver || kind == ConditionKind::kEvent ||
         kind == ConditionKind::kOperationError || kind == ConditionKind::kUnclippedCut;
}

std::size_t CountGoodClips(const OperationSnapshot& now) noexcept {
  const auto clips = std::span(now.clips).first(now.clip_count);
  return static_cast<std::size_t>(std::count_if(
      clips.begin(), clips.end(), [](const surgery::ClipSnapshot& clip) { return clip.IsGood(); }));
}

/// What clips, cuts and heat have left.
Finding FindOfTissue(const Scene& scene, const OperationSnapshot& now, const Condition& c) noexcept {
  if (c.kind == ConditionKind::kParted) {
    const auto i = static_cast<std::size_t>(c.band);
    const ModelBand& band = scene.model->bands[i];
    return {now.band_is_whole[i] == 0, math::Lerp(band.from, band.to, 0.5), -1};
  }
  if (c.sheet >= 0) {
    const surgery::PatternCut& sheet = now.sheets[static_cast<std::size_t>(c.sheet)];
    const bool is_true = c.kind == ConditionKind::kCutFree      ? sheet.is_free
                         : c.kind == ConditionKind::kCutOffLine ? sheet.farthest >= c.amount
                                                                : sheet.off_area >= c.amount;
    return {is_true, sheet.p_farthest, -1};
  }
  if (c.kind == ConditionKind::kClipped) {
    for (const surgery::ClipSnapshot& clip : std::span(now.clips).first(now.clip_count)) {
      if (clip.IsGood() && IsOneOf(*scene.task, c.regions, clip.p_rest)) return {true, clip.p_rest, -1};
    }
    return {};
  }
  for (const Vec3& p_rest : std::span(now.tube_cuts).first(now.tube_cut_count)) {
    if (IsOneOf(*scene.task, c.regions, p_rest)) return {true, p_rest, -1};
  }
  return {};
}

}  // namespace

void TaskMonitor::Reset(const Scene& scene, TaskSnapshot& task) {
  tracks_.assign(scene.objects.size(), {});
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    tracks_[i].start_height = scene.objects[i].body.X_world_body.translation.z;
  condition_monitors_.clear();
  task = {};
  events_before_ = 0;
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto h = static_cast<std::size_t>(hand);
    start_tips_[h] =
        instrument::CalcToolPose(scene.instruments[h].p_world_port, scene.instruments[h].home).translation;
  }
  X_world_start_view_ = instrument::CalcToolPose(scene.laparoscope.p_world_port, scene.laparoscope.home);
  if (!scene.task) return;
  for (const ErrorRule& rule : scene.task->errors) condition_monitors_.emplace_back(rule.when.size());
  task.phase = TaskPhase::kReady;
  task.goals.resize(scene.task->goals.size());
  task.errors.resize(scene.task->errors.size());
}

void TaskMonitor::BeginFrom(const Snapshot& snapshot) noexcept {
  for (std::size_t hand = 0; hand < kHandCount; ++hand)
    start_tips_[hand] = snapshot.instruments[hand].X_world_device.translation;
  X_world_start_view_ = snapshot.X_world_laparoscope;
}

bool TaskMonitor::HasMoved(const Snapshot& snapshot) const noexcept {
  for (std::size_t hand = 0; hand < kHandCount; ++hand) {
    if (math::Distance(snapshot.instruments[hand].X_world_device.translation, start_tips_[hand]) >
        kFirstMovement)
      return true;
  }
  return math::Distance(snapshot.X_world_laparoscope.translation, X_world_start_view_.translation) >
         kFirstMovement;
}

void TaskMonitor::Follow(const Snapshot& snapshot, double dt) noexcept {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Track& track = tracks_[i];
    const scene::ObjectSnapshot& now = snapshot.objects[i];
    const bool is_in_air = now.touches == 0;
    track.from = track.to = -1;
    if (track.held_by == kBothHands && (now.held_by == 1 || now.held_by == 2)) {
      track.to = now.held_by == 1 ? kLeft : kRight;
      track.from = 1 - track.to;
      track.handed_seconds = track.both_seconds;
    }
    track.both_seconds = now.held_by == kBothHands && is_in_air ? track.both_seconds + dt : 0.0;
    if (now.held_by != 0 || now.is_at_rest) track.is_falling = false;
    if (track.held_by != 0 && now.held_by == 0 && is_in_air) {
      track.is_falling = true;
      track.let_go_height = now.X_world_object.translation.z;
    }
    track.held_by = now.held_by;
  }
}

Finding TaskMonitor::FindOfObject(const Scene& scene, const Snapshot& snapshot,
                                  const Condition& c) const noexcept {
  const auto i = static_cast<std::size_t>(c.object);
  const scene::ObjectSnapshot& object = snapshot.objects[i];
  const Track& track = tracks_[i];
  const Task& task = *scene.task;
  const Vec3& p = object.X_world_object.translation;
  Finding found{false, p, FirstHand(object.held_by != 0 ? object.held_by : object.touched_by)};
  switch (c.kind) {
    case ConditionKind::kHeld:
      found.is_true = HasHand(object.held_by, c.hand);
      break;
    case ConditionKind::kLifted:
      found.is_true = HasHand(object.held_by, c.hand) && p.z >= track.start_height + c.amount;
      break;
    case ConditionKind::kHandedOver:
      found.is_true = track.to >= 0 && track.handed_seconds >= c.seconds &&
                      (c.hand == kAnyHand || c.hand == track.from) && (c.to == kAnyHand || c.to == track.to);
      break;
    case ConditionKind::kInRegion:
      found.is_true = IsOneOf(task, c.regions, p);
      break;
    case ConditionKind::kPlaced:
      found.is_true = object.held_by == 0 && object.is_at_rest && IsOneOf(task, c.regions, p);
      break;
    case ConditionKind::kOutside:
      found.is_true = !IsOneOf(task, c.regions, p);
      break;
    case ConditionKind::kTouches:
      found.is_true = ((object.touches >> c.other) & 1) != 0;
      break;
    case ConditionKind::kToolTouches:
      for (int hand = 0; hand < kHandCount; ++hand) {
        if ((c.hand != kAnyHand && c.hand != hand) || !HasHand(object.touched_by, hand)) continue;
        const InstrumentSnapshot& tool = snapshot.instruments[static_cast<std::size_t>(hand)];
        if (math::Norm(tool.force) >= c.amount) found = {true, tool.X_world_tool.translation, hand};
      }
      break;
    case ConditionKind::kDropped:
      found.is_true = track.is_falling && track.let_go_height - p.z >= c.amount;
      break;
    case ConditionKind::kOutOfView:
      found.is_true = !instrument::IsInView(snapshot.X_world_laparoscope, scene.laparoscope.field_of_view, p);
      break;
    default:
      break;
  }
  if (c.while_held && object.held_by == 0) found.is_true = false;
  return found;
}

Finding TaskMonitor::FindOfTool(const Scene& scene, const Snapshot& snapshot,
                                const Condition& c) const noexcept {
  for (int hand = 0; hand < kHandCount; ++hand) {
    if (c.hand != kAnyHand && c.hand != hand) continue;
    const InstrumentSnapshot& tool = snapshot.instruments[static_cast<std::size_t>(hand)];
    const Vec3& tip = tool.X_world_tool.translation;
    const bool is_true =
        c.kind == ConditionKind::kTipInRegion ? IsOneOf(*scene.task, c.regions, tip)
        : c.kind == ConditionKind::kTipOutOfView
            ? !instrument::IsInView(snapshot.X_world_laparoscope, scene.laparoscope.field_of_view, tip)
            : math::Norm(tool.force) > c.amount;
    if (is_true) return {true, tip, hand};
  }
  return {};
}

Finding TaskMonitor::Find(const Scene& scene, const Snapshot& snapshot, const Condition& c) const noexcept {
  if (c.object >= 0) return FindOfObject(scene, snapshot, c);
  if (c.kind == ConditionKind::kCameraSees) {
    for (const int region : c.regions) {
      const Region& one = scene.task->regions[static_cast<std::size_t>(region)];
      if (IsSeen(one, c, snapshot.X_world_laparoscope)) return {true, one.centre, -1};
    }
    return {};
  }
  switch (c.kind) {
    case ConditionKind::kEvent:
    case ConditionKind::kOperationError:
    case ConditionKind::kUnclippedCut:
      return FindOfEvents(scene, snapshot, c);
    case ConditionKind::kClipped:
    case ConditionKind::kDivided:
    case ConditionKind::kParted:
    case ConditionKind::kCutFree:
    case ConditionKind::kCutOffLine:
    case ConditionKind::kCutAreaOff:
      return FindOfTissue(scene, snapshot.operation, c);
    default:
      return FindOfTool(scene, snapshot, c);
  }
}

Finding TaskMonitor::FindOfEvents(const Scene& scene, const Snapshot& snapshot,
                                  const Condition& c) const noexcept {
  const auto is_meant = [&](const scene::Event& event) {
    if (c.hand != kAnyHand && c.hand != event.hand) return false;
    switch (c.kind) {
      case ConditionKind::kOperationError:
        return event.kind == FactKind::kVerdict && event.error == c.error;
      case ConditionKind::kUnclippedCut:
        return event.kind == FactKind::kTubeCut &&
               static_cast<double>(CountGoodClips(snapshot.operation)) < c.amount;
      default:
        if (static_cast<int>(event.kind) != c.event) return false;
        return c.regions.empty() || IsOneOf(*scene.task, c.regions, event.p_rest) != c.is_outside;
    }
  };
  const auto ring = static_cast<std::uint64_t>(snapshot.events.size());
  const std::uint64_t oldest = snapshot.event_count > ring ? snapshot.event_count - ring : 0;
  for (std::uint64_t n = std::max(events_before_, oldest); n < snapshot.event_count; ++n) {
    const scene::Event& event = snapshot.events[n % ring];
    if (!is_meant(event)) continue;
    const auto tip = [&](std::size_t hand) { return snapshot.instruments[hand].X_world_tool.translation; };
    const Vec3 position = event.hand >= 0 ? tip(static_cast<std::size_t>(event.hand))
                                          : math::Lerp(tip(kLeft), tip(kRight), 0.5);
    return {true, position, event.hand};
  }
  return {};
}

void TaskMonitor::UpdateGoals(const Scene& scene, const Snapshot& snapshot, TaskSnapshot& progress) noexcept {
  const Task& task = *scene.task;
  int stage = std::numeric_limits<int>::max();
  for (std::size_t g = 0; g < task.goals.size(); ++g) {
    if (!progress.goals[g].is_done) stage = std::min(stage, task.goals[g].stage);
  }
  for (std::size_t g = 0; g < task.goals.size(); ++g) {
    const Goal& goal = task.goals[g];
    GoalSnapshot& now = progress.goals[g];
    now.is_open = !now.is_done && goal.stage == stage;
    if (now.is_open) {
      const Condition& step = goal.steps[now.steps_done];
      // a hand-over is a moment; its seconds are those before it
      const bool is_moment = IsMoment(step.kind);
      const bool is_true = Find(scene, snapshot, step).is_true;
      now.held_seconds = is_true ? now.held_seconds + scene.tick_seconds : 0.0;
      if (is_true && (is_moment || now.held_seconds >= step.seconds)) {
        ++now.steps_done;
        now.held_seconds = 0;
        now.is_done = now.steps_done == goal.steps.size();
        now.is_open = !now.is_done;
      }
    }
  }
}

void TaskMonitor::UpdateErrors(const Scene& scene, const Snapshot& snapshot, TaskSnapshot& now) noexcept {
  const Task& task = *scene.task;
  for (std::size_t e = 0; e < task.errors.size(); ++e) {
    const ErrorRule& rule = task.errors[e];
    for (std::size_t i = 0; i < rule.when.size(); ++i) {
      const Condition& condition = rule.when[i];
      ConditionMonitor& monitor = condition_monitors_[e][i];
      const Finding found = Find(scene, snapshot, condition);
      monitor.seconds = found.is_true ? monitor.seconds + scene.tick_seconds : 0.0;
      if (!found.is_true) monitor.is_counted = false;
      const bool is_moment = IsMoment(condition.kind);
      if (!found.is_true || monitor.is_counted || (!is_moment && monitor.seconds < condition.seconds))
        continue;
      monitor.is_counted = true;
      ++now.errors[e];
      now.penalty += rule.penalty;
      now.last_errors[now.error_count % now.last_errors.size()] = {
          static_cast<std::int32_t>(e), now.time, found.position, condition.object, found.hand};
      ++now.error_count;
      if (rule.ends_task) now.phase = TaskPhase::kEnded;
    }
  }
}

/// Goals' points and the time saved, less penalties. What has not been completed saves no time.
void TaskMonitor::Judge(const Task& task, TaskSnapshot& now) const noexcept {
  double points = -now.penalty;
  for (std::size_t g = 0; g < task.goals.size(); ++g) {
    if (now.goals[g].is_done) points += task.goals[g].points;
  }
  if (now.phase == TaskPhase::kCompleted && task.points_per_second_left > 0)
    points += task.points_per_second_left * std::max(0.0, task.time_limit - now.time);
  if (task.reference_points > 0) points *= 100.0 / task.reference_points;
  now.score = std::max(0.0, points);
}

void TaskMonitor::Update(const Scene& scene, const Snapshot& snapshot, TaskSnapshot& now) noexcept {
  if (!scene.task || snapshot.tick == 0) return;
  Follow(snapshot, scene.tick_seconds);
  if (now.phase == TaskPhase::kReady && HasMoved(snapshot)) now.phase = TaskPhase::kRunning;
  if (now.phase == TaskPhase::kRunning) {
    now.time += scene.tick_seconds;
    UpdateErrors(scene, snapshot, now);
    UpdateGoals(scene, snapshot, now);
    const bool is_done =
        std::all_of(now.goals.begin(), now.goals.end(), [](const auto& goal) { return goal.is_done; });
    if (now.phase == TaskPhase::kRunning && is_done) now.phase = TaskPhase::kCompleted;
    if (now.phase == TaskPhase::kRunning && now.time >= scene.task->time_limit)
      now.phase = TaskPhase::kTimeOver;
    Judge(*scene.task, now);
  }
  events_before_ = snapshot.event_count;
}

void TaskMonitor::VisitState(base::StateArchive& archive) {
  for (Track& track : tracks_) {
    archive.Field("held_by", track.held_by);
    archive.Field("both_seconds", track.both_seconds);
    archive.Field("from", track.from);
    archive.Field("to", track.to);
    archive.Field("handed_seconds", track.handed_seconds);
    archive.Field("is_falling", track.is_falling);
    archive.Field("let_go_height", track.let_go_height);
  }
  for (auto& rule : condition_monitors_) {
    for (ConditionMonitor& monitor : rule) {
      archive.Field("seconds", monitor.seconds);
      archive.Field("is_counted", monitor.is_counted);
    }
  }
  archive.Field("events_before", events_before_);
}

}  // namespace trocar::simulation
