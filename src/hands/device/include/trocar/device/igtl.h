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

#include "trocar/base/result.h"
#include "trocar/math/pose.h"

namespace trocar::device {

inline constexpr int kIgtlPort = 18944;
inline constexpr std::size_t kIgtlHeaderSize = 58;  // [bytes]

/// CRC-64 of message bodies: polynomial 0x42F0E1EBA9EA3693, start 0, nothing reflected.
std::uint64_t CalcIgtlCrc(std::string_view bytes) noexcept;

/// A pose with a name: a TRANSFORM or POSITION, or one element of a TDATA or QTDATA message.
struct IgtlPose {
  std::string_view name;  ///< of the device or tool; valid during the call that it is given to
  math::Pose pose;        ///< [m]
};

/// Why something that came does not count.
enum class IgtlFault : std::uint8_t {
  kNoChecksum,      ///< 0 where another belongs: the sender computes none
  kChecksum,        ///< another than belongs to the body
  kSize,            ///< of the body, which is none of this kind of message
  kManyTools,       ///< in one message, which is passed over whole
  kExtendedHeader,  ///< of version 2, which is longer than the body
  kNoRotation,      ///< a POSITION of a place alone
  kZero,            ///< a rotation of zeros only, as trackers send for a tool that they do not see
  kNumbers,         ///< not finite, or a place beyond every room
  kByteOrder,       ///< a pose if the lowest byte came first
  kMirror,          ///< left-handed axes
  kSkew,            ///< axes that are not at right angles
  kScale,           ///< axes, or a quaternion, of another length than 1
};

/// Count of what came by one kind and name: of messages, and of each tool in a message of several.
struct IgtlSeen {
  std::array<char, 12> type{};  ///< zeros behind its end, as in `name`
  std::array<char, 20> name{};
  std::uint64_t came = 0, refused = 0;
  std::uint64_t poses = 0;  ///< good ones
  IgtlFault fault{};        ///< of the last one refused
  std::array<std::uint64_t, 2>
      words{};  ///< what was wrong with it: its checksum and the right one, its size [bytes]; or
  std::array<double, 3> numbers{};  ///< the axes' lengths, the angle between them [degrees off a right one]
};

/// Counts of messages: good, skipped and bad.
struct IgtlCounts {
  std::uint64_t messages = 0;  ///< whole and right
  std::uint64_t skipped = 0;   ///< of kinds that are not read here
  std::uint64_t bad = 0;       ///< wrong checksum, size or content
};

/// Tools of one TDATA message that are read; a message of more is passed over whole, counted and named.
inline constexpr std::size_t kMostIgtlTools = 256;

/// Kinds and names that are told apart; what comes under further ones is counted together.
inline constexpr std::size_t kMostIgtlSeen = 24;

/// Takes a stream of messages apart; keeps at most one small message and never room for what a header promises.
/// Reads TRANSFORM and TDATA, POSITION and QTDATA with their quaternions (a POSITION's of three or four numbers).
class IgtlReader {
 public:
  using Sink = std::function<void(const IgtlPose&)>;
  /// \return false where the stream cannot be followed any more: a header that is none, or a size that is a lie. The
  ///         connection has to be closed then.
  /// \note Real-time safe where the sink is.
  bool Feed(std::string_view bytes, const Sink& sink);
  void Restart() noexcept;
  const IgtlCounts& Counts() const noexcept { return counts_; }
  /// Messages and poses that came and do not count, a sentence for each reason:
  /// "TRANSFORM \"LeftTool\": 119 of 119 do not count, because ...".
  /// \note Not real-time safe: allocates, as the two below.
  std::vector<std::string> DescribeRefused() const;
  /// All that came by kind and name: "TRANSFORM \"LeftTool\" (119), STATUS \"PlusServer\" (60)".
  std::string DescribeReceived() const;
  /// Why Feed() gave up, and what to do; empty where it did not since Restart().
  std::string DescribeBadHeader() const;
  std::span<const IgtlSeen> Seen() const noexcept { return {seen_.data(), seen_count_}; }
  std::uint64_t ByteCount() const noexcept { return byte_count_; }

 private:
  bool ReadHeader() noexcept;
  void ReadBody(const Sink& sink);
  IgtlSeen* See(std::string_view type, std::string_view name) noexcept;
  void Refuse(IgtlSeen* seen, IgtlFault fault, std::array<std::uint64_t, 2> words = {},
              std::array<double, 3> numbers = {}) noexcept;

  /// Largest message that is read: a header, a TDATA body of 70 bytes a tool, and what version 2 puts around it [bytes].
  static constexpr std::size_t kCapacity = kIgtlHeaderSize + 70 * kMostIgtlTools + 1024;
  std::array<char, kCapacity> buffer_{};
  std::size_t size_ = 0;  // bytes there
  std::size_t wanted_ = kIgtlHeaderSize;
  std::uint64_t to_skip_ = 0;   // bytes of a body that is not read
  bool is_header_bad_ = false;  // which is kept in the buffer
  std::array<IgtlSeen, kMostIgtlSeen> seen_{};
  std::size_t seen_count_ = 0;
  std::uint64_t unseen_ = 0;      // came under further names
  std::uint64_t byte_count_ = 0;  // since the start
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
