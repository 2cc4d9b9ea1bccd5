// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/igtl.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "emulated_line.h"
#include "trocar/device/igtl_tracker.h"

#if TROCAR_HAS_OPENIGTLINK
#include <igtlPolyDataMessage.h>
#include <igtlPositionMessage.h>
#include <igtlQuaternionTrackingDataMessage.h>
#include <igtlTrackingDataMessage.h>
#include <igtlTransformMessage.h>

// the library allocates what it found in a POLYDATA message twice and frees it once (1.11)
extern "C" __attribute__((visibility("default"))) const char* __lsan_default_suppressions() {
  return "leak:libOpenIGTLink\n";
}
#endif

namespace trocar::device {
namespace {

using base::ErrorCode;

math::Pose MakePose() {
  return {math::RotationAbout(math::Normalized(math::Vec3{1, 2, 3}), 0.7), {0.1, -0.25, 1.5}};
}

struct Got {
  std::vector<std::string> names;
  std::vector<math::Pose> poses;
  IgtlCounts counts;
  bool is_followed = true;
};

Got Read(std::string_view bytes, std::size_t chunk = 1u << 20) {
  IgtlReader reader;
  Got got;
  for (; !bytes.empty() && got.is_followed; bytes.remove_prefix(std::min(chunk, bytes.size()))) {
    got.is_followed = reader.Feed(bytes.substr(0, chunk), [&](const IgtlPose& pose) {
      got.names.emplace_back(pose.name);
      got.poses.push_back(pose.pose);
    });
  }
  got.counts = reader.Counts();
  return got;
}

std::string Big(std::uint64_t word, int size) {
  std::string bytes;
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) bytes += static_cast<char>(word >> shift & 0xff);
  return bytes;
}

std::string Message(const std::string& type, const std::string& body, std::uint64_t size, int version = 1) {
  const auto padded = [](std::string text, std::size_t length) {
    text.resize(length, '\0');
    return text;
  };
  return Big(static_cast<std::uint64_t>(version), 2) + padded(type, 12) + padded("left", 20) + Big(0, 8) +
         Big(size, 8) + Big(CalcIgtlCrc(body), 8) + body;
}

// golden: the check value of the polynomial (domain facts, section 0)
TEST(Igtl, HasTheChecksumOfTheProtocol) {
  EXPECT_EQ(CalcIgtlCrc("123456789"), 0x6C40DF5F0B497347u);
  EXPECT_EQ(CalcIgtlCrc(""), 0u);
}

TEST(Igtl, HasTheLengthsOfTheProtocol) {
  EXPECT_EQ(FormatIgtlTransform("left", MakePose(), 0).size(), 58u + 48u);
  const IgtlTool tools[] = {{"left", MakePose()}, {"right", MakePose()}};
  EXPECT_EQ(FormatIgtlTrackingData("tools", tools, 0).size(), 58u + 2 * 70u);
  // golden: an upright pose 1 mm along x; a column after the other, then millimetres
  const std::string message = FormatIgtlTransform("A", {{}, {0.001, 0, 0}}, 0);
  EXPECT_EQ(message.substr(58), Big(0x3f800000, 4) + Big(0, 12) + Big(0x3f800000, 4) + Big(0, 12) +
                                    Big(0x3f800000, 4) + Big(0x3f800000, 4) + Big(0, 8));
  EXPECT_EQ(message.substr(0, 14), Big(1, 2) + std::string("TRANSFORM\0\0\0", 12));
}

TEST(Igtl, GivesBackWhatWasSentInAnyChunks) {
  const IgtlTool tools[] = {{"left", MakePose()},
                            {"a name longer than twenty bytes", math::Inverse(MakePose())}};
  const std::string bytes =
      FormatIgtlTransform("right", MakePose(), 1.5) + Message("IMAGE", std::string(9000, 'x'), 9000) +
      FormatIgtlTrackingData("tools", tools, 2) + FormatIgtlTransform("right", MakePose(), 3);
  for (const std::size_t chunk : {1u << 20, 1u, 2u, 3u, 57u, 58u, 59u, 106u, 4096u}) {
    const Got got = Read(bytes, chunk);
    ASSERT_EQ(got.names, (std::vector<std::string>{"right", "left", "a name longer than t", "right"}))
        << chunk;
    EXPECT_EQ(got.counts.messages, 3u);
    EXPECT_EQ(got.counts.skipped, 1u);
    EXPECT_EQ(got.counts.bad, 0u);
    EXPECT_LT(math::Distance(got.poses[0].translation, MakePose().translation), 1e-7);
    EXPECT_LT(math::Distance(got.poses[2] * math::Vec3{0.1, 0.2, 0.3},
                             math::Inverse(MakePose()) * math::Vec3{0.1, 0.2, 0.3}),
              1e-6);
  }
}

TEST(Igtl, ReadsTheExtendedHeader) {
  const std::string content = FormatIgtlTransform("left", MakePose(), 0).substr(58);
  const std::string body = Big(12, 2) + Big(4, 2) + Big(7, 4) + Big(1, 4) + content + "metameta!!!";
  EXPECT_EQ(Read(Message("TRANSFORM", body, body.size(), 2)).poses.size(), 1u);
  for (const auto& lie : {Big(0, 2), Big(11, 2), Big(0xffff, 2)}) {
    std::string bad = body;
    bad.replace(0, 2, lie);
    EXPECT_EQ(Read(Message("TRANSFORM", bad, bad.size(), 2)).counts.bad, 1u);
  }
  std::string bad = body;
  bad.replace(4, 4, Big(0xffffffff, 4));
  EXPECT_EQ(Read(Message("TRANSFORM", bad, bad.size(), 2)).counts.bad, 1u);
  EXPECT_EQ(Read(Message("TRANSFORM", "", 0, 2)).counts.bad, 1u);
}

// faults D7
TEST(Igtl, RefusesSizesThatLie) {
  const std::string body = FormatIgtlTransform("left", MakePose(), 0).substr(58);
  for (const std::uint64_t size :
       {std::uint64_t{1} << 32, ~std::uint64_t{0} - 57, ~std::uint64_t{0}, std::uint64_t{1} << 63})
    EXPECT_FALSE(Read(Message("IMAGE", body, size)).is_followed) << size;
  // small lies about kinds that are read: refused, the stream goes on
  for (const std::uint64_t size : {0u, 47u, 49u, 5000u}) {
    const Got got = Read(Message("TRANSFORM", body, size) + std::string(6000, '\0'));
    EXPECT_TRUE(got.poses.empty()) << size;
    EXPECT_GE(got.counts.bad, 1u);
  }
  EXPECT_EQ(Read(FormatIgtlTransform("left", MakePose(), 0)).poses.size(), 1u)
      << "the control: an honest size is read";
  EXPECT_FALSE(Read(std::string(58, 'x')).is_followed) << "no version, no message";
  EXPECT_FALSE(Read(Message("TRANS\x01", body, 48)).is_followed);
}

TEST(Igtl, ReadsManyToolsAndNamesAMessageOfTooMany) {
  const auto tools = [](std::size_t count) {
    std::vector<IgtlTool> all(count, IgtlTool{"marker", MakePose()});
    all.back().name = "left";
    return FormatIgtlTrackingData("Theatre", all, 0);
  };
  const Got many = Read(tools(100));
  ASSERT_EQ(many.poses.size(), 100u) << "as a tracker with passive markers sends them";
  EXPECT_EQ(Read(tools(kMostIgtlTools)).poses.size(), kMostIgtlTools);
  IgtlReader reader;
  std::size_t poses = 0;
  const auto count = [&](const IgtlPose&) { ++poses; };
  EXPECT_TRUE(reader.DescribeRefused().empty());
  ASSERT_TRUE(reader.Feed(tools(600) + tools(2), count));
  EXPECT_EQ(poses, 2u) << "the stream goes on";
  EXPECT_EQ(reader.Counts().bad, 1u);
  ASSERT_EQ(reader.DescribeRefused().size(), 1u);
  EXPECT_TRUE(reader.DescribeRefused()[0].starts_with(
      "TDATA \"Theatre\": 1 of 1 do not count, because they have more than 256 tools (42000 bytes)"))
      << reader.DescribeRefused()[0];
  // a name may be anything
  std::string nasty = tools(600);
  nasty.replace(14, 7, "\x1b[2Jxyz");
  ASSERT_TRUE(reader.Feed(nasty, count));
  EXPECT_EQ(reader.DescribeRefused()[0].find('\x1b'), std::string::npos);
  EXPECT_EQ(reader.DescribeReceived().find('\x1b'), std::string::npos);
}

/// Twelve numbers as a TRANSFORM's body.
std::string Matrix(const std::vector<float>& numbers) {
  std::string body;
  for (const float number : numbers) body += Big(std::bit_cast<std::uint32_t>(number), 4);
  return body;
}

std::vector<float> Turned(double x, double y, double z) {
  std::vector<float> numbers;
  const double lengths[] = {x, y, z};
  for (int column = 0; column < 3; ++column) {
    math::Vec3 unit;
    unit[column] = 1;
    const math::Vec3 axis = math::Rotate(MakePose().rotation, unit) * lengths[column];
    for (int row = 0; row < 3; ++row) numbers.push_back(static_cast<float>(axis[row]));
  }
  numbers.insert(numbers.end(), {10, 20, 30});
  return numbers;
}

// each reason for which something does not count is named with its figures and a remedy
TEST(Igtl, SaysWhyWhatCameDoesNotCount) {
  const auto transform = [](const std::vector<float>& numbers) {
    return Message("TRANSFORM", Matrix(numbers), 4 * numbers.size());
  };
  const auto with_checksum = [](std::string bytes, std::uint64_t checksum) {
    return bytes.replace(50, 8, Big(checksum, 8));
  };
  const std::string good = FormatIgtlTransform("left", MakePose(), 0);
  std::vector<float> skewed = Turned(1, 1, 1);
  for (int row = 0; row < 3; ++row)
    skewed[3 + static_cast<std::size_t>(row)] =
        0.8f * skewed[3 + static_cast<std::size_t>(row)] + 0.6f * skewed[static_cast<std::size_t>(row)];
  std::vector<float> unbounded = Turned(1, 1, 1);
  unbounded[4] = std::numeric_limits<float>::quiet_NaN();
  std::string swapped;
  for (const float number : Turned(1, 1, 1)) {
    std::string word = Big(std::bit_cast<std::uint32_t>(number), 4);
    swapped.append(word.rbegin(), word.rend());
  }
  const struct {
    IgtlFault fault;
    std::string bytes, says;
  } cases[] = {
      {IgtlFault::kNoChecksum, with_checksum(good, 0), "their checksum is 0"},
      {IgtlFault::kChecksum, with_checksum(good, 0x123), "0000000000000123 instead of"},
      {IgtlFault::kSize, transform({1, 2, 3}), "a body of 12 bytes"},
      {IgtlFault::kExtendedHeader, Message("TRANSFORM", std::string(48, '\x7f'), 48, 2), "extended header"},
      {IgtlFault::kNoRotation, Message("POSITION", Matrix({1, 2, 3}), 12), "a place without a rotation"},
      {IgtlFault::kZero, transform(std::vector<float>(12, 0.0f)), "all zeros"},
      {IgtlFault::kNumbers, transform(unbounded), "not finite"},
      {IgtlFault::kByteOrder, Message("TRANSFORM", swapped, 48), "wrong byte order"},
      {IgtlFault::kMirror, transform(Turned(1, 1, -1)), "mirrors (its determinant is negative)"},
      {IgtlFault::kSkew, transform(skewed), "36.87 degrees off a right angle"},
      {IgtlFault::kScale, transform(Turned(1.1, 1, 1)), "1.1, 1 and 1 instead of 1, a scale"},
      {IgtlFault::kScale, transform(Turned(0.1, 0.1, 0.1)), "0.1, 0.1 and 0.1"},
      {IgtlFault::kScale, Message("POSITION", Matrix({1, 2, 3, 0, 0, 0, 2}), 28), "2, 2 and 2"},
      {IgtlFault::kManyTools, Message("TDATA", std::string(70 * 300, 'x'), 70 * 300), "more than 256 tools"},
  };
  for (const auto& one : cases) {
    IgtlReader reader;
    int poses = 0;
    ASSERT_TRUE(reader.Feed(one.bytes + good, [&](const IgtlPose&) { ++poses; })) << one.says;
    EXPECT_EQ(poses, 1) << one.says << ": the good one behind it counts";
    EXPECT_EQ(reader.Counts().bad, 1u);
    ASSERT_GE(reader.Seen().size(), 1u);
    EXPECT_EQ(reader.Seen()[0].fault, one.fault) << one.says;
    EXPECT_EQ(reader.Seen()[0].refused, 1u);
    // out of sight now and then is no fault of a tool that is seen otherwise
    if (one.fault == IgtlFault::kZero) {
      EXPECT_TRUE(reader.DescribeRefused().empty());
      reader = {};
      ASSERT_TRUE(reader.Feed(one.bytes, [](const IgtlPose&) {}));
    }
    ASSERT_EQ(reader.DescribeRefused().size(), 1u) << one.says;
    const std::string said = reader.DescribeRefused()[0];
    EXPECT_NE(said.find(" do not count, because "), std::string::npos) << said;
    EXPECT_NE(said.find(one.says), std::string::npos) << said;
  }
}

TEST(Igtl, PutsRightWhatRoundingLeavesAndNothingMore) {
  const auto read = [](double length) {
    return Read(Message("TRANSFORM", Matrix(Turned(length, 1, 1)), 48));
  };
  for (const double length : {0.997, 1.0, 1.003}) {
    const Got got = read(length);
    ASSERT_EQ(got.poses.size(), 1u) << length;
    EXPECT_LT(math::Distance(got.poses[0] * math::Vec3{1, 0, 0},
                             math::Rotate(MakePose().rotation, {1, 0, 0}) + math::Vec3{0.01, 0.02, 0.03}),
              1e-6);
  }
  for (const double length : {0.99, 1.01}) EXPECT_TRUE(read(length).poses.empty()) << length;
}

TEST(Igtl, ReadsPlacesWithQuaternions) {
  const math::Pose pose = MakePose();
  const math::Quaternion& q = pose.rotation;
  std::vector<float> numbers;
  for (const double number :
       {1e3 * pose.translation.x, 1e3 * pose.translation.y, 1e3 * pose.translation.z, q.x, q.y, q.z, q.w})
    numbers.push_back(static_cast<float>(number));
  const std::string element = std::string("right") + std::string(15, '\0') + "\x02" + std::string(1, '\0');
  const Got got = Read(Message("POSITION", Matrix(numbers), 28) +
                       Message("QTDATA", element + Matrix(numbers) + element + Matrix(numbers), 100));
  ASSERT_EQ(got.names, (std::vector<std::string>{"left", "right", "right"}));
  for (const math::Pose& one : got.poses)
    EXPECT_LT(math::Distance(one * math::Vec3{1, 1, 1}, pose * math::Vec3{1, 1, 1}), 1e-6);
}

// the reference library also packs a POSITION with a quaternion of three numbers, whose fourth is what is left to 1
TEST(Igtl, ReadsAPositionWithAQuaternionOfThreeNumbers) {
  const math::Pose pose = MakePose();
  math::Quaternion q = pose.rotation;
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  const auto message = [](const std::vector<double>& rotation) {
    std::vector<float> numbers = {100, -250, 1500};
    for (const double number : rotation) numbers.push_back(static_cast<float>(number));
    return Message("POSITION", Matrix(numbers), 24);
  };
  const Got got = Read(message({q.x, q.y, q.z}));
  ASSERT_EQ(got.poses.size(), 1u);
  EXPECT_LT(math::Distance(got.poses[0] * math::Vec3{1, 1, 1}, pose * math::Vec3{1, 1, 1}), 1e-6);
  // half a turn leaves nothing, with rounding a little less than nothing
  for (const double length : {1.0, 1.0000002}) {
    const Got half = Read(message({0, 0, length}));
    ASSERT_EQ(half.poses.size(), 1u) << length;
    EXPECT_LT(math::Distance(math::Rotate(half.poses[0].rotation, {1, 0, 0}), {-1, 0, 0}), 1e-6);
  }
  // no rotation at all is zeros here
  ASSERT_EQ(Read(message({0, 0, 0})).poses.size(), 1u);
  IgtlReader reader;
  ASSERT_TRUE(reader.Feed(message({0, 0, 2}), [](const IgtlPose&) { FAIL() << "it is no rotation"; }));
  ASSERT_EQ(reader.DescribeRefused().size(), 1u);
  EXPECT_NE(reader.DescribeRefused()[0].find("2, 2 and 2"), std::string::npos) << reader.DescribeRefused()[0];
  // the lowest byte first, it would be next to nothing everywhere: no rotation at the origin
  std::string swapped;
  for (const double number : {100.0, -250.0, 1500.0, q.x, q.y, q.z}) {
    std::string word = Big(std::bit_cast<std::uint32_t>(static_cast<float>(number)), 4);
    swapped.append(word.rbegin(), word.rend());
  }
  reader = {};
  ASSERT_TRUE(
      reader.Feed(Message("POSITION", swapped, 24), [](const IgtlPose&) { FAIL() << "it is no pose"; }));
  ASSERT_EQ(reader.DescribeRefused().size(), 1u);
  EXPECT_NE(reader.DescribeRefused()[0].find("wrong byte order"), std::string::npos)
      << reader.DescribeRefused()[0];
}

TEST(Igtl, CountsWhatCameByKindAndName) {
  IgtlReader reader;
  const IgtlTool tools[] = {{"left", MakePose()}, {"Reference", MakePose()}};
  std::string bytes = Message("STATUS", std::string(30, '\0'), 30) +
                      FormatIgtlTrackingData("Tracker", tools, 0) + FormatIgtlTrackingData("Tracker", {}, 0) +
                      Message("IMAGE", std::string(5000, 'x'), 5000);
  ASSERT_TRUE(reader.Feed(bytes + bytes, [](const IgtlPose&) {}));
  EXPECT_EQ(reader.DescribeReceived(),
            "STATUS \"left\" (2), TDATA \"left\" (2), TDATA \"Reference\" (2), TDATA \"Tracker\" (2), IMAGE "
            "\"left\" (2)");
  EXPECT_TRUE(reader.DescribeRefused().empty());
  // a sender of ever new names costs no memory
  for (int i = 0; i < 1000; ++i)
    ASSERT_TRUE(reader.Feed(FormatIgtlTransform(std::to_string(i), MakePose(), 0), [](const IgtlPose&) {}));
  EXPECT_EQ(reader.Seen().size(), kMostIgtlSeen);
  EXPECT_NE(reader.DescribeReceived().find(", ... (981)"), std::string::npos) << reader.DescribeReceived();
}

TEST(Igtl, SaysWhatIsNoHeader) {
  const auto said = [](const std::string& bytes) {
    IgtlReader reader;
    EXPECT_FALSE(reader.Feed(bytes, [](const IgtlPose&) {}));
    EXPECT_FALSE(reader.Feed(bytes, [](const IgtlPose&) {})) << "it has to be restarted";
    return reader.DescribeBadHeader();
  };
  EXPECT_NE(said("HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\nServer: a long one\r\n\r\n")
                .find("\"HTTP/1.1 400 Bad\""),
            std::string::npos);
  EXPECT_NE(said(Message("TRANSFORM", "", 0, 4)).find("version 4"), std::string::npos);
  EXPECT_NE(said(Message("TRANSFORM", "", 0, 0x0100)).find("byte order"), std::string::npos);
  EXPECT_NE(said(Message("TRANSFORM", "", std::uint64_t{1} << 40)).find("1099511627776 bytes"),
            std::string::npos);
  EXPECT_EQ(said("\x1b[2J" + std::string(60, '\x9b')).find('\x1b'), std::string::npos);
}

// faults D6: in this protocol nothing numbers a message, so what is sent twice is taken twice; it only says again where a hand
// was, and the gate of poses drops what a hand cannot do
TEST(Igtl, ARepeatedMessageMovesNothing) {
  TrackedHandsSettings settings;
  settings.has_hemisphere_doubt = false;
  TrackedHands hands(settings);
  hands.Reset();
  HandSamples samples;
  const math::Pose now = MakePose();
  math::Pose old = now;
  old.translation.x += 0.2;
  hands.Accept(kLeftHand, now, 1.0);
  ASSERT_TRUE(hands.Collect(1.0, samples));
  const HandSample before = samples[kLeftHand];
  hands.Accept(kLeftHand, now, 1.001);  // twice
  hands.Accept(kLeftHand, old, 1.002);  // replayed, 200 mm away
  hands.Collect(1.002, samples);
  EXPECT_EQ(samples[kLeftHand].pan, before.pan);
  EXPECT_EQ(samples[kLeftHand].depth, before.depth);
  EXPECT_EQ(hands.Counts().jumps, 1u);
}

TEST(Igtl, RefusesWrongChecksumsAndWhatIsNoPose) {
  std::string bytes = FormatIgtlTransform("left", MakePose(), 0);
  for (std::size_t at = 50; at < bytes.size(); ++at) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    EXPECT_TRUE(Read(flipped).poses.empty()) << at;
  }
  const auto with_column = [&](double value) {
    math::Pose pose = MakePose();
    pose.translation.x = value;
    return Read(FormatIgtlTransform("left", pose, 0)).counts.bad;
  };
  EXPECT_EQ(with_column(std::nan("")), 1u);
  EXPECT_EQ(with_column(INFINITY), 1u);
  EXPECT_EQ(with_column(1e6), 1u);
  const std::string scaled = Big(0x40000000, 4) + std::string(44, '\0');
  EXPECT_EQ(Read(Message("TRANSFORM", scaled, 48)).counts.bad, 1u);
  // a mirror is no rotation
  const std::string mirror =
      Big(0xbf800000, 4) + Big(0, 12) + Big(0x3f800000, 4) + Big(0, 12) + Big(0x3f800000, 4) + Big(0, 12);
  EXPECT_EQ(Read(Message("TRANSFORM", mirror, 48)).counts.bad, 1u);
}

TEST(Igtl, SurvivesRandomBytes) {
  math::Random random(21);
  const std::string good = FormatIgtlTransform("left", MakePose(), 0);
  for (int trial = 0; trial < 3000; ++trial) {
    std::string bytes = good + good;
    for (int i = 0; i < 4; ++i)
      bytes[random.NextWord() % bytes.size()] = static_cast<char>(random.NextWord());
    const Got whole = Read(bytes);
    const Got parts = Read(bytes, 13);
    EXPECT_EQ(whole.poses.size(), parts.poses.size()) << "seed 21, trial " << trial;
    EXPECT_EQ(whole.is_followed, parts.is_followed);
  }
}

#if TROCAR_HAS_OPENIGTLINK
// oracle: the reference library writes, we read; we write, it reads
TEST(IgtlOracle, UnderstandsTheLibraryBothWays) {
  const math::Pose pose = MakePose();
  igtl::TransformMessage::Pointer message = igtl::TransformMessage::New();
  message->SetDeviceName("left");
  igtl::Matrix4x4 matrix;
  igtl::IdentityMatrix(matrix);
  for (int column = 0; column < 3; ++column) {
    math::Vec3 unit;
    unit[column] = 1;
    for (int row = 0; row < 3; ++row)
      matrix[row][column] = static_cast<float>(math::Rotate(pose.rotation, unit)[row]);
  }
  for (int row = 0; row < 3; ++row) matrix[row][3] = static_cast<float>(1000 * pose.translation[row]);
  message->SetMatrix(matrix);
  message->Pack();
  const Got got = Read({static_cast<const char*>(message->GetPackPointer()),
                        static_cast<std::size_t>(message->GetPackSize())});
  ASSERT_EQ(got.poses.size(), 1u);
  EXPECT_LT(math::Distance(got.poses[0] * math::Vec3{1, 1, 1}, pose * math::Vec3{1, 1, 1}), 1e-5);

  const auto unpack = [](igtl::MessageBase* into, const std::string& bytes, int is_checked = 1) {
    igtl::MessageHeader::Pointer header = igtl::MessageHeader::New();
    header->InitPack();
    std::copy_n(bytes.data(), 58, static_cast<char*>(header->GetPackPointer()));
    header->Unpack();
    into->SetMessageHeader(header);
    into->AllocatePack();
    std::copy(bytes.begin() + 58, bytes.end(), static_cast<char*>(into->GetPackBodyPointer()));
    return (into->Unpack(is_checked) & igtl::MessageHeader::UNPACK_BODY) != 0;
  };
  igtl::TransformMessage::Pointer back = igtl::TransformMessage::New();
  ASSERT_TRUE(unpack(back, FormatIgtlTransform("left", pose, 12.5)));
  igtl::Matrix4x4 read;
  back->GetMatrix(read);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) EXPECT_NEAR(read[row][column], matrix[row][column], 1e-4);
  }
  EXPECT_STREQ(back->GetDeviceName(), "left");

  // a POSITION and a QTDATA, read as the library itself reads them. It packs shorter POSITIONs, too, but writes past their end
  math::Quaternion q = pose.rotation;
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  const auto number = [](double value) { return static_cast<float>(value); };
  const auto bytes_of = [](igtl::MessageBase* from) {
    from->Pack();
    return std::string(static_cast<const char*>(from->GetPackPointer()),
                       static_cast<std::size_t>(from->GetPackSize()));
  };
  igtl::PositionMessage::Pointer position = igtl::PositionMessage::New();
  position->SetDeviceName("left");
  position->SetPosition(100, -250, 1500);
  position->SetQuaternion(number(q.x), number(q.y), number(q.z), number(q.w));
  const Got read_position = Read(bytes_of(position));
  ASSERT_EQ(read_position.poses.size(), 1u);
  EXPECT_LT(math::Distance(read_position.poses[0] * math::Vec3{1, 1, 1}, pose * math::Vec3{1, 1, 1}), 1e-5);
  igtl::QuaternionTrackingDataElement::Pointer element = igtl::QuaternionTrackingDataElement::New();
  element->SetName("right");
  element->SetType(igtl::QuaternionTrackingDataElement::TYPE_6D);
  element->SetPosition(100, -250, 1500);
  element->SetQuaternion(number(q.x), number(q.y), number(q.z), number(q.w));
  igtl::QuaternionTrackingDataMessage::Pointer quaternions = igtl::QuaternionTrackingDataMessage::New();
  quaternions->AddQuaternionTrackingDataElement(element);
  const Got read_quaternions = Read(bytes_of(quaternions));
  ASSERT_EQ(read_quaternions.names, std::vector<std::string>{"right"});
  EXPECT_LT(math::Distance(read_quaternions.poses[0] * math::Vec3{1, 1, 1}, pose * math::Vec3{1, 1, 1}),
            1e-5);

  // docs/devices.md: a checksum of 0 is refused by the library where its check is asked for, which is not its default
  const std::string unsigned_bytes =
      FormatIgtlTransform("left", pose, 0).replace(50, 8, std::string(8, '\0'));
  for (const int is_checked : {1, 0}) {
    igtl::TransformMessage::Pointer into = igtl::TransformMessage::New();
    EXPECT_EQ(unpack(into, unsigned_bytes, is_checked), is_checked == 0);
  }

  const IgtlTool tools[] = {{"left", pose}, {"right", pose}};
  igtl::TrackingDataMessage::Pointer tracking = igtl::TrackingDataMessage::New();
  ASSERT_TRUE(unpack(tracking, FormatIgtlTrackingData("tools", tools, 1)));
  EXPECT_EQ(tracking->GetNumberOfTrackingDataElements(), 2);

  const math::Vec3 points[] = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}};
  const std::uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
  igtl::PolyDataMessage::Pointer poly = igtl::PolyDataMessage::New();
  ASSERT_TRUE(unpack(poly, FormatIgtlPolyData("liver", points, triangles, 1)));
  EXPECT_EQ(poly->GetPoints()->GetNumberOfPoints(), 4);
  EXPECT_EQ(poly->GetPolygons()->GetNumberOfCells(), 2u);
}
#else
TEST(IgtlOracle, UnderstandsTheLibraryBothWays) {
  GTEST_SKIP() << "libopenigtlink-dev was not there when this was built";
}
#endif

class IgtlTrackerTest : public testing::Test {
 protected:
  void Make(std::vector<Fault> faults = {}) {
    settings_.hands = *MakeHandsSettings(DefaultTracker());
    settings_.hands.has_hemisphere_doubt = false;
    host_ = *EmulatorHost::MakeTcp(MakeIgtlEmulator(MoveHands(settings_.hands, CalcHandMotion)), 0,
                                   std::move(faults));
    clock_.Add(*host_);
    const std::string address = host_->Address();
    const int port = std::stoi(address.substr(address.find(':') + 1));
    driver_ = std::make_unique<IgtlTracker>(
        settings_, [port] { return ConnectTcp("localhost", port); }, clock_);
  }
  IgtlSettings settings_;
  std::unique_ptr<EmulatorHost> host_;
  EmulatorClock clock_;
  std::unique_ptr<IgtlTracker> driver_;
  HandSamples samples_;
};

TEST_F(IgtlTrackerTest, SeesBothHandsOverLoopback) {
  Make();
  const base::Status done = driver_->Configure();
  ASSERT_TRUE(done.ok()) << done.error().Text();
  ASSERT_TRUE(driver_->Activate().ok());
  for (int i = 0; i < 100; ++i) {
    clock_.Sleep(0.01);
    ASSERT_NE(driver_->Read(samples_), ReadStatus::kLost);
  }
  for (const Channel hand : {kLeftHand, kRightHand}) {
    EXPECT_TRUE(samples_[hand].is_valid);
    EXPECT_NEAR(samples_[hand].pan, CalcHandMotion(clock_.Now())[hand].pan, 0.03);
  }
  host_->Unplug();
  ReadStatus status = ReadStatus::kUnchanged;
  // the kernel needs a moment to say that the other side is gone
  for (int i = 0; i < 20000 && status != ReadStatus::kLost; ++i) status = driver_->Read(samples_);
  EXPECT_EQ(status, ReadStatus::kLost);
}

TEST_F(IgtlTrackerTest, SaysWhichNamesItWants) {
  Make();
  settings_.names = {"port", "starboard", "periscope"};
  const std::string address = host_->Address();
  const int port = std::stoi(address.substr(address.find(':') + 1));
  IgtlTracker driver(
      settings_, [port] { return ConnectTcp("localhost", port); }, clock_);
  const base::Status status = driver.Configure();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kDeviceStale);
  EXPECT_NE(status.error().message.find("starboard"), std::string::npos);
  EXPECT_NE(status.error().message.find("This came: TRANSFORM \"LeftToTracker\" ("), std::string::npos)
      << status.error().message;
}

/// A server that says the same again and again.
class Repeater : public Emulator {
 public:
  explicit Repeater(std::string bytes) : bytes_(std::move(bytes)) {}
  void Receive(std::string_view) override {}
  std::string Advance(double) override { return bytes_; }

 private:
  std::string bytes_;
};

// what came stands in the error where no hand can be seen, and among what was held back where one can
TEST_F(IgtlTrackerTest, SaysWhatCameInsteadOfPoses) {
  std::string unchecked = FormatIgtlTransform("LeftTool", MakePose(), 0);
  unchecked.replace(50, 8, 8, '\0');
  const std::string mirrored = Message("TRANSFORM", Matrix(Turned(1, 1, -1)), 48);
  const std::string right = FormatIgtlTransform("RightTool", MakePose(), 0);
  const struct {
    std::string bytes, error, held_back;
  } cases[] = {
      {unchecked, "TRANSFORM \"LeftTool\": ", ""},
      {unchecked + Message("TRANSFORM", Matrix(Turned(0.1, 0.1, 0.1)), 48),
       "; also, TRANSFORM \"left\": ", ""},
      {mirrored + right, "", "TRANSFORM \"left\": "},
      {Message("STATUS", std::string(30, '\0'), 30), "This came: STATUS \"left\" (", ""},
      {"", "nothing came", ""},
      {"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\nServer: a long one\r\n\r\n", "it is no OpenIGTLink",
       ""},
  };
  for (const auto& one : cases) {
    const auto host = *EmulatorHost::MakeTcp(std::make_unique<Repeater>(one.bytes), 0, {});
    EmulatorClock clock;
    clock.Add(*host);
    const std::string address = host->Address();
    const int port = std::stoi(address.substr(address.find(':') + 1));
    IgtlTracker driver(
        settings_, [port] { return ConnectTcp("localhost", port); }, clock);
    const base::Status status = driver.Configure();
    EXPECT_EQ(status.ok(), one.error.empty()) << one.error;
    if (!status.ok()) {
      EXPECT_NE(status.error().message.find(one.error), std::string::npos) << status.error().message;
    }
    if (one.held_back.empty()) continue;
    ASSERT_TRUE(status.ok());
    ASSERT_TRUE(driver.Activate().ok());
    for (int i = 0; i < 50; ++i) {
      clock.Sleep(0.01);
      (void)driver.Read(samples_);
    }
    EXPECT_TRUE(samples_[kRightHand].is_valid);
    EXPECT_FALSE(samples_[kLeftHand].is_valid);
    ASSERT_EQ(driver.DescribeHeldBack().size(), 1u);
    EXPECT_TRUE(driver.DescribeHeldBack()[0].starts_with(one.held_back)) << driver.DescribeHeldBack()[0];
  }
}

}  // namespace
}  // namespace trocar::device
