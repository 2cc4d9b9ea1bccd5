// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/polhemus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "trocar/math/random.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::device {
namespace {

using math::Quaternion;
using math::Vec3;

constexpr PolhemusFormat kFormats[] = {PolhemusFormat::kFastrakAscii, PolhemusFormat::kFastrakBinary,
                                       PolhemusFormat::kLiberty, PolhemusFormat::kPatriot};

std::vector<TrackerRecord> Parse(PolhemusFormat format, std::string_view bytes, std::size_t chunk = 1u << 20,
                                 FramerCounts* counts = nullptr) {
  PolhemusFramer framer(format);
  std::vector<TrackerRecord> records;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(chunk, bytes.size())))
    framer.Feed(bytes.substr(0, chunk), [&](const TrackerRecord& record) { records.push_back(record); });
  if (counts != nullptr) *counts = framer.Counts();
  return records;
}

Quaternion RandomRotation(math::Random& random) {
  return math::RotationAbout(
      math::Normalized(Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)}),
      random.Uniform(0, 3.1));
}

TrackerRecord RandomRecord(math::Random& random) {
  return {1 + static_cast<int>(random.NextWord() % 2),
          ' ',
          {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)},
          RandomRotation(random)};
}

std::string RandomStream(PolhemusFormat format, math::Random& random, int records) {
  std::string bytes;
  for (int i = 0; i < records; ++i)
    bytes +=
        FormatRecord(format, RequestedItems(format), RandomRecord(random), false, random.NextWord() & 0xffff);
  return bytes;
}

bool AreSame(const std::vector<TrackerRecord>& a, const std::vector<TrackerRecord>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].station != b[i].station || a[i].error != b[i].error || !(a[i].position == b[i].position) ||
        !(a[i].rotation == b[i].rotation))
      return false;
  }
  return true;
}

// golden: written by hand after the manual, values touching as they may
TEST(PolhemusFramer, ReadsFastrakAsciiByColumns) {
  const std::string line = "01   10.00-100.25  20.50  90.00   0.00   0.00\r\n";
  const std::string touching = "02  100.00-100.25-200.50 -90.00 -30.00-170.00\r\n";
  ASSERT_EQ(line.size(), 47u);
  ASSERT_EQ(touching.size(), 47u);
  EXPECT_EQ(Parse(PolhemusFormat::kFastrakAscii, line).size(), 1u);
  const auto records = Parse(PolhemusFormat::kFastrakAscii, touching);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].station, 2);
  EXPECT_NEAR(records[0].position.x, 100.00 * 0.0254, 1e-12);
  EXPECT_NEAR(records[0].position.y, -100.25 * 0.0254, 1e-12);
  EXPECT_NEAR(records[0].position.z, -200.50 * 0.0254, 1e-12);
  // one column too many is no record
  EXPECT_TRUE(Parse(PolhemusFormat::kFastrakAscii, "01 " + line.substr(2)).empty());
}

TEST(PolhemusFramer, TurnsByAzimuthThenElevationThenRoll) {
  const auto x_axis = [](const char* angles) {
    const auto records =
        Parse(PolhemusFormat::kFastrakAscii, std::string("01    1.00   2.00   3.00") + angles + "\r\n");
    EXPECT_EQ(records.size(), 1u);
    return records.empty() ? Vec3{} : math::Rotate(records[0].rotation, {1, 0, 0});
  };
  EXPECT_LT(math::Distance(x_axis("  90.00   0.00   0.00"), {0, 1, 0}), 1e-12);
  // a rise about y takes x towards -z
  EXPECT_LT(math::Distance(x_axis("   0.00  90.00   0.00"), {0, 0, -1}), 1e-12);
  EXPECT_LT(math::Distance(x_axis("   0.00   0.00  90.00"), {1, 0, 0}), 1e-12);
}

TEST(PolhemusFramer, ReadsLibertyFrameOfTheHeaderFile) {
  // 'LY', station 1, 'C', no error, reserved, 26 bytes: six floats and CR LF, the tracker's own list
  std::string bytes = {'L', 'Y', 1, 'C', ' ', 0, 26, 0};
  bytes += {0, 0, '\x80', '\x3f', 0, 0, 0, '\x40', 0, 0, '\x40', '\xc0'};  // 1, 2, -3
  bytes += {0, 0, '\xb4', '\x42', 0, 0, 0, 0, 0, 0, 0, 0};                 // 90, 0, 0
  bytes += "\r\n";
  ASSERT_EQ(bytes.size(), 34u);
  const auto records = Parse(PolhemusFormat::kLiberty, bytes);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_LT(math::Distance(records[0].position, Vec3{1, 2, -3} * 0.0254), 1e-9);
  EXPECT_LT(math::Distance(math::Rotate(records[0].rotation, {1, 0, 0}), {0, 1, 0}), 1e-6);
  EXPECT_TRUE(Parse(PolhemusFormat::kPatriot, bytes).empty()) << "a PATRIOT says PA";
}

TEST(PolhemusFramer, HasTheLengthsOfTheProtocols) {
  const TrackerRecord record{1, ' ', {0.1, 0.2, 0.3}, {}};
  const std::size_t lengths[] = {47, 32, 41, 41};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(FormatRecord(kFormats[i], RequestedItems(kFormats[i]), record).size(), lengths[i]);
    EXPECT_EQ(PolhemusFramer(kFormats[i]).RecordLength(), lengths[i]);
  }
  const int standard[] = {2, 4, 1};
  EXPECT_EQ(FormatRecord(PolhemusFormat::kLiberty, standard, record).size(), 34u);
}

TEST(PolhemusFramer, GivesBackWhatWasSent) {
  math::Random random(3);
  for (const PolhemusFormat format : kFormats) {
    const bool is_ascii = format == PolhemusFormat::kFastrakAscii;
    for (int i = 0; i < 200; ++i) {
      const TrackerRecord sent = RandomRecord(random);
      const auto got = Parse(format, FormatRecord(format, RequestedItems(format), sent));
      ASSERT_EQ(got.size(), 1u) << FormatName(format) << " seed 3, record " << i;
      EXPECT_EQ(got[0].station, sent.station);
      EXPECT_LT(math::Distance(got[0].position, sent.position), is_ascii ? 0.00023 : 1e-6);
      EXPECT_LT(math::AngleBetween(got[0].rotation, sent.rotation), is_ascii ? 3e-4 : 1e-3);
    }
  }
}

TEST(PolhemusFramer, GivesTheSameRecordsForAnyChunking) {
  math::Random random(11);
  for (const PolhemusFormat format : kFormats) {
    for (int trial = 0; trial < 20; ++trial) {
      std::string bytes = RandomStream(format, random, 12);
      // half of the streams are damaged: chunking must not matter for these either
      for (int i = 0; trial % 2 == 1 && i < 10; ++i)
        bytes[random.NextWord() % bytes.size()] = static_cast<char>(random.NextWord());
      const auto whole = Parse(format, bytes);
      for (const std::size_t chunk : {1, 2, 3, 5, 7, 31, 32, 33, 47, 64, 100})
        EXPECT_TRUE(AreSame(whole, Parse(format, bytes, chunk)))
            << FormatName(format) << " seed 11, chunk " << chunk;
      if (trial % 2 == 0) {
        EXPECT_EQ(whole.size(), 12u) << FormatName(format);
      }
    }
  }
}

TEST(PolhemusFramer, FindsTheNextRecordAfterGarbage) {
  math::Random random(5);
  for (const PolhemusFormat format : kFormats) {
    for (int trial = 0; trial < 50; ++trial) {
      std::string garbage;
      for (int i = 0; i < 40; ++i) garbage += static_cast<char>(random.NextWord());
      // faults D3: back in step after at most two records
      const std::string good = RandomStream(format, random, 4);
      EXPECT_GE(Parse(format, garbage + good).size(), 2u) << FormatName(format) << " seed 5, trial " << trial;
      // begun in the middle of a record
      const std::size_t cut = 1 + random.NextWord() % 30;
      EXPECT_GE(Parse(format, std::string_view(good).substr(cut)).size(), 2u) << FormatName(format);
    }
  }
}

// faults D3, the negative control: a reader that goes on by whole records after garbage, as if nothing had happened
TEST(PolhemusFramer, WithoutTryingEveryByteWhatFollowsGarbageIsLost) {
  math::Random random(5);
  for (const PolhemusFormat format : kFormats) {
    const std::string good = RandomStream(format, random, 20);
    const std::string stream = "?" + good;
    const std::size_t length = PolhemusFramer(format).RecordLength();
    std::size_t found = 0;
    for (std::size_t at = 0; at + length <= stream.size(); at += length)
      found += Parse(format, std::string_view(stream).substr(at, length)).size();
    EXPECT_EQ(found, 0u) << FormatName(format);
    EXPECT_EQ(Parse(format, stream).size(), 20u) << FormatName(format);
  }
}

TEST(PolhemusFramer, RefusesEveryTruncation) {
  for (const PolhemusFormat format : kFormats) {
    const std::string record = FormatRecord(format, RequestedItems(format), {1, ' ', {0.1, 0.2, 0.3}, {}});
    for (std::size_t length = 0; length < record.size(); ++length)
      EXPECT_TRUE(Parse(format, record.substr(0, length)).empty());
  }
}

TEST(PolhemusFramer, RefusesSizesThatLie) {
  const std::string good = FormatRecord(PolhemusFormat::kLiberty, RequestedItems(PolhemusFormat::kLiberty),
                                        {1, ' ', {0.1, 0, 0}, {}});
  ASSERT_EQ(Parse(PolhemusFormat::kLiberty, good).size(), 1u);
  for (const int size : {0, 1, 25, 27, 32, 34, 255, 0xffff}) {
    std::string lie = good;
    lie[6] = static_cast<char>(size & 0xff);
    lie[7] = static_cast<char>(size >> 8);
    FramerCounts counts;
    EXPECT_TRUE(Parse(PolhemusFormat::kLiberty, lie, 1000, &counts).empty());
    EXPECT_GT(counts.garbage, 0u) << "a size that cannot be must not be waited for: " << size;
  }
}

TEST(PolhemusFramer, RefusesWhatNoSensorMeasures) {
  const auto count = [](const TrackerRecord& record) {
    const PolhemusFormat format = PolhemusFormat::kFastrakBinary;
    return Parse(format, FormatRecord(format, RequestedItems(format), record)).size();
  };
  EXPECT_EQ(count({1, ' ', {0.1, 0, 0}, {}}), 1u);
  EXPECT_EQ(count({1, ' ', {std::nan(""), 0, 0}, {}}), 0u);
  EXPECT_EQ(count({1, ' ', {0, INFINITY, 0}, {}}), 0u);
  EXPECT_EQ(count({1, ' ', {0, 0, 11.0}, {}}), 0u);
  EXPECT_EQ(count({1, ' ', {}, {0, 0, 0, 0}}), 0u);
  EXPECT_EQ(count({1, ' ', {}, {2, 0, 0, 0}}), 0u);
  EXPECT_EQ(count({1, ' ', {}, {std::nan(""), 0, 0, 1}}), 0u);
  EXPECT_EQ(count({5, ' ', {}, {}}), 0u) << "FASTRAK has four stations";
}

// bounded; the target in fuzz/ runs as long as one likes
TEST(PolhemusFramer, SurvivesRandomBytes) {
  for (const PolhemusFormat format : kFormats) {
    math::Random random(static_cast<std::uint64_t>(format) + 1);
    std::string bytes;
    for (int i = 0; i < 100'000; ++i) {
      // mostly bytes that look like a beginning
      const std::uint64_t word = random.NextWord();
      bytes += word % 3 == 0 ? static_cast<char>(word >> 8) : "0 1LYPAC.\r\n\x1a\x21"[word % 13];
    }
    FramerCounts counts;
    const auto records = Parse(format, bytes, 97, &counts);
    EXPECT_EQ(records.size(), counts.records);
    for (const TrackerRecord& record : records) {
      EXPECT_TRUE(math::IsFinite(record.position));
      EXPECT_LE(math::Norm(record.position), 18.0);
      EXPECT_NEAR(math::AngleBetween(record.rotation, record.rotation), 0.0, 1e-6);
    }
  }
}

TEST(PolhemusCommands, AskForInchesListAndHemisphere) {
  const int stations[] = {1, 2};
  EXPECT_EQ(SetUpCommands(PolhemusFormat::kFastrakBinary, stations, {1, 0, 0}),
            "cfUO1,2,11,0\rH1,1.000,0.000,0.000\rO2,2,11,0\rH2,1.000,0.000,0.000\r");
  EXPECT_EQ(SetUpCommands(PolhemusFormat::kFastrakAscii, std::span(stations, 1), {0, 0, -1}),
            "cFUO1,2,4,1\rH1,0.000,0.000,-1.000\r");
  EXPECT_EQ(SetUpCommands(PolhemusFormat::kLiberty, std::span(stations, 1), {1, 0, 0}),
            "PF1\rU0\rO1,2,7,8,0\rH1,1.000,0.000,0.000\r");
  EXPECT_EQ(StartCommand(PolhemusFormat::kFastrakAscii), "C");
  EXPECT_EQ(StartCommand(PolhemusFormat::kPatriot), "C\r");
}

}  // namespace
}  // namespace trocar::device
