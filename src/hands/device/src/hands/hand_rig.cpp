// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/hand_rig.h"

#include <utility>

namespace trocar::device {

HandRig::HandRig(std::unique_ptr<Driver> hands, std::unique_ptr<Driver> jaws)
    : Driver(hands->GetName() + " and " + jaws->GetName(), kChannelCount),
      hands_(std::move(hands)),
      jaws_(std::move(jaws)) {
  TROCAR_ASSERT(hands_->GetChannelCount() == kChannelCount && jaws_->GetChannelCount() == kChannelCount);
}

std::vector<std::string> HandRig::DescribeHeldBack() const {
  std::vector<std::string> all = hands_->DescribeHeldBack();
  for (std::string& sentence : jaws_->DescribeHeldBack()) all.push_back(std::move(sentence));
  return all;
}

base::Status HandRig::DoConfigure() {
  jaw_ = {};
  if (base::Status done = hands_->Configure(); !done) return done;
  base::Status done = jaws_->Configure();
  if (!done) DoCleanup();
  return done;
}

base::Status HandRig::DoActivate() {
  if (base::Status done = hands_->Activate(); !done) return done;
  base::Status done = jaws_->Activate();
  if (!done) DoDeactivate();
  return done;
}

// one part may have been lost, and closed itself, before the other

void HandRig::DoDeactivate() noexcept {
  for (Driver* part : {hands_.get(), jaws_.get()}) {
    if (part->GetState() == DriverState::kActive) (void)part->Deactivate();
  }
}

void HandRig::DoCleanup() noexcept {
  for (Driver* part : {hands_.get(), jaws_.get()}) {
    if (part->GetState() == DriverState::kInactive) (void)part->Cleanup();
  }
}

ReadStatus HandRig::DoRead(std::span<HandSample> samples) noexcept {
  const ReadStatus hands = hands_->Read(samples);
  const ReadStatus jaws = jaws_->Read(jaw_samples_);
  if (hands == ReadStatus::kLost || jaws == ReadStatus::kLost) return ReadStatus::kLost;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (jaw_samples_[i].is_valid) jaw_[i] = jaw_samples_[i].jaw;
    samples[i].jaw = jaw_[i];
  }
  return hands == ReadStatus::kFresh || jaws == ReadStatus::kFresh ? ReadStatus::kFresh
                                                                   : ReadStatus::kUnchanged;
}

}  // namespace trocar::device
