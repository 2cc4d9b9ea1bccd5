// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/math/elementary.h"
#include "trocar/math/random.h"
#include "trocar/scene/scene.h"

namespace trocar::scene {
namespace {

/// Sines that make up the tremor of one axis.
constexpr int kTremorSines = 3;

/// Smooth tremor of both tips at a time [m].
std::array<math::Vec3, instrument::kHandCount> CalcTremor(double amplitude, std::uint64_t seed, double time) {
  math::Random random(seed);
  std::array<math::Vec3, instrument::kHandCount> offsets;
  for (math::Vec3& offset : offsets) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int sine = 0; sine < kTremorSines; ++sine) {
        const double frequency = random.Uniform(8.0, 12.0), phase = random.Uniform(0.0, 2.0 * M_PI);
        offset[axis] += amplitude / kTremorSines * math::Sin(2.0 * M_PI * frequency * time + phase);
      }
    }
  }
  return offsets;
}

}  // namespace

Input CalcScriptInput(const Scene& scene, double time) {
  Input input;
  for (int hand = 0; hand < instrument::kHandCount; ++hand) input.hands[hand] = scene.instruments[hand].home;
  input.laparoscope = scene.laparoscope.home;
  input.settings = scene.settings;
  const auto& keys = scene.script.keys;
  if (keys.empty()) return input;

  const auto next = std::upper_bound(keys.begin(), keys.end(), time,
                                     [](double t, const ScriptKey& key) { return t < key.time; });
  const ScriptKey& to = next == keys.end() ? keys.back() : *next;
  const ScriptKey& from = next == keys.begin() ? keys.front() : *(next - 1);
  const double span = to.time - from.time;
  const double t = span > 0.0 ? std::clamp((time - from.time) / span, 0.0, 1.0) : 1.0;
  // minimum jerk (Flash and Hogan 1985): starts and ends at rest
  const double s = t * t * t * (10.0 + t * (-15.0 + 6.0 * t));
  const auto tremor = CalcTremor(scene.script.tremor, scene.seed, time);
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    const auto blend = [&](double a, double b) { return a + s * (b - a); };
    input.hands[hand] =
        instrument::FindJoints(scene.instruments[hand].p_world_port,
                               math::Lerp(from.p_world_tip[hand], to.p_world_tip[hand], s) + tremor[hand],
                               blend(from.spin[hand], to.spin[hand]), blend(from.jaw[hand], to.jaw[hand]));
  }
  return input;
}

}  // namespace trocar::scene
