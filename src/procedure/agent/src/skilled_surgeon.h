// SPDX-License-Identifier: Apache-2.0
/// \file skilled_surgeon.h  Another surgeon's inputs, later than they were meant, and with a picture that wanders off.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "trocar/agent/skill.h"
#include "trocar/agent/surgeon.h"

namespace trocar::agent {

/// Where in the loop of seeing and acting the time is lost makes no difference, so the inputs wait, not the pictures.
class SkilledSurgeon final : public Surgeon {
 public:
  SkilledSurgeon(std::unique_ptr<Surgeon> hands, const SurgeonSkill& skill, double tick_seconds,
                 std::uint64_t seed);

  scene::Input Act(const simulation::Snapshot& seen) override;
  bool HasFinished() const override { return hands_->HasFinished(); }
  std::string_view Doing() const override { return hands_->Doing(); }
  std::optional<std::uint8_t> OwnPhase() const override { return hands_->OwnPhase(); }
  std::string_view BailOutReason() const override { return hands_->BailOutReason(); }
  void VisitState(base::StateArchive& archive) override;
  void KnowFirstView(const instrument::TrocarJoints& laparoscope) override {
    hands_->KnowFirstView(laparoscope);
  }

 private:
  static constexpr int kSines = 2;
  std::unique_ptr<Surgeon> hands_;
  double tick_seconds_, drift_;
  std::array<std::array<double, kSines>, 2> frequency_{}, phase_{};  // of pan and tilt [Hz], [rad]
  /// Part of an input that changes from tick to tick.
  struct Waiting {
    std::array<instrument::TrocarJoints, instrument::kHandCount> hands;
    std::array<scene::HandControls, instrument::kHandCount> controls;
    scene::AssistantCommand assistant = scene::AssistantCommand::kWait;
    instrument::TrocarJoints laparoscope;
    void VisitState(base::StateArchive& archive);
  };
  std::vector<Waiting> waiting_;  // a ring
  std::uint64_t acted_ = 0;       // inputs that were made
};

}  // namespace trocar::agent
