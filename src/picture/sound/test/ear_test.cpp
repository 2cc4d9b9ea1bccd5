// SPDX-License-Identifier: Apache-2.0
#include "trocar/sound/ear.h"

#include <gtest/gtest.h>

namespace trocar::sound {
namespace {

constexpr auto kHook = instrument::ToolKind::kHook;
constexpr auto kGrasper = instrument::ToolKind::kGrasper;

/// A hook and a grasper for each hand, in that order; a patient of one organ.
scene::Scene MakeScene() {
  scene::Scene scene;
  scene.patient.organs.resize(1);
  for (auto& setup : scene.instruments) {
    setup.tray.resize(2);
    setup.tray[0].kind = kHook;
    setup.tray[1].kind = kGrasper;
  }
  return scene;
}

void Happen(simulation::Snapshot& snapshot, surgery::FactKind kind) {
  snapshot.events[snapshot.event_count++ % snapshot.events.size()].kind = kind;
}

TEST(Ear, PedalsSoundOnlyWithAnElectrodeInTheHand) {
  const scene::Scene scene = MakeScene();
  simulation::Snapshot snapshot;
  scene::Input input;
  Ear ear;
  const auto listen = [&] { return ear.Listen(scene, snapshot, input, true).energy; };
  EXPECT_EQ(listen(), EnergyTone::kNone);
  input.controls[instrument::kRight].coagulate = true;
  EXPECT_EQ(listen(), EnergyTone::kCoagulation);
  input.controls[instrument::kLeft].cut = true;
  EXPECT_EQ(listen(), EnergyTone::kCut);
  snapshot.operation.tools = {1, 1};
  EXPECT_EQ(listen(), EnergyTone::kNone);
  snapshot.operation.has_current[instrument::kLeft] =
      true;  // of an expert, whose pedals are not in the input
  input.controls = {};
  EXPECT_EQ(listen(), EnergyTone::kCoagulation);
  EXPECT_EQ(ear.Listen(scene, snapshot, input, false).energy, EnergyTone::kNone);
}

TEST(Ear, CountsClosedClipsOnceAndGoesOnAfterAReset) {
  const scene::Scene scene = MakeScene();
  simulation::Snapshot snapshot;
  Ear ear;
  const auto clicks = [&] { return ear.Listen(scene, snapshot, {}, true).clicks; };
  EXPECT_EQ(clicks(), 0u);
  Happen(snapshot, surgery::FactKind::kGrasp);
  Happen(snapshot, surgery::FactKind::kClipClosed);
  EXPECT_EQ(clicks(), 1u);
  EXPECT_EQ(clicks(), 1u);
  for (int i = 0; i < 20; ++i) Happen(snapshot, surgery::FactKind::kClipClosed);
  EXPECT_EQ(clicks(), 1u + simulation::kEventRing);  // older ones have left the ring
  snapshot.event_count = 0;
  EXPECT_EQ(clicks(), 1u + simulation::kEventRing);
  Happen(snapshot, surgery::FactKind::kClipClosed);
  EXPECT_EQ(clicks(), 2u + simulation::kEventRing);
}

TEST(Ear, MonitorFollowsLostBloodAndIsNotThereOverABox) {
  scene::Scene scene = MakeScene();
  simulation::Snapshot snapshot;
  Ear ear;
  EXPECT_TRUE(ear.Listen(scene, snapshot, {}, true).has_pulse);
  EXPECT_EQ(ear.Listen(scene, snapshot, {}, true).signs, CalcVitalSigns(0));
  snapshot.operation.flow.ledger.Leak(surgery::Fluid::kBile, 1e-3);
  EXPECT_EQ(ear.Listen(scene, snapshot, {}, true).signs, CalcVitalSigns(0));
  snapshot.operation.flow.ledger.Leak(surgery::Fluid::kBlood, 1e-3);
  EXPECT_EQ(ear.Listen(scene, snapshot, {}, true).signs, CalcVitalSigns(1e-3));
  EXPECT_FALSE(ear.Listen(scene, snapshot, {}, false).has_pulse);
  scene.patient.organs.clear();
  EXPECT_FALSE(ear.Listen(scene, snapshot, {}, true).has_pulse);
}

}  // namespace
}  // namespace trocar::sound
