// SPDX-License-Identifier: Apache-2.0
// A procedure that nothing but this file knows: what docs/procedures.md says, tried. A blind pouch, the appendix, is taken off a caecum;
// both are of roles that the engine has never heard of.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/files/scene_file.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/procedures/operation_end.h"
#include "trocar/scene/patient_tissue.h"
#include "trocar/scene/procedure.h"
#include "trocar/scene/scene_fields.h"
#include "trocar/simulation/simulation.h"
#include "trocar/simulation/snapshot_codec.h"

namespace trocar::procedures {
namespace {

using roles::LandmarkRole;
using roles::OrganRole;
using roles::TubeRole;
using scene::ProcedureSnapshot;
using simulation::Simulation;

// --- the procedure

constexpr OrganRole kCaecum{roles::kFirstOwnRole}, kAppendix{roles::kFirstOwnRole + 1};
constexpr TubeRole kAppendicularArtery{roles::kFirstOwnArtery};
constexpr LandmarkRole kBase{roles::kFirstOwnRole}, kTip{roles::kFirstOwnRole + 1};

enum class AppendectomyError : std::uint8_t { kCaecumBurnt, kCurrentUsed, kCount };
constexpr std::array<surgery::ErrorRow, 2> kErrors = {
    {{"caecum_burnt", "The electrode burnt the caecum.", surgery::Severity::kCritical},
     {"current_used", "The pedal was pressed.", surgery::Severity::kMinor}}};
constexpr std::array<scene::PhaseRow, 2> kPhases = {
    {{"Exposure", "Showing the appendix"}, {"Burning", "Burning"}}};
constexpr std::array<scene::MeasureRow, 1> kMeasures = {{{"held_share", "held", true}}};
constexpr std::array<TubeRole, 1> kDivided = {kAppendicularArtery};
constexpr std::array<scene::OwnRole<OrganRole>, 2> kOrganRoles = {
    {{kCaecum, "caecum"}, {kAppendix, "appendix"}}};
constexpr std::array<scene::PartRow, 2> kParts = {
    {{"start", "from the start",
      [](const ProcedureSnapshot&, const surgery::RetrievalObservation&) noexcept { return true; }},
     {"free", "until the appendix is free",
      [](const ProcedureSnapshot&, const surgery::RetrievalObservation& retrieval) noexcept {
        return retrieval.is_free;
      }}}};

class AppendectomyJudge final : public scene::ProcedureJudge {
 public:
  explicit AppendectomyJudge(const scene::OperatedPatient& patient)
      : caecum_(scene::FindSurface(patient.tissue.surfaces, kCaecum)), errors_(kErrors) {}

  void SeeTools(const surgery::OperationObservation& now) noexcept override {
    before_ = errors_.Entries().size();
    for (const surgery::Fact& fact : now.facts) {
      if (fact.kind == surgery::FactKind::kCurrentOn)
        errors_.Add({AppendectomyError::kCurrentUsed, now.time, fact.position, fact.hand});
      if (fact.kind == surgery::FactKind::kOrganBurnt && fact.surface == caecum_)
        errors_.Add({AppendectomyError::kCaecumBurnt, now.time, fact.position, fact.hand});
    }
  }
  void Update(const surgery::OperationObservation& now) noexcept override {
    seconds_ += now.seconds;
    held_seconds_ += now.hands[0].is_holding ? now.seconds : 0.0;
  }
  std::span<const surgery::ErrorEntry> NewErrors() const noexcept override {
    return errors_.Entries().subspan(before_);
  }
  const surgery::ErrorLog& Errors() const noexcept override { return errors_; }
  void Publish(ProcedureSnapshot& snapshot) const noexcept override {
    snapshot.phase = errors_.Count() > 0 ? 1 : 0;
    snapshot.measures[0] = seconds_ > 0.0 ? held_seconds_ / seconds_ : 0.0;
  }
  scene::ProcedureResult CalcResult(const surgery::Vessels&, const surgery::StoneCount&) const override;
  void VisitState(base::StateArchive& archive) override {
    archive.Field("errors", errors_);
    archive.Field("seconds", seconds_);
    archive.Field("held_seconds", held_seconds_);
    if (archive.IsRestoring()) before_ = errors_.Entries().size();
  }

 private:
  std::int32_t caecum_;  // constant
  surgery::ErrorLog errors_;
  double seconds_ = 0, held_seconds_ = 0;
  std::size_t before_ = 0;
};

const scene::Procedure& Appendectomy() {
  static const scene::Procedure procedure = [] {
    scene::Procedure made;
    made.name = made.fingerprint = "appendectomy";
    made.organ = kAppendix, made.host = kCaecum;
    made.organ_name = "appendix";
    made.neck = kBase, made.tip = kTip;
    made.organ_roles = kOrganRoles;
    made.divided = kDivided;
    made.phases = kPhases;
    made.measures = kMeasures;
    made.errors = kErrors;
    made.parts = kParts;
    made.make_judge = [](const scene::OperatedPatient& patient) -> std::unique_ptr<scene::ProcedureJudge> {
      return std::make_unique<AppendectomyJudge>(patient);
    };
    return made;
  }();
  return procedure;
}

scene::ProcedureResult AppendectomyJudge::CalcResult(const surgery::Vessels&,
                                                     const surgery::StoneCount&) const {
  scene::ProcedureResult result;
  result.errors = errors_;
  scene::SizeSnapshot(Appendectomy(), result.now);
  Publish(result.now);
  result.findings = {{"peritonitis", false, false}};
  return result;
}

// --- a scene of it: the delivered patient, whose organs, artery and landmarks get the procedure's own roles

std::shared_ptr<const scene::Scene> MakeScene() {
  auto read = files::ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json");
  EXPECT_TRUE(read.ok()) << (read.ok() ? "" : read.error().Text());
  if (!read.ok()) return nullptr;
  scene::Scene scene = std::move(*read);
  const auto rename = [&](OrganRole from, OrganRole to, const std::string& name) {
    patient::Organ& organ = scene.patient.organs[static_cast<std::size_t>(scene.patient.OrganOf(from))];
    for (patient::Tube& tube : scene.patient.tubes) {
      for (std::string* end : {&tube.from, &tube.to}) *end = *end == organ.name ? name : *end;
    }
    for (scene::OrganMaterial& material : scene.materials) {
      if (material.organ == organ.name) material.organ = name, material.tissue = roles::TissueRole::kOther;
    }
    organ.name = name, organ.role = to;
  };
  rename(OrganRole::kLiver, kCaecum, "caecum");
  rename(OrganRole::kGallbladder, kAppendix, "appendix");
  for (patient::Tube& tube : scene.patient.tubes)
    tube.role = tube.role == TubeRole::kCysticArtery ? kAppendicularArtery : TubeRole::kOther;
  for (patient::Landmark& landmark : scene.patient.landmarks) {
    landmark.role = landmark.role == LandmarkRole::kInfundibulum ? kBase
                    : landmark.role == LandmarkRole::kFundus     ? kTip
                                                                 : LandmarkRole::kOther;
  }
  scene.operation->procedure = &Appendectomy();
  return std::make_shared<const scene::Scene>(std::move(scene));
}

std::shared_ptr<const scene::Scene> SharedScene() {
  static const auto scene = MakeScene();
  return scene;
}

Simulation MakeSimulation() {
  auto made = Simulation::Make(SharedScene());
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().Text());
  return std::move(*made);
}

/// The right hand takes the hook and presses its pedal.
scene::Input Press(const Simulation& simulation) {
  scene::Input input = scene::CalcScriptInput(simulation.GetScene(), 0.0);
  const auto& tray = simulation.GetScene().instruments[instrument::kRight].tray;
  const auto hook = std::find_if(tray.begin(), tray.end(), [](const instrument::Tool& tool) {
    return tool.kind == instrument::ToolKind::kHook;
  });
  input.controls[instrument::kRight].tool = static_cast<std::uint8_t>(hook - tray.begin());
  input.controls[instrument::kRight].coagulate = true;
  return input;
}

TEST(SecondProcedure, IsSimulatedByAnEngineThatHasNeverHeardOfIt) {
  Simulation simulation = MakeSimulation();
  const auto& now = simulation.GetSnapshot().operation;
  ASSERT_EQ(now.procedure.measures.size(), 1u);
  EXPECT_TRUE(now.procedure.view.criteria.empty());
  EXPECT_FALSE(now.procedure.view.IsAchieved()) << "no view is asked for";
  const scene::Input input = Press(simulation);
  for (int tick = 0; tick < 20; ++tick) simulation.Step(input);
  EXPECT_EQ(scene::PhaseName(&Appendectomy(), now.procedure.phase), "Burning");
  EXPECT_GT(now.errors, 0u);
  EXPECT_EQ(now.critical_errors, 0u);
  const auto& snapshot = simulation.GetSnapshot();
  EXPECT_TRUE(std::any_of(snapshot.events.begin(), snapshot.events.end(), [](const scene::Event& event) {
    const surgery::ErrorRow* error = scene::FindError(&Appendectomy(), event.error);
    return event.kind == surgery::FactKind::kVerdict && error != nullptr && error->name == "current_used";
  })) << "a verdict is remembered";
  const auto result = simulation.GetOperationResult();
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->procedure.errors.Count(AppendectomyError::kCurrentUsed), now.errors);
  EXPECT_EQ(JudgeEnd(*result, true), OperationEnd::kConversion);
}

// Bed strands, contact and volume follow from what the patient file attaches, and from the table.
TEST(SecondProcedure, ItsOrganIsHollowAndLiesInItsBed) {
  const scene::Scene& scene = *SharedScene();
  const auto beds = scene.patient.ListBeds();
  ASSERT_EQ(beds.size(), 1u);
  EXPECT_EQ(scene.patient.organs[static_cast<std::size_t>(beds[0].organ)].role, kAppendix);
  EXPECT_EQ(scene.patient.organs[static_cast<std::size_t>(beds[0].host)].role, kCaecum);
  EXPECT_TRUE(roles::IsHollow(kAppendix));
  EXPECT_FALSE(roles::IsDuct(kAppendicularArtery));
  EXPECT_TRUE(scene::MayBeDivided(&Appendectomy(), kAppendicularArtery));
  EXPECT_FALSE(scene::MayBeDivided(&Appendectomy(), TubeRole::kCysticArtery));
  Simulation simulation = MakeSimulation();
  simulation.Step(Press(simulation));
  EXPECT_FALSE(simulation.GetSnapshot().operation.is_organ_free) << "its bed holds it";
  EXPECT_GT(simulation.GetSnapshot().organs[static_cast<std::size_t>(beds[0].organ)].volume, 0.0);
}

TEST(SecondProcedure, ItsJudgeIsSavedAndRestoredWithTheWorld) {
  Simulation played = MakeSimulation(), fresh = MakeSimulation();
  const scene::Input input = Press(played);
  for (int tick = 0; tick < 12; ++tick) played.Step(input);
  std::vector<std::byte> state;
  played.Save(state);
  ASSERT_TRUE(fresh.Restore(state).ok());
  EXPECT_EQ(fresh.Hash(), played.Hash());
  EXPECT_EQ(fresh.GetSnapshot().operation.errors, played.GetSnapshot().operation.errors);
  for (int tick = 0; tick < 12; ++tick) played.Step(input), fresh.Step(input);
  EXPECT_EQ(fresh.Hash(), played.Hash());
  const auto fields = played.HashFields();
  EXPECT_TRUE(std::any_of(fields.begin(), fields.end(), [](const auto& field) {
    return field.first == "judge/held_seconds";
  })) << "its own fields are the state's";
}

TEST(SecondProcedure, ItsSnapshotsTravelAndItsRowsAreChecked) {
  Simulation simulation = MakeSimulation();
  simulation.Step(Press(simulation));
  const simulation::SnapshotLayout layout = simulation::DescribeSnapshots(simulation);
  EXPECT_EQ(layout.phases, kPhases.size());
  simulation::SnapshotEncoder encoder(layout);
  simulation::SnapshotDecoder decoder(layout);
  std::vector<std::byte> message;
  simulation::Snapshot sent = simulation.GetSnapshot(), received;
  ASSERT_TRUE(encoder.EncodeWhole(sent, message).ok());
  ASSERT_TRUE(decoder.Decode(message, received).ok());
  EXPECT_EQ(received.operation.procedure.phase, sent.operation.procedure.phase);
  sent.operation.procedure.phase = kPhases.size();
  ASSERT_TRUE(encoder.EncodeWhole(sent, message).ok());
  EXPECT_FALSE(decoder.Decode(message, received).ok()) << "there is no such phase";
}

TEST(SecondProcedure, MakesItsScenesOthersThanThoseOfTheFirst) {
  scene::Scene scene = *SharedScene();
  const std::uint64_t own = scene::CalcSceneFingerprint(scene);
  scene.operation->procedure = FindProcedure(kUsualProcedure);
  const std::uint64_t usual = scene::CalcSceneFingerprint(scene);
  EXPECT_NE(own, usual);
  scene.operation->procedure = nullptr;
  EXPECT_EQ(scene::CalcSceneFingerprint(scene), usual) << "as scenes had it before procedures had names";
}

}  // namespace
}  // namespace trocar::procedures
