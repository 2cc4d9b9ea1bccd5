// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "trocar/device/emulator.h"

namespace trocar::device {
namespace {

constexpr std::array kNames = {std::string_view("silence"), std::string_view("garbage"),
                               std::string_view("flips"),   std::string_view("unplug"),
                               std::string_view("flood"),   std::string_view("jump")};
/// One flooded record becomes so many.
constexpr int kFloodFactor = 100;
constexpr double kJumpSize = 0.050;  // [m]
constexpr double kJumpSlot = 0.010;  // jumps last so long [s] ...
constexpr int kJumpEvery = 10;       // ... once in so many slots

/// Reads a number from the front of `text` and takes it away.
bool TakeNumber(std::string_view& text, double& value) {
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || !std::isfinite(value) || value < 0.0) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

void TurnBits(std::string& bytes, double rate, math::Random& random) {
  for (char& byte : bytes) {
    for (int bit = 0; bit < 8; ++bit) {
      if (random.Uniform() < rate) byte = static_cast<char>(byte ^ (1 << bit));
    }
  }
}

/// How far off a measurement is just now [m].
double CalcJump(const std::vector<Fault>& faults, double time) noexcept {
  double jump = 0;
  for (const Fault& fault : faults) {
    if (fault.kind != FaultKind::kJump || !fault.IsOn(time)) continue;
    if (static_cast<long long>((time - fault.start) / kJumpSlot) % kJumpEvery == kJumpEvery - 1)
      jump += kJumpSize;
  }
  return jump;
}

}  // namespace

std::string_view FaultName(FaultKind kind) noexcept {
  return kNames[static_cast<std::size_t>(kind)];
}

base::Result<Fault> ParseFault(std::string_view text) {
  const std::string whole(text);
  const auto fail = [&] {
    return base::Error{
        base::ErrorCode::kUsage,
        "--fault " + whole +
            ": not like silence, flips=0.01 or unplug@5+2; kinds are silence, garbage, flips, unplug, "
            "flood and jump"};
  };
  Fault fault;
  std::size_t kind = 0;
  while (kind < kNames.size() && !text.starts_with(kNames[kind])) ++kind;
  if (kind == kNames.size()) return fail();
  fault.kind = static_cast<FaultKind>(kind);
  text.remove_prefix(kNames[kind].size());
  const std::pair<char, double*> parts[] = {{'=', &fault.rate}, {'@', &fault.start}, {'+', &fault.duration}};
  for (const auto& [mark, value] : parts) {
    if (!text.starts_with(mark)) continue;
    text.remove_prefix(1);
    if (!TakeNumber(text, *value)) return fail();
  }
  if (!text.empty() || fault.rate > 1.0) return fail();
  return fault;
}

std::string SpoilBytes(const std::vector<Fault>& faults, double time, std::string bytes,
                       math::Random& random) {
  for (const Fault& fault : faults) {
    if (!fault.IsOn(time)) continue;
    switch (fault.kind) {
      case FaultKind::kSilence:
        bytes.clear();
        break;
      case FaultKind::kGarbage:
        if (random.Uniform() < 0.5) {
          for (char& byte : bytes) byte = static_cast<char>(random.NextWord());
        }
        break;
      case FaultKind::kFlips:
        TurnBits(bytes, fault.rate, random);
        break;
      case FaultKind::kFlood: {
        const std::string once = bytes;
        for (int i = 1; i < kFloodFactor; ++i) bytes += once;
        break;
      }
      case FaultKind::kUnplug:
      case FaultKind::kJump:
        break;
    }
  }
  return bytes;
}

SensorMotion SpoilMotion(std::vector<Fault> faults, SensorMotion motion) {
  return [faults = std::move(faults), motion = std::move(motion)](int channel, double time) {
    math::Pose pose = motion(channel, time);
    pose.translation.x += CalcJump(faults, time);
    return pose;
  };
}

CursorMotion SpoilCursor(std::vector<Fault> faults, CursorMotion motion) {
  return [faults = std::move(faults), motion = std::move(motion)](int device, double time) {
    return motion(device, time) + math::Vec3{CalcJump(faults, time), 0, 0};
  };
}

}  // namespace trocar::device
