// SPDX-License-Identifier: Apache-2.0
/// \file igtl.h  Messages of OpenIGTLink, versions 1 and 2 of the header: what trackers send and what 3D Slicer takes.
/// Source: OpenIGTLink protocol, documents of versions 1 to 3. Big-endian, millimetres.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/core/result.h"
#include "trocar/math/pose.h"

namespace trocar::device {

inline constexpr int kIgtlPort = 18944;
inline constexpr std::size_t kIgtlHeaderSize = 58;  // [bytes]

/// CRC-64 of message bodies: polynomial 0x42F0E1EBA9EA3693, start 0, nothing reflected.
std::uint64_t CalcIgtlCrc(std::string_view bytes) noexcept;

/// A pose with a name: a TRANSFORM, or one element of a TDATA message.
struct IgtlPose {
  std::string_view name;  ///< of the device or tool; valid during the call that it is given to
  math::Pose pose;        ///< [m]
};

/// What came in, and what was held back.
struct IgtlCounts {
  std::uint64_t messages = 0;  ///< whole and right
  std::uint64_t skipped = 0;   ///< of kinds that are not read here
  std::uint64_t bad = 0;       ///< wrong checksum, size or content
  std::uint64_t large = 0;     ///< of kinds that are read, with more tools than are read; among `bad`
};

/// Tools of one TDATA message that are read; a message of more is passed over whole, counted and named.
inline constexpr std::size_t kMostIgtlTools = 256;

/// Takes a stream of messages apart; keeps at most one small message and never room for what a header promises.
class IgtlReader {
 public:
  using Sink = std::function<void(const IgtlPose&)>;
  /// \return false where the stream cannot be followed any more: a header that is none, or a size that is a lie. The
  ///         connection has to be closed then.
  /// \note Real-time safe where the sink is.
  bool Feed(std::string_view bytes, const Sink& sink);
  void Restart() noexcept;
  const IgtlCounts& Counts() const noexcept { return counts_; }
  /// What was too large: "2 messages had more than 256 tools and were passed over, the last TDATA \"Tools\" of 7000 bytes".
  /// Empty where nothing was.
  /// \note Not real-time safe: allocates.
  std::string DescribeLarge() const;

 private:
  bool ReadHeader() noexcept;
  void ReadBody(const Sink& sink);

  /// Largest message that is read: a header, a TDATA body of 70 bytes a tool, and what version 2 puts around it [bytes].
  static constexpr std::size_t kCapacity = kIgtlHeaderSize + 70 * kMostIgtlTools + 1024;
  std::array<char, kCapacity> buffer_{};
  std::array<char, 12 + 20> large_name_{};  // kind and device of the last one that was too large
  std::uint64_t large_size_ = 0;            // of its body [bytes]
  std::size_t size_ = 0;                    // bytes there
  std::size_t wanted_ = kIgtlHeaderSize;
  std::uint64_t to_skip_ = 0;  // bytes of a body that is not read
  IgtlCounts counts_;
};

// --- writing

/// \param name  of the device, at most 20 bytes; longer ones are cut
/// \param time  Unix time [s]
std::string FormatIgtlTransform(std::string_view name, const math::Pose& pose, double time);

struct IgtlTool {
  std::string name;  ///< at most 20 bytes
  math::Pose pose;   ///< [m]
};
/// TDATA of 6D tools.
std::string FormatIgtlTrackingData(std::string_view name, std::span<const IgtlTool> tools, double time);

/// \param points     (n) [m]
/// \param triangles  (3 m) indices into the points
std::string FormatIgtlPolyData(std::string_view name, std::span<const math::Vec3> points,
                               std::span<const std::uint32_t> triangles, double time);

}  // namespace trocar::device
