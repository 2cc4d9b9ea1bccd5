// SPDX-License-Identifier: Apache-2.0
/// \file scripted_hands.h  Hands that follow a list of steps, for courses that no surgeon of this module plays.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trocar/agent/hand_motion.h"
#include "trocar/agent/surgeon.h"
#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/patient/patient.h"

namespace trocar::agent {

class ScriptedHands {
 public:
  /// One tick of a step. \param tick  of the step \return whether it goes on
  using Act = std::function<bool(const simulation::Snapshot& seen, int tick, scene::Input& input)>;

  explicit ScriptedHands(std::shared_ptr<const scene::Scene> scene) : scene_(std::move(scene)) {
    for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand)
      input_.hands[hand] = scene_->instruments[hand].home;
    input_.laparoscope = scene_->laparoscope.home;
  }

  scene::Input operator()(const simulation::Snapshot& seen) {
    while (at_ < steps_.size() && !steps_[at_](seen, tick_++, input_)) ++at_, tick_ = 0;
    return input_;
  }

  void Add(Act act) { steps_.push_back(std::move(act)); }
  void Wait(int ticks) {
    Add([=](const simulation::Snapshot&, int tick, scene::Input&) { return tick < ticks; });
  }
  /// For so many ticks, the tip on its way to a place that is looked up in each.
  void Reach(int hand, int ticks, std::function<math::Vec3(const simulation::Snapshot&)> place,
             double spin = 0) {
    Add([=, scene = scene_, place = std::move(place)](const simulation::Snapshot& seen, int tick,
                                                      scene::Input& input) {
      const auto h = static_cast<std::size_t>(hand);
      const math::Vec3 from = seen.instruments[h].X_world_device.translation;
      const double share = 1.0 / std::max(1, ticks - tick);
      input.hands[h] = instrument::FindJoints(scene->instruments[h].p_world_port,
                                              math::Lerp(from, place(seen), share), spin, input.hands[h].jaw);
      return tick < ticks;
    });
  }
  /// \param share  of the tool's opening
  void Jaw(int hand, int ticks, double share) {
    Add([=, scene = scene_](const simulation::Snapshot& seen, int tick, scene::Input& input) {
      const auto h = static_cast<std::size_t>(hand);
      const auto& tray = scene->instruments[h].tray;
      const instrument::Tool& tool =
          tray.empty() ? scene->instruments[h].tool : tray[seen.operation.tools[h]];
      input.hands[h].jaw =
          std::lerp(seen.instruments[h].joints.jaw, share * tool.max_jaw, 1.0 / std::max(1, ticks - tick));
      return tick < ticks;
    });
  }
  /// Asks for a tool and goes on asking. \param name  of one in the tray
  void Exchange(int hand, int ticks, const std::string& name) {
    const auto& tray = scene_->instruments[static_cast<std::size_t>(hand)].tray;
    const auto found =
        std::find_if(tray.begin(), tray.end(), [&](const auto& tool) { return tool.name == name; });
    Add([=, tool = static_cast<std::uint8_t>(found - tray.begin())](const simulation::Snapshot&, int tick,
                                                                    scene::Input& input) {
      input.controls[hand].tool = tool;
      return tick < ticks;
    });
  }
  /// Lets a surgeon of the library do it until something has come of it.
  void LeaveTo(const std::string& name, std::function<bool(const simulation::Snapshot&)> until) {
    auto made = MakeSurgeon(name, scene_, 1);
    std::shared_ptr<Surgeon> surgeon = made.ok() ? std::move(*made) : nullptr;
    Add([=, until = std::move(until)](const simulation::Snapshot& seen, int, scene::Input& input) {
      if (surgeon == nullptr || surgeon->HasFinished() || until(seen)) return false;
      input = surgeon->Act(seen);
      return true;
    });
  }

  const scene::Scene& GetScene() const { return *scene_; }
  const std::shared_ptr<const scene::Scene>& SharedScene() const { return scene_; }

 private:
  std::shared_ptr<const scene::Scene> scene_;
  scene::Input input_;
  std::vector<Act> steps_;
  std::size_t at_ = 0;
  int tick_ = 0;
};

/// The spilled stone nearest to a hand's tool.
inline std::optional<math::Vec3> FindSpilledStone(const simulation::Snapshot& seen, int hand) {
  std::optional<math::Vec3> found;
  const math::Vec3& tip = seen.instruments[static_cast<std::size_t>(hand)].X_world_tool.translation;
  for (const surgery::StoneSnapshot& stone : seen.operation.stones) {
    if (stone.place != surgery::StonePlace::kSpilled) continue;
    if (!found || math::Distance(stone.position, tip) < math::Distance(*found, tip)) found = stone.position;
  }
  return found;
}

/// Draws the hook with its current through the gallbladder's wall, from the fundus on.
inline void OpenGallbladder(ScriptedHands& hands) {
  constexpr double kDeep = 0.005, kWay = 0.020;  // of the hook in the wall, and along it [m]
  const scene::Scene& scene = hands.GetScene();
  const math::Vec3 port = scene.instruments[instrument::kRight].p_world_port;
  const math::Vec3 fundus = scene.patient.LandmarkOf(roles::LandmarkRole::kFundus)->position;
  const math::Vec3 neck = scene.patient.LandmarkOf(roles::LandmarkRole::kInfundibulum)->position;
  const math::Vec3 in = math::Normalized(fundus - port), along = math::Normalized(neck - fundus);
  const auto press = [](bool is_down) {
    return [=](const simulation::Snapshot&, int, scene::Input& input) {
      input.controls[instrument::kRight].cut = is_down;
      return false;
    };
  };
  hands.Reach(instrument::kRight, 100, [=](const simulation::Snapshot&) { return fundus - 0.01 * in; });
  hands.Add(press(true));
  hands.Reach(instrument::kRight, 40, [=](const simulation::Snapshot&) { return fundus + kDeep * in; });
  hands.Reach(instrument::kRight, 120,
              [=](const simulation::Snapshot&) { return fundus + kDeep * in + kWay * along; });
  hands.Add(press(false));
  hands.Reach(instrument::kRight, 40, [=](const simulation::Snapshot&) { return fundus - 0.03 * in; });
  hands.Wait(60);
}

/// Takes a stone and lifts it.
inline void TakeStone(int hand, ScriptedHands& hands) {
  const math::Vec3 port = hands.GetScene().instruments[static_cast<std::size_t>(hand)].p_world_port;
  const auto beyond = [=](double way) {
    return [=](const simulation::Snapshot& seen) {
      const math::Vec3 at =
          FindSpilledStone(seen, hand)
              .value_or(seen.instruments[static_cast<std::size_t>(hand)].X_world_device.translation);
      return at + way * math::Normalized(at - port);
    };
  };
  hands.Reach(hand, 90, beyond(-0.030));
  hands.Jaw(hand, 30, 1.0);
  hands.Reach(hand, 60, beyond(0.006));
  hands.Jaw(hand, 50, 0.0);
  hands.Reach(hand, 60, [=](const simulation::Snapshot& seen) {
    return seen.instruments[static_cast<std::size_t>(hand)].X_world_device.translation +
           math::Vec3{0, 0, 0.001};
  });
}

/// Clips the scene's first duct or vessel and cuts it. The tray has to have both tools.
inline void Divide(int hand, ScriptedHands& hands) {
  const scene::Scene& scene = hands.GetScene();
  const math::Vec3 port = scene.instruments[static_cast<std::size_t>(hand)].p_world_port;
  const auto& line = scene.patient.tubes.front().line.points;
  const std::size_t middle = line.size() / 2;
  const math::Vec3 along = math::Normalized(line[middle + 1] - line[middle]);
  const auto approach = [&](const std::string& name, std::size_t point) {
    const math::Vec3 p = line[point], in = math::Normalized(p - port);
    const double deep = 0.4 * instrument::FindTool(name)->jaw_length;
    const double spin = FindSpin(port, p, math::Cross(in, along));
    hands.Reach(
        hand, 70, [=](const simulation::Snapshot&) { return p - 0.03 * in; }, spin);
    hands.Jaw(hand, 30, 1.0);
    hands.Reach(
        hand, 50, [=](const simulation::Snapshot&) { return p + deep * in; }, spin);
    hands.Wait(10);
    hands.Jaw(hand, 40, 0.0);
    hands.Jaw(hand, 10, 0.5);
    hands.Reach(
        hand, 50, [=](const simulation::Snapshot&) { return p - 0.03 * in; }, spin);
  };
  hands.Exchange(hand, 75, "clip_applier");
  approach("clip_applier", middle);
  hands.Exchange(hand, 75, "scissors");
  approach("scissors", middle + 2);
}

/// Opens the dissector's jaws in the fat beside the cystic duct, from the gallbladder on.
inline void SpreadFat(int hand, ScriptedHands& hands) {
  const scene::Scene& scene = hands.GetScene();
  const math::Vec3 port = scene.instruments[static_cast<std::size_t>(hand)].p_world_port;
  const auto& tubes = scene.patient.tubes;
  const auto duct = std::find_if(tubes.begin(), tubes.end(), [](const patient::Tube& tube) {
    return tube.role == roles::TubeRole::kCysticDuct;
  });
  hands.Exchange(hand, 75, "maryland");
  for (std::size_t i = 1; i + 1 < duct->line.points.size(); i += 2) {
    const math::Vec3 p = duct->line.points[i], in = math::Normalized(p - port);
    hands.Reach(hand, i == 1 ? 120 : 40, [=](const simulation::Snapshot&) { return p - 0.004 * in; });
    hands.Reach(hand, 20, [=](const simulation::Snapshot&) { return p + 0.002 * in; });
    hands.Jaw(hand, 30, 1.0);
    hands.Jaw(hand, 20, 0.0);
  }
}

/// Closes a grasper on what lies at a place, and pulls at it while it asks for another tool.
/// \param jaw   share of its opening to which it closes
/// \param pull  of the tip
inline void HoldAndAsk(int hand, const math::Vec3& place, const std::string& other, double jaw,
                       const math::Vec3& pull, ScriptedHands& hands) {
  const math::Vec3 port = hands.GetScene().instruments[static_cast<std::size_t>(hand)].p_world_port;
  const math::Vec3 in = math::Normalized(place - port);
  hands.Reach(hand, 70, [=](const simulation::Snapshot&) { return place - 0.03 * in; });
  hands.Jaw(hand, 30, 1.0);
  hands.Reach(hand, 30, [=](const simulation::Snapshot&) { return place + 0.006 * in; });
  hands.Jaw(hand, 40, jaw);
  hands.Exchange(hand, 20, other);
  hands.Reach(hand, 80, [=](const simulation::Snapshot&) { return place + 0.006 * in + pull; });
}

/// Cuts the circle out, lifts it, and pulls lightly held at the rest until it slips.
inline void LiftPiece(ScriptedHands& hands) {
  const math::Vec3 middle = hands.GetScene().model->sheets.front().centre;
  hands.LeaveTo("expert",
                [](const simulation::Snapshot& seen) { return seen.operation.sheets.front().is_free; });
  hands.Wait(10);
  HoldAndAsk(instrument::kLeft, middle, "suction_irrigator", 0.0, {0.005, 0, 0.03}, hands);
  hands.Exchange(instrument::kRight, 75, "grasper");
  HoldAndAsk(instrument::kRight, middle + math::Vec3{0.027, 0, 0}, "hook", 0.19, {0, 0, 0.06}, hands);
}

/// Goes on cutting where the tissue stands still because it was bad too often in a row.
inline void CutFrozen(ScriptedHands& hands) {
  constexpr int kBad = 6, kGoesOnCutting = 200;
  const auto has_cut = [](const simulation::Snapshot& seen) { return seen.operation.topology.version > 20; };
  std::shared_ptr<Surgeon> surgeon = std::move(*MakeSurgeon("expert", hands.SharedScene(), 1));
  int bad = -1;
  hands.Add([=](const simulation::Snapshot& seen, int, scene::Input& input) mutable {
    input = surgeon->Act(seen);
    if (bad < 0 && !has_cut(seen)) return true;
    if (++bad < kBad) {
      input.settings.solver.kind = tissue::SolverKind::kRelaxationPaper;
      input.settings.solver.relaxation.alpha = 1e6;  // far beyond the bound of stability [m/N]
    }
    return bad < kGoesOnCutting;
  });
}

/// \return nothing where nobody has that name
inline std::optional<ScriptedHands> MakeScriptedHands(const std::string& name,
                                                      std::shared_ptr<const scene::Scene> scene) {
  ScriptedHands hands(std::move(scene));
  if (name == "takes_stones") {
    OpenGallbladder(hands);
    hands.Exchange(instrument::kRight, 75, "grasper");
    for (const int hand : {instrument::kRight, instrument::kLeft}) {
      TakeStone(hand, hands);
      hands.Jaw(hand, 50, 1.0);
    }
    TakeStone(instrument::kRight, hands);
    hands.Exchange(instrument::kRight, 75, "suction_irrigator");
    hands.Wait(60);
    return hands;
  }
  if (name == "lifts_piece") return LiftPiece(hands), hands;
  if (name == "cuts_frozen") return CutFrozen(hands), hands;
  if (name == "lets_assistant_hold") {
    hands.Wait(60);
    hands.Add([](const simulation::Snapshot&, int tick, scene::Input& input) {
      input.assistant = scene::AssistantCommand::kRetract;
      return tick < 400;
    });
    return hands;
  }
  const int hand = name.ends_with("_left") ? instrument::kLeft : instrument::kRight;
  if (name.starts_with("divides_")) return Divide(hand, hands), hands;
  if (name.starts_with("spreads_")) return SpreadFat(hand, hands), hands;
  return std::nullopt;
}

}  // namespace trocar::agent
