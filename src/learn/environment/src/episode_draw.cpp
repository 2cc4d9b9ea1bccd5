// SPDX-License-Identifier: Apache-2.0
#include "episode_draw.h"

#include <cmath>
#include <string>

#include "trocar/math/random.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::environment {
namespace {

/// Parts this row of numbers from those of the task's layout.
constexpr std::uint64_t kDrawSeed = 0x3c6ef372fe94f82bULL;

math::Vec3 DrawDirection(math::Random& random) {
  while (true) {
    const math::Vec3 v = {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
    const double length = math::Norm(v);
    if (length > 0.01 && length <= 1) return v / length;
  }
}

}  // namespace

base::Status CheckRanges(const Ranges& ranges) {
  for (std::size_t i = 0; i < kVariedCount; ++i) {
    const auto quantity = static_cast<Varied>(i);
    const Range limits = LimitsOf(quantity);
    const Range& range = ranges[i];
    if (range.low >= limits.low && range.low <= range.high && range.high <= limits.high) continue;
    const auto text = [](double value) {
      std::string digits = std::to_string(value);
      digits.erase(digits.find_last_not_of('0') + 1);
      if (digits.ends_with('.')) digits.pop_back();
      return digits;
    };
    return base::Error{base::ErrorCode::kUsage,
                       "the range of " + std::string(NameOf(quantity)) + " goes from " + text(range.low) +
                           " to " + text(range.high) + "; it lies within " + text(limits.low) + " and " +
                           text(limits.high) + ", the lower number first"};
  }
  return {};
}

EpisodeDraw DrawEpisode(std::uint64_t seed, const Ranges& ranges) {
  EpisodeDraw draw;
  draw.seed = seed;
  math::Random seeds(seed ^ kDrawSeed);
  draw.choice = seeds.NextWord();
  for (std::size_t i = 0; i < kVariedCount; ++i) {
    const double share = math::Random(seeds.NextWord()).Uniform();
    draw.values[i] = ranges[i].low == ranges[i].high
                         ? ranges[i].low
                         : ranges[i].low + share * (ranges[i].high - ranges[i].low);
  }
  for (math::Vec3& aside : draw.asides) {
    math::Random random(seeds.NextWord());
    aside = DrawDirection(random);
  }
  math::Random random(seeds.NextWord());
  math::Vec3 direction;
  double length = 0;
  do {
    direction = DrawDirection(random);
    length = std::sqrt(direction.x * direction.x + direction.y * direction.y);
  } while (!(length > 0.1));
  draw.aside_pan = direction.x / length;
  draw.aside_tilt = direction.y / length;
  return draw;
}

scene::Input CalcStart(const scene::Scene& scene, const EpisodeDraw& draw) {
  scene::Input start;
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    const scene::InstrumentSetup& setup = scene.instruments[hand];
    instrument::TrocarJoints& joints = start.hands[hand];
    joints = setup.home;
    const double distance = 1e-3 * draw.Get(Varied::kStart);
    if (distance == 0) continue;  // the home's own bits
    const math::Vec3 tip = instrument::CalcToolPose(setup.p_world_port, setup.home).translation +
                           distance * draw.asides[static_cast<std::size_t>(hand)];
    joints = instrument::FindJoints(setup.p_world_port, tip, setup.home.spin, setup.home.jaw);
    instrument::JointLimits limits;
    limits.max_jaw = setup.tool.max_jaw;
    joints = instrument::ClampJoints(joints, limits);
    joints.jaw = setup.home.jaw;
  }
  start.laparoscope = scene.laparoscope.home;
  const double aside = math::kDegree * draw.Get(Varied::kCamera);
  if (aside != 0) {
    start.laparoscope.pan += aside * draw.aside_pan;
    start.laparoscope.tilt += aside * draw.aside_tilt;
    instrument::JointLimits limits;
    limits.min_depth = 0.01;
    start.laparoscope = instrument::ClampJoints(start.laparoscope, limits);
  }
  return start;
}

bool ChangesThings(const EpisodeDraw& draw) noexcept {
  return draw.Get(Varied::kMass) != 1 || draw.Get(Varied::kFriction) != 1;
}

void ChangeThings(const EpisodeDraw& draw, scene::Scene& scene) {
  for (scene::SceneObject& object : scene.objects) {
    if (!object.Moves()) continue;
    object.body.mass *= draw.Get(Varied::kMass);
    object.body.friction *= draw.Get(Varied::kFriction);
  }
}

}  // namespace trocar::environment
