// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/input_codec.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "wandering_input.h"

namespace trocar::record {

using scene::Input;

namespace {

/// Also where it is not a number.
void ExpectSameBits(const Input& a, const Input& b) {
  const auto of_a = ListJoints(a), of_b = ListJoints(b);
  for (std::size_t i = 0; i < kJointCount; ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(of_a[i]), std::bit_cast<std::uint64_t>(of_b[i])) << "joint " << i;
  EXPECT_EQ(a.controls, b.controls);
  EXPECT_EQ(a.assistant, b.assistant);
  EXPECT_EQ(a.settings, b.settings);
}

void ExpectRoundTrip(const std::vector<Input>& inputs) {
  InputEncoder encoder;
  std::vector<std::byte> bytes;
  for (const Input& input : inputs) encoder.Encode(input, bytes);
  InputDecoder decoder;
  std::span<const std::byte> rest = bytes;
  for (const Input& input : inputs) {
    Input decoded;
    ASSERT_TRUE(decoder.Decode(rest, decoded));
    ExpectSameBits(input, decoded);
  }
  EXPECT_TRUE(rest.empty());
}

TEST(InputCodec, KeepsEveryBit) {
  std::mt19937_64 random(1);
  std::vector<Input> inputs(500);
  constexpr double kOdd[] = {
      0.0,   -0.0,   std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
      1e300, 5e-324, -std::numeric_limits<double>::infinity(), 0x1p-30};
  for (Input& input : inputs) {
    for (instrument::TrocarJoints* joints : {&input.hands[0], &input.hands[1], &input.laparoscope}) {
      for (double* joint : {&joints->pan, &joints->tilt, &joints->spin, &joints->depth, &joints->jaw}) {
        switch (random() % 4) {
          case 0:
            *joint = kOdd[random() % std::size(kOdd)];
            break;
          case 1:
            *joint = std::bit_cast<double>(random());
            break;
          case 2:
            *joint = std::ldexp(static_cast<double>(random() % 1000000), -30);
            break;
          default:
            break;
        }
      }
    }
    input.controls[random() % 2].tool = static_cast<std::uint8_t>(random() % 3);
    input.controls[random() % 2].coagulate = random() % 2 == 0;
    input.assistant = static_cast<scene::AssistantCommand>(random() % 4);
    if (random() % 7 == 0) input.settings.solver.max_iterations = static_cast<int>(random() % 100);
  }
  ExpectRoundTrip(inputs);
}

TEST(InputCodec, HandsOnTheGridNeedLittle) {
  std::vector<Input> inputs;
  InputEncoder encoder;
  std::vector<std::byte> bytes;
  constexpr std::size_t kTicks = 12000;
  for (std::size_t tick = 0; tick < kTicks; ++tick) {
    inputs.push_back(MakeWanderingInput({}, tick));
    encoder.Encode(inputs.back(), bytes);
  }
  ExpectRoundTrip(inputs);
  // both hands move all the time: half an hour of it stays below 10 MB, and so does the rest of a recording beside it
  EXPECT_LT(static_cast<double>(bytes.size()) / kTicks * 216000, 8e6);
}

// Scripted hands: smooth, with a tremor, off the grid. Half an hour of five joints of both hands stays below 10 MB with
// hashes and events; format 1 took about seven bytes a joint.
TEST(InputCodec, SmoothHandsOffTheGridNeedLessThanSixBytesAJoint) {
  std::vector<Input> inputs;
  InputEncoder encoder;
  std::vector<std::byte> bytes;
  constexpr int kTicks = 6000, kMoving = 8;
  for (int tick = 0; tick < kTicks; ++tick) {
    const double t = tick / 120.0;
    Input input;
    for (std::size_t hand = 0; hand < 2; ++hand) {
      instrument::TrocarJoints& joints = input.hands[hand];
      const double phase = 1.7 * static_cast<double>(hand);
      const double tremor = 1e-4 * std::sin(2 * M_PI * 9.3 * t + phase);
      joints.pan = 0.4 * std::sin(0.7 * t + phase) + tremor;
      joints.tilt = -0.3 + 0.2 * std::cos(0.9 * t + phase) + 0.7 * tremor;
      joints.spin = 0.5 * std::sin(0.3 * t + phase);
      joints.depth = 0.12 + 0.03 * std::sin(1.1 * t + phase) + 0.1 * tremor;
    }
    inputs.push_back(input);
    encoder.Encode(input, bytes);
  }
  ExpectRoundTrip(inputs);
  EXPECT_LT(static_cast<double>(bytes.size()) / kTicks, 4 + 5.5 * kMoving);
}

TEST(InputCodec, WhatRestsCostsFourBytes) {
  InputEncoder encoder;
  std::vector<std::byte> bytes;
  const Input still = MakeWanderingInput({}, 7);
  encoder.Encode(still, bytes);
  bytes.clear();
  for (int i = 0; i < 10; ++i) encoder.Encode(still, bytes);
  EXPECT_EQ(bytes.size(), 40u);
}

TEST(InputCodec, RoundingMovesLessThanANanometreAndOnlyOnce) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> joint(-3, 3);
  for (int i = 0; i < 1000; ++i) {
    Input input;
    input.hands[1].pan = joint(random);
    input.laparoscope.depth = joint(random);
    Input rounded = input;
    RoundJoints(rounded);
    EXPECT_NEAR(rounded.hands[1].pan, input.hands[1].pan, 0.5e-9);
    EXPECT_NEAR(rounded.laparoscope.depth, input.laparoscope.depth, 0.5e-9);
    Input twice = rounded;
    RoundJoints(twice);
    EXPECT_EQ(twice, rounded);
  }
}

TEST(InputCodec, RefusesBytesThatAreNoInput) {
  InputEncoder encoder;
  std::vector<std::byte> bytes;
  encoder.Encode(MakeWanderingInput({}, 3), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    InputDecoder decoder;
    std::span<const std::byte> cut = std::span(bytes).first(size);
    Input input;
    EXPECT_FALSE(decoder.Decode(cut, input)) << size;
  }
}

}  // namespace
}  // namespace trocar::record
