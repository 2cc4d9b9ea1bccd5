// SPDX-License-Identifier: Apache-2.0
#include "viewer_feed.h"

#include <utility>

#include "trocar/device/ports.h"

namespace trocar::session {
namespace {

/// Between two looks for new ticks: less than one of them [s].
constexpr double kLookPeriod = 0.004;

}  // namespace

ViewerFeed::ViewerFeed(std::unique_ptr<net::IgtlServer> server)
    : server_(std::move(server)), port_(server_->Port()), ring_(kCapacity) {
  thread_ = std::thread([this] { Run(); });
}

ViewerFeed::~ViewerFeed() {
  is_stopping_.store(true);
  thread_.join();
}

void ViewerFeed::Add(const simulation::Snapshot& snapshot) {
  // organs first: the tools of this tick are never seen without any
  if (!has_organs_ || snapshot.tick % kOrganTicks == 0) {
    Organs& organs = organs_.Back();
    organs.time = snapshot.time;
    organs.p_world.assign(snapshot.positions.begin(), snapshot.positions.end());
    organs_.Publish();
    has_organs_ = true;
  }
  const std::uint64_t added = added_.load(std::memory_order_relaxed);
  if (added - published_.load(std::memory_order_acquire) == kCapacity) {
    left_out_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  ring_[added % kCapacity] = net::ToolPosesOf(snapshot);
  added_.store(added + 1, std::memory_order_release);
}

void ViewerFeed::Run() {
  while (!is_stopping_.load(std::memory_order_relaxed)) {
    std::uint64_t done = published_.load(std::memory_order_relaxed);
    while (done != added_.load(std::memory_order_acquire)) {
      organs_.Update();
      server_->Publish(ring_[done % kCapacity], {organs_.Front().time, organs_.Front().p_world});
      viewers_.store(server_->ViewerCount());
      published_.store(++done, std::memory_order_release);
    }
    device::SystemClock().Sleep(kLookPeriod);
  }
}

}  // namespace trocar::session
