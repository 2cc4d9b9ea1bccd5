// SPDX-License-Identifier: Apache-2.0
/// \file operation.h  Surgery in the tick: tools that cut, burn, clip, rinse and carry away, and what comes of it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "operation/assistant.h"
#include "operation/operated.h"
#include "operation/tools/tool_use.h"
#include "trocar/instrument/camera.h"
#include "trocar/scene/patient_tissue.h"
#include "trocar/scene/patient_vessels.h"
#include "trocar/scene/procedure.h"
#include "trocar/simulation/operation_result.h"
#include "trocar/simulation/simulation.h"
#include "trocar/surgery/bed_ooze.h"
#include "trocar/surgery/cuttable_organ.h"
#include "trocar/surgery/electrosurgery.h"
#include "trocar/surgery/fact.h"
#include "trocar/surgery/gallstone_spill.h"
#include "trocar/surgery/observation.h"
#include "trocar/surgery/organ_attachment.h"
#include "trocar/surgery/pattern_cut_monitor.h"
#include "trocar/surgery/vessels.h"

namespace trocar::simulation {

class Operation {
 public:
  /// Nodes that cuts may use.
  static constexpr scene::SpareNodes kSpare{500, 32};

  /// \return kPatientInvalid or kMeshInvalid
  static base::Result<std::unique_ptr<Operation>> Make(const scene::Scene& scene,
                                                       std::shared_ptr<const scene::PatientTissue> tissue);

  /// Begins a tick, before all other calls.
  /// \param facts  of the tick, to which the stages add; outlives the tick
  void BeginTick(surgery::FactList& facts) noexcept { facts_ = &facts; }

  // --- tools

  const instrument::Tool& Tool(int hand) const {
    return scene_->instruments[hand].tray[active_[static_cast<std::size_t>(hand)]];
  }
  /// Adapts the wanted joints of a hand: a tool that is exchanged is drawn out.
  /// \param is_holding  then there is no exchange, unless it is the bag that holds
  /// \return false where an exchange was asked for and refused
  /// \note Real-time safe.
  bool MoveTool(int hand, const scene::HandControls& controls, bool is_holding, double seconds,
                instrument::TrocarJoints& wanted) noexcept;

  /// Opening that a stone between the jaws allows them [rad]. Stones are taken and let go here.
  /// \param is_holding  tissue
  /// \note Real-time safe.
  double StopJaw(int hand, double jaw_before, double jaw, bool is_holding) noexcept;
  bool HoldsStone(int hand) const { return parts_.stones.HeldBy(hand) >= 0; }

  // --- the stages of a tick

  /// Tools cut, clip, rinse, and let current flow.
  /// \note Real-time safe, as are all stages.
  void Act(const HandsNow& hands, OperatedTissue& tissue) noexcept;
  /// Heat flows, and tissue that the current has heated gives way.
  void Heat(const HandsNow& hands, OperatedTissue& tissue) noexcept;
  /// The third hand.
  void Assist(const HandsNow& hands, OperatedTissue& tissue) noexcept;
  /// Completes the cuts of Act. \return whether nodes or springs changed: then Change() says which
  bool EndCuts() noexcept;
  const surgery::TopologyChange& Change() const { return parts_.change; }
  /// After the solve: blood and bile run, stones leave with the bile, clips slip.
  void Flow(const HandsNow& hands, OperatedTissue& tissue) noexcept;
  /// Loose stones and clips fall, are pushed and carried.
  void MoveLoose(const HandsNow& hands, const OperatedTissue& tissue) noexcept;

  /// Observation of this tick so far. It refers to the state of the tick, which has to outlive it.
  /// \param camera  through which the trainee looks
  surgery::OperationObservation Observe(const HandsNow& hands, const OperatedTissue& tissue,
                                        const instrument::Camera& camera) const noexcept;
  /// The procedure's judge, who knows this operation's anatomy; null where the scene names no procedure.
  std::unique_ptr<scene::ProcedureJudge> MakeJudge() const;

  const surgery::CuttableOrgan& Organ(std::size_t i) const { return parts_.organs[i]; }
  /// Ducts and vessels as they are now, for contacts.
  std::vector<collision::TubePiece> TubePieces() const;
  std::vector<std::uint32_t> TubesOfPieces() const;
  std::span<const scene::StrandInfo> Strands() const { return strands_; }

  void Size(OperationSnapshot& snapshot) const;
  void Publish(const tissue::TissueState& tissue, OperationSnapshot& snapshot) const noexcept;
  /// How it stands: what the judge says of it, fluids, stones, and how far the retrieval is.
  /// \param judge  null: nobody judges
  OperationResult CalcResult(const scene::ProcedureJudge* judge) const;

  /// Meshes and lines with their cuts. Before VisitState.
  void VisitTopology(base::StateArchive& archive);
  void VisitState(base::StateArchive& archive);

 private:
  struct HandState {
    BladeUse blade;
    SpreadUse spread;
    ElectrodeUse electrode;
    ClipUse clips;
    SuctionUse suction;
    bool was_refused = false;
    bool was_open = false;  // jaws, since they closed last
    bool was_outside_emitted = false;
    double exchange_seconds = 0;
    void VisitState(base::StateArchive& archive);
  };

  Operation(const scene::Scene& scene, std::vector<scene::StrandInfo> strands)
      : scene_(&scene), strands_(std::move(strands)) {}
  base::Status MakeAll();
  base::Status MakeOrgans();
  base::Status MakeTubes();
  void FindBandStrands();
  void MakeAssistant();
  void MakeOoze();
  double WidestTool(int hand) const noexcept;
  ToolUse UseOf(int hand, const HandsNow& hands, OperatedTissue& tissue) noexcept;
  void OpenTubeEnds(const OperatedTissue& tissue) noexcept;
  void KeepLeaked(tissue::OrganVolume& organ) const noexcept;
  void SpillStones(double leaked, const OperatedTissue& tissue) noexcept;
  void SlipClips(const HandsNow& hands, const OperatedTissue& tissue) noexcept;
  void EmitRetrieved(int hand, int count) noexcept;
  static void RefuseImpossible(ToolUse& use, HandState& state) noexcept;
  bool IsOf(std::uint32_t node, std::int32_t organ) const noexcept;
  /// A fact of that hand and the tool in it; of no hand: -1.
  surgery::Fact FactOf(surgery::FactKind kind, int hand) const noexcept;
  void Add(const surgery::Fact& fact) noexcept { facts_->Add(fact); }
  void AddOfTube(surgery::FactKind kind, int hand, const surgery::TubePlace& place,
                 const math::Vec3& position) noexcept;
  const scene::ElectrodeParameters& Electrode() const noexcept {
    return scene_->operation->parameters.electrode;
  }
  const scene::SuctionParameters& Suction() const noexcept { return scene_->operation->parameters.suction; }

  const scene::Scene* scene_;  // outlives this
  std::vector<scene::StrandInfo> strands_;
  std::shared_ptr<const scene::PatientTissue> made_;
  OperatedAnatomy anatomy_;
  scene::VesselAnatomy vessel_anatomy_;
  /// Where a duct or artery enters the organ that is taken out.
  struct TubeEnd {
    std::uint32_t node = 0;              // of the tube
    std::vector<std::uint32_t> strands;  // that tie it
    double section = 0;                  // [m^2]
    bool is_off = false;
  };
  std::vector<TubeEnd> tube_ends_;

  OperatedParts parts_;
  std::vector<surgery::PatternCutMonitor> sheets_;  // (ModelSetup::sheets), which are the organs
  surgery::OrganAttachment attachment_;
  std::optional<Assistant> assistant_;
  surgery::BedOoze ooze_;
  std::vector<surgery::LooseStone*> loose_clips_;  // scratch

  std::array<std::size_t, instrument::kHandCount> active_{};
  std::array<HandState, instrument::kHandCount> hands_;
  std::array<math::Pose, instrument::kHandCount> X_world_tools_;  // that are seen, in the tick before
  std::uint32_t topology_version_ = 0;
  surgery::FactList* facts_ = nullptr;  // outlives the tick
};

/// Adds the judge's part: errors, phase, measures and view.
void Publish(const scene::ProcedureJudge& judge, OperationSnapshot& snapshot) noexcept;

}  // namespace trocar::simulation
