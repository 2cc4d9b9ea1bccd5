// SPDX-License-Identifier: Apache-2.0
#include "trocar/net/igtl_server.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "trocar/device/ports.h"

namespace trocar::net {
namespace {

using math::Vec3;

TEST(RasFromWorld, TurnsLeftCranialAnteriorIntoRightAnteriorSuperior) {
  EXPECT_EQ(RasFromWorld(Vec3{1, 0, 0}), (Vec3{-1, 0, 0})) << "the patient's left is not right";
  EXPECT_EQ(RasFromWorld(Vec3{0, 1, 0}), (Vec3{0, 0, 1})) << "cranial is superior";
  EXPECT_EQ(RasFromWorld(Vec3{0, 0, 1}), (Vec3{0, 1, 0})) << "anterior";
  // a pose moves points as the map of points does
  const math::Pose X_world_tool{math::RotationAbout(math::Normalized(Vec3{1, -2, 0.5}), 1.1),
                                {0.1, 0.2, 0.3}};
  for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{0.1, 0, 0}, Vec3{0, 0.1, 0.2}})
    EXPECT_LT(math::Distance(RasFromWorld(X_world_tool) * p, RasFromWorld(X_world_tool * p)), 1e-12);
}

class IgtlServerTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kNodes = 2000;
  void SetUp() override {
    scene::SurfaceInfo organ;
    organ.name = "liver";
    organ.node_count = kNodes;
    organ.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene::SurfaceInfo duct;
    duct.name = "cystic_duct";
    duct.first_node = kNodes;
    duct.node_count = 2;
    snapshot_.positions.resize(kNodes + 2, {0.1, 0.2, 0.3});
    snapshot_.instruments[scene::kLeft].X_world_tool.translation = {0.01, 0.02, 0.03};
    IgtlServerSettings settings;
    settings.port = 0;
    const scene::SurfaceInfo surfaces[] = {organ, duct};
    auto made = IgtlServer::Make(settings, surfaces);
    ASSERT_TRUE(made.ok()) << made.error().Text();
    server_ = std::move(*made);
  }
  std::unique_ptr<device::Transport> Connect() {
    auto line = device::ConnectTcp("127.0.0.1", server_->Port());
    EXPECT_TRUE(line.ok());
    return line.ok() ? std::move(*line) : nullptr;
  }
  void Tick(int count) {
    for (int i = 0; i < count; ++i) {
      snapshot_.time += 1.0 / 120;
      ++snapshot_.tick;
      server_->Publish(snapshot_);
    }
  }
  static std::string ReadAll(device::Transport& line) {
    std::string bytes;
    std::array<char, 65536> buffer;
    for (int quiet = 0; quiet < 50;) {
      const device::IoResult got = line.Read(buffer);
      bytes.append(buffer.data(), got.count);
      if (got.count > 0) {
        quiet = 0;
        continue;
      }
      ++quiet;
      device::SystemClock().Sleep(0.001);
    }
    return bytes;
  }
  /// How often each kind of message occurs.
  static std::map<std::string, int> Count(const std::string& bytes) {
    std::map<std::string, int> counts;
    for (std::size_t at = 0; at + device::kIgtlHeaderSize <= bytes.size();) {
      ++counts[std::string(bytes.c_str() + at + 2)];
      std::uint64_t size = 0;
      for (std::size_t i = 0; i < 8; ++i) size = size << 8 | static_cast<unsigned char>(bytes[at + 42 + i]);
      at += device::kIgtlHeaderSize + size;
    }
    return counts;
  }

  simulation::Snapshot snapshot_;
  std::unique_ptr<IgtlServer> server_;
};

TEST_F(IgtlServerTest, SendsToolsOftenAndOrgansSeldom) {
  const auto viewer = Connect();
  Tick(121);
  const std::string bytes = ReadAll(*viewer);
  const auto counts = Count(bytes);
  // thirty a second at most; a sender that the system lets wait sends the newest, not all
  EXPECT_LE(counts.at("TDATA"), 32);
  EXPECT_GE(counts.at("TDATA"), 4 * counts.at("POLYDATA"));
  EXPECT_EQ(counts.at("TRANSFORM"), 3 * counts.at("TDATA"));
  EXPECT_NEAR(counts.at("POLYDATA"), 3, 1) << "one at once, then two a second; no ducts";
  device::IgtlReader reader;
  Vec3 tip;
  ASSERT_TRUE(reader.Feed(bytes, [&](const device::IgtlPose& tool) {
    if (tool.name == "LeftTool") tip = tool.pose.translation;
  }));
  EXPECT_EQ(reader.Counts().bad, 0u);
  EXPECT_LT(math::Distance(tip, {-0.01, 0.03, 0.02}), 1e-6);
}

// faults N1: a viewer that does not read costs nobody anything and is let go
TEST_F(IgtlServerTest, LetsGoOfAViewerThatTakesNothing) {
  const auto sleeper = Connect(), reader = Connect();
  std::size_t most = 0;
  // what a sleeper's machine buffers for it is some megabytes
  for (int round = 0; round < 200 && server_->ViewerCount() != 1; ++round) {
    Tick(600);
    most = std::max(most, ReadAll(*reader).size());
  }
  EXPECT_EQ(server_->ViewerCount(), 1u);
  EXPECT_GT(most, 10'000u) << "the other still gets everything";
}

// eight that fall behind do not lock the ninth out; eight that keep up do
TEST_F(IgtlServerTest, TheSlowestMakesRoom) {
  std::vector<std::unique_ptr<device::Transport>> viewers;
  for (int i = 0; i < 8; ++i) viewers.push_back(Connect());
  Tick(4);
  ASSERT_EQ(server_->ViewerCount(), 8u);
  auto ninth = Connect();
  for (int round = 0; round < 20; ++round) {
    Tick(12);
    for (const auto& viewer : viewers) ReadAll(*viewer);
  }
  EXPECT_EQ(ReadAll(*ninth).size(), 0u) << "the control: all keep up, so it was sent away";

  // from now on all of them take a trickle, so that none is silent for ten seconds, and the first takes nothing for longest
  std::size_t got = 0;
  std::array<char, 16> trickle;
  for (int round = 0; round < 400 && got == 0; ++round) {
    Tick(600);
    for (const auto& viewer : viewers) (void)viewer->Read(trickle);
    ninth = Connect();
    Tick(8);
    got = ReadAll(*ninth).size();
  }
  EXPECT_GT(got, 1000u) << "the ninth is served";
  EXPECT_LE(server_->ViewerCount(), 8u);
}

// faults N9: nothing that a viewer says matters
TEST_F(IgtlServerTest, IgnoresWhatItIsTold) {
  const auto viewer = Connect();
  Tick(1);
  const simulation::Snapshot before = snapshot_;
  ASSERT_GT(
      viewer->Write(device::FormatIgtlTransform("LeftTool", {{}, {9, 9, 9}}, 0) + std::string(20000, 'x'))
          .count,
      0u);
  Tick(10);
  EXPECT_EQ(server_->ViewerCount(), 1u);
  EXPECT_EQ(snapshot_.instruments[0].X_world_tool, before.instruments[0].X_world_tool);
}

TEST_F(IgtlServerTest, StandsViewersThatComeAndGoAndAReset) {
  for (int i = 0; i < 20; ++i) {
    auto viewer = Connect();
    Tick(3);
    if (i % 2 == 0) viewer.reset();
    Tick(3);
  }
  snapshot_.time = 0;
  const auto viewer = Connect();
  Tick(30);
  EXPECT_GT(ReadAll(*viewer).size(), 500u);
  EXPECT_LE(server_->ViewerCount(), 8u);
}

TEST_F(IgtlServerTest, SaysThatThePortIsTaken) {
  IgtlServerSettings settings;
  settings.port = server_->Port();
  EXPECT_EQ(IgtlServer::Make(settings, {}).error().code, core::ErrorCode::kDeviceBusy);
}

}  // namespace
}  // namespace trocar::net
