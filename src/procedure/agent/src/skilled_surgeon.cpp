// SPDX-License-Identifier: Apache-2.0
#include "skilled_surgeon.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "state_fields.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"

namespace trocar::agent {
namespace {

/// How fast a picture wanders that nobody keeps in place [Hz].
constexpr double kSlowest = 0.03, kFastest = 0.09;

}  // namespace

SkilledSurgeon::SkilledSurgeon(std::unique_ptr<Surgeon> hands, const SurgeonSkill& skill, double tick_seconds,
                               std::uint64_t seed)
    : hands_(std::move(hands)), tick_seconds_(tick_seconds), drift_(skill.camera_drift) {
  math::Random random(seed ^ 0x6472696674ULL);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    for (std::size_t i = 0; i < kSines; ++i) {
      frequency_[axis][i] = random.Uniform(kSlowest, kFastest);
      phase_[axis][i] = random.Uniform(0.0, 2 * M_PI);
    }
  }
  waiting_.resize(base::RoundTo<std::size_t>(skill.delay / tick_seconds));
}

scene::Input SkilledSurgeon::Act(const simulation::Snapshot& seen) {
  scene::Input input = hands_->Act(seen);
  if (drift_ > 0) {
    const double time = static_cast<double>(acted_) * tick_seconds_;
    const auto drift = [&](std::size_t axis) {
      double sum = 0;
      for (std::size_t i = 0; i < kSines; ++i)
        sum +=
            math::Sin(2 * M_PI * frequency_[axis][i] * time + phase_[axis][i]) - math::Sin(phase_[axis][i]);
      return drift_ / kSines * sum;
    };
    input.laparoscope.pan += drift(0);
    input.laparoscope.tilt += drift(1);
  }
  if (!waiting_.empty()) {
    // until the first has waited long enough, the hands rest where they are
    const Waiting made{input.hands, input.controls, input.assistant, input.laparoscope};
    if (acted_ == 0) std::fill(waiting_.begin(), waiting_.end(), made);
    const Waiting due = std::exchange(waiting_[acted_ % waiting_.size()], made);
    input.hands = due.hands;
    input.controls = due.controls;
    input.assistant = due.assistant;
    input.laparoscope = due.laparoscope;
  }
  ++acted_;
  return input;
}

void SkilledSurgeon::Waiting::VisitState(base::StateArchive& archive) {
  archive.Field("hands", hands);
  archive.Field("controls", controls);
  archive.Field("assistant", assistant);
  archive.Field("laparoscope", laparoscope);
}

void SkilledSurgeon::VisitState(base::StateArchive& archive) {
  archive.Field("hands", *hands_);
  archive.Field("waiting", waiting_);
  archive.Field("acted", acted_);
}

}  // namespace trocar::agent
