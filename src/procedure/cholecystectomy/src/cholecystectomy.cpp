// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/cholecystectomy.h"

#include <array>
#include <memory>
#include <utility>

#include "patient_anatomy.h"
#include "trocar/cholecystectomy/injury.h"
#include "trocar/cholecystectomy/operation_error.h"
#include "trocar/cholecystectomy/operation_judge.h"
#include "trocar/cholecystectomy/triplet.h"
#include "trocar/scene/patient_tissue.h"
#include "trocar/scene/scene.h"

namespace trocar::cholecystectomy {
namespace {

using scene::ProcedureSnapshot;
using surgery::RetrievalObservation;

constexpr std::array<scene::MeasureRow, kMeasureCount> kMeasures = {
    {{"cleared_share", "cleared", true},
     {"detached_share", "detached", true},
     {"structures_entering", "structures_entering", false}}};
constexpr std::array<std::string_view, kCriterionCount> kCriteria = {"triangle", "plate", "two_structures"};
constexpr std::array<std::string_view, kSightCount> kSights = {"front", "behind"};

bool IsStart(const ProcedureSnapshot& /*now*/, const RetrievalObservation& /*retrieval*/) noexcept {
  return true;
}
bool HasView(const ProcedureSnapshot& now, const RetrievalObservation& /*retrieval*/) noexcept {
  return now.view.IsAchieved();
}
bool IsDivided(const ProcedureSnapshot& now, const RetrievalObservation& /*retrieval*/) noexcept {
  return now.Measure(kStructuresEntering) == 0.0;
}
bool IsFree(const ProcedureSnapshot& /*now*/, const RetrievalObservation& retrieval) noexcept {
  return retrieval.is_free;
}
bool IsOut(const ProcedureSnapshot& /*now*/, const RetrievalObservation& retrieval) noexcept {
  return retrieval.is_leaving;
}
constexpr std::array<scene::PartRow, 5> kParts = {
    {{"start", "from the start", IsStart},
     {"critical_view", "until the critical view of safety stands", HasView},
     {"divided", "until nothing enters the gallbladder any more", IsDivided},
     {"free", "until the gallbladder is off its bed", IsFree},
     {"completed", "until the gallbladder has left in its bag", IsOut}}};

/// The phases of Cholec80 (Twinanda et al. 2017) in words.
constexpr std::array<std::string_view, kPhaseCount> kPhaseTexts = {
    "Preparation",
    "Dissection of the hepatocystic triangle",
    "Clipping and cutting",
    "Dissection of the gallbladder from its bed",
    "Packing the gallbladder",
    "Cleaning and coagulation",
    "Taking the gallbladder out"};

std::array<scene::PhaseRow, kPhaseCount> ListPhases() {
  std::array<scene::PhaseRow, kPhaseCount> phases;
  for (std::size_t i = 0; i < phases.size(); ++i) phases[i] = {NameOf(static_cast<Phase>(i)), kPhaseTexts[i]};
  return phases;
}

std::unique_ptr<scene::ProcedureJudge> MakeJudge(const scene::OperatedPatient& patient) {
  const scene::Scene& scene = patient.scene;
  const scene::PatientTissue& tissue = patient.tissue;
  const surgery::JudgementSettings& settings = scene.operation->parameters.judgement;
  const MainNodes main =
      FindMainNodes(scene.patient, tissue.surfaces, patient.vessels, patient.anatomy.roles);
  JudgedAnatomy anatomy;
  anatomy.targets = MakeTargetTable(tissue.surfaces, tissue.strands);
  anatomy.biliary = patient.anatomy;
  anatomy.main_ducts = main.ducts;
  anatomy.organ_count = scene.patient.organs.size();
  anatomy.has_critical_view = scene::FindSurface(tissue.surfaces, roles::OrganRole::kGallbladder) >= 0;
  anatomy.may_cut_organs = scene.model.has_value();
  return std::make_unique<OperationJudge>(
      std::move(anatomy),
      DissectionMonitor(
          MakeDissectedAnatomy(scene.patient, {tissue.surfaces, tissue.strands, tissue.definition.rest}, main,
                               settings),
          tissue.definition.rest),
      settings);
}

scene::Procedure MakeTissueTask() {
  static const std::array<scene::PhaseRow, kPhaseCount> phases = ListPhases();
  scene::Procedure procedure;
  procedure.name = "tissue_task";
  // states of environments have always called it so, also where there is none
  procedure.organ_name = roles::NameOf(roles::OrganRole::kGallbladder);
  procedure.divided = kDividedVessels;
  procedure.phases = phases;
  procedure.measures = kMeasures;
  procedure.criteria = kCriteria;
  procedure.sights = kSights;
  procedure.errors = OperationErrors();
  procedure.parts = kParts;
  procedure.make_judge = MakeJudge;
  return procedure;
}

scene::Procedure MakeCholecystectomy() {
  scene::Procedure procedure = MakeTissueTask();
  procedure.name = "cholecystectomy";
  procedure.organ = roles::OrganRole::kGallbladder;
  procedure.host = roles::OrganRole::kLiver;
  procedure.neck = roles::LandmarkRole::kInfundibulum;
  procedure.tip = roles::LandmarkRole::kFundus;
  return procedure;
}

}  // namespace

const scene::Procedure& Cholecystectomy() noexcept {
  static const scene::Procedure procedure = MakeCholecystectomy();
  return procedure;
}

const scene::Procedure& TissueTask() noexcept {
  static const scene::Procedure procedure = MakeTissueTask();
  return procedure;
}

}  // namespace trocar::cholecystectomy
