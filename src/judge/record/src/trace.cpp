// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/trace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trocar/base/to_integer.h"
#include "trocar/instrument/tool.h"
#include "trocar/math/elementary.h"
#include "trocar/record/replay.h"
#include "trocar/scene/procedure.h"
#include "trocar/simulation/attempt_end.h"

namespace trocar::record {
namespace {

using math::Vec3;
using scene::SurfaceInfo;
using simulation::InstrumentSnapshot;
using simulation::Snapshot;
using surgery::FactKind;
using training::AttemptTrace;

/// Between samples of what ran out [s].
constexpr double kFluidSeconds = 1.0;

/// Ducts in which a burn is the gravest.
bool IsMainBileDuct(roles::TubeRole role) {
  using roles::TubeRole;
  return role == TubeRole::kCommonHepaticDuct || role == TubeRole::kCommonBileDuct ||
         role == TubeRole::kRightHepaticDuct || role == TubeRole::kLeftHepaticDuct ||
         role == TubeRole::kAberrantRightDuct;
}

/// From a point to the wall of a tube, as it lies now; 0 inside.
double DistanceToTube(const Vec3& p, const SurfaceInfo& tube, const std::vector<Vec3>& positions) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i + 1 < tube.node_count; ++i) {
    const Vec3 &a = positions[tube.first_node + i], &b = positions[tube.first_node + i + 1];
    const double length2 = math::SquaredDistance(a, b);
    const double t = length2 > 0.0 ? std::clamp(math::Dot(p - a, b - a) / length2, 0.0, 1.0) : 0.0;
    const double radius = (1.0 - t) * tube.radii[i] + t * tube.radii[i + 1];
    least = std::min(least, std::max(0.0, math::Distance(p, a + t * (b - a)) - radius));
  }
  return least;
}

training::CameraSample SampleCamera(const math::Pose& X_world_laparoscope) {
  const math::Quaternion& rotation = X_world_laparoscope.rotation;
  const double lean = math::Rotate(rotation, {1, 0, 0}).y;
  return {X_world_laparoscope.translation, math::Rotate(rotation, {0, 0, -1}),
          math::Asin(std::clamp(lean, -1.0, 1.0))};
}

/// Facts of a kind that goes on are one span if no more than this lies between them [s].
constexpr double kFactPause = 0.1;

bool IsVolume(FactKind kind) {
  return kind == FactKind::kRinse || kind == FactKind::kAspirate;
}

/// What a rule says of an operation's error that the judge has found in the same tick is not a second error.
bool Restates(const scene::ErrorRule& rule, const std::vector<std::int32_t>& found) {
  return std::any_of(rule.when.begin(), rule.when.end(), [&](const scene::Condition& condition) {
    return condition.kind == scene::ConditionKind::kOperationError &&
           std::find(found.begin(), found.end(), condition.error) != found.end();
  });
}

}  // namespace

struct TraceBuilder::Content {
  // constant
  std::vector<SurfaceInfo> surfaces;
  std::array<std::vector<std::int16_t>, instrument::kHandCount> tool_index;  // (tray) place in tool_names
  std::array<std::vector<bool>, instrument::kHandCount> is_electrode;        // (tray)
  std::optional<scene::Task> task;
  double field_of_view = 0;

  AttemptTrace trace;  // what is known at the end only is added by Calc
  /// Of the last snapshot.
  struct Ending {
    std::uint64_t tick = 0;
    std::vector<surgery::ClipSnapshot> clips;
    std::vector<surgery::StoneSnapshot> stones;
    training::FluidSample fluids;
    bool is_completed = false;
    scene::TaskPhase phase = scene::TaskPhase::kNone;
    double score = 0, penalty = 0, task_time = 0;  // of the task, as shown; [s]
  } last;
  std::uint64_t first_tick = 0, missed = 0, known_events = 0, known_task_errors = 0;
  const scene::Procedure* procedure = nullptr;  // of static storage
  std::vector<int> clip_tubes;                  // surface, or -1
  std::vector<roles::StrandRole> strand_roles;
  std::vector<std::size_t> going_on;                                        // of trace.facts
  std::array<std::optional<std::size_t>, instrument::kHandCount> pressing;  // of trace.events

  bool IsEmpty() const { return trace.Ticks() == 0; }
  double TimeOf(std::uint64_t tick) const { return static_cast<double>(tick - first_tick) * trace.dt; }
  std::size_t ToolInUse(const Snapshot& now, std::size_t hand) const {
    return std::min<std::size_t>(now.operation.tools[hand], tool_index[hand].size() - 1);
  }
  void AddHand(const Snapshot& now, const scene::HandControls& controls, std::size_t hand);
  void AddEvents(const Snapshot& now);
  void AddEvent(const Snapshot& now, const scene::Event& event, std::vector<std::int32_t>& found);
  void AddBrokenRules(const Snapshot& now, const std::vector<std::int32_t>& found);
  void AddForces(const Snapshot& now);
  void AddFacts(const Snapshot& now);
  void AddClips(const Snapshot& now);
  void AddJudgement(const Snapshot& now);
  int TubeAt(const Vec3& p, const std::vector<Vec3>& positions) const;
};

TraceBuilder::TraceBuilder(const simulation::Simulation& simulation) : content_(std::make_unique<Content>()) {
  const scene::Scene& scene = simulation.GetScene();
  Content& c = *content_;
  c.surfaces.assign(simulation.Surfaces().begin(), simulation.Surfaces().end());
  for (const scene::StrandInfo& strand : simulation.Strands()) c.strand_roles.push_back(strand.kind);
  for (SurfaceInfo& surface : c.surfaces) {
    surface.triangles.clear();
    c.trace.organ_names.push_back(surface.name);
  }
  auto& names = c.trace.tool_names;
  for (std::size_t hand = 0; hand < c.tool_index.size(); ++hand) {
    for (const instrument::Tool& tool : scene.instruments[hand].tray) {
      auto place = std::find(names.begin(), names.end(), tool.name);
      if (place == names.end()) place = names.insert(names.end(), tool.name);
      c.tool_index[hand].push_back(static_cast<std::int16_t>(place - names.begin()));
      c.is_electrode[hand].push_back(instrument::AbilitiesOf(tool.kind).electrode !=
                                     instrument::Electrode::kNone);
    }
  }
  c.task = scene.task;
  c.procedure = scene::ProcedureOf(scene);
  c.field_of_view = scene.laparoscope.field_of_view;
  c.trace.dt = scene.tick_seconds;
  c.trace.is_operation = simulation.GetOperationResult().has_value();
  if (c.task) {
    for (const scene::Goal& goal : c.task->goals)
      c.trace.goals.push_back({goal.name, std::nullopt, goal.points});
    for (std::size_t hand = 0; hand < c.trace.ideal_path.size(); ++hand) {
      if (!c.task->ideal_path[hand].empty()) c.trace.ideal_path[hand] = CalcIdealPathLength(*c.task, hand);
    }
  }
}
TraceBuilder::TraceBuilder(TraceBuilder&&) noexcept = default;
TraceBuilder& TraceBuilder::operator=(TraceBuilder&&) noexcept = default;
TraceBuilder::~TraceBuilder() = default;

std::uint64_t TraceBuilder::MissedTicks() const {
  return content_->missed;
}

void TraceBuilder::Content::AddHand(const Snapshot& now, const scene::HandControls& controls,
                                    std::size_t hand) {
  const InstrumentSnapshot& seen = now.instruments[hand];
  const std::size_t tray = ToolInUse(now, hand);
  training::ToolSample sample;
  sample.tip = seen.X_world_tool.translation;
  sample.axis = math::Rotate(seen.X_world_tool.rotation, {0, 0, -1});
  sample.insertion = seen.joints.depth;
  sample.spin = seen.joints.spin;
  sample.jaw = seen.joints.jaw;
  sample.force = math::Norm(seen.force);
  sample.tool = tool_index[hand][tray];
  sample.organ = static_cast<std::int16_t>(seen.organ);
  sample.in_view = instrument::IsInView(now.X_world_laparoscope, field_of_view, sample.tip);
  sample.grasping = seen.is_grasping;
  sample.in_contact = seen.is_touching;
  sample.touching_tool = seen.is_touching_tool;
  sample.pedal = (controls.cut || controls.coagulate) && is_electrode[hand][tray];
  sample.has_current = now.operation.has_current[hand];
  if (seen.is_touching) sample.press = math::Distance(seen.X_world_device.translation, sample.tip);
  if (sample.has_current) {
    for (const SurfaceInfo& surface : surfaces) {
      if (!IsMainBileDuct(surface.tube)) continue;
      const double distance = DistanceToTube(sample.tip, surface, now.positions);
      if (std::isfinite(distance) && (sample.duct_distance < 0.0 || distance < sample.duct_distance))
        sample.duct_distance = distance;
    }
  }
  trace.hands[hand].push_back(sample);
}

void TraceBuilder::Content::AddEvent(const Snapshot& now, const scene::Event& event,
                                     std::vector<std::int32_t>& found) {
  training::AttemptEvent entry;
  entry.time = TimeOf(event.tick);
  entry.kind = surgery::FactName(event.kind);
  entry.hand = event.hand;
  entry.organ = event.organ;
  entry.force = event.force;
  if (event.hand >= 0)
    entry.position = now.instruments[static_cast<std::size_t>(event.hand)].X_world_tool.translation;
  const surgery::ErrorRow* const error =
      event.kind == FactKind::kVerdict ? scene::FindError(procedure, event.error) : nullptr;
  if (error != nullptr) {
    found.push_back(event.error);
    entry.kind = error->name;
    entry.text = error->explanation;
    entry.is_error = true;
    entry.severity = error->severity;
    entry.position = event.p_rest;  // of an error: where it happened
  }
  trace.events.push_back(std::move(entry));
}

void TraceBuilder::Content::AddBrokenRules(const Snapshot& now, const std::vector<std::int32_t>& found) {
  const auto ring = static_cast<std::uint64_t>(now.task.last_errors.size());
  const std::uint64_t oldest = now.task.error_count > ring ? now.task.error_count - ring : 0;
  for (std::uint64_t n = std::max(known_task_errors, oldest); n < now.task.error_count; ++n) {
    const scene::TaskError& error = now.task.last_errors[n % ring];
    const scene::ErrorRule& rule = task->errors[static_cast<std::size_t>(error.rule)];
    if (Restates(rule, found)) continue;
    training::AttemptEvent entry;
    entry.time = TimeOf(now.tick);
    entry.kind = rule.name;
    entry.hand = error.hand;
    entry.position = error.position;
    entry.is_error = entry.is_rule = true;
    entry.severity = rule.severity;
    entry.text = rule.about;
    trace.events.push_back(std::move(entry));
  }
  known_task_errors = now.task.error_count;
}

/// Of a task: in an operation its judge finds what is pulled too hard.
void TraceBuilder::Content::AddForces(const Snapshot& now) {
  for (std::size_t hand = 0; hand < pressing.size(); ++hand) {
    const double force = trace.hands[hand].back().force;
    if (pressing[hand]) {
      training::AttemptEvent& known = trace.events[*pressing[hand]];
      if (force > known.force) {
        known.force = force;
        known.position = trace.hands[hand].back().tip;
      }
      if (force < training::kErrorForceRelease * training::kErrorForce) pressing[hand].reset();
    } else if (force > training::kErrorForce) {
      training::AttemptEvent entry;
      entry.time = TimeOf(now.tick);
      entry.kind = training::kExcessForceOfTask;
      entry.hand = static_cast<int>(hand);
      entry.force = force;
      entry.position = trace.hands[hand].back().tip;
      entry.is_error = true;
      entry.severity = surgery::Severity::kMinor;
      entry.text = training::kExcessForceOfTaskText;
      pressing[hand] = trace.events.size();
      trace.events.push_back(std::move(entry));
    }
  }
}

int TraceBuilder::Content::TubeAt(const Vec3& p, const std::vector<Vec3>& positions) const {
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (surfaces[i].radii.empty()) continue;
    const double distance = DistanceToTube(p, surfaces[i], positions);
    if (distance < least) least = distance, nearest = static_cast<int>(i);
  }
  return nearest;
}

/// What is heated, cut, spread, rinsed for a while becomes one span.
void TraceBuilder::Content::AddFacts(const Snapshot& now) {
  const double time = TimeOf(now.tick);
  std::erase_if(going_on, [&](std::size_t i) { return time - trace.facts[i].end > kFactPause; });
  for (const surgery::Fact& fact : std::span(now.facts).first(now.fact_count)) {
    std::string part;
    if (fact.strand >= 0) {
      part = roles::NameOf(strand_roles[static_cast<std::size_t>(fact.strand)]);
    } else if (fact.surface >= 0) {
      part = trace.organ_names[static_cast<std::size_t>(fact.surface)];
    }
    const std::string_view kind = surgery::FactName(fact.kind);
    const auto goes_on = [&](const training::FactSpan& span) {
      return span.hand == fact.hand && span.kind == kind && span.part == part;
    };
    const auto known = std::find_if(going_on.begin(), going_on.end(),
                                    [&](std::size_t i) { return goes_on(trace.facts[i]); });
    if (known == going_on.end()) {
      going_on.push_back(trace.facts.size());
      trace.facts.push_back({std::string(kind), fact.hand, std::move(part), time, time, fact.amount});
      continue;
    }
    training::FactSpan& span = trace.facts[*known];
    span.end = time;
    span.amount = IsVolume(fact.kind) ? span.amount + fact.amount : std::max(span.amount, fact.amount);
  }
}

void TraceBuilder::Content::AddClips(const Snapshot& now) {
  // clips are only ever added; who closed the new ones stands in the facts of the tick, in the same order
  std::size_t next = 0;
  for (std::size_t i = trace.clips.size(); i < now.operation.clip_count; ++i) {
    const surgery::ClipSnapshot& clip = now.operation.clips[i];
    training::ClipRecord record;
    record.time = TimeOf(now.tick);
    for (; next < now.fact_count && record.hand < 0; ++next) {
      const FactKind kind = now.facts[next].kind;
      if (kind == FactKind::kClipClosed || kind == FactKind::kClipLost) record.hand = now.facts[next].hand;
    }
    clip_tubes.push_back(clip.is_lost ? -1 : TubeAt(clip.X_world_clip.translation, now.positions));
    if (!clip.is_lost && record.hand >= 0) {
      const math::Pose& X = now.instruments[static_cast<std::size_t>(record.hand)].X_world_tool;
      const Vec3 jaws = math::Rotate(X.rotation, {0, 0, -1});
      const Vec3 line = math::Rotate(clip.X_world_clip.rotation, {0, 0, 1});
      record.angle = math::Acos(std::clamp(std::fabs(math::Dot(jaws, line)), 0.0, 1.0));
    }
    trace.clips.push_back(std::move(record));
  }
}

void TraceBuilder::Content::AddEvents(const Snapshot& now) {
  const auto ring = static_cast<std::uint64_t>(now.events.size());
  const std::uint64_t oldest = now.event_count > ring ? now.event_count - ring : 0;
  std::vector<std::int32_t> found;
  for (std::uint64_t n = std::max(known_events, oldest); n < now.event_count; ++n) {
    AddEvent(now, now.events[n % ring], found);
  }
  known_events = now.event_count;
  if (task) AddBrokenRules(now, found);
  if (task && !trace.is_operation) AddForces(now);
  if (now.tick > first_tick) AddFacts(now);
  AddClips(now);
}

void TraceBuilder::Content::AddJudgement(const Snapshot& now) {
  const double time = TimeOf(now.tick);
  for (std::size_t g = 0; g < trace.goals.size() && g < now.task.goals.size(); ++g) {
    std::optional<double>& done = trace.goals[g].time;
    if (now.task.goals[g].is_done && !done) done = time;
  }
  if (!trace.is_operation) return;
  if (now.operation.procedure.view.IsAchieved() && !trace.critical_view_time) trace.critical_view_time = time;
  const std::string_view phase = scene::PhaseName(procedure, now.operation.procedure.phase);
  if (trace.phases.empty() || trace.phases.back().name != phase) {
    if (!trace.phases.empty()) trace.phases.back().end = time;
    trace.phases.push_back({std::string(phase), time, time});
  }
  trace.phases.back().end = time;
  const auto& fluids = now.operation.flow.ledger.fluids;
  last.fluids = {time, fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)].left,
                 fluids[static_cast<std::size_t>(surgery::Fluid::kBile)].left};
  if (trace.fluids.empty() || time - trace.fluids.back().time >= kFluidSeconds)
    trace.fluids.push_back(last.fluids);
  last.clips.assign(now.operation.clips.begin(),
                    now.operation.clips.begin() + static_cast<std::ptrdiff_t>(now.operation.clip_count));
  last.stones = now.operation.stones;
  last.is_completed = now.operation.is_completed;
}

void TraceBuilder::Reserve(double seconds) {
  const auto ticks = base::TruncateTo<std::size_t>(seconds / content_->trace.dt) + 1;
  for (auto& hand : content_->trace.hands) hand.reserve(ticks);
  content_->trace.camera.reserve(ticks);
}

void TraceBuilder::Add(const Snapshot& now,
                       const std::array<scene::HandControls, instrument::kHandCount>& controls) {
  Content& c = *content_;
  if (c.IsEmpty()) {
    // what happened before is not of this attempt
    c.first_tick = now.tick;
    c.known_events = now.event_count;
    c.known_task_errors = now.task.error_count;
  } else if (now.tick <= c.last.tick) {
    return;
  } else {
    for (std::uint64_t tick = c.last.tick + 1; tick < now.tick; ++tick, ++c.missed) {
      for (auto& hand : c.trace.hands) hand.push_back(hand.back());
      c.trace.camera.push_back(c.trace.camera.back());
    }
  }
  for (std::size_t hand = 0; hand < c.trace.hands.size(); ++hand) c.AddHand(now, controls[hand], hand);
  c.trace.camera.push_back(SampleCamera(now.X_world_laparoscope));
  c.AddEvents(now);
  c.AddJudgement(now);
  c.last.tick = now.tick;
  c.last.phase = now.task.phase;
  c.last.score = c.task ? scene::CalcShownScore(*c.task, now.task) : 0.0;
  if (c.task) {
    const bool is_percent = c.task->reference_points > 0;
    c.last.penalty = now.task.penalty * (is_percent ? c.task->best_score / c.task->reference_points : 1.0);
  }
  c.last.task_time = now.task.time;
}

training::AttemptTrace TraceBuilder::Calc() const {
  const Content& c = *content_;
  const Content::Ending& last = c.last;
  AttemptTrace trace = c.trace;
  if (c.IsEmpty()) return trace;
  for (std::size_t i = 0; i < trace.clips.size(); ++i) {
    training::ClipRecord& record = trace.clips[i];
    const surgery::ClipSnapshot& clip = last.clips[i];
    record.is_lost = clip.is_lost;
    const int tube = c.clip_tubes[i];
    if (clip.is_lost || tube < 0) continue;
    const SurfaceInfo& vessel = c.surfaces[static_cast<std::size_t>(tube)];
    record.vessel = vessel.name;
    record.is_misplaced = !clip.IsGood() || !scene::MayBeDivided(c.procedure, vessel.tube);
    for (std::size_t j = 0; j < trace.clips.size(); ++j) {
      if (j == i || last.clips[j].is_lost || c.clip_tubes[j] != tube) continue;
      const double gap = math::Distance(clip.p_rest, last.clips[j].p_rest);
      record.gap = std::min(record.gap.value_or(gap), gap);
    }
  }
  if (trace.is_operation && trace.fluids.back().time < last.fluids.time) trace.fluids.push_back(last.fluids);
  for (const surgery::StoneSnapshot& stone : last.stones) {
    using surgery::StonePlace;
    trace.stones_spilled += stone.place != StonePlace::kInside;
    trace.stones_lost += stone.place == StonePlace::kSpilled || stone.place == StonePlace::kHeld;
  }
  const bool is_completed = simulation::HasCompleted(last.phase, last.is_completed);
  if (c.task) {
    trace.outcome = {std::string(scene::PhaseName(last.phase)), is_completed, last.score, last.task_time,
                     last.penalty};
  } else if (trace.is_operation) {
    trace.outcome.is_completed = is_completed;
    trace.outcome.phase = is_completed ? "completed" : "unfinished";
  }
  return trace;
}

base::Result<training::AttemptTrace> TraceRecording(Recording recording, int threads,
                                                    const std::function<void(double)>& progress) {
  auto opened = Replay::Open(std::move(recording), threads);
  if (!opened.ok()) return opened.error();
  Replay& replay = *opened;
  TraceBuilder builder(replay.GetSimulation());
  builder.Add(replay.GetSimulation().GetSnapshot());
  const Recording& played = replay.GetRecording();
  const auto count = static_cast<double>(std::max<std::size_t>(1, played.inputs.size()));
  while (!replay.IsAtEnd()) {
    const std::uint64_t done = replay.Tick() - played.FirstTick();
    replay.Step();
    builder.Add(replay.GetSimulation().GetSnapshot(), played.inputs[done].controls);
    if (progress && done % 30 == 0) progress(static_cast<double>(done) / count);
  }
  if (const auto& divergence = replay.GetDivergence()) {
    return base::Error{
        base::ErrorCode::kRecordingInvalid,
        "the recording does not replay to the states that were recorded: it differs from " +
            std::to_string(static_cast<double>(divergence->tick) * played.description.tick_seconds) +
            " s on, and metrics of it would be of something else (trocar replay --verify)"};
  }
  return builder.Calc();
}

}  // namespace trocar::record
