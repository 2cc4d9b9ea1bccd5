// SPDX-License-Identifier: Apache-2.0
#include "dicom_volumes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

namespace trocar::images {
namespace {

using base::ErrorCode;
using testing::ElementsAre;
using testing::HasSubstr;

/// Axial slices of one series, `step` apart from `begin` on; `change` gets the header and the index.
std::vector<DicomSlice> MakeStack(int count, double begin, double step,
                                  const std::function<void(ImageHeader&, int)>& change = {}) {
  std::vector<DicomSlice> slices;
  for (int i = 0; i < count; ++i) {
    DicomSlice slice;
    ImageHeader& header = slice.header;
    header.width = header.height = 8, header.depth = header.channels = 1;
    header.has_position = 1;
    header.is_ct = 1;
    header.series_hash = 5;
    header.spacing[0] = header.spacing[1] = 0.7;
    for (int axis = 0; axis < 3; ++axis) header.direction[axis][axis] = 1;
    header.origin[2] = begin + i * step;
    header.instance_number = i + 1;
    std::fill(std::begin(header.keys), std::end(header.keys), kKeyNotSaid);
    if (change) change(header, i);
    slice.file = "IM" + std::to_string(begin) + "-" + std::to_string(i);
    slices.push_back(slice);
  }
  return slices;
}

std::function<void(ImageHeader&, int)> With(DicomKey key, std::int64_t value) {
  return [=](ImageHeader& header, int) { header.keys[static_cast<std::size_t>(key)] = value; };
}

std::vector<DicomSlice> operator+(std::vector<DicomSlice> a, const std::vector<DicomSlice>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// "part: slices" of each volume, with what is wrong with it.
std::vector<std::string> Split(const std::vector<DicomSlice>& slices) {
  std::vector<std::string> parts;
  for (const DicomVolume& volume : SplitVolumes(slices)) {
    parts.push_back(volume.part + ": " + std::to_string(volume.slices.size()) +
                    (volume.order.ok() ? "" : " " + std::string(base::CodeText(volume.order.error().code))));
  }
  return parts;
}

TEST(SplitVolumes, KeepsSeriesApartInTheOrderOfTheirFiles) {
  auto slices = MakeStack(6, 0, 2);
  for (const int i : {1, 3, 5}) slices[i].header.series_hash = 7;
  const auto volumes = SplitVolumes(slices);
  ASSERT_EQ(volumes.size(), 2u);
  EXPECT_EQ(volumes[1].number, 2);
  EXPECT_EQ(volumes[1].slices[0].header.series_hash, 7u);
  EXPECT_EQ(volumes[0].part, "");
}

TEST(SplitVolumes, TellsPhasesApartByWhatTheHeadersSay) {
  for (const auto& [key, name] : {std::pair{DicomKey::kAcquisition, "acquisition"},
                                  {DicomKey::kTemporalPosition, "temporal position"},
                                  {DicomKey::kEcho, "echo"}}) {
    const auto slices = MakeStack(24, 0, 5, With(key, 2)) + MakeStack(24, 0, 5, With(key, 1));
    EXPECT_THAT(Split(slices), ElementsAre(std::string(name) + " 1: 24", std::string(name) + " 2: 24"));
  }
  EXPECT_THAT(Split(MakeStack(9, 0, 5, With(DicomKey::kKernel, 1234)) +
                    MakeStack(9, 0, 5, With(DicomKey::kKernel, 99))),
              ElementsAre("kernel 1 of 2: 9", "kernel 2 of 2: 9"));
  EXPECT_THAT(Split(MakeStack(9, 0, 5, With(DicomKey::kEchoTime, 2300)) + MakeStack(9, 0, 5)),
              ElementsAre("echo time not said: 9", "echo time 2.3 ms: 9"));
}

TEST(SplitVolumes, TakesTwoKeysWhereOneIsNotEnough) {
  std::vector<DicomSlice> slices;
  for (int phase = 1; phase <= 3; ++phase) {
    for (int echo = 1; echo <= 2; ++echo) {
      slices = slices + MakeStack(7, 0, 3, [=](ImageHeader& header, int) {
                 header.keys[static_cast<std::size_t>(DicomKey::kAcquisition)] = phase;
                 header.keys[static_cast<std::size_t>(DicomKey::kEcho)] = echo;
               });
    }
  }
  const auto parts = Split(slices);
  ASSERT_EQ(parts.size(), 6u);
  EXPECT_EQ(parts[3], "acquisition 2, echo 2: 7");
}

TEST(SplitVolumes, OfTwoAcquisitionsThatOverlapEachIsAVolume) {
  EXPECT_THAT(Split(MakeStack(20, 0, 5, With(DicomKey::kAcquisition, 1)) +
                    MakeStack(30, 50, 5, With(DicomKey::kAcquisition, 2))),
              ElementsAre("acquisition 1: 20", "acquisition 2: 30"));
  // and shifted against each other, so that no two slices lie in one place
  EXPECT_THAT(Split(MakeStack(20, 0, 5, With(DicomKey::kAcquisition, 1)) +
                    MakeStack(20, 1.3, 5, With(DicomKey::kAcquisition, 2))),
              ElementsAre("acquisition 1: 20", "acquisition 2: 20"));
}

TEST(SplitVolumes, WhatIsOneVolumeStaysOne) {
  // a number for each turn of the gantry, one table position after the other, times that go on
  EXPECT_THAT(Split(MakeStack(40, 0, 2,
                              [](ImageHeader& header, int i) {
                                header.keys[static_cast<std::size_t>(DicomKey::kAcquisition)] = i / 4;
                                header.keys[static_cast<std::size_t>(DicomKey::kContentTime)] = 1000 * i;
                                header.keys[static_cast<std::size_t>(DicomKey::kTriggerTime)] = i;
                              })),
              ElementsAre(": 40"));
  EXPECT_THAT(Split(MakeStack(20, 0, 2, With(DicomKey::kAcquisition, 1)) +
                    MakeStack(20, 40, 2, With(DicomKey::kAcquisition, 2))),
              ElementsAre(": 40"));
  // in magnetic resonance slices of one volume are acquired in turns
  const auto turns = [](ImageHeader& header, int i) {
    header.is_ct = 0;
    header.keys[static_cast<std::size_t>(DicomKey::kAcquisition)] = i % 2;
  };
  EXPECT_THAT(Split(MakeStack(20, 0, 2, turns)), ElementsAre(": 20"));
}

TEST(SplitVolumes, PhasesThatLieBetweenEachOtherAreNotMergedInSilence) {
  EXPECT_THAT(Split(MakeStack(20, 0, 5, With(DicomKey::kAcquisition, 1)) +
                    MakeStack(20, 2.5, 5, With(DicomKey::kAcquisition, 2))),
              ElementsAre("acquisition 1: 20", "acquisition 2: 20"));
}

TEST(SplitVolumes, FallsBackOnTimesAndOnTheOrderOfInstances) {
  const auto at = [](DicomKey key, std::int64_t begin, std::int64_t step) {
    return [=](ImageHeader& header, int i) { header.keys[static_cast<std::size_t>(key)] = begin + i * step; };
  };
  // every slice has a time of its own; the table moves one way, and back
  EXPECT_THAT(Split(MakeStack(20, 0, 5, at(DicomKey::kAcquisitionTime, 0, 200)) +
                    MakeStack(30, 0, 5, at(DicomKey::kAcquisitionTime, 60000, -200))),
              ElementsAre("acquisition time 1 of 2: 20", "acquisition time 2 of 2: 30"));
  // without a pause between the sweeps
  EXPECT_THAT(Split(MakeStack(10, 0, 5, at(DicomKey::kContentTime, 0, 100)) +
                    MakeStack(10, 0, 5, at(DicomKey::kContentTime, 1000, 100)) +
                    MakeStack(10, 0, 5, at(DicomKey::kContentTime, 2000, 100))),
              ElementsAre("content time 1 of 3: 10", "content time 2 of 3: 10", "content time 3 of 3: 10"));
  // nothing but the numbers of the instances
  const auto numbered = [](int begin) {
    return [=](ImageHeader& header, int i) { header.instance_number = begin + i; };
  };
  EXPECT_THAT(Split(MakeStack(8, 0, 5, numbered(1)) + MakeStack(8, 0, 5, numbered(9))),
              ElementsAre("order of instance numbers, 1 of 2: 8", "order of instance numbers, 2 of 2: 8"));
  // nothing at all
  const auto same = [](ImageHeader& header, int) { header.instance_number = 0; };
  EXPECT_THAT(Split(MakeStack(8, 0, 5, same) + MakeStack(8, 0, 5, same)), ElementsAre(": 16 E-IMG-008"));
}

TEST(SplitVolumes, APhaseWithAGapIsAPhaseWithAGap) {
  auto second = MakeStack(24, 0, 5, With(DicomKey::kAcquisition, 2));
  second.erase(second.begin() + 7);
  EXPECT_THAT(Split(MakeStack(24, 0, 5, With(DicomKey::kAcquisition, 1)) + second),
              ElementsAre("acquisition 1: 24", "acquisition 2: 23 E-IMG-007"));
}

TEST(SplitVolumes, ALocalizerInTheSeriesIsNoVolume) {
  const auto scout = [](ImageHeader& header, int) {
    header.is_localizer = 1;
    header.direction[1][1] = 0, header.direction[1][2] = -1;
    header.direction[2][2] = 0, header.direction[2][1] = 1;
    header.width = 300;
  };
  const auto volumes = SplitVolumes(MakeStack(2, 0, 1, scout) + MakeStack(20, 0, 5));
  ASSERT_EQ(volumes.size(), 2u);
  EXPECT_EQ(volumes[0].part, "localizer");
  EXPECT_FALSE(volumes[0].is_volume);
  EXPECT_TRUE(volumes[1].is_volume);
  std::string note;
  const auto chosen = ChooseVolume(volumes, 0, note);
  ASSERT_TRUE(chosen.ok()) << chosen.error().Text();
  EXPECT_EQ(*chosen, 1u);
  EXPECT_THAT(note, HasSubstr("it alone is a volume; beside it: 1 (localizer, slices: 2)"));
}

TEST(SplitVolumes, SizesAndOrientationsAreVolumesOfTheirOwn) {
  const auto large = [](ImageHeader& header, int) { header.width = 16; };
  const auto turned = [](ImageHeader& header, int) {
    header.direction[0][0] = std::cos(0.1), header.direction[0][1] = std::sin(0.1);
    header.direction[1][0] = -std::sin(0.1), header.direction[1][1] = std::cos(0.1);
  };
  EXPECT_THAT(Split(MakeStack(5, 0, 2) + MakeStack(6, 0, 2, large) + MakeStack(7, 0, 2, turned)),
              ElementsAre(": 5", "16 x 8 pixels: 6", "turned or with pixels of 0.7 mm: 7"));
}

TEST(SplitVolumes, IdsAreOfTheVolumeAndNotOfTheFolder) {
  const auto first = MakeStack(9, 0, 5, With(DicomKey::kAcquisition, 1)),
             second = MakeStack(9, 0, 5, With(DicomKey::kAcquisition, 2));
  auto other = MakeStack(5, 0, 5);
  for (DicomSlice& slice : other) slice.header.series_hash = 77;
  const auto alone = SplitVolumes(first + second), beside = SplitVolumes(other + second + first);
  ASSERT_EQ(alone.size(), 2u);
  ASSERT_EQ(beside.size(), 3u);
  std::set<int> ids;
  for (const DicomVolume& volume : beside) {
    EXPECT_GE(volume.id, 100001);
    EXPECT_LE(volume.id, 999999999);
    ids.insert(volume.id);
  }
  EXPECT_EQ(ids.size(), 3u);
  for (const DicomVolume& volume : alone) EXPECT_TRUE(ids.contains(volume.id)) << volume.part;
  // the numbers of series are those that they had before parts of series could be chosen
  EXPECT_EQ(beside[0].slices[0].header.series_hash, 77u);
  EXPECT_EQ(beside[1].part, "acquisition 1");
  EXPECT_EQ(beside[2].part, "acquisition 2");
}

TEST(SplitVolumes, SeriesWithoutAPlaceKeepTheirNumbers) {
  auto capture = MakeStack(1, 0, 1), first = MakeStack(3, 0, 2), second = MakeStack(3, 0, 2);
  capture[0].header.series_hash = 1, capture[0].header.has_position = 0, capture[0].file = "A";
  for (DicomSlice& slice : first) slice.file = "B";
  for (DicomSlice& slice : second) slice.file = "C", slice.header.series_hash = 6;
  const auto volumes = SplitVolumes(first + second, capture);
  ASSERT_EQ(volumes.size(), 2u);
  EXPECT_EQ(volumes[0].number, 2);
  EXPECT_EQ(volumes[1].number, 3);
}

TEST(ChooseVolume, AsksWhereSeveralCouldBeMeant) {
  const auto volumes = SplitVolumes(MakeStack(24, 0, 5, With(DicomKey::kAcquisition, 1)) +
                                    MakeStack(24, 0, 5, With(DicomKey::kAcquisition, 2)));
  std::string note;
  const auto asked = ChooseVolume(volumes, 0, note);
  ASSERT_FALSE(asked.ok());
  EXPECT_EQ(asked.error().code, ErrorCode::kImageSeriesMixed);
  EXPECT_THAT(
      asked.error().message,
      HasSubstr("1 (acquisition 1, slices: 24); 2 (acquisition 2, slices: 24); choose one with --series"));
  EXPECT_EQ(*ChooseVolume(volumes, 2, note), 1u);
  EXPECT_EQ(*ChooseVolume(volumes, volumes[1].id, note), 1u);
  EXPECT_EQ(note, "") << "a person chose";
  EXPECT_EQ(ChooseVolume(volumes, 3, note).error().code, ErrorCode::kImageSliceMissing);
}

}  // namespace
}  // namespace trocar::images
