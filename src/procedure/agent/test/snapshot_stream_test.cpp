// SPDX-License-Identifier: Apache-2.0
// Whole runs as streams of snapshots: what is received is what was sent, every value of it, in every tick.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "course.h"
#include "snapshot_samples.h"
#include "trocar/host/clock.h"

namespace trocar::agent {

using simulation::HashBits;
using simulation::Snapshot;
using simulation::SnapshotDecoder;
using simulation::SnapshotEncoder;
using simulation::SnapshotLayout;
using simulation::SnapshotPrecision;

namespace {

/// A sender and a receiver; the base moves on every so many ticks.
class Stream {
 public:
  Stream(const SnapshotLayout& layout, SnapshotPrecision precision, std::uint64_t base_ticks)
      : encoder_(layout, precision), decoder_(layout), base_ticks_(base_ticks) {}

  void Send(const Snapshot& now) {
    const bool is_offered = now.tick % base_ticks_ == 0;
    const base::Status encoded = encoder_.HasBase() ? encoder_.EncodeDelta(now, message_, is_offered)
                                                    : encoder_.EncodeWhole(now, message_);
    ASSERT_TRUE(encoded.ok()) << encoded.error().Text();
    (encoder_.HasBase() ? bytes_ : whole_bytes_) += message_.size();
    const base::Status decoded = decoder_.Decode(message_, received_);
    ASSERT_TRUE(decoded.ok()) << decoded.error().Text();
    encoder_.Acknowledge(decoder_.LastKept());
  }
  const Snapshot& Received() const { return received_; }
  std::size_t WholeBytes() const { return whole_bytes_; }
  /// Of all differences together.
  std::size_t DeltaBytes() const { return bytes_; }

 private:
  SnapshotEncoder encoder_;
  SnapshotDecoder decoder_;
  std::uint64_t base_ticks_;
  std::vector<std::byte> message_;
  Snapshot received_;
  std::size_t whole_bytes_ = 0, bytes_ = 0;
};

std::string NameOfRun(const testing::TestParamInfo<Course>& info) {
  return NameOf(info);
}

void CheckStreams(const Course& course) {
  const auto scene = ReadCourse(course);
  auto made = simulation::Simulation::Make(scene, {.now = host::NowNanoseconds});
  ASSERT_TRUE(made.ok()) << made.error().Text();
  simulation::Simulation& simulation = *made;
  // another program's: of the same scene, made apart
  const SnapshotLayout layout = DescribeSnapshots(*simulation::Simulation::Make(scene));
  Actor actor(course, scene, 1);
  Stream each(layout, SnapshotPrecision::kExact, 1), distant(layout, SnapshotPrecision::kExact, 30),
      picture(layout, SnapshotPrecision::kPicture, 1);
  std::uint64_t ticks = 0;
  for (; ticks < static_cast<std::uint64_t>(course.ticks) && !actor.HasFinished(); ++ticks) {
    simulation.Step(actor.Act(simulation.GetSnapshot()));
    const Snapshot& now = simulation.GetSnapshot();
    for (Stream* stream : {&each, &distant, &picture}) ASSERT_NO_FATAL_FAILURE(stream->Send(now));
    const std::uint64_t hash = HashBits(now);
    ASSERT_EQ(HashBits(each.Received()), hash) << now.tick;
    ASSERT_EQ(HashBits(distant.Received()), hash) << now.tick;
    Snapshot shown = picture.Received();
    for (std::size_t node = 0; node < now.positions.size(); ++node) {
      const math::Vec3 off = now.positions[node] - shown.positions[node];
      ASSERT_LE(std::max({std::fabs(off.x), std::fabs(off.y), std::fabs(off.z)}),
                simulation::kPictureGrid / 2);
    }
    shown.positions = now.positions;
    ASSERT_EQ(HashBits(shown), hash) << now.tick;
  }
  EXPECT_GT(simulation.GetSnapshot().tick_seconds, 0.0);
  ASSERT_GT(ticks, 100U);
  testing::Test::RecordProperty("ticks", std::to_string(ticks));
  testing::Test::RecordProperty("bytes_whole", std::to_string(each.WholeBytes()));
  for (const auto& [name, stream] :
       {std::pair("bytes_delta", &each), {"bytes_delta_of_30", &distant}, {"bytes_picture", &picture}})
    testing::Test::RecordProperty(name, std::to_string(stream->DeltaBytes() / (ticks - 1)));
  EXPECT_LT(each.DeltaBytes() / (ticks - 1), each.WholeBytes());
  // where nothing moves there is nothing to round
  EXPECT_LE(picture.DeltaBytes(), each.DeltaBytes());
}

class SnapshotStream : public testing::TestWithParam<Course> {};
TEST_P(SnapshotStream, CarriesEveryTickOfARun) {
  CheckStreams(GetParam());
}
INSTANTIATE_TEST_SUITE_P(Runs, SnapshotStream,
                         testing::Values(Course{"retraction", "", 300}, Course{"tearing", "", 300},
                                         Course{"peg_transfer", "expert", 1200},
                                         Course{"pattern_cut", "expert", 600},
                                         Course{"clip_and_cut", "fumbler", 300},
                                         Course{"cholecystectomy", "expert", 120}),
                         NameOfRun);

class SnapshotStreamSlow : public testing::TestWithParam<Course> {};
TEST_P(SnapshotStreamSlow, CarriesEveryTickOfARun) {
  CheckStreams(GetParam());
}
INSTANTIATE_TEST_SUITE_P(
    Runs, SnapshotStreamSlow,
    testing::Values(Course{"demonstration", "", 1000}, Course{"clip_and_cut", "expert", 20'000},
                    Course{"hook_dissection", "expert", 20'000}, Course{"pattern_cut", "expert", 20'000},
                    Course{"cholecystectomy", "fumbler", 1800}, Course{"cholecystectomy", "expert", 3000}),
    NameOfRun);

class SnapshotStreamWhole : public testing::TestWithParam<Course> {};
TEST_P(SnapshotStreamWhole, CarriesEveryTickOfARun) {
  CheckStreams(GetParam());
}
INSTANTIATE_TEST_SUITE_P(Runs, SnapshotStreamWhole,
                         testing::Values(Course{"cholecystectomy", "expert", 100'000}), NameOfRun);

TEST(SnapshotStreams, AreRefusedInAnotherScene) {
  const auto layout_of = [](const char* name) {
    return DescribeSnapshots(*simulation::Simulation::Make(ReadCourse(Course{name, ""})));
  };
  const SnapshotLayout pegs = layout_of("peg_transfer"), wire = layout_of("wire_run");
  SnapshotEncoder encoder(pegs);
  std::vector<std::byte> message;
  ASSERT_TRUE(encoder.EncodeWhole(pegs.shape, message).ok());
  Snapshot received;
  SnapshotDecoder other(wire), same(pegs);
  EXPECT_FALSE(other.Decode(message, received).ok());
  EXPECT_TRUE(same.Decode(message, received).ok()) << "the control";
}

}  // namespace
}  // namespace trocar::agent
