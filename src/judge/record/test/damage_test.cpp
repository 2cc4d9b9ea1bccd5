// SPDX-License-Identifier: Apache-2.0
// Recordings that are cut, changed, of another time or of nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <random>

#include "chunk.h"
#include "recorded_scene.h"
#include "recording_json.h"
#include "trocar/host/safe_file.h"

namespace trocar::record {
namespace {

constexpr std::size_t kCutSize = 64 << 10;

class Damage : public RecordedScene {
 protected:
  void SetUp() override {
    RecordedScene::SetUp();
    Record(600);
    const auto content = host::ReadFile(File());
    ASSERT_TRUE(content.ok());
    const auto view = std::as_bytes(std::span(*content));
    bytes_.assign(view.begin(), view.end());
  }
  /// What was read is the beginning of what was recorded.
  void ExpectBeginning(const Recording& recording) const {
    ASSERT_LE(recording.inputs.size(), 600u);
    for (std::size_t tick = 0; tick < recording.inputs.size(); tick += 37)
      ASSERT_EQ(recording.inputs[tick], InputOf(tick));
    if (!recording.inputs.empty()) {
      ASSERT_EQ(recording.inputs.back(), InputOf(recording.inputs.size() - 1));
    }
  }
  std::vector<std::byte> bytes_;
};

// A cut leaves no ending; one that contradicts the rest was written by somebody.
TEST_F(Damage, TellsAnEndingThatContradictsFromOneThatIsMissing) {
  const auto whole = ReadRecording(bytes_, "whole");
  ASSERT_TRUE(whole.ok() && whole->ending);
  EXPECT_FALSE(whole->is_ending_refused);
  // the last chunk is the ending
  std::size_t at = sizeof(FileHeader), last = 0;
  std::uint64_t number = 0;
  for (ChunkHeader chunk; at < bytes_.size(); at += sizeof chunk + chunk.size) {
    std::memcpy(&chunk, bytes_.data() + at, sizeof chunk);
    last = at, number = chunk.number;
  }
  std::vector<std::byte> cut(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(last));
  const auto missing = ReadRecording(cut, "cut");
  ASSERT_TRUE(missing.ok());
  EXPECT_FALSE(missing->ending || missing->is_ending_refused);
  Ending other = *whole->ending;
  ++other.ticks;
  for (const std::string& text : {WriteEnding(other), std::string("{}"), std::string("its ending")}) {
    std::vector<std::byte> forged = cut;
    PutChunk(whole->file_id, number, ChunkKind::kEnding, other.ticks, BytesOf(text), forged);
    const auto recording = ReadRecording(forged, "forged");
    ASSERT_TRUE(recording.ok());
    EXPECT_FALSE(recording->ending.has_value()) << text;
    EXPECT_TRUE(recording->is_ending_refused) << text;
    EXPECT_FALSE(recording->damage.empty()) << text;
  }
}

TEST_F(Damage, EveryTruncationIsNoticedAndWhatIsBeforeIsRead) {
  const std::size_t most = std::min(bytes_.size() - 1, kCutSize);
  std::size_t before = 0;
  for (std::size_t size = 0; size <= most; ++size) {
    const auto recording = ReadRecording(std::span(bytes_).first(size), "cut");
    if (!recording.ok()) {
      ASSERT_EQ(recording.error().code, base::ErrorCode::kRecordingInvalid);
      continue;
    }
    // between two chunks nothing is damaged, but it has no ending
    ASSERT_FALSE(recording->ending.has_value()) << size;
    ASSERT_EQ(recording->damage.empty(), recording->whole_bytes == size) << size;
    ASSERT_GE(recording->inputs.size(), before);
    before = recording->inputs.size();
    if (size % 1024 == 0) ExpectBeginning(*recording);
  }
  EXPECT_GT(before, 50u);
}

TEST_F(Damage, EveryFlippedBitIsNoticed) {
  std::mt19937_64 random(3);
  const std::size_t size = std::min(bytes_.size(), kCutSize);
  int most_read = 0;
  for (int trial = 0; trial < 100000; ++trial) {
    std::vector<std::byte>& bytes = bytes_;
    const std::size_t at = random() % size;
    const auto bit = static_cast<std::byte>(1u << random() % 8);
    bytes[at] ^= bit;
    const auto recording = ReadRecording(std::span(bytes).first(size), "flipped");
    bytes[at] ^= bit;
    if (!recording.ok()) {
      ASSERT_EQ(recording.error().code, base::ErrorCode::kRecordingInvalid);
      continue;
    }
    ASSERT_FALSE(recording->damage.empty()) << "byte " << at;
    ASSERT_LE(recording->whole_bytes, at) << "byte " << at;
    most_read = std::max(most_read, static_cast<int>(recording->inputs.size()));
    if (trial % 1000 == 0) ExpectBeginning(*recording);
  }
  EXPECT_GT(most_read, 50);
}

TEST_F(Damage, AChunkOfAnotherFileIsNone) {
  const std::vector<std::byte> one = bytes_;
  std::filesystem::remove(File());
  Record(600);
  const auto content = host::ReadFile(File());
  ASSERT_TRUE(content.ok());
  // the same attempt, so that chunks lie at the same places
  std::vector<std::byte> mixed = one;
  const auto other = std::as_bytes(std::span(*content));
  ASSERT_GT(other.size(), 4000u);
  std::copy(other.begin() + 4000,
            other.begin() + static_cast<std::ptrdiff_t>(std::min(other.size(), one.size())),
            mixed.begin() + 4000);
  const auto recording = ReadRecording(mixed, "mixed");
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->damage, "a checksum does not fit");
  EXPECT_LT(recording->whole_bytes, one.size());
}

TEST_F(Damage, ALaterFormatIsRefusedWithWhatToDo) {
  bytes_[8] = std::byte{200};
  const auto recording = ReadRecording(bytes_, "later");
  ASSERT_FALSE(recording.ok());
  EXPECT_EQ(recording.error().code, base::ErrorCode::kRecordingInvalid);
  EXPECT_THAT(recording.error().message, testing::HasSubstr("format 200"));
}

TEST_F(Damage, WhatIsNoRecordingIsRefused) {
  Write("text.trocar", "a text that is long enough to be taken for a header");
  const auto recording = ReadRecording(folder_ / "text.trocar");
  ASSERT_FALSE(recording.ok());
  EXPECT_EQ(recording.error().code, base::ErrorCode::kRecordingInvalid);
  EXPECT_EQ(ReadRecording(folder_ / "none.trocar").error().code, base::ErrorCode::kFileMissing);
}

TEST_F(Damage, IsRepairedByCuttingItOff) {
  std::vector<std::byte> damaged = bytes_;
  damaged[damaged.size() * 2 / 3] ^= std::byte{1};
  Write("damaged.trocar", std::string(reinterpret_cast<const char*>(damaged.data()), damaged.size()));
  const auto repaired = folder_ / "repaired.trocar";
  const base::Status status = RepairRecording(folder_ / "damaged.trocar", repaired);
  ASSERT_TRUE(status.ok()) << status.error().Text();
  const auto recording = ReadRecording(repaired);
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->damage, "");
  EXPECT_GT(recording->inputs.size(), 50u);
  ExpectBeginning(*recording);
  EXPECT_EQ(RepairRecording(File(), folder_ / "none").error().code, base::ErrorCode::kRecordingInvalid);
}

TEST_F(Damage, WrongContentUnderARightChecksumIsReadOrRefused) {
  std::mt19937_64 random(4);
  // where the chunks begin
  std::vector<std::size_t> starts;
  std::uint64_t file_id = 0;
  std::memcpy(&file_id, bytes_.data() + offsetof(FileHeader, file_id), sizeof file_id);
  for (std::size_t at = sizeof(FileHeader); at < bytes_.size();) {
    ChunkHeader header;
    std::memcpy(&header, bytes_.data() + at, sizeof header);
    starts.push_back(at);
    at += sizeof header + header.size;
  }
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const std::size_t at = starts[random() % starts.size()];
    std::vector<std::byte> bytes = bytes_;
    ChunkHeader header;
    std::memcpy(&header, bytes.data() + at, sizeof header);
    const auto content = std::span(bytes).subspan(at + sizeof header, header.size);
    for (int change = 0; change < 3 && !content.empty(); ++change)
      content[random() % std::min<std::size_t>(content.size(), 40)] = static_cast<std::byte>(random());
    if (random() % 5 == 0) header.kind = static_cast<ChunkKind>(random() % 9);
    header.checksum = CalcChunkChecksum(file_id, header, content);
    std::memcpy(bytes.data() + at, &header, sizeof header);
    const auto recording = ReadRecording(bytes, "changed");
    if (!recording.ok() || !recording->damage.empty()) {
      ++refused;
      continue;
    }
    for (std::size_t frame = 0; frame < recording->KeyframeTicks().size(); ++frame) {
      const auto state = recording->ReadKeyframe(frame);
      if (!state.ok()) ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace trocar::record
