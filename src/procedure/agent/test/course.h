// SPDX-License-Identifier: Apache-2.0
/// \file course.h  Simulations that are played, and the states on their way, for tests of saving and restoring.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "altered_state.h"
#include "published.h"
#include "scripted_hands.h"
#include "task_play.h"
#include "trocar/files/scene_file.h"
#include "trocar/math/random.h"

namespace trocar::agent {

/// A scene, and who acts in it.
struct Course {
  std::string name;     ///< of a delivered task, or of a scene file
  std::string surgeon;  ///< "" for the scene's script, "fumbler" for a Fumbler, or of MakeScriptedHands()
  int ticks = 0;        ///< at most
  int points = 0;       ///< random ticks at which it is saved
  int events = 12;      ///< after which it is saved as well, at most
  bool changes_settings = false;  ///< as ChangeSettings() does
  int from = 0;                   ///< no point before this tick
  bool has_equal_trays = false;   ///< the left hand is offered the right one's tools, too
  bool is_dissected = false;      ///< there is no fat, and all fibres of the gallbladder's bed part at once
  bool swaps_hands = false;       ///< each hand does through the other's trocar what the other one would do
  bool looks_before = false;      ///< a tick before what happens and after it, as CountMoments() counts
  const char* alteration = "";    ///< of Alterations(): each state that is saved gets its values
};

inline void PrintTo(const Course& course, std::ostream* out) {
  *out << course.name << " " << course.surgeon;
}

inline std::string NameOf(const testing::TestParamInfo<Course>& info) {
  return info.param.name + (info.param.surgeon.empty() ? "" : "_" + info.param.surgeon) +
         (info.param.changes_settings ? "_changes_settings" : "") +
         (info.param.has_equal_trays ? "_equal_trays" : "") + (info.param.is_dissected ? "_dissected" : "") +
         (info.param.swaps_hands ? "_swapped" : "") + (info.param.looks_before ? "_moments" : "") +
         (info.param.from > 0 ? "_late" : "") +
         (info.param.alteration[0] != 0 ? "_with_" + std::string(info.param.alteration) : "");
}

inline constexpr int kGoesOn = 240;  // ticks after a point

inline std::shared_ptr<const scene::Scene> ReadCourse(const Course& course) {
  const auto file = std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes" / (course.name + ".json");
  auto read = std::filesystem::exists(file) ? files::ReadScene(file)
                                            : base::Result<scene::Scene>(*ReadDelivered(course.name));
  EXPECT_TRUE(read.ok()) << read.error().Text();
  if (course.has_equal_trays) {
    auto& left = read->instruments[instrument::kLeft];
    const auto& right = read->instruments[instrument::kRight];
    left.tool = right.tool, left.tray = right.tray;
  }
  if (course.is_dissected) {
    read->operation->fat_spacing = 0;
    for (scene::OrganMaterial& material : read->materials) {
      if (std::isfinite(material.failure_strain)) material.failure_strain = -1;
    }
  }
  return std::make_shared<const scene::Scene>(std::move(*read));
}

/// One tick of it goes wrong, and the guard takes the tick back.
inline tissue::SolverSettings DivergingSolver() {
  tissue::SolverSettings settings;
  settings.kind = tissue::SolverKind::kRelaxationPaper;
  settings.relaxation.alpha = 1e6;  // far beyond the bound of stability [m/N]
  return settings;
}

/// Hands that go where anything is and do there whatever a hand and a foot can do, under settings that change: they bring a
/// state where no plan leads. Now and then a tick goes wrong.
class Fumbler {
 public:
  explicit Fumbler(std::uint64_t seed) : random_(seed) {}

  scene::Input Act(const scene::Scene& scene, const simulation::Snapshot& seen) {
    if (tick_ == 0) {
      for (int hand = 0; hand < instrument::kHandCount; ++hand)
        input_.hands[hand] = scene.instruments[hand].home;
      input_.laparoscope = scene.laparoscope.home;
    }
    for (int hand = 0; hand < instrument::kHandCount; ++hand) {
      if (tick_ % kReachTicks == static_cast<std::size_t>(hand)) Reach(scene, seen, hand);
    }
    if (tick_ % kSettingsTicks == kSettingsTicks - 1) ChangeSettings();
    input_.settings.solver = {};
    const bool freezes = tick_ >= kFreezes && tick_ < kFreezes + 4;
    if (tick_ % kBadTicks == kBadTicks - 1 || freezes) input_.settings.solver = DivergingSolver();
    ++tick_;
    return input_;
  }

 private:
  static constexpr std::size_t kReachTicks = 40, kSettingsTicks = 90, kBadTicks = 151;
  static constexpr std::size_t kFreezes =
      1300;  // so many bad ticks in a row here that the tissue stands still

  bool Chance(double share) { return random_.Uniform() < share; }

  void Reach(const scene::Scene& scene, const simulation::Snapshot& seen, int hand) {
    const scene::InstrumentSetup& setup = scene.instruments[hand];
    math::Vec3 place = setup.p_world_port;
    if (!seen.positions.empty()) {
      place = seen.positions[static_cast<std::size_t>(random_.Uniform() *
                                                      static_cast<double>(seen.positions.size()))];
    } else if (!seen.objects.empty()) {
      place =
          seen.objects[static_cast<std::size_t>(random_.Uniform() * static_cast<double>(seen.objects.size()))]
              .X_world_object.translation;
    }
    place += math::Vec3{random_.Uniform(-0.005, 0.005), random_.Uniform(-0.005, 0.005),
                        random_.Uniform(-0.005, 0.005)};
    const double jaw = Chance(0.5) ? 0.0 : setup.tool.max_jaw;
    input_.hands[hand] = instrument::FindJoints(setup.p_world_port, place, random_.Uniform(-1.5, 1.5), jaw);
    if (Chance(0.1)) input_.hands[hand].depth = 0.02;  // back into the trocar
    scene::HandControls& controls = input_.controls[hand];
    controls.cut = Chance(0.3), controls.coagulate = Chance(0.3);
    controls.rinse = Chance(0.3), controls.aspirate = Chance(0.3);
    if (Chance(0.3) && !setup.tray.empty())
      controls.tool = static_cast<std::uint8_t>(random_.Uniform() * static_cast<double>(setup.tray.size()));
    input_.assistant = static_cast<scene::AssistantCommand>(random_.NextWord() % 4);
  }

  void ChangeSettings() {
    input_.settings.head_up = random_.Uniform(-0.5, 0.5);
    input_.settings.right_up = random_.Uniform(-0.5, 0.5);
    input_.settings.holds_camera = Chance(0.5);
    input_.settings.stiffness_scale = random_.Uniform(0.6, 2.0);
    input_.settings.shape_scale = random_.Uniform(0.8, 1.5);
  }

  math::Random random_;
  scene::Input input_;
  std::size_t tick_ = 0;
};

/// Cuts, clips, stones, things taken: where a state is the least like the one of before.
inline std::uint64_t CountEvents(const simulation::Snapshot& snapshot) {
  const simulation::OperationSnapshot& operation = snapshot.operation;
  std::uint64_t count =
      operation.topology.version + operation.clip_count + operation.errors + snapshot.task.error_count;
  for (const surgery::StoneSnapshot& stone : operation.stones)
    count += stone.place != surgery::StonePlace::kInside ? 1 : 0;
  for (const simulation::InstrumentSnapshot& tool : snapshot.instruments) count += tool.is_grasping ? 1 : 0;
  return count;
}

/// Finer: also what jaws take and let go, and every fibre that parts.
inline std::uint64_t CountMoments(const simulation::Snapshot& snapshot) {
  std::uint64_t count = CountEvents(snapshot) + snapshot.event_count;
  for (const std::uint8_t is_intact : snapshot.operation.strand_is_intact) count += is_intact == 0 ? 1 : 0;
  return count;
}

/// An instructor who tilts the table, stiffens the tissue for a while, again and again, and leaves the camera to its holder.
inline void ChangeSettings(std::size_t tick, scene::LiveSettings& settings) {
  settings.holds_camera = true;
  if (tick / 90 % 2 == 0) return;
  settings.head_up = 0.3;
  settings.stiffness_scale *= 1.5;
  settings.shape_scale *= 1.2;
}

struct Point {
  std::size_t tick = 0;
  std::vector<std::byte> bytes;
  std::uint64_t hash = 0, hash_after = 0;            ///< of the state, now and kGoesOn ticks later
  std::uint64_t published = 0, published_after = 0;  ///< of what others see
  std::uint64_t patches = 0;                         ///< of what the haptic loop gets
};

/// \param in_own_trocars  what is done there
inline scene::Input SwapHands(scene::Input in_own_trocars) {
  std::swap(in_own_trocars.hands[instrument::kLeft], in_own_trocars.hands[instrument::kRight]);
  std::swap(in_own_trocars.controls[instrument::kLeft], in_own_trocars.controls[instrument::kRight]);
  return in_own_trocars;
}

/// The same scene with everything of one hand in the other.
inline std::shared_ptr<const scene::Scene> SwapHands(const scene::Scene& scene) {
  auto swapped = std::make_shared<scene::Scene>(scene);
  std::swap(swapped->instruments[instrument::kLeft], swapped->instruments[instrument::kRight]);
  return swapped;
}

/// Whoever acts in a course.
class Actor {
 public:
  Actor(const Course& course, std::shared_ptr<const scene::Scene> scene, std::uint64_t seed)
      : scene_(scene), fumbler_(seed), script_(MakeScriptedHands(course.surgeon, scene)), course_(course) {
    if (course.surgeon.empty() || course.surgeon == "fumbler" || script_) return;
    surgeon_ = std::move(*MakeSurgeon(course.surgeon, scene, 1));
  }

  scene::Input Act(const simulation::Snapshot& seen) {
    if (surgeon_ != nullptr) return surgeon_->Act(seen);
    if (script_) return (*script_)(seen);
    if (course_.surgeon == "fumbler") return fumbler_.Act(*scene_, seen);
    return scene::CalcScriptInput(*scene_, seen.time);
  }
  bool HasFinished() const { return surgeon_ != nullptr && surgeon_->HasFinished(); }

 private:
  std::shared_ptr<const scene::Scene> scene_;
  Fumbler fumbler_;
  std::optional<ScriptedHands> script_;
  std::unique_ptr<Surgeon> surgeon_;
  const Course& course_;
};

/// What is done in a course, tick by tick.
inline std::vector<scene::Input> RecordInputs(const Course& course,
                                              std::shared_ptr<const scene::Scene> scene) {
  simulation::Simulation simulation =
      std::move(*simulation::Simulation::Make(std::move(*simulation::MakeSimulationModel(scene))));
  Actor actor(course, std::move(scene), std::hash<std::string>()(course.name));
  std::vector<scene::Input> inputs;
  for (int tick = 0; tick < course.ticks + kGoesOn && !actor.HasFinished(); ++tick) {
    inputs.push_back(actor.Act(simulation.GetSnapshot()));
    simulation.Step(inputs.back());
  }
  return inputs;
}

/// One course with its inputs, and the states on its way.
struct Recording {
  std::shared_ptr<const simulation::SimulationModel> model;
  std::vector<scene::Input> inputs;
  std::vector<Point> points;
};

inline Recording Record(const Course& course, std::shared_ptr<const scene::Scene> scene) {
  Recording recording;
  std::vector<scene::Input> swapped;  // what the hands would do unswapped
  if (course.swaps_hands) swapped = RecordInputs(course, scene), scene = SwapHands(*scene);
  auto model = simulation::MakeSimulationModel(scene);
  EXPECT_TRUE(model.ok()) << model.error().Text();
  recording.model = *model;
  simulation::Simulation simulation = std::move(*simulation::Simulation::Make(recording.model));
  const std::uint64_t seed = std::hash<std::string>()(course.name);
  Actor actor(course, scene, seed);
  math::Random random(seed);
  std::set<std::size_t> chosen;
  for (int i = 0; i < course.points; ++i)
    chosen.insert(
        static_cast<std::size_t>(course.from + random.Uniform(0.0, 1.0) * (course.ticks - course.from)));
  std::uint64_t events = 0;
  int events_saved = 0;
  std::map<std::size_t, std::size_t> ends;  // tick to point
  Point before;                             // of the tick before
  std::optional<simulation::Simulation> altered;
  simulation::Simulation::AlterField alter;
  if (course.alteration[0] != 0) {
    altered = std::move(*simulation::Simulation::Make(recording.model));
    alter = FindAlteration(course.alteration);
  }
  const auto take = [&](Point& point, std::size_t tick) {
    point.tick = tick;
    if (altered) {
      simulation.SaveAltered(point.bytes, alter);
      EXPECT_TRUE(altered->Restore(point.bytes).ok()) << course.alteration;
    } else {
      simulation.Save(point.bytes);
    }
    simulation::Simulation& saved = altered ? *altered : simulation;
    point.hash = saved.Hash();
    point.published = CalcPublishedHash(saved);
    point.patches = CalcPatchHash(saved);
  };
  const auto add = [&](Point point) {
    if (!ends.emplace(point.tick + kGoesOn, recording.points.size()).second) return;
    recording.points.push_back(std::move(point));
  };
  for (std::size_t tick = 0; tick < static_cast<std::size_t>(course.ticks + kGoesOn); ++tick) {
    if (const auto end = ends.find(tick); end != ends.end()) {
      recording.points[end->second].hash_after = simulation.Hash();
      recording.points[end->second].published_after = CalcPublishedHash(simulation);
    }
    const simulation::Snapshot& seen = simulation.GetSnapshot();
    const std::uint64_t now = course.looks_before ? CountMoments(seen) : CountEvents(seen);
    const bool is_event =
        now != events && events_saved < course.events && tick >= static_cast<std::size_t>(course.from);
    events = now;
    if (is_event) ++events_saved;
    const bool is_over = course.swaps_hands ? tick >= swapped.size() : actor.HasFinished();
    if (is_over && (ends.empty() || tick > ends.rbegin()->first)) break;
    const bool has_time = tick < static_cast<std::size_t>(course.ticks) && !is_over;
    if (is_event && course.looks_before && has_time && tick > 0) add(std::move(before));
    if ((chosen.count(tick) != 0 || is_event) && has_time) take(before, tick), add(before);
    if (course.looks_before && has_time) take(before, tick);
    scene::Input input =
        course.swaps_hands ? SwapHands(swapped[std::min(tick, swapped.size() - 1)]) : actor.Act(seen);
    if (course.changes_settings) ChangeSettings(tick, input.settings);
    recording.inputs.push_back(input);
    simulation.Step(input);
  }
  return recording;
}

}  // namespace trocar::agent
