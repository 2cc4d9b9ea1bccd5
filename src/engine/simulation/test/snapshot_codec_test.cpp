// SPDX-License-Identifier: Apache-2.0
#include "trocar/simulation/snapshot_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <map>
#include <span>
#include <utility>

#include "allocation_counter.h"
#include "snapshot_samples.h"
#include "trocar/base/checksum.h"
#include "trocar/base/state_hash.h"

namespace trocar::simulation {
namespace {

using Message = std::vector<std::byte>;

Message Whole(SnapshotEncoder& encoder, const Snapshot& snapshot, bool is_offered = true) {
  Message message;
  const base::Status encoded = encoder.EncodeWhole(snapshot, message, is_offered);
  EXPECT_TRUE(encoded.ok()) << encoded.error().Text();
  return message;
}

Message Delta(SnapshotEncoder& encoder, const Snapshot& snapshot, bool is_offered = false) {
  Message message;
  const base::Status encoded = encoder.EncodeDelta(snapshot, message, is_offered);
  EXPECT_TRUE(encoded.ok()) << encoded.error().Text();
  return message;
}

/// Gives a message that was changed the checksum that fits it.
void MendChecksum(Message& message) {
  constexpr std::size_t kAt = kSnapshotHeaderSize - sizeof(std::uint64_t);
  const std::span<const std::byte> bytes(message);
  base::StateHash hash;
  hash.Add(base::CalcChecksum(bytes.first(kAt)));
  hash.Add(base::CalcChecksum(bytes.subspan(kSnapshotHeaderSize)));
  const std::uint64_t checksum = hash.Value();
  std::memcpy(message.data() + kAt, &checksum, sizeof(checksum));
}

/// Tries values that differ from the one that is there; an index may have few.
struct ChangeTo {
  int attempt;

  template <typename T>
  void operator()(T& value) const {
    if constexpr (std::is_same_v<T, bool>) {
      value = !value;
    } else if constexpr (std::is_floating_point_v<T>) {
      value = std::nextafter(value, std::numeric_limits<T>::max());  // the last bit is enough
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(static_cast<std::underlying_type_t<T>>(value) + (attempt == 0 ? 1 : -1));
    } else {
      value = static_cast<T>(attempt == 0 ? value + 1 : value - 1);
    }
  }
};

// The control: each value of each field, also in lists and in structs in them, is changed alone and has to arrive, in a whole
// message and in a difference.
TEST(SnapshotCodec, CarriesAChangeOfAnyOneValue) {
  const SnapshotLayout layout = MakeSampleLayout();
  Snapshot original = layout.shape;
  math::Random random(3);
  GoOn(original, random);
  const auto bits = BitsOf(original);
  const std::size_t count = CountValues(original);
  EXPECT_GT(count, 1000u);
  for (std::size_t which = 0; which < count; ++which) {
    bool is_carried = false;
    for (int attempt = 0; attempt < 2 && !is_carried; ++attempt) {
      Snapshot changed = original;
      ChangeValue(changed, which, ChangeTo{attempt});
      const auto wanted = BitsOf(changed);
      ASSERT_NE(wanted, bits) << "value " << which;

      SnapshotEncoder encoder(layout);
      SnapshotDecoder decoder(layout), other(layout);
      Snapshot received;
      if (!decoder.Decode(Whole(encoder, changed), received).ok()) continue;
      ASSERT_EQ(BitsOf(received), wanted) << "value " << which;

      Snapshot seen;
      ASSERT_TRUE(other.Decode(Whole(encoder, original), seen).ok());
      ASSERT_TRUE(encoder.Acknowledge(other.LastKept()));
      ASSERT_TRUE(other.Decode(Delta(encoder, changed), seen).ok());
      ASSERT_EQ(BitsOf(seen), wanted) << "value " << which << " as a difference";
      is_carried = true;
    }
    EXPECT_TRUE(is_carried) << "value " << which << " of " << count << " is refused whatever it is";
  }
}

// Another look at whether every field is visited: in memory there is no room between the values for a real number, a size or a
// list that is not, only what alignment needs.
TEST(SnapshotCodec, LeavesNoGapBetweenTheValuesThatItVisits) {
  struct Place {
    std::uintptr_t begin;
    std::size_t size;
  };
  std::vector<Place> places, regions;
  const auto place_of = [](const auto& value) {
    return Place{reinterpret_cast<std::uintptr_t>(&value), sizeof(value)};
  };
  const Snapshot shape = MakeSampleLayout().shape;
  regions.push_back(place_of(shape));
  Visit(
      shape, [&](const auto& value) { places.push_back(place_of(value)); },
      [&](const auto& list) {
        places.push_back(place_of(list));
        regions.push_back(
            {reinterpret_cast<std::uintptr_t>(list.data()), list.size() * sizeof(list.front())});
      });
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
  std::size_t seen = 0;
  for (const auto& [begin, size] : regions) {
    std::uintptr_t end = begin;
    for (const Place& place : places) {
      if (place.begin < begin || place.begin >= begin + size) continue;
      ASSERT_LT(place.begin - end, sizeof(double)) << place.begin - begin;
      end = place.begin + place.size;
      ++seen;
    }
    EXPECT_LT(begin + size - end, sizeof(double));
  }
  EXPECT_EQ(seen, places.size());
}

TEST(SnapshotCodec, NoticesAListOfAnotherLength) {
  const SnapshotLayout layout = MakeSampleLayout();
  // \return how many lists there are
  const auto lengthen = [](Snapshot& snapshot, std::size_t which, std::size_t by) {
    std::size_t met = 0;
    Visit(
        snapshot, [](const auto&) {},
        [&](auto& list) {
          if (met++ == which) list.resize(list.size() + by);
        });
    return met;
  };
  Snapshot same = layout.shape;
  const std::size_t lists = lengthen(same, ~std::size_t{0}, 1);
  EXPECT_EQ(lists, 20u);
  for (std::size_t which = 0; which < lists; ++which) {
    for (const std::size_t step : {std::size_t{1}, ~std::size_t{0}}) {
      Snapshot other = layout.shape;
      lengthen(other, which, step);
      SnapshotEncoder encoder(layout);
      Message message = {std::byte{1}};
      const base::Status encoded = encoder.EncodeWhole(other, message);
      ASSERT_FALSE(encoded.ok()) << which;
      EXPECT_EQ(encoded.error().code, base::ErrorCode::kStateInvalid);
      EXPECT_TRUE(message.empty());
      EXPECT_EQ(encoder.LastMessage(), 0u);
    }
  }
}

// Who reads a snapshot looks things up by its counts and indices.
TEST(SnapshotCodec, RefusesCountsIndicesAndEnumeratorsOutOfRange) {
  const SnapshotLayout layout = MakeSampleLayout();
  std::size_t accepted = 0, tried = 0;
  for (std::size_t which = 0; which < CountValues(layout.shape); ++which) {
    bool is_real = false;
    Snapshot changed = layout.shape;
    ChangeValue(changed, which, [&](auto& value) {
      using T = std::remove_reference_t<decltype(value)>;
      if constexpr (std::is_floating_point_v<T> || std::is_same_v<T, bool>) {
        is_real = true;
      } else if constexpr (std::is_enum_v<T>) {
        value = static_cast<T>(100);
      } else {
        value = std::numeric_limits<T>::max();
      }
    });
    if (is_real) continue;
    ++tried;
    SnapshotEncoder encoder(layout);
    SnapshotDecoder decoder(layout);
    Snapshot received = layout.shape;
    if (decoder.Decode(Whole(encoder, changed), received).ok()) {
      ++accepted;
    } else {
      EXPECT_EQ(BitsOf(received), BitsOf(layout.shape)) << "refused, and changed";
    }
  }
  EXPECT_GT(tried, 150u);
  // what only counts: ticks of the snapshot and of its eight events, iterations, contacts and dropped ones, events, clips left
  // (2), version of the topology, errors (2); of the task: errors of each rule (3) and of all. A new index or count
  // of elements belongs into IsWithin
  EXPECT_EQ(accepted, 22u);
}

TEST(SnapshotCodec, CarriesNumbersThatAreNone) {
  const SnapshotLayout layout = MakeSampleLayout();
  Snapshot odd = layout.shape;
  odd.residual = std::numeric_limits<double>::quiet_NaN();
  odd.time = -0.0;
  odd.positions[1] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::denorm_min(),
                      -std::numeric_limits<double>::max()};
  SnapshotEncoder encoder(layout);
  SnapshotDecoder decoder(layout);
  Snapshot received;
  ASSERT_TRUE(decoder.Decode(Whole(encoder, odd), received).ok());
  EXPECT_EQ(BitsOf(received), BitsOf(odd));
}

TEST(SnapshotCodec, PictureRoundsPositionsAlone) {
  const SnapshotLayout layout = MakeSampleLayout();
  math::Random random(7);
  Snapshot now = layout.shape;
  SnapshotEncoder encoder(layout, SnapshotPrecision::kPicture);
  SnapshotDecoder decoder(layout);
  for (int i = 0; i < 50; ++i) {
    GoOn(now, random);
    for (math::Vec3& p : now.positions) p += math::Vec3{random.Uniform() - 0.5, 0.1, -0.3};
    Snapshot received;
    const base::Status decoded =
        decoder.Decode(encoder.HasBase() ? Delta(encoder, now, true) : Whole(encoder, now), received);
    ASSERT_TRUE(decoded.ok()) << decoded.error().Text();
    ASSERT_TRUE(encoder.Acknowledge(decoder.LastKept()));
    double farthest = 0;
    for (std::size_t node = 0; node < now.positions.size(); ++node) {
      for (int axis = 0; axis < 3; ++axis)
        farthest = std::max(farthest, std::fabs(now.positions[node][axis] - received.positions[node][axis]));
    }
    EXPECT_LE(farthest, kPictureGrid / 2);
    EXPECT_GT(farthest, 0.0) << "the control: something is lost";
    received.positions = now.positions;
    EXPECT_EQ(BitsOf(received), BitsOf(now));
  }
  now.positions[2].y = std::numeric_limits<double>::quiet_NaN();
  Message message;
  const base::Status encoded = encoder.EncodeDelta(now, message);
  ASSERT_FALSE(encoded.ok());
  EXPECT_EQ(encoded.error().code, base::ErrorCode::kStateNotFinite);
  EXPECT_TRUE(message.empty());
}

// A stream over a network that loses messages and delivers acknowledgements late.
TEST(SnapshotCodec, LostMessagesMakeNoOtherOneUnreadable) {
  const SnapshotLayout layout = MakeSampleLayout();
  math::Random random(11);
  SnapshotEncoder encoder(layout);
  SnapshotDecoder decoder(layout);
  Snapshot now = layout.shape, received;
  std::deque<std::pair<int, std::uint64_t>> under_way;  // acknowledgements, and when they arrive
  int arrived = 0, wholes = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    GoOn(now, random);
    while (!under_way.empty() && under_way.front().first <= tick) {
      encoder.Acknowledge(under_way.front().second);
      under_way.pop_front();
    }
    wholes += encoder.HasBase() ? 0 : 1;
    const bool is_offered = tick % 12 == 0;  // longer than an acknowledgement takes
    const Message message =
        encoder.HasBase() ? Delta(encoder, now, is_offered) : Whole(encoder, now, is_offered);
    if (random.Uniform() < 0.3) continue;
    const base::Status decoded = decoder.Decode(message, received);
    ASSERT_TRUE(decoded.ok()) << tick << ": " << decoded.error().Text();
    ASSERT_EQ(BitsOf(received), BitsOf(now)) << tick;
    ++arrived;
    if (random.Uniform() < 0.8) under_way.emplace_back(tick + 6, decoder.LastKept());
  }
  EXPECT_GT(arrived, 1200);
  EXPECT_GT(wholes, 5);
  EXPECT_LT(wholes, 200);
}

// A late message from before does not take away the base.
TEST(SnapshotCodec, AMessageThatComesLateIsReadAndNotKept) {
  const SnapshotLayout layout = MakeSampleLayout();
  math::Random random(13);
  SnapshotEncoder encoder(layout);
  SnapshotDecoder decoder(layout);
  Snapshot now = layout.shape, received;
  ASSERT_TRUE(decoder.Decode(Whole(encoder, now), received).ok());
  ASSERT_TRUE(encoder.Acknowledge(decoder.LastKept()));
  GoOn(now, random);
  const Message late = Delta(encoder, now, true);
  GoOn(now, random);
  ASSERT_TRUE(decoder.Decode(Delta(encoder, now, true), received).ok());
  const std::uint64_t kept = decoder.LastKept();
  ASSERT_TRUE(encoder.Acknowledge(kept));
  ASSERT_TRUE(decoder.Decode(late, received).ok());
  EXPECT_EQ(received.tick, now.tick - 1);
  EXPECT_EQ(decoder.LastKept(), kept) << "what came late is not kept";
  GoOn(now, random);
  // nor does a whole one that is not offered
  ASSERT_TRUE(decoder.Decode(Whole(encoder, now, false), received).ok());
  ASSERT_TRUE(encoder.HasBase());
  ASSERT_TRUE(decoder.Decode(Delta(encoder, now), received).ok());
  EXPECT_EQ(BitsOf(received), BitsOf(now));
}

TEST(SnapshotCodec, AcknowledgesWhatWasOfferedLast) {
  const SnapshotLayout layout = MakeSampleLayout();
  Snapshot now = layout.shape;
  SnapshotEncoder encoder(layout);
  EXPECT_FALSE(encoder.HasBase());
  EXPECT_FALSE(encoder.Acknowledge(0));
  Whole(encoder, now);
  const std::uint64_t first = encoder.LastMessage();
  ++now.tick;
  Whole(encoder, now);
  EXPECT_FALSE(encoder.Acknowledge(first));
  EXPECT_TRUE(encoder.Acknowledge(encoder.LastMessage()));
  EXPECT_TRUE(encoder.HasBase());
  const std::uint64_t second = encoder.LastMessage();
  ++now.tick;
  Delta(encoder, now);
  EXPECT_FALSE(encoder.Acknowledge(encoder.LastMessage())) << "it was not offered";
  EXPECT_FALSE(encoder.Acknowledge(second)) << "twice";
  EXPECT_TRUE(encoder.HasBase());
}

struct Stream {
  SnapshotLayout layout = MakeSampleLayout();
  Snapshot before, after;
  Message whole, delta;

  Stream() {
    math::Random random(5);
    SnapshotEncoder encoder(layout);
    before = layout.shape;
    GoOn(before, random);
    whole = Whole(encoder, before);
    EXPECT_TRUE(encoder.Acknowledge(encoder.LastMessage()));
    after = before;
    GoOn(after, random);
    delta = Delta(encoder, after);
  }
  /// Has the base.
  SnapshotDecoder MakeDecoder() const {
    SnapshotDecoder decoder(layout);
    Snapshot received;
    EXPECT_TRUE(decoder.Decode(whole, received).ok());
    return decoder;
  }
};

TEST(SnapshotCodec, RejectsTruncated) {
  const Stream stream;
  SnapshotDecoder decoder = stream.MakeDecoder();
  for (const Message& message : {stream.whole, stream.delta}) {
    Snapshot received = stream.before;
    for (std::size_t length = 0; length < message.size(); ++length) {
      const base::Status decoded = decoder.Decode(std::span(message).first(length), received);
      ASSERT_FALSE(decoded.ok()) << length;
      EXPECT_EQ(decoded.error().code, base::ErrorCode::kStateInvalid);
    }
    Message longer = message;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(decoder.Decode(longer, received).ok());
    EXPECT_EQ(BitsOf(received), BitsOf(stream.before));
    EXPECT_TRUE(decoder.Decode(message, received).ok()) << "the control";
  }
}

TEST(SnapshotCodec, RejectsAnyByteThatIsFlipped) {
  const Stream stream;
  SnapshotDecoder decoder = stream.MakeDecoder();
  Snapshot received = stream.before;
  for (const Message& message : {stream.whole, stream.delta}) {
    for (std::size_t at = 0; at < message.size(); ++at) {
      Message other = message;
      other[at] ^= std::byte{static_cast<unsigned char>(1U << (at % 8))};
      ASSERT_FALSE(decoder.Decode(other, received).ok()) << at;
    }
  }
  EXPECT_EQ(BitsOf(received), BitsOf(stream.before));
}

/// What others do with a snapshot that they trust.
void ExpectUsable(const Snapshot& seen) {
  const OperationSnapshot& o = seen.operation;
  ASSERT_LE(o.clip_count, o.clips.size());
  ASSERT_LE(o.tube_cut_count, o.tube_cuts.size());
  ASSERT_LE(o.flow.leak_count, o.flow.leaks.size());
  ASSERT_LE(o.flow.ooze_count, o.flow.oozes.size());
  ASSERT_LE(o.topology.tube_piece_count, o.topology.tube_pieces.size());
  for (std::size_t i = 0; i < o.topology.first_triangle.size(); ++i) {
    ASSERT_LE(std::uint64_t{o.topology.first_triangle[i]} + o.topology.triangle_count[i],
              o.topology.triangles.size());
  }
  for (const auto& triangle : o.topology.triangles) {
    for (const std::uint32_t node : triangle) ASSERT_LT(node, seen.positions.size());
  }
  for (const scene::Event& event : seen.events) ASSERT_FALSE(surgery::FactName(event.kind).empty());
}

// Bytes of somebody who knows the format: the checksum fits. What is not refused can be used.
TEST(SnapshotCodec, MutatedMessagesAreRefusedOrUsable) {
  const Stream stream;
  math::Random random(17);
  const auto pick = [&](std::size_t count) {
    return std::min(static_cast<std::size_t>(random.Uniform() * static_cast<double>(count)), count - 1);
  };
  int refused = 0, accepted = 0;
  for (int i = 0; i < 6000; ++i) {
    SnapshotDecoder decoder = stream.MakeDecoder();
    Message message = i % 2 == 0 ? stream.whole : stream.delta;
    const int changes = 1 + static_cast<int>(pick(4));
    for (int k = 0; k < changes; ++k) {
      // half of them in the header
      const std::size_t at = random.Uniform() < 0.3 ? pick(kSnapshotHeaderSize) : pick(message.size());
      switch (pick(4)) {
        case 0:
          message[at] = static_cast<std::byte>(pick(256));
          break;
        case 1:
          message[at] ^= static_cast<std::byte>(1U << pick(8));
          break;
        case 2:
          message.erase(message.begin() + static_cast<std::ptrdiff_t>(at));
          break;
        default:
          message.insert(message.begin() + static_cast<std::ptrdiff_t>(at),
                         static_cast<std::byte>(pick(256)));
      }
      if (message.size() < kSnapshotHeaderSize) message.resize(kSnapshotHeaderSize);
    }
    if (random.Uniform() < 0.9) {
      const auto size = static_cast<std::uint32_t>(message.size() - kSnapshotHeaderSize);
      std::memcpy(message.data() + 48, &size, sizeof(size));
    }
    MendChecksum(message);
    Snapshot received = stream.before;
    if (decoder.Decode(message, received).ok()) {
      ++accepted;
      ExpectUsable(received);
    } else {
      ++refused;
      ASSERT_EQ(BitsOf(received), BitsOf(stream.before)) << i;
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(accepted, 200) << "the mutations are too wild to get anywhere";
}

TEST(SnapshotCodec, SaysWhyItRefuses) {
  const Stream stream;
  const auto reason = [&](const SnapshotLayout& layout, const Message& message) {
    SnapshotDecoder decoder(layout);
    Snapshot received;
    const base::Status decoded = decoder.Decode(message, received);
    return decoded.ok() ? std::string("accepted") : decoded.error().message;
  };
  EXPECT_EQ(reason(stream.layout, stream.whole), "accepted");
  EXPECT_NE(reason(stream.layout, stream.delta).find("a difference from tick 1,"), std::string::npos);
  SnapshotLayout other_scene = stream.layout;
  other_scene.model ^= 1;
  EXPECT_NE(reason(other_scene, stream.whole).find("another scene"), std::string::npos);
  SnapshotLayout other_fields = stream.layout;
  other_fields.shape.organs.emplace_back();
  EXPECT_NE(reason(other_fields, stream.whole).find("other fields"), std::string::npos);
  Message later = stream.whole;
  later[4] = std::byte{2};
  EXPECT_NE(reason(stream.layout, later).find("version 2"), std::string::npos);
  Message foreign = stream.whole;
  foreign[0] = std::byte{'X'};
  EXPECT_NE(reason(stream.layout, foreign).find("no message"), std::string::npos);

  // the base of another run of the same scene, of the same tick
  SnapshotEncoder encoder(stream.layout);
  Snapshot alike = stream.before;
  alike.positions[0].x += 1e-9;
  const Message whole = Whole(encoder, alike);
  SnapshotDecoder decoder(stream.layout);
  Snapshot received;
  ASSERT_TRUE(decoder.Decode(whole, received).ok());
  EXPECT_FALSE(decoder.Decode(stream.delta, received).ok());
  EXPECT_EQ(BitsOf(received), BitsOf(alike));
}

TEST(SnapshotCodec, AllocatesNothingOnceItHasRun) {
  const SnapshotLayout layout = MakeSampleLayout();
  math::Random random(23);
  for (const SnapshotPrecision precision : {SnapshotPrecision::kExact, SnapshotPrecision::kPicture}) {
    SnapshotEncoder encoder(layout, precision);
    SnapshotDecoder decoder(layout);
    Snapshot now = layout.shape, received = layout.shape;
    // the largest message that there can be
    VisitValues(now, [&](auto& value) {
      if constexpr (std::is_same_v<decltype(value), double&>) value = random.Uniform() - 0.5;
    });
    Message message;
    ASSERT_TRUE(encoder.EncodeWhole(now, message).ok());
    ASSERT_TRUE(decoder.Decode(message, received).ok());
    ASSERT_TRUE(encoder.Acknowledge(decoder.LastKept()));
    message.reserve(2 * message.size());
    const long before = CountAllocations();
    bool is_good = true;
    for (int i = 0; i < 20; ++i) {
      GoOn(now, random);
      is_good = is_good && encoder.EncodeDelta(now, message, i % 3 == 0).ok() &&
                decoder.Decode(message, received).ok();
      encoder.Acknowledge(decoder.LastKept());
      is_good = is_good && (i % 7 != 0 || encoder.EncodeWhole(now, message).ok());
      if (i % 7 == 0)
        is_good =
            is_good && decoder.Decode(message, received).ok() && encoder.Acknowledge(decoder.LastKept());
    }
    EXPECT_EQ(CountAllocations() - before, 0);
    EXPECT_TRUE(is_good);
  }
}

}  // namespace
}  // namespace trocar::simulation
