// SPDX-License-Identifier: Apache-2.0
// Energy of a simulated device against the local model: its mass, damping, friction and encoder steps as in the domain
// facts, sections 3.4 and 3.5 (Touch), force held over each tick.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pressed_sheet.h"
#include "trocar/haptics/coupling.h"
#include "trocar/haptics/local_model.h"
#include "trocar/math/random.h"

namespace trocar::haptics {
namespace {

constexpr double kTick = 0.001;  // [s]
constexpr int kSubsteps = 16;

device::ForceLimits Touch() {
  device::ForceLimits touch;
  touch.max_force = 3.3;
  touch.max_stiffness = 400;
  touch.damping = 0.2;
  touch.friction = 0.26;
  touch.mass = 0.045;
  touch.position_step = 0.055e-3;
  return touch;
}

/// What the encoders say of a place.
math::Vec3 Quantise(const math::Vec3& p, double step) {
  return {step * std::floor(p.x / step), step * std::floor(p.y / step), step * std::floor(p.z / step)};
}

struct Rendering {
  LocalModel model;
  double encoder_step;

  Rendering(const tissue::LocalPatch& patch, double stiffness, double step)
      : model([&] {
          LocalModelSettings settings;
          settings.coupling_stiffness = stiffness;
          return settings;
        }()),
        encoder_step(step) {
    model.Take(patch);
  }
  math::Vec3 Render(const math::Vec3& device) {
    return model.Step({{}, Quantise(device, encoder_step)}).force;
  }
};

/// Smooth closed path: still at both ends.
struct ClosedPath {
  math::Vec3 start;
  double duration = 0;
  struct Wave {
    math::Vec3 amplitude;
    double frequency, phase;
  } waves[3];

  ClosedPath(math::Random& random, const math::Vec3& from) : start(from) {
    duration = random.Uniform(0.05, 1.0);
    for (Wave& wave : waves) {
      wave.frequency = 0.5 * std::pow(200.0, random.Uniform());
      const double speed = 0.4 * random.Uniform();
      const double size = std::min(0.008, speed / (2 * std::numbers::pi * wave.frequency));
      wave.amplitude = size * math::Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
      wave.phase = random.Uniform(0, 2 * std::numbers::pi);
    }
  }
  math::Vec3 At(double t) const {
    const double window = std::pow(std::sin(std::numbers::pi * std::clamp(t / duration, 0.0, 1.0)), 2);
    math::Vec3 p = start;
    for (const Wave& wave : waves)
      p += window * std::sin(2 * std::numbers::pi * wave.frequency * t + wave.phase) * wave.amplitude;
    return p;
  }
};

/// Energy that a hand has to spend to lead the device once around: below zero, it gains [J].
double CalcHandWork(Rendering& rendering, const ClosedPath& path, const device::ForceLimits& device) {
  double work = 0;
  const int ticks = static_cast<int>(std::ceil(path.duration / kTick)) + 5;
  for (int i = 0; i < 60; ++i) rendering.Render(path.start);
  math::Vec3 here = path.start;
  for (int tick = 0; tick < ticks; ++tick) {
    const math::Vec3 force = rendering.Render(here);
    for (int i = 1; i <= kSubsteps; ++i) {
      const math::Vec3 next = path.At((tick + static_cast<double>(i) / kSubsteps) * kTick);
      const math::Vec3 moved = next - here;
      work += device.damping * math::SquaredNorm(moved) * kSubsteps / kTick +
              device.friction * math::Norm(moved) - math::Dot(force, moved);
      here = next;
    }
  }
  return work;
}

tissue::LocalPatch MakePatch(bool is_hard, double depth, int rings) {
  PressedSheet sheet(is_hard ? 2000.0 : 20.0);
  if (is_hard) {
    for (tissue::ContactSpring& contact : sheet.contacts) contact.stiffness = 20'000;
  }
  sheet.Solve({0, 0, -depth});
  return sheet.Cut(rings);
}

/// Smallest work over many paths, each against the patch that `patch_of` gives for it [J].
template <typename PatchOf>
double FindLeastWorkOn(PatchOf&& patch_of, int paths, double stiffness, const device::ForceLimits& device) {
  math::Random random(35);
  double least = INFINITY;
  for (int i = 0; i < paths; ++i) {
    Rendering rendering(patch_of(i, random), stiffness, device.position_step);
    const math::Vec3 start{0, 0, random.Uniform(-0.006, 0.002)};
    least = std::fmin(least, CalcHandWork(rendering, ClosedPath(random, start), device));
  }
  return least;
}

/// The same, soft and hard tissue in turn.
double FindLeastWork(int paths, double stiffness, const device::ForceLimits& device, int rings = 1) {
  const tissue::LocalPatch soft = MakePatch(false, 0.003, rings), hard = MakePatch(true, 0.0005, rings);
  return FindLeastWorkOn(
      [&](int i, math::Random&) -> const tissue::LocalPatch& { return i % 2 == 0 ? soft : hard; }, paths,
      stiffness, device);
}

/// What takes over where a segment is too large: a round shaft that presses some tissue under it, its contacts up to 70
/// degrees to both sides and a little along it.
tissue::LocalPatch MakeLinear(math::Random& random) {
  tissue::LocalPatch patch;
  patch.kind = tissue::LocalPatch::Kind::kLinear;
  patch.is_healthy = true;
  patch.X_world_tool.translation = {0, 0, -0.003};
  const double stiffness = 5.0 * std::pow(100.0, random.Uniform());  // of one contact [N/m]
  for (int contact = 0; contact < 80; ++contact) {
    const double side = random.Uniform(-1.2, 1.2);
    const math::Vec3 normal =
        math::Normalized(math::Vec3{0.2 * random.Uniform(-1, 1), std::sin(side), -std::cos(side)});
    patch.presses[patch.press_count++] = {normal, stiffness * random.Uniform(0, 0.002), stiffness};
    patch.force -= patch.presses[patch.press_count - 1].force * normal;
  }
  return patch;
}

#if defined(__SANITIZE_ADDRESS__)
constexpr int kPathCount = 50;  // thirty times slower there
#else
constexpr int kPathCount = 400;
#endif

void ExpectNoGain(int paths) {
  const device::ForceLimits touch = Touch();
  const double cap = CalcStiffnessCap(touch, kTick);
  EXPECT_EQ(cap, 400.0);
  EXPECT_GE(FindLeastWork(paths, cap, touch), 0.0);
}

TEST(Passivity, NoClosedPathGainsEnergy) {
  ExpectNoGain(kPathCount);
}

TEST(PassivitySlow, NoneOfAThousandClosedPathsGainsEnergy) {
  ExpectNoGain(1000);
}

// Each of its springs lets go on its own. One cut-off for all, on the plane where the whole force turns round, would leave a
// force across that plane: 17 mJ came out of a way round then.
TEST(Passivity, NoClosedPathGainsEnergyFromTheLinearModel) {
  const device::ForceLimits touch = Touch();
  const double cap = CalcStiffnessCap(touch, kTick);
  const auto linear = [](int, math::Random& random) { return MakeLinear(random); };
  EXPECT_GE(FindLeastWorkOn(linear, 1000, cap, touch), 0.0);
  device::ForceLimits bare = touch;
  bare.damping = 0.02;
  bare.friction = 0.0;
  EXPECT_LT(FindLeastWorkOn(linear, 100, 4000.0, bare), -1e-4) << "the control";
}

// The same against the widest segment, which is what runs where it fits.
void ExpectNoGainFromAWideSegment(int paths) {
  EXPECT_GE(FindLeastWork(paths, CalcStiffnessCap(Touch(), kTick), Touch(), 3), 0.0);
}

TEST(Passivity, NoClosedPathGainsEnergyFromAWideSegment) {
  ExpectNoGainFromAWideSegment(kPathCount / 4);
}

TEST(PassivitySlow, NoneOfAThousandClosedPathsGainsEnergyFromAWideSegment) {
  ExpectNoGainFromAWideSegment(1000);
}

// Negative control: a spring beyond the bound on a device without its own losses feeds the hand.
TEST(Passivity, StifferThanTheBoundGainsEnergy) {
  device::ForceLimits bare = Touch();
  bare.damping = 0.02;
  bare.friction = 0.0;
  EXPECT_LT(FindLeastWork(100, 4000.0, bare), -1e-4);
}

/// A device that flies at the tissue: its largest energy on the way out over that on the way in.
double CalcLargestReturn(int flights, double stiffness, const device::ForceLimits& device) {
  constexpr int kRings = 1;
  math::Random random(53);
  const tissue::LocalPatch soft = MakePatch(false, 0.003, kRings), hard = MakePatch(true, 0.0005, kRings);
  double largest = 0;
  for (int i = 0; i < flights; ++i) {
    Rendering rendering(i % 2 == 0 ? soft : hard, stiffness, device.position_step);
    math::Vec3 position{0.002 * random.Uniform(-1, 1), 0.002 * random.Uniform(-1, 1), 0.004};
    math::Vec3 velocity{0.1 * random.Uniform(-1, 1), 0.1 * random.Uniform(-1, 1), -random.Uniform(0.05, 1.0)};
    for (int tick = 0; tick < 60; ++tick) rendering.Render(position);
    const double before = 0.5 * device.mass * math::SquaredNorm(velocity);
    double later = 0;
    for (int tick = 0; tick < 1000; ++tick) {
      const math::Vec3 force = rendering.Render(position);
      for (int k = 0; k < kSubsteps; ++k) {
        const double h = kTick / kSubsteps;
        const double speed = math::Norm(velocity);
        velocity += (h / device.mass) * (force - device.damping * velocity);
        const double lost = h / device.mass * device.friction;
        velocity = speed > lost ? (1.0 - lost / speed) * velocity : math::Vec3{};
        position += h * velocity;
      }
      later = std::fmax(later, 0.5 * device.mass * math::SquaredNorm(velocity));
    }
    largest = std::fmax(largest, later / before);
  }
  return largest;
}

TEST(Passivity, NothingComesBackFasterThanItCame) {
  EXPECT_LT(CalcLargestReturn(100, CalcStiffnessCap(Touch(), kTick), Touch()), 1.0);
  device::ForceLimits bare = Touch();
  bare.damping = 0.02;
  bare.friction = 0.0;
  EXPECT_GT(CalcLargestReturn(20, 4000.0, bare), 1.2) << "the control";
}

TEST(StiffnessCap, IsTheSmallestOfWhatIsKnown) {
  device::ForceLimits limits;
  EXPECT_EQ(CalcStiffnessCap(limits, 0.001), 200.0);
  limits.damping = 0.2;
  EXPECT_DOUBLE_EQ(CalcStiffnessCap(limits, 0.001), 400.0);
  EXPECT_DOUBLE_EQ(CalcStiffnessCap(limits, 1.0 / 600), 240.0);  // domain facts 3.5, the paper's 600 Hz
  limits.friction = 0.01;
  limits.position_step = 1e-4;
  EXPECT_DOUBLE_EQ(CalcStiffnessCap(limits, 0.001), 200.0);
  limits.max_stiffness = 150;
  EXPECT_DOUBLE_EQ(CalcStiffnessCap(limits, 0.001), 150.0);
}

TEST(DeviceMap, KeepsTheStiffnessInTheHand) {
  const DeviceMap map{{math::RotationAbout({0, 0, 1}, 0.7), {0.1, 0.2, 0.3}}, 2.0, 0.25};
  const math::Vec3 p{0.01, -0.02, 0.03};
  EXPECT_LT(math::Distance(ToDevice(map, ToWorld(map, p)), p), 1e-15);
  // a hand that moves by u moves the tool's spring by 2 u; what it feels is K u
  const double k = CalcCouplingStiffness(map, 400.0);
  const math::Vec3 u{0.001, 0, 0.002};
  const math::Vec3 stretched = ToWorld(map, p + u) - ToWorld(map, p);
  EXPECT_LT(math::Distance(ToDeviceForce(map, -k * stretched).newton, -400.0 * u), 1e-12);
}

}  // namespace
}  // namespace trocar::haptics
