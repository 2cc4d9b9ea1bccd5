// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "polhemus_layout.h"

namespace trocar::device {
namespace {

using math::Quaternion;
using math::Vec3;

void AppendWord(std::string& bytes, std::uint32_t word) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(word >> (8 * i) & 0xff);
}

void AppendFloat(std::string& bytes, double value) {
  AppendWord(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

/// Numbers as FASTRAK writes them in ASCII: S, three digits, point, two digits.
void AppendColumns(std::string& bytes, const Vec3& values) {
  for (int i = 0; i < 3; ++i) {
    char field[16];
    std::snprintf(field, sizeof field, "%7.2f", std::clamp(values[i], -999.99, 999.99));
    bytes += field;
  }
}

void AppendItem(std::string& bytes, PolhemusFormat format, int item, const TrackerRecord& record,
                bool is_metric, std::uint32_t milliseconds, std::uint32_t frame) {
  const bool is_ascii = format == PolhemusFormat::kFastrakAscii;
  const Quaternion& q = record.rotation;
  const auto append_vector = [&](const Vec3& values) {
    if (is_ascii) return AppendColumns(bytes, values);
    for (int i = 0; i < 3; ++i) AppendFloat(bytes, values[i]);
  };
  if (item == 0) bytes += ' ';
  if (item == 1) bytes += "\r\n";
  if (item == 2) append_vector(record.position / (is_metric ? 0.01 : kMetresPerInch));
  if (item == 4) append_vector(EulerFromRotation(record.rotation) * (180.0 / kPi));
  if (!is_ascii && item == (IsFastrak(format) ? 11 : 7)) {
    for (const double part : {q.w, q.x, q.y, q.z}) AppendFloat(bytes, part);
  }
  if (!IsFastrak(format) && item == 8) AppendWord(bytes, milliseconds);
  if (!IsFastrak(format) && item == 9) AppendWord(bytes, frame);
}

}  // namespace

std::string_view FormatName(PolhemusFormat format) noexcept {
  constexpr std::string_view kNames[] = {"fastrak", "fastrak-binary", "liberty", "patriot"};
  return kNames[static_cast<int>(format)];
}

std::optional<PolhemusFormat> FindFormat(std::string_view name) noexcept {
  for (const PolhemusFormat format : {PolhemusFormat::kFastrakAscii, PolhemusFormat::kFastrakBinary,
                                      PolhemusFormat::kLiberty, PolhemusFormat::kPatriot}) {
    if (FormatName(format) == name) return format;
  }
  return std::nullopt;
}

int StationCount(PolhemusFormat format) noexcept {
  if (format == PolhemusFormat::kPatriot) return 2;
  return format == PolhemusFormat::kLiberty ? kMaxStations : 4;
}

Quaternion RotationFromEuler(const Vec3& angles) {
  return math::RotationAbout({0, 0, 1}, angles.x) * math::RotationAbout({0, 1, 0}, angles.y) *
         math::RotationAbout({1, 0, 0}, angles.z);
}

Vec3 EulerFromRotation(const Quaternion& rotation) {
  const Vec3 x = math::Rotate(rotation, {1, 0, 0});
  const Vec3 y = math::Rotate(rotation, {0, 1, 0});
  const Vec3 z = math::Rotate(rotation, {0, 0, 1});
  return {std::atan2(x.y, x.x), -std::asin(std::clamp(x.z, -1.0, 1.0)), std::atan2(y.z, z.z)};
}

std::span<const int> RequestedItems(PolhemusFormat format) noexcept {
  static constexpr int kAscii[] = {2, 4, 1}, kBinary[] = {2, 11, 0}, kFrame[] = {2, 7, 8, 0};
  if (format == PolhemusFormat::kFastrakAscii) return kAscii;
  if (format == PolhemusFormat::kFastrakBinary) return kBinary;
  return kFrame;
}

std::string FormatRecord(PolhemusFormat format, std::span<const int> items, const TrackerRecord& record,
                         bool is_metric, std::uint32_t milliseconds, std::uint32_t frame) {
  std::string payload;
  for (const int item : items) AppendItem(payload, format, item, record, is_metric, milliseconds, frame);
  if (IsFastrak(format))
    return std::string{'0', static_cast<char>('0' + record.station), record.error} + payload;
  std::string header(Preamble(format));
  header += {static_cast<char>(record.station), 'C', record.error, '\0'};
  header += {static_cast<char>(payload.size() & 0xff), static_cast<char>(payload.size() >> 8 & 0xff)};
  return header + payload;
}

// --- commands

std::string SetUpCommands(PolhemusFormat format, std::span<const int> stations, const Vec3& hemisphere) {
  const bool is_fastrak = IsFastrak(format);
  std::string commands = StopCommand(format);
  if (is_fastrak) {
    commands += format == PolhemusFormat::kFastrakAscii ? "FU" : "fU";
  } else {
    commands += "F1\rU0\r";
  }
  for (const int station : stations) {
    const std::string number = std::to_string(station);
    commands += "O" + number;
    for (const int item : RequestedItems(format)) commands += "," + std::to_string(item);
    commands += "\r";
    char text[96];
    std::snprintf(text, sizeof text, "H%d,%.3f,%.3f,%.3f\r", station, hemisphere.x, hemisphere.y,
                  hemisphere.z);
    commands += text;
  }
  return commands;
}

std::string PollCommand() {
  return "P";
}

std::string StartCommand(PolhemusFormat format) {
  return IsFastrak(format) ? "C" : "C\r";
}

std::string StopCommand(PolhemusFormat format) {
  return IsFastrak(format) ? "c" : "P";
}

}  // namespace trocar::device
