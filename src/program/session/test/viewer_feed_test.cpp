// SPDX-License-Identifier: Apache-2.0
#include "viewer_feed.h"

#include <gtest/gtest.h>

#include <functional>

#include "trocar/device/ports.h"
#include "trocar/device/tcp_port.h"
#include "trocar/host/clock.h"

namespace trocar::session {
namespace {

class ViewerFeedTest : public testing::Test {
 protected:
  ViewerFeedTest() {
    scene::SurfaceInfo organ;
    organ.name = "liver";
    organ.node_count = 5000;
    organ.triangles = {{0, 1, 2}};
    net::IgtlServerSettings settings;
    settings.port = 0;
    settings.tool_period = 1e-6;
    auto server = net::IgtlServer::Make(settings, {&organ, 1});
    EXPECT_TRUE(server.ok());
    feed_ = std::make_unique<ViewerFeed>(std::move(*server));
    snapshot_.positions.resize(5000);
  }
  void Add(int ticks) {
    for (int tick = 0; tick < ticks; ++tick) {
      snapshot_.time = static_cast<double>(++snapshot_.tick) / 120;
      feed_->Add(snapshot_);
    }
  }
  bool Eventually(const std::function<bool()>& claim) const {
    for (int i = 0; i < 5000 && !claim(); ++i) device::SystemClock().Sleep(0.002);
    return claim();
  }
  simulation::Snapshot snapshot_;
  std::unique_ptr<ViewerFeed> feed_;
};

TEST_F(ViewerFeedTest, PublishesEveryTick) {
  Add(500);
  EXPECT_TRUE(Eventually([&] { return feed_->Published() == 500; }));
  EXPECT_EQ(feed_->LeftOut(), 0u);
}

// A viewer that never reads, and a thread that is far behind: the simulation is not held up, and what is left out is counted.
TEST_F(ViewerFeedTest, HoldsNoTickUp) {
  const auto deaf = device::ConnectTcp("127.0.0.1", feed_->Port());
  ASSERT_TRUE(deaf.ok());
  Add(1);
  ASSERT_TRUE(Eventually([&] { return feed_->ViewerCount() == 1; }));
  constexpr int kTicks = 20'000;
  const std::int64_t start = host::ThreadCpuNanoseconds();
  Add(kTicks);
  const double a_tick = 1e-9 * static_cast<double>(host::ThreadCpuNanoseconds() - start) / kTicks;
  EXPECT_LT(a_tick, 1e-3);
  EXPECT_TRUE(Eventually([&] { return feed_->Published() + feed_->LeftOut() == kTicks + 1; }));
  EXPECT_GE(feed_->Published(), ViewerFeed::kCapacity) << "what was handed over is published";
}

}  // namespace
}  // namespace trocar::session
