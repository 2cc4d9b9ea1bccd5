// SPDX-License-Identifier: Apache-2.0
#include "lens_smear.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/random.h"

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kTouch =
    0.0065;  // m from the lens to a node of the tissue: a telescope's radius and a little
constexpr double kLetGo = 0.0090;     // m; farther, the touch is over
constexpr double kWipeDepth = 0.025;  // m; drawn back so far, the laparoscope is taken out and wiped
constexpr int kBlotsATouch = 2;
constexpr double kThicken = 0.25;  // of a blot's thickness, each second of touching
constexpr double kThickest = 0.95;

}  // namespace

void LensSmear::Update(const simulation::Snapshot& snapshot) {
  if (snapshot.time < time_ || snapshot.laparoscope.depth < kWipeDepth) {
    blots_.clear();
    is_touching_ = false;
  }
  const double passed = std::max(0.0, snapshot.time - time_);
  time_ = snapshot.time;
  if (snapshot.laparoscope.depth < kWipeDepth) return;
  const math::Pose& X = snapshot.X_world_laparoscope;
  double nearest = 1.0;
  Vec3 place;
  for (const Vec3& p : snapshot.positions) {
    const double squared = math::SquaredNorm(p - X.translation);
    if (squared >= nearest) continue;
    nearest = squared;
    place = p;
  }
  const double distance = std::sqrt(nearest);
  if (is_touching_) {
    for (render::Blot& blot : blots_) blot.thick = std::min(kThickest, blot.thick + kThicken * passed);
    is_touching_ = distance < kLetGo;
    return;
  }
  if (distance >= kTouch) return;
  is_touching_ = true;
  // on the side of the lens that touched, the largest there
  const Vec3 p_camera = math::Inverse(X) * place;
  const double angle = std::atan2(p_camera.y, p_camera.x);
  math::Random random(snapshot.tick + 1);
  for (int i = 0; i < kBlotsATouch; ++i) {
    if (blots_.size() == render::kMaxBlots) blots_.erase(blots_.begin());
    const double turned = angle + (i == 0 ? 0.0 : random.Uniform(-1.4, 1.4));
    const double far = random.Uniform(0.10, 0.34);
    blots_.push_back({{far * std::cos(turned), far * std::sin(turned)},
                      (i == 0 ? 0.22 : 0.11) * random.Uniform(0.8, 1.2),
                      random.Uniform(0.55, 0.8)});
  }
}

}  // namespace trocar::view
