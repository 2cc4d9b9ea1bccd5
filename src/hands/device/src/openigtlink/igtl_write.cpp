// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>

#include "trocar/device/igtl.h"

namespace trocar::device {
namespace {

constexpr double kMillimetres = 1000.0;

/// The highest byte first.
template <typename Word>
void Append(std::string& bytes, Word word) {
  for (int shift = 8 * (static_cast<int>(sizeof word) - 1); shift >= 0; shift -= 8)
    bytes += static_cast<char>(static_cast<std::uint64_t>(word) >> shift & 0xff);
}

void AppendFloat(std::string& bytes, double value) {
  Append(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

void AppendName(std::string& bytes, std::string_view name, std::size_t size) {
  bytes += name.substr(0, size);
  bytes.append(size - std::min(size, name.size()), '\0');
}

/// Three columns of the rotation, then the place.
void AppendPose(std::string& bytes, const math::Pose& pose) {
  for (const math::Vec3& axis : {math::Vec3{1, 0, 0}, math::Vec3{0, 1, 0}, math::Vec3{0, 0, 1}}) {
    const math::Vec3 column = math::Rotate(pose.rotation, axis);
    for (int i = 0; i < 3; ++i) AppendFloat(bytes, column[i]);
  }
  for (int i = 0; i < 3; ++i) AppendFloat(bytes, kMillimetres * pose.translation[i]);
}

std::string Pack(std::string_view type, std::string_view name, double time, const std::string& body) {
  std::string bytes;
  bytes.reserve(kIgtlHeaderSize + body.size());
  Append(bytes, std::uint16_t{1});
  AppendName(bytes, type, 12);
  AppendName(bytes, name, 20);
  const double whole = std::floor(time);
  Append(bytes, static_cast<std::uint32_t>(whole));
  Append(bytes, static_cast<std::uint32_t>((time - whole) * 4294967296.0));
  Append(bytes, static_cast<std::uint64_t>(body.size()));
  Append(bytes, CalcIgtlCrc(body));
  return bytes + body;
}

constexpr std::array<std::uint64_t, 256> MakeCrcTable() {
  std::array<std::uint64_t, 256> table{};
  for (std::uint64_t i = 0; i < 256; ++i) {
    std::uint64_t value = i << 56;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 63 != 0 ? 0x42F0E1EBA9EA3693u : 0u) ^ (value << 1);
    table[i] = value;
  }
  return table;
}

constexpr std::array<std::uint64_t, 256> kCrcTable = MakeCrcTable();

}  // namespace

std::uint64_t CalcIgtlCrc(std::string_view bytes) noexcept {
  std::uint64_t crc = 0;
  for (const char byte : bytes)
    crc = kCrcTable[(crc >> 56 ^ static_cast<unsigned char>(byte)) & 0xff] ^ (crc << 8);
  return crc;
}

std::string FormatIgtlTransform(std::string_view name, const math::Pose& pose, double time) {
  std::string body;
  AppendPose(body, pose);
  return Pack("TRANSFORM", name, time, body);
}

std::string FormatIgtlTrackingData(std::string_view name, std::span<const IgtlTool> tools, double time) {
  constexpr std::uint8_t kSixD = 2;
  std::string body;
  for (const IgtlTool& tool : tools) {
    AppendName(body, tool.name, 20);
    Append(body, kSixD);
    Append(body, std::uint8_t{0});
    AppendPose(body, tool.pose);
  }
  return Pack("TDATA", name, time, body);
}

std::string FormatIgtlPolyData(std::string_view name, std::span<const math::Vec3> points,
                               std::span<const std::uint32_t> triangles, double time) {
  const auto triangle_count = static_cast<std::uint32_t>(triangles.size() / 3);
  // counts and sizes: points, vertices, lines, polygons, triangle strips, attributes
  const std::uint32_t counts[] = {
      static_cast<std::uint32_t>(points.size()), 0, 0, 0, 0, triangle_count, 16 * triangle_count, 0, 0, 0};
  std::string body;
  body.reserve(sizeof counts + 12 * points.size() + 16 * triangle_count);
  for (const std::uint32_t count : counts) Append(body, count);
  for (const math::Vec3& point : points) {
    for (int i = 0; i < 3; ++i) AppendFloat(body, kMillimetres * point[i]);
  }
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    Append(body, std::uint32_t{3});
    for (std::size_t corner = 0; corner < 3; ++corner) Append(body, triangles[i + corner]);
  }
  return Pack("POLYDATA", name, time, body);
}

}  // namespace trocar::device
