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

namespace trocar::agent {

class ScriptedHands {
 public:
  /// One tick of a step. \param tick  of the step \return whether it goes on
  using Act = std::function<bool(const Snapshot& seen, int tick, Input& input)>;

  explicit ScriptedHands(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {
    for (std::size_t hand = 0; hand < scene::kHandCount; ++hand)
      input_.hands[hand] = scene_->instruments[hand].home;
    input_.laparoscope = scene_->laparoscope.home;
  }

  Input operator()(const Snapshot& seen) {
    while (at_ < steps_.size() && !steps_[at_](seen, tick_++, input_)) ++at_, tick_ = 0;
    return input_;
  }

  void Add(Act act) { steps_.push_back(std::move(act)); }
  void Wait(int ticks) {
    Add([=](const Snapshot&, int tick, Input&) { return tick < ticks; });
  }
  /// For so many ticks, the tip on its way to a place that is looked up in each.
  void Reach(int hand, int ticks, std::function<math::Vec3(const Snapshot&)> place, double spin = 0) {
    Add([=, scene = scene_, place = std::move(place)](const Snapshot& seen, int tick, Input& input) {
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
    Add([=, scene = scene_](const Snapshot& seen, int tick, Input& input) {
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
    Add([=, tool = static_cast<std::uint8_t>(found - tray.begin())](const Snapshot&, int tick, Input& input) {
      input.controls[hand].tool = tool;
      return tick < ticks;
    });
  }
  /// Lets a surgeon of the library do it until something has come of it.
  void LeaveTo(const std::string& name, std::function<bool(const Snapshot&)> until) {
    auto made = MakeSurgeon(name, scene_, 1);
    std::shared_ptr<Surgeon> surgeon = made.ok() ? std::move(*made) : nullptr;
    Add([=, until = std::move(until)](const Snapshot& seen, int, Input& input) {
      if (surgeon == nullptr || surgeon->HasFinished() || until(seen)) return false;
      input = surgeon->Act(seen);
      return true;
    });
  }

  const Scene& GetScene() const { return *scene_; }

 private:
  std::shared_ptr<const Scene> scene_;
  Input input_;
  std::vector<Act> steps_;
  std::size_t at_ = 0;
  int tick_ = 0;
};

/// The spilled stone nearest to a hand's tool.
inline std::optional<math::Vec3> FindSpilledStone(const Snapshot& seen, int hand) {
  std::optional<math::Vec3> found;
  const math::Vec3& tip = seen.instruments[static_cast<std::size_t>(hand)].X_world_tool.translation;
  for (const simulation::StoneSnapshot& stone : seen.operation.stones) {
    if (stone.place != simulation::StonePlace::kSpilled) continue;
    if (!found || math::Distance(stone.position, tip) < math::Distance(*found, tip)) found = stone.position;
  }
  return found;
}

/// Takes a stone, lifts it, and lets it fall.
inline void TakeStone(int hand, ScriptedHands& hands) {
  const math::Vec3 port = hands.GetScene().instruments[static_cast<std::size_t>(hand)].p_world_port;
  const auto beyond = [=](double way) {
    return [=](const Snapshot& seen) {
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
  hands.Reach(hand, 60, [=](const Snapshot& seen) {
    return seen.instruments[static_cast<std::size_t>(hand)].X_world_device.translation +
           math::Vec3{0, 0, 0.001};
  });
}

/// Clips the scene's first duct or vessel and cuts it. The tray has to have both tools.
inline void Divide(int hand, ScriptedHands& hands) {
  const Scene& scene = hands.GetScene();
  const math::Vec3 port = scene.instruments[static_cast<std::size_t>(hand)].p_world_port;
  const auto& line = scene.patient.tubes.front().line.points;
  const std::size_t middle = line.size() / 2;
  const math::Vec3 along = math::Normalized(line[middle + 1] - line[middle]);
  const auto approach = [&](const std::string& name, std::size_t point) {
    const math::Vec3 p = line[point], in = math::Normalized(p - port);
    const double deep = 0.4 * instrument::FindTool(name)->jaw_length;
    const double spin = FindSpin(port, p, math::Cross(in, along));
    hands.Reach(
        hand, 70, [=](const Snapshot&) { return p - 0.03 * in; }, spin);
    hands.Jaw(hand, 30, 1.0);
    hands.Reach(
        hand, 50, [=](const Snapshot&) { return p + deep * in; }, spin);
    hands.Wait(10);
    hands.Jaw(hand, 40, 0.0);
    hands.Jaw(hand, 10, 0.5);
    hands.Reach(
        hand, 50, [=](const Snapshot&) { return p - 0.03 * in; }, spin);
  };
  hands.Exchange(hand, 75, "clip_applier");
  approach("clip_applier", middle);
  hands.Exchange(hand, 75, "scissors");
  approach("scissors", middle + 2);
}

/// Opens the dissector's jaws in the fat beside the cystic duct, from the gallbladder on.
inline void SpreadFat(int hand, ScriptedHands& hands) {
  const Scene& scene = hands.GetScene();
  const math::Vec3 port = scene.instruments[static_cast<std::size_t>(hand)].p_world_port;
  const auto& tubes = scene.patient.tubes;
  const auto duct = std::find_if(tubes.begin(), tubes.end(), [](const anatomy::Tube& tube) {
    return tube.role == roles::TubeRole::kCysticDuct;
  });
  hands.Exchange(hand, 75, "maryland");
  for (std::size_t i = 1; i + 1 < duct->line.points.size(); i += 2) {
    const math::Vec3 p = duct->line.points[i], in = math::Normalized(p - port);
    hands.Reach(hand, i == 1 ? 120 : 40, [=](const Snapshot&) { return p - 0.004 * in; });
    hands.Reach(hand, 20, [=](const Snapshot&) { return p + 0.002 * in; });
    hands.Jaw(hand, 30, 1.0);
    hands.Jaw(hand, 20, 0.0);
  }
}

/// \return nothing where nobody has that name
inline std::optional<ScriptedHands> MakeScriptedHands(const std::string& name,
                                                      std::shared_ptr<const Scene> scene) {
  ScriptedHands hands(std::move(scene));
  if (name == "takes_stones") {
    // opens the gallbladder, takes stones with either hand, lets them go, and takes one out
    hands.LeaveTo("perforates", [](const Snapshot& seen) {
      return std::count_if(seen.operation.stones.begin(), seen.operation.stones.end(), [](const auto& stone) {
               return stone.place == simulation::StonePlace::kSpilled;
             }) > 3;
    });
    hands.Exchange(scene::kRight, 75, "grasper");
    for (const int hand : {scene::kRight, scene::kLeft}) {
      TakeStone(hand, hands);
      hands.Jaw(hand, 50, 1.0);
    }
    TakeStone(scene::kRight, hands);
    hands.Exchange(scene::kRight, 75, "suction_irrigator");
    hands.Wait(60);
    return hands;
  }
  const int hand = name.ends_with("_left") ? scene::kLeft : scene::kRight;
  if (name.starts_with("divides_")) return Divide(hand, hands), hands;
  if (name.starts_with("spreads_")) return SpreadFat(hand, hands), hands;
  return std::nullopt;
}

}  // namespace trocar::agent
