// SPDX-License-Identifier: Apache-2.0
#include "trocar/haptics/local_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pressed_sheet.h"

namespace trocar::haptics {
namespace {

/// A model that puts the tool almost into the hand, so that its place can be chosen.
LocalModelSettings MakeStiff() {
  LocalModelSettings settings;
  settings.coupling_stiffness = 1e5;
  settings.sweeps = 8;
  return settings;
}

/// Force once the sweeps have come to rest, of the tissue on the tool at `tool`.
LocalAnswer FindRest(LocalModel& model, const math::Vec3& hand, int ticks = 400) {
  LocalAnswer answer;
  for (int i = 0; i < ticks; ++i) answer = model.Step({{}, hand});
  return answer;
}

TEST(LocalModel, AnswersWithTheTicksForceWhereItWasCut) {
  PressedSheet sheet;
  sheet.Solve({0, 0, -0.003});
  ASSERT_GT(sheet.force.z, 0.1);
  const tissue::LocalPatch patch = sheet.Cut();
  ASSERT_EQ(patch.kind, tissue::LocalPatch::Kind::kSegment);
  for (const double coupling : {50.0, 400.0, 1e5}) {
    LocalModelSettings settings;
    settings.coupling_stiffness = coupling;
    LocalModel model(settings);
    model.Take(patch);
    // the hand so far beyond that the coupling carries just this force
    const math::Vec3 hand = sheet.p_world_tool - sheet.force / coupling;
    const LocalAnswer answer = FindRest(model, hand, 40);
    EXPECT_LT(math::Distance(answer.force, sheet.force), 1e-9) << coupling;
    EXPECT_LT(math::Distance(answer.p_world_tool, sheet.p_world_tool), 1e-12) << coupling;
  }
}

// Oracle: the whole sheet's equilibrium with the tool elsewhere. The rim stands still, so a segment is too stiff, and
// the less the wider it is.
TEST(LocalModel, FollowsTheWholeSystemTheBetterTheWiderItIs) {
  for (const math::Vec3 step : {math::Vec3{0, 0, -0.0008}, math::Vec3{0, 0, 0.0008}}) {
    double error_before = 1;
    for (int rings = 1; rings <= 3; ++rings) {
      PressedSheet sheet;
      sheet.Solve({0, 0, -0.003});
      const math::Vec3 force_at_cut = sheet.force;
      LocalModel model(MakeStiff());
      model.Take(sheet.Cut(rings));
      const LocalAnswer answer = FindRest(model, sheet.p_world_tool + step);
      const math::Vec3 tool = answer.p_world_tool;
      sheet.Solve(tool);
      const double change = math::Norm(sheet.force - force_at_cut);
      const double error = math::Distance(answer.force, sheet.force) / change;
      EXPECT_LT(error, error_before) << rings;
      if (step.z < 0.0) {
        EXPECT_GT(answer.force.z, sheet.force.z) << rings;
      }
      RecordProperty("error_" + std::to_string(rings), std::to_string(error));
      error_before = error;
    }
    EXPECT_LT(error_before, 0.05) << "three rings";
  }
}

TEST(LocalModel, LetsGoWhereTheToolLeaves) {
  PressedSheet sheet;
  sheet.Solve({0, 0, -0.003});
  LocalModelSettings settings;
  LocalModel model(settings);
  model.Take(sheet.Cut());
  const LocalAnswer away = FindRest(model, {0, 0, 0.002}, 100);
  EXPECT_LT(math::Norm(away.force), 1e-6);
  EXPECT_LT(math::Distance(away.p_world_tool, {0, 0, 0.002}), 1e-6);
}

TEST(LocalModel, PullsByWhatTheJawsHold) {
  PressedSheet sheet;
  sheet.Hold();
  sheet.Solve({0, 0, 0.004});
  ASSERT_LT(sheet.force.z, -0.1);
  const tissue::LocalPatch patch = sheet.Cut();
  ASSERT_EQ(patch.held_count, 2u);
  LocalModel model(MakeStiff());
  model.Take(patch);
  EXPECT_LT(math::Distance(FindRest(model, sheet.p_world_tool - sheet.force / 1e5).force, sheet.force), 1e-6);
  const math::Vec3 further = sheet.p_world_tool + math::Vec3{0.0005, 0, 0.001};
  const LocalAnswer answer = FindRest(model, further);
  const math::Vec3 before = sheet.force;
  sheet.Solve(answer.p_world_tool);
  EXPECT_LT(math::Distance(answer.force, sheet.force), 0.25 * math::Distance(before, sheet.force));
}

/// Compares the Jacobian at a hand with central differences of converged answers.
/// \param step       of the hand [m]
/// \param tolerance  [N/m]
/// \return the answer there
LocalAnswer ExpectJacobianIsDerivative(const tissue::LocalPatch& patch, const LocalModelSettings& settings,
                                       const math::Vec3& hand, int ticks, double step, double tolerance) {
  const auto answer_at = [&](const math::Vec3& p) {
    LocalModel model(settings);
    model.Take(patch);
    return FindRest(model, p, ticks);
  };
  const LocalAnswer answer = answer_at(hand);
  for (int axis = 0; axis < 3; ++axis) {
    math::Vec3 nudge;
    nudge[axis] = step;
    const math::Vec3 change = answer_at(hand + nudge).force - answer_at(hand - nudge).force;
    for (int row = 0; row < 3; ++row)
      EXPECT_NEAR(answer.jacobian[row][axis], change[row] / (2 * step), tolerance) << row << axis;
  }
  return answer;
}

// Springs shorter than at rest count along their direction only.
TEST(LocalModel, JacobianIsTheForcesDerivative) {
  for (const bool holds : {false, true}) {
    PressedSheet sheet;
    if (holds) sheet.Hold();
    sheet.Solve({0.0002, 0, holds ? 0.004 : -0.003});
    const tissue::LocalPatch patch = sheet.Cut();
    LocalModelSettings settings;
    settings.coupling_stiffness = 400;
    settings.sweeps = 8;
    const math::Vec3 hand = sheet.p_world_tool - sheet.force / 400.0;
    SCOPED_TRACE(holds);
    const LocalAnswer answer = ExpectJacobianIsDerivative(patch, settings, hand, 500, 2e-6, 4.0);
    EXPECT_LT(answer.jacobian[2].z, -50.0);
    EXPECT_GT(answer.jacobian[2].z, -400.0) << "stiffer than the coupling";
  }
}

TEST(LocalModel, ForceIsContinuousWhenSegmentsChange) {
  PressedSheet sheet;
  LocalModel model{LocalModelSettings{}};
  math::Vec3 last;
  double largest = 0;
  const auto step = [&](const math::Vec3& hand) {
    const math::Vec3 force = model.Step({{}, hand}).force;
    largest = std::fmax(largest, math::Distance(force, last));
    last = force;
  };
  // segments that have little to do with each other, one every eight ticks, at a hand that stands
  const math::Vec3 hand{0, 0, -0.006};
  for (const double depth : {0.003, 0.001, 0.004, 0.0, 0.0035}) {
    sheet.Solve({0, 0, -depth});
    tissue::LocalPatch patch = sheet.Cut();
    if (depth == 0.0) patch.kind = tissue::LocalPatch::Kind::kNone;
    model.Take(patch);
    const math::Vec3 before = last;
    step(hand);
    EXPECT_LT(math::Distance(before, last), 1e-12) << depth;
    for (int i = 0; i < 8; ++i) step(hand);
  }
  EXPECT_GT(math::Norm(last), 0.2);
  EXPECT_LT(largest, 0.25) << "a jump within a segment or its blending";
}

TEST(LocalModel, TurningTheShaftMovesWhatItPresses) {
  PressedSheet sheet;
  sheet.Solve({0, 0, -0.003});
  tissue::LocalPatch patch = sheet.Cut();
  // the tool's origin lies 50 mm to the side of what presses
  patch.X_world_tool.translation = {-0.05, 0, -0.003};
  for (std::uint32_t c = 0; c < patch.contact_count; ++c) patch.contacts[c].lever += math::Vec3{0.05, 0, 0};
  LocalModel model(MakeStiff());
  model.Take(patch);
  const auto turned = [&](double angle) {
    LocalAnswer answer;
    for (int i = 0; i < 300; ++i)
      answer = model.Step({math::RotationAbout({0, 1, 0}, angle), patch.X_world_tool.translation});
    return answer.force.z;
  };
  const double straight = turned(0.0);
  EXPECT_GT(turned(0.02), straight + 0.05);  // about +y: +x goes down, deeper
  EXPECT_LT(turned(-0.02), straight - 0.05);
}

/// A shaft that lies on the sheet between its trocar and its tip, both 100 mm away.
struct ShaftOnSheet {
  explicit ShaftOnSheet(double depth) { sheet.Solve({0, 0, -depth}); }
  tissue::LocalPatch Cut() const {
    tissue::PatchSource source = sheet.Source();
    source.X_world_tool.translation = tip + math::Vec3{0, 0, sheet.p_world_tool.z};
    source.has_pivot = true;
    source.p_world_pivot = pivot + math::Vec3{0, 0, sheet.p_world_tool.z};
    tissue::LocalPatch patch;
    tissue::PatchCutter(sheet.model.Size()).Cut(source, patch);
    return patch;
  }
  PressedSheet sheet;
  math::Vec3 tip{0.1, 0, 0}, pivot{-0.1, 0, 0};
};

// Analytic: half way between trocar and tip a force across is felt by half, and the tip goes twice as far.
TEST(LocalModel, WhatPressesTheShaftIsFeltByItsLever) {
  const ShaftOnSheet shaft(0.003);
  const tissue::LocalPatch patch = shaft.Cut();
  ASSERT_EQ(patch.kind, tissue::LocalPatch::Kind::kSegment);
  double felt = 0;
  for (std::uint32_t c = 0; c < patch.contact_count; ++c) {
    const tissue::LocalPatch::Contact& contact = patch.contacts[c];
    const double share = (contact.lever.x + 0.2) / 0.2;
    EXPECT_NEAR(share, 0.5, 0.05);
    EXPECT_NEAR(contact.tip_normal.z, share * contact.normal.z, 1e-12);
    felt += contact.stiffness * std::max(0.0, contact.depth) * share;
  }
  EXPECT_NEAR(patch.force.z, felt, 1e-9);
  EXPECT_NEAR(patch.force.z / shaft.sheet.force.z, 0.5, 0.01);

  LocalModel model(MakeStiff());
  model.Take(patch);
  const math::Vec3 start = patch.X_world_tool.translation;
  const LocalAnswer at_cut = FindRest(model, start - patch.force / MakeStiff().coupling_stiffness);
  EXPECT_LT(math::Distance(at_cut.force, patch.force), 1e-6) << "continuous with the tick";
  const LocalAnswer deeper = FindRest(model, start - math::Vec3{0, 0, 0.002});
  const double moved = deeper.p_world_tool.z - start.z;
  // the whole system, pressed half as far as the tip went
  ShaftOnSheet whole(0.003 - 0.5 * moved);
  EXPECT_NEAR(deeper.force.z, 0.5 * whole.sheet.force.z, 0.04 * whole.sheet.force.z);
  // stiffness at the tip: a quarter of that at the contact
  PressedSheet further;
  further.Solve({0, 0, -0.0031});
  const double at_contact = (further.force.z - shaft.sheet.force.z) / 0.0001;
  const double at_tip = (deeper.force.z - patch.force.z) / -moved;
  EXPECT_NEAR(at_tip / at_contact, 0.25, 0.04);
}

TEST(PatchCutter, TheLeverLeavesForcesAtTheTipAndAlongTheShaftAlone) {
  PressedSheet sheet;
  sheet.Solve({0, 0, -0.003});
  tissue::PatchSource source = sheet.Source();
  source.has_pivot = true;
  source.p_world_pivot = {0, 0, 0.15};  // above: the tip presses along the shaft
  tissue::LocalPatch patch;
  tissue::PatchCutter(sheet.model.Size()).Cut(source, patch);
  EXPECT_LT(math::Distance(patch.force, sheet.force), 1e-9);
  for (std::uint32_t c = 0; c < patch.contact_count; ++c)
    EXPECT_LT(math::Distance(patch.contacts[c].tip_normal, patch.contacts[c].normal), 1e-9);
  source.p_world_pivot = {-0.15, 0, -0.003};  // aside: it presses across, at the tip
  tissue::PatchCutter(sheet.model.Size()).Cut(source, patch);
  EXPECT_NEAR(patch.force.z, sheet.force.z, 0.02 * sheet.force.z);
}

TEST(LocalModel, NothingTouchedIsNoForce) {
  LocalModel model{LocalModelSettings{}};
  EXPECT_FALSE(model.Step({{}, {0.1, 0.2, 0.3}}).is_in_contact);
  tissue::LocalPatch patch;
  patch.is_healthy = true;
  model.Take(patch);
  const LocalAnswer answer = model.Step({{}, {0.1, 0.2, 0.3}});
  EXPECT_EQ(answer.force, math::Vec3());
  EXPECT_EQ(answer.p_world_tool, (math::Vec3{0.1, 0.2, 0.3}));
}

TEST(PatchCutter, TakesTheLinearModelWhereTooMuchIsTouched) {
  PressedSheet wide(20.0, 5);  // 121 contacts
  wide.Solve({0, 0, -0.003});
  const tissue::LocalPatch patch = wide.Cut();
  ASSERT_EQ(patch.kind, tissue::LocalPatch::Kind::kLinear);
  LocalModel model(MakeStiff());
  model.Take(patch);
  EXPECT_LT(math::Distance(FindRest(model, wide.p_world_tool - wide.force / 1e5).force, wide.force), 1e-6);
  // never softer than the tissue, and one-sided
  const LocalAnswer deeper = FindRest(model, wide.p_world_tool - math::Vec3{0, 0, 0.001});
  const math::Vec3 at_cut = wide.force;
  wide.Solve(deeper.p_world_tool);
  EXPECT_GT(deeper.force.z, wide.force.z);
  EXPECT_GT(wide.force.z, at_cut.z);
  EXPECT_EQ(FindRest(model, wide.p_world_tool + math::Vec3{0, 0, 0.02}).force, math::Vec3());
}

// more than there is room for: joined by direction, and still the tick's force at the tick's pose
TEST(PatchCutter, JoinsTheSpringsOfTheLinearModelThatFindNoRoom) {
  PressedSheet wide(20.0, 7);  // 225 contacts
  wide.Solve({0, 0, -0.003});
  const tissue::LocalPatch patch = wide.Cut();
  ASSERT_EQ(patch.kind, tissue::LocalPatch::Kind::kLinear);
  EXPECT_EQ(patch.press_count, tissue::LocalPatch::kMaxPresses);
  LocalModel model(MakeStiff());
  model.Take(patch);
  EXPECT_LT(math::Distance(FindRest(model, wide.p_world_tool - wide.force / 1e5).force, wide.force), 1e-6);
}

// Finite differences, where some springs press and others have let go.
TEST(LocalModel, TheLinearModelsJacobianIsItsForcesDerivative) {
  tissue::LocalPatch patch;
  patch.kind = tissue::LocalPatch::Kind::kLinear;
  patch.is_healthy = true;
  for (int i = 0; i < 12; ++i) {
    const double side = -1.2 + 0.2 * i;
    patch.presses[patch.press_count++] = {{0, std::sin(side), -std::cos(side)}, 0.02 * i, 20.0 + i};
    patch.force -= patch.presses[patch.press_count - 1].force * patch.presses[patch.press_count - 1].normal;
  }
  LocalModelSettings settings;
  settings.coupling_stiffness = 400;
  for (const math::Vec3& hand : {math::Vec3{}, math::Vec3{0.001, 0.004, 0.001}, math::Vec3{0, -0.01, 0.004}})
    ExpectJacobianIsDerivative(patch, settings, hand, 20, 1e-7, 0.1);
}

TEST(PatchCutter, NarrowsTheSegmentUntilItFits) {
  PressedSheet sheet(20.0, 3);  // 49 contacts: three rings of nodes do not fit
  sheet.Solve({0, 0, -0.002});
  const tissue::LocalPatch patch = sheet.Cut();
  EXPECT_EQ(patch.kind, tissue::LocalPatch::Kind::kSegment);
  EXPECT_LE(patch.node_count, tissue::LocalPatch::kMaxNodes);
  EXPECT_EQ(patch.contact_count, 49u);
}

TEST(PatchCutter, LeavesOutWhatAnotherToolTouches) {
  PressedSheet sheet;
  sheet.Solve({0, 0, -0.003});
  sheet.tools.assign(sheet.tools.size(), 1);
  EXPECT_EQ(sheet.Cut().kind, tissue::LocalPatch::Kind::kNone);
  sheet.tools[0] = 0;
  EXPECT_EQ(sheet.Cut().contact_count, 1u);
}

TEST(PatchCutter, MarksABadTick) {
  PressedSheet sheet;
  sheet.Solve({0, 0, -0.003});
  tissue::PatchSource source = sheet.Source();
  tissue::LocalPatch patch;
  tissue::PatchCutter cutter(sheet.model.Size());
  source.is_healthy = false;
  cutter.Cut(source, patch);
  EXPECT_FALSE(patch.is_healthy);
  source.is_healthy = true;
  source.force.x = NAN;
  cutter.Cut(source, patch);
  EXPECT_FALSE(patch.is_healthy);
  // and forgets nothing of its own: the next cut is whole
  source.force = sheet.force;
  cutter.Cut(source, patch);
  EXPECT_TRUE(patch.is_healthy);
  EXPECT_EQ(patch.node_count, sheet.Cut().node_count);
}

}  // namespace
}  // namespace trocar::haptics
