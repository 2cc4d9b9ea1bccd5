// SPDX-License-Identifier: Apache-2.0
#include "player.h"

#include <algorithm>
#include <utility>

#include "trocar/agent/surgeon.h"
#include "trocar/files/find_scene.h"
#include "trocar/record/replay.h"

namespace trocar::dataset {
namespace {

constexpr double kWidestView = 2.4;  // rad

scene::Input HomeOf(const scene::Scene& scene) {
  scene::Input input;
  for (int hand = 0; hand < instrument::kHandCount; ++hand) input.hands[hand] = scene.instruments[hand].home;
  input.laparoscope = scene.laparoscope.home;
  input.settings = scene.settings;
  return input;
}

class SurgeonPlayer : public Player {
 public:
  SurgeonPlayer(std::unique_ptr<agent::Surgeon> surgeon, simulation::Simulation simulation)
      : surgeon_(std::move(surgeon)),
        simulation_(std::move(simulation)),
        input_(HomeOf(simulation_.GetScene())) {}
  const simulation::Simulation& GetSimulation() const override { return simulation_; }
  bool HasFinished() const override { return surgeon_->HasFinished(); }
  std::string_view Doing() const override { return surgeon_->Doing(); }
  std::optional<std::uint8_t> OwnPhase() const override { return surgeon_->OwnPhase(); }
  void Step() override {
    input_ = surgeon_->Act(simulation_.GetSnapshot());
    simulation_.Step(input_);
  }
  const scene::Input& LastInput() const override { return input_; }

 private:
  std::unique_ptr<agent::Surgeon> surgeon_;
  simulation::Simulation simulation_;
  scene::Input input_;
};

class RecordingPlayer : public Player {
 public:
  RecordingPlayer(record::Replay replay, std::string name)
      : replay_(std::move(replay)),
        name_(std::move(name)),
        input_(replay_.GetRecording().FirstTick() == 0 ? HomeOf(replay_.GetSimulation().GetScene())
                                                       : replay_.GetRecording().inputs.front()) {}
  const simulation::Simulation& GetSimulation() const override { return replay_.GetSimulation(); }
  bool HasFinished() const override { return replay_.IsAtEnd(); }
  void Step() override {
    const record::Recording& recording = replay_.GetRecording();
    input_ = recording.inputs[replay_.Tick() - recording.FirstTick()];
    replay_.Step();
  }
  const scene::Input& LastInput() const override { return input_; }
  base::Status Finish() const override {
    if (!replay_.GetDivergence()) return {};
    return base::Error{
        base::ErrorCode::kRecordingInvalid,
        name_ + ": this program computes other states than were recorded from tick " +
            std::to_string(replay_.GetDivergence()->tick) +
            " on; use the program of the recording's version (trocar replay --verify names it)"};
  }

 private:
  record::Replay replay_;
  std::string name_;
  scene::Input input_;
};

}  // namespace

base::Result<std::unique_ptr<Player>> MakeSurgeonPlayer(const Plan& plan, std::uint64_t seed,
                                                        const std::filesystem::path& patient,
                                                        double field_of_view_scale) {
  auto read = files::FindScene(plan.task, {plan.level, seed, patient});
  if (!read) return read.error();
  read->laparoscope.field_of_view =
      std::min(kWidestView, read->laparoscope.field_of_view * field_of_view_scale);
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto simulation = simulation::Simulation::Make(scene);
  if (!simulation) return simulation.error();
  auto surgeon = agent::MakeSurgeon(plan.surgeon, scene, seed);
  if (!surgeon) return surgeon.error();
  return std::unique_ptr<Player>(
      std::make_unique<SurgeonPlayer>(std::move(*surgeon), std::move(*simulation)));
}

base::Result<std::unique_ptr<Player>> MakeRecordingPlayer(const std::filesystem::path& recording) {
  auto read = record::ReadRecording(recording);
  if (!read) return read.error();
  const std::string name = recording.filename().string();
  if (!read->damage.empty() || !read->ending || read->inputs.empty()) {
    return base::Error{base::ErrorCode::kRecordingInvalid,
                       name + ": " + (read->damage.empty() ? "it has no ending" : read->damage) +
                           "; a set is made of whole recordings: trocar record repair writes what is whole"};
  }
  auto replay = record::Replay::Open(std::move(*read), record::ReplaySettings{.visit_seconds = 0});
  if (!replay) return replay.error();
  return std::unique_ptr<Player>(std::make_unique<RecordingPlayer>(std::move(*replay), name));
}

}  // namespace trocar::dataset
