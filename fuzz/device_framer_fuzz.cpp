// SPDX-License-Identifier: Apache-2.0
/// \file device_framer_fuzz.cpp  One parser of a device's bytes under libFuzzer: any chunking must give the same records,
/// and every record must be fit for use. TROCAR_FUZZ_PARSER names the parser; the first byte chooses the chunk. Nothing here but
/// Haply's JSON allocates, so that ten million inputs take minutes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

#include "haply/haply_messages.h"
#include "haply/web_socket.h"
#include "trocar/device/igtl.h"
#include "trocar/device/jaw_sensor.h"
#include "trocar/device/polhemus.h"

namespace {

using trocar::device::IgtlPose;
using trocar::device::IgtlReader;
using trocar::device::JawFramer;
using trocar::device::JawReading;
using trocar::device::PolhemusFormat;
using trocar::device::PolhemusFramer;
using trocar::device::TrackerRecord;
namespace device = trocar::device;
namespace math = trocar::math;

/// Longer inputs are not asked for (-max_len in fuzz/run).
constexpr std::size_t kMostBytes = 600;

void Require(bool is_true) {
  if (!is_true) std::abort();
}

[[maybe_unused]] void RequirePose(const math::Vec3& p, const math::Quaternion& q) {
  Require(math::IsFinite(p) && math::Norm(p) < 200.0);
  Require(std::fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1.0) < 1e-9);
}

template <typename Feed>
void InChunks(std::string_view bytes, std::size_t chunk, Feed&& feed) {
  for (; !bytes.empty(); bytes.remove_prefix(std::min(chunk, bytes.size()))) feed(bytes.substr(0, chunk));
}

/// Records of the whole input, which those of the parts must equal one by one.
template <typename Record>
class Expected {
 public:
  void Add(const Record& record) {
    Require(count_ < records_.size());
    records_[count_++] = record;
  }
  const Record& Next() {
    Require(next_ < count_);
    return records_[next_++];
  }
  bool AreAllSeen() const { return next_ == count_; }

 private:
  std::array<Record, kMostBytes / 8> records_;  // no record is shorter than 8 bytes
  std::size_t count_ = 0, next_ = 0;
};

[[maybe_unused]] void TryPolhemus(PolhemusFormat format, std::string_view bytes, std::size_t chunk) {
  Expected<TrackerRecord> whole;
  PolhemusFramer one(format), other(format);
  one.Feed(bytes, [&](const TrackerRecord& record) {
    Require(record.station >= 1 && record.station <= device::StationCount(format));
    RequirePose(record.position, record.rotation);
    whole.Add(record);
  });
  InChunks(bytes, chunk, [&](std::string_view part) {
    other.Feed(part, [&](const TrackerRecord& record) {
      const TrackerRecord& wanted = whole.Next();
      Require(record.station == wanted.station && record.error == wanted.error &&
              record.position == wanted.position && record.rotation == wanted.rotation);
    });
  });
  Require(whole.AreAllSeen() && one.Counts().garbage == other.Counts().garbage);
}

[[maybe_unused]] void TryJaw(std::string_view bytes, std::size_t chunk) {
  Expected<JawReading> whole;
  JawFramer one, other;
  one.Feed(bytes, [&](const JawReading& reading) {
    Require(reading.tool >= 0 && reading.tool < device::kJawTools);
    Require(reading.raw >= 0 && reading.raw <= device::kMaxJawRaw);
    whole.Add(reading);
  });
  InChunks(bytes, chunk, [&](std::string_view part) {
    other.Feed(part, [&](const JawReading& reading) {
      const JawReading& wanted = whole.Next();
      Require(reading.tool == wanted.tool && reading.milliseconds == wanted.milliseconds &&
              reading.raw == wanted.raw);
    });
  });
  Require(whole.AreAllSeen() && one.Counts().garbage == other.Counts().garbage);
}

/// Reports as the system hands them over: one a read, of any length. What comes out goes through the sensor's own filter.
[[maybe_unused]] void TryJawHid(std::string_view bytes, std::size_t length) {
  device::JawFilter filters[device::kJawTools];
  std::uint32_t now = 0;
  InChunks(bytes, length, [&](std::string_view report) {
    const device::HidReport read = device::ParseHidReport(report);
    const auto& values = read.raw;
    Require(read.milliseconds.has_value() == (report.size() == device::kHidReportSize));
    for (std::size_t tool = 0; tool < values.size(); ++tool) {
      if (!values[tool]) continue;
      Require(report.size() == device::kHidReportSize || report.size() == device::kHidReportSizeWithoutClock);
      Require(*values[tool] >= 0 && *values[tool] <= device::kMaxJawRaw);
      Require(static_cast<unsigned char>(report[2 * tool]) == (*values[tool] & 0xff) &&
              static_cast<unsigned char>(report[2 * tool + 1]) == *values[tool] >> 8);
      const double filtered = filters[tool].Filter({static_cast<int>(tool), now, *values[tool]});
      Require(filtered >= 0.0 && filtered <= device::kMaxJawRaw);
    }
    now += static_cast<std::uint32_t>(report.size() + static_cast<unsigned char>(report[0]));
  });
}

/// Writes the right checksum into every message that is whole, without which hardly an input would get past it.
[[maybe_unused]] void MendChecksums(std::span<char> bytes) {
  constexpr std::size_t kBodySizeAt = 42, kCrcAt = 50;
  while (bytes.size() >= device::kIgtlHeaderSize) {
    std::uint64_t size = 0;
    for (std::size_t i = 0; i < 8; ++i) size = size << 8 | static_cast<unsigned char>(bytes[kBodySizeAt + i]);
    if (size > bytes.size() - device::kIgtlHeaderSize) return;
    const std::span<char> body = bytes.subspan(device::kIgtlHeaderSize, static_cast<std::size_t>(size));
    std::uint64_t crc = device::CalcIgtlCrc({body.data(), body.size()});
    for (std::size_t i = 8; i-- > 0; crc >>= 8) bytes[kCrcAt + i] = static_cast<char>(crc & 0xff);
    bytes = bytes.subspan(device::kIgtlHeaderSize + body.size());
  }
}

struct SeenPose {
  math::Pose pose;
  std::size_t name_size = 0;
};

[[maybe_unused]] void TryIgtl(std::string_view given, std::size_t chunk, bool is_mended) {
  std::array<char, kMostBytes> copy;
  const std::size_t size = given.copy(copy.data(), copy.size());
  if (is_mended) MendChecksums({copy.data(), size});
  const std::string_view bytes(copy.data(), size);
  Expected<SeenPose> whole;
  IgtlReader one, other;
  const bool is_followed = one.Feed(bytes, [&](const IgtlPose& tool) {
    RequirePose(tool.pose.translation, tool.pose.rotation);
    Require(tool.name.size() <= 20);
    whole.Add({tool.pose, tool.name.size()});
  });
  bool is_other_followed = true;
  InChunks(bytes, chunk, [&](std::string_view part) {
    if (!is_other_followed) return;
    is_other_followed = other.Feed(part, [&](const IgtlPose& tool) {
      const SeenPose& wanted = whole.Next();
      Require(tool.pose.translation == wanted.pose.translation &&
              tool.pose.rotation == wanted.pose.rotation && tool.name.size() == wanted.name_size);
    });
  });
  Require(is_followed == is_other_followed && whole.AreAllSeen());
  Require(one.Counts().bad == other.Counts().bad && one.Counts().messages == other.Counts().messages);
}

struct HaplySeen {
  std::size_t frames = 0, states = 0, length = 0;
  double sum = 0;  // of all positions, so that two readings can be compared
  bool is_garbage = false;

  friend bool operator==(const HaplySeen&, const HaplySeen&) = default;
};

/// Takes whole frames from the front, as the driver does.
[[maybe_unused]] void TakeHaplyFrames(std::string& inbox, HaplySeen& seen) {
  while (!seen.is_garbage) {
    device::web_socket::Frame frame;
    const device::Parsed parsed = device::web_socket::ParseFrame(inbox, false, frame);
    seen.is_garbage = parsed.verdict == device::Parsed::Verdict::kGarbage;
    if (parsed.verdict != device::Parsed::Verdict::kRecord) return;
    Require(parsed.length <= inbox.size() && parsed.length >= frame.payload.size() + 2);
    inbox.erase(0, parsed.length);
    ++seen.frames;
    seen.length += parsed.length;
    device::haply::State state;
    if (frame.opcode != device::web_socket::Opcode::kText || !device::haply::ParseState(frame.payload, state))
      continue;
    ++seen.states;
    Require(state.devices.size() <= device::haply::kMaxDevices && state.buttons < 8);
    RequirePose({}, state.grip);
    for (const device::haply::DeviceState& one : state.devices) {
      RequirePose(one.position, {});
      Require(!one.id.empty());
      seen.sum += one.position.x + one.position.y + one.position.z;
    }
  }
}

/// Frames of Haply's service and the JSON in them. This one allocates, as the driver's own thread does.
[[maybe_unused]] void TryHaply(std::string_view bytes, std::size_t chunk) {
  HaplySeen whole, parts;
  std::string inbox(bytes);
  TakeHaplyFrames(inbox, whole);
  std::string other;
  InChunks(bytes, chunk, [&](std::string_view part) {
    other += part;
    TakeHaplyFrames(other, parts);
  });
  Require(whole == parts);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1 || size > kMostBytes) return 0;
  const std::size_t chunk = 1 + (data[0] & 0x7f) % 80;
  [[maybe_unused]] const bool is_mended = (data[0] & 0x80) != 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  constexpr std::string_view kParser = TROCAR_FUZZ_PARSER;
  if constexpr (kParser == "jaw") {
    TryJaw(bytes, chunk);
  } else if constexpr (kParser == "jaw-hid") {
    TryJawHid(bytes, chunk);
  } else if constexpr (kParser == "haply") {
    TryHaply(bytes, chunk);
  } else if constexpr (kParser == "igtl") {
    TryIgtl(bytes, chunk, is_mended);
  } else {
    static const PolhemusFormat kFormat = device::FindFormat(kParser).value();
    TryPolhemus(kFormat, bytes, chunk);
  }
  return 0;
}
