// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/bed_ooze.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "operation_harness.h"
#include "trocar/patient/pathology.h"
#include "trocar/patient/patient.h"

namespace trocar::simulation {

using patient::CalcPathology;
using scene::StrandInfo;

namespace {

constexpr double kBed = 15e-6;  // of a whole bed [m^3]

class BedOozeTest : public OperationHarness {
 protected:
  BedOozeTest() : heat_(Tissue().definition, Tissue().heat_mass) { Make(1.0); }

  void Make(double bleeding) {
    const scene::SurfaceInfo& liver = Tissue().surfaces[static_cast<std::size_t>(liver_)];
    std::vector<surgery::BedFibre> fibres;
    bed_.clear();
    on_liver_.assign(Tissue().strands.size(), 0);
    for (std::uint32_t i = 0; i < on_liver_.size(); ++i) {
      const StrandInfo& strand = Tissue().strands[i];
      const bool is_bed = strand.kind == StrandInfo::Kind::kBed;
      if (is_bed) bed_.push_back(i);
      if (!is_bed && strand.kind != StrandInfo::Kind::kAdhesion) continue;
      for (const std::uint32_t node : {strand.a, strand.b}) {
        if (node < liver.first_node || node >= liver.first_node + liver.node_count) continue;
        on_liver_[i] = node;
        fibres.push_back({i, node, is_bed});
      }
    }
    ooze_ = surgery::BedOoze(fibres, bleeding);
  }
  double Wait(double seconds) {
    double out = 0;
    for (double t = 0; t < seconds - 0.5 * kTick; t += kTick)
      out += ooze_.Update(state_, heat_, Tissue().definition.rest.size(), kTick);
    return out;
  }
  /// \param from, to  shares of the bed's fibres
  void Tear(double from, double to) {
    const auto n = static_cast<double>(bed_.size());
    for (auto i = static_cast<std::size_t>(from * n); i < static_cast<std::size_t>(to * n); ++i)
      state_.strand_is_intact[bed_[i]] = 0;
  }

  surgery::Electrosurgery heat_;
  surgery::BedOoze ooze_;
  std::vector<std::uint32_t> bed_, on_liver_;
};

TEST_F(BedOozeTest, AWholeBedIsDry) {
  EXPECT_EQ(Wait(10.0), 0.0);
  EXPECT_EQ(ooze_.Lost(), 0.0);
}

TEST_F(BedOozeTest, WhatIsTornBleedsAsLongAsItTakesToClot) {
  Tear(0.0, 1.0);
  const double first = Wait(60.0);
  EXPECT_NEAR(first, 0.5 * kBed, 0.01 * kBed) << "half in the first minute";
  EXPECT_NEAR(Wait(60.0), 0.25 * kBed, 0.01 * kBed);
  EXPECT_NEAR(first + Wait(900.0), kBed - 0.25 * kBed, 0.01 * kBed);
  EXPECT_NEAR(ooze_.Lost(), kBed, 0.001 * kBed);
  EXPECT_LT(ooze_.Rate(), 1e-10) << "it has stopped by itself";
  // far below what counts as bleeding
  EXPECT_LT(ooze_.Lost(), 0.5 * 50e-6);
}

TEST_F(BedOozeTest, HalfABedLosesHalfAndACirrhoticOneFourTimesAsMuch) {
  Tear(0.0, 0.5);
  EXPECT_NEAR(Wait(1000.0), 0.5 * kBed, 0.02 * kBed);
  patient::Patient patient = OperationScene()->patient;
  EXPECT_EQ(CalcPathology(patient).bed_bleeding, 1.0);
  patient.parameters = {{"cirrhosis", 1.0, "", "set by the user"}};
  const double bleeding = CalcPathology(patient).bed_bleeding;
  EXPECT_NEAR(bleeding, 4.0, 1e-12);
  Make(bleeding);
  state_ = tissue::MakeRestState(model_);
  Wait(kTick);
  Tear(0.0, 0.5);
  EXPECT_NEAR(Wait(1000.0), 2.0 * kBed, 0.05 * kBed);
}

TEST_F(BedOozeTest, HeatStopsItAndWhatHeatPartsNeverBleeds) {
  // current along a third of the bed parts its fibres
  const auto n = Tissue().definition.rest.size();
  std::array<std::uint32_t, 16> parted;
  for (std::size_t i = 0; i < bed_.size() / 3; ++i) {
    const surgery::Electrosurgery::Target target{static_cast<std::uint32_t>(n + bed_[i]), 0.0, 1.0};
    surgery::Electrosurgery::Electrode electrode;
    electrode.power = 25.0;
    for (int tick = 0; tick < 40 && state_.strand_is_intact[bed_[i]] != 0; ++tick) {
      heat_.AddPower(electrode, {&target, 1});
      (void)heat_.Step(kTick, state_, parted);
      Wait(kTick);
    }
    ASSERT_EQ(state_.strand_is_intact[bed_[i]], 0);
  }
  EXPECT_EQ(Wait(60.0), 0.0);

  // a fibre that was torn cold bleeds until its place on the liver is blanched
  const std::uint32_t torn = bed_.back();
  state_.strand_is_intact[torn] = 0;
  EXPECT_GT(Wait(1.0), 0.0);
  const surgery::Electrosurgery::Target place{on_liver_[torn], 0.0, 1.0};
  surgery::Electrosurgery::Electrode electrode;
  electrode.power = 25.0;
  for (int tick = 0; tick < 1200 && heat_.InjuryOf(place.part) < surgery::HeatInjury::kBlanched; ++tick) {
    heat_.AddPower(electrode, {&place, 1});
    (void)heat_.Step(kTick, state_, parted);
  }
  Wait(kTick);
  EXPECT_EQ(Wait(10.0), 0.0);
}

TEST_F(BedOozeTest, ShowsThePlacesThatBleedMost) {
  Tear(0.0, 0.2);
  Wait(60.0);
  Tear(0.2, 1.0);
  Wait(kTick);
  std::array<surgery::OozeSnapshot, 32> oozes;
  ASSERT_EQ(ooze_.Publish(state_.position, oozes), oozes.size());
  for (std::size_t i = 1; i < oozes.size(); ++i) EXPECT_LE(oozes[i].rate, oozes[i - 1].rate);
  EXPECT_NEAR(oozes.back().rate, oozes.front().rate, 0.01 * oozes.front().rate) << "the fresh ones";
}

// In the operation: what ran out lies in the pool, to the drop.
TEST_F(BedOozeTest, IsCountedAsBlood) {
  MakeOperation();
  Tear(0.0, 1.0);
  for (int i = 0; i < 1200; ++i) Judge();
  const OperationResult result = Result();
  const auto& blood = result.fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)];
  EXPECT_GT(result.bed_blood, 1e-6);
  EXPECT_NEAR(blood.left, result.bed_blood, 1e-3 * blood.left);
  EXPECT_NEAR(blood.left, blood.pooled + blood.aspirated, 1e-3 * blood.left);
  EXPECT_EQ(CountErrors("bleeding"), 0u);
}

}  // namespace
}  // namespace trocar::simulation
