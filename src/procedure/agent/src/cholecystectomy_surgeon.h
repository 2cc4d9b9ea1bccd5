// SPDX-License-Identifier: Apache-2.0
/// \file cholecystectomy_surgeon.h  Scripted surgeons of the cholecystectomy: one who does all of it, and careless ones.
///
/// They know the patient as a surgeon does, from what is seen: where ducts, gallbladder and fibres are now
/// (Snapshot), never what the simulation thinks of it but for what the window shows: the critical view.
///
/// The plan is a row of acts, made from the table of goals (cholecystectomy_goals.h). What each act does in a tick is in
/// act_execution.h; what the planners choose, in one file for each: hold, traction, hook, spread, division, turn, view, camera.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>

#include "careless_cholecystectomy.h"
#include "operation_memory.h"
#include "organ_clearance.h"
#include "patient_knowledge.h"
#include "surgeon_act.h"
#include "surgeon_view.h"
#include "trocar/agent/skill.h"
#include "trocar/agent/surgeon.h"
#include "trocar/simulation/model_description.h"

namespace trocar::agent {

class CholecystectomySurgeon final : public Surgeon {
 public:
  CholecystectomySurgeon(std::shared_ptr<const scene::Scene> scene, const SurgeonSkill& skill,
                         OperationErrorScenario error_scenario, std::uint64_t seed);

  scene::Input Act(const simulation::Snapshot& seen) override;
  bool HasFinished() const override { return course_.has_finished; }
  std::string_view Doing() const override { return course_.doing; }
  std::optional<std::uint8_t> OwnPhase() const override;
  std::string_view BailOutReason() const override { return memory_.bail_out; }
  void VisitState(base::StateArchive& archive) override;
  void KnowFirstView(const instrument::TrocarJoints& laparoscope) override;

 private:
  /// The plan, and how far it has come.
  struct Course {
    std::deque<SurgeonAct> acts;  // the first is under way, once it has begun
    bool has_begun = false, has_finished = false;
    double act_seconds = 0;
    std::string doing;
  };
  SurgeonView See(const simulation::Snapshot& seen);
  void GoOn(const SurgeonView& view);
  bool WatchProgress(const SurgeonAct& act, const SurgeonView& view);

  std::shared_ptr<const scene::Scene> scene_;
  PatientKnowledge known_;                // constant
  bool operates_ = true;                  // means to finish; constant
  bool has_goals_ = false;                // its plan is that of a whole operation; constant
  OrganClearance organs_;                 // follows what is seen
  cholecystectomy::TriangleSight sight_;  // likewise
  OperationMemory memory_;
  Course course_;
};

/// Whether a scene is one that they can operate on.
bool IsCholecystectomy(const scene::Scene& scene);

}  // namespace trocar::agent
