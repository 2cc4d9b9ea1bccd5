// SPDX-License-Identifier: Apache-2.0
// How stiff a wall may be through a maker's library: a light grip presses the stand-in's device against a wall, the force
// comes a call after the position that it was made from, as in the running program.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stand_in_gate.h"
#include "trocar/device/open_haptics.h"

namespace trocar::haptics {
// as in haptics/coupling.h, which brings the real gate along
double CalcStiffnessCap(const device::ForceLimits& limits, double tick) noexcept;
}  // namespace trocar::haptics

namespace trocar::session {
namespace {

using device::OpenHaptics;

class LibraryWall : public testing::Test {
 protected:
  void SetUp() override {
    library_ = ::dlopen(TROCAR_STAND_IN_HD, RTLD_NOW);
    ASSERT_NE(library_, nullptr);
    Find<void(int)>("StandInStepped")(1);
  }
  void TearDown() override {
    Find<void(int)>("StandInStepped")(0);
    ::dlclose(library_);
  }
  template <typename Function>
  Function* Find(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(library_, name));
  }

  /// How far the hand shakes in the last half second of three [m].
  ///
  /// \param stiffness  chosen from the limits that the driver gives [N/m]
  template <typename Choose>
  double Shake(Choose&& stiffness) {
    device::OpenHapticsSettings settings;
    settings.hd_file = TROCAR_STAND_IN_HD;
    settings.names = {"Left"};
    OpenHaptics driver(settings);
    EXPECT_TRUE(driver.Configure().ok() && driver.Activate().ok());
    Find<void(int)>("StandInStepped")(1);
    const double wall = stiffness(driver.GetLimits(0));
    std::array<device::ForceSample, 1> sample;
    double lowest = 1, highest = -1;
    for (int tick = 0; tick < 3000; ++tick) {
      Find<void()>("StandInStep")();
      driver.ReadForceSamples(sample);
      const double depth = std::max(0.0, -sample[0].position.y);
      driver.SendForce(0, haptics::ForceGate::Make({0, std::min(3.3, wall * depth), 0}));
      if (tick < 2500) continue;
      lowest = std::min(lowest, Find<double()>("StandInHand")());
      highest = std::max(highest, Find<double()>("StandInHand")());
    }
    EXPECT_LT(highest, 0.005);
    return highest - lowest;
  }
  void* library_ = nullptr;
};

TEST_F(LibraryWall, StandsStillAtTheStiffnessThatIsAssumed) {
  const auto cap = [](const device::ForceLimits& limits) {
    const double stiffness = haptics::CalcStiffnessCap(limits, 0.001);
    EXPECT_NEAR(stiffness, 400, 1e-6) << "what was proved for a Touch, not its maker's 1,020";
    return stiffness;
  };
  EXPECT_LT(Shake(cap), 0.0003);
}

// the control: the maker's own figure
TEST_F(LibraryWall, ShakesAtTheMakersStiffness) {
  EXPECT_GT(Shake([](const device::ForceLimits& limits) { return limits.max_stiffness; }), 0.002);
}

}  // namespace
}  // namespace trocar::session
