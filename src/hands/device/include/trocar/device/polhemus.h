// SPDX-License-Identifier: Apache-2.0
/// \file polhemus.h  Bytes of Polhemus trackers: FASTRAK (ASCII and binary), LIBERTY and PATRIOT (binary).
/// Source: FASTRAK manual (output records, commands), PDI headers for LIBERTY and PATRIOT frames.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "trocar/device/framer.h"
#include "trocar/math/pose.h"

namespace trocar::device {

enum class PolhemusFormat { kFastrakAscii, kFastrakBinary, kLiberty, kPatriot };
/// "fastrak", "fastrak-binary", "liberty", "patriot"
std::string_view FormatName(PolhemusFormat format) noexcept;
/// The format of that name; nothing for an unknown one.
std::optional<PolhemusFormat> FindFormat(std::string_view name) noexcept;

/// Stations that a record can name: 1 to this.
inline constexpr int kMaxStations = 16;
int StationCount(PolhemusFormat format) noexcept;

/// One station at one time.
struct TrackerRecord {
  int station = 0;            ///< from 1
  char error = ' ';           ///< ' ' where the tracker has nothing to complain of
  math::Vec3 position;        ///< of the sensor in the source's frame [m]
  math::Quaternion rotation;  ///< R_source_sensor, unit length
};

/// Takes the stream apart. Understands what SetUpCommands() asks for, and LIBERTY's and PATRIOT's default list.
///
/// There is no checksum in these protocols. A record must have its marks in place, a known station, a size that fits,
/// finite numbers within 10 m and a unit quaternion; what passes that is left to the driver's gate.
class PolhemusFramer {
 public:
  explicit PolhemusFramer(PolhemusFormat format) noexcept : format_(format) {}

  template <typename Sink>
  void Feed(std::string_view bytes, Sink&& sink) {
    framer_.Feed(
        bytes, [this](std::string_view rest, TrackerRecord& record) { return Parse(rest, record); }, sink);
  }
  void Restart() noexcept { framer_.Restart(); }
  const FramerCounts& Counts() const noexcept { return framer_.Counts(); }
  /// Length of a record as SetUpCommands() asks for it [bytes].
  std::size_t RecordLength() const noexcept;

 private:
  Parsed Parse(std::string_view bytes, TrackerRecord& record) const noexcept;

  PolhemusFormat format_;
  Framer<TrackerRecord, 64> framer_;
};

/// Bytes of a record, as the tracker sends them; for emulators and tests.
///
/// \param items        output list: 0 space, 1 CR LF, 2 position, 4 azimuth, elevation, roll; FASTRAK 11 quaternion;
///                     LIBERTY and PATRIOT 7 quaternion, 8 time, 9 frame. Others are left out.
/// \param is_metric    centimetres in place of inches
/// \param milliseconds  LIBERTY and PATRIOT: time of the record
std::string FormatRecord(PolhemusFormat format, std::span<const int> items, const TrackerRecord& record,
                         bool is_metric = false, std::uint32_t milliseconds = 0, std::uint32_t frame = 0);
/// The output list that SetUpCommands() asks for.
std::span<const int> RequestedItems(PolhemusFormat format) noexcept;

/// Commands that make a tracker send the records above: no continuous sending, inches, the output list, the hemisphere.
///
/// \param stations    stations that are used, from 1
/// \param hemisphere  unit vector from the source to where the sensors are, source frame
std::string SetUpCommands(PolhemusFormat format, std::span<const int> stations, const math::Vec3& hemisphere);
/// Asks for one record of every station that is on.
std::string PollCommand();
std::string StartCommand(PolhemusFormat format);
std::string StopCommand(PolhemusFormat format);

}  // namespace trocar::device
