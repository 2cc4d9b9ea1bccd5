// SPDX-License-Identifier: Apache-2.0
/// \file device_framer_fuzz.cpp  One parser of a device's bytes under libFuzzer: any chunking must give the same records,
/// and every record must be fit for use. TROCAR_FUZZ_PARSER names the parser; the first byte chooses the chunk.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

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
namespace math = trocar::math;

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

[[maybe_unused]] void TryPolhemus(PolhemusFormat format, std::string_view bytes, std::size_t chunk) {
  std::vector<TrackerRecord> whole, parts;
  PolhemusFramer one(format), other(format);
  one.Feed(bytes, [&](const TrackerRecord& record) { whole.push_back(record); });
  InChunks(bytes, chunk, [&](std::string_view part) {
    other.Feed(part, [&](const TrackerRecord& record) { parts.push_back(record); });
  });
  Require(whole.size() == parts.size() && one.Counts().garbage == other.Counts().garbage);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    Require(whole[i].station == parts[i].station && whole[i].position == parts[i].position &&
            whole[i].rotation == parts[i].rotation);
    Require(whole[i].station >= 1 && whole[i].station <= trocar::device::StationCount(format));
    RequirePose(whole[i].position, whole[i].rotation);
  }
}

[[maybe_unused]] void TryJaw(std::string_view bytes, std::size_t chunk) {
  std::size_t whole = 0, parts = 0;
  JawFramer one, other;
  one.Feed(bytes, [&](const JawReading& reading) {
    Require(reading.tool >= 0 && reading.tool < trocar::device::kJawTools);
    Require(reading.raw >= 0 && reading.raw <= trocar::device::kMaxJawRaw);
    ++whole;
  });
  InChunks(bytes, chunk,
           [&](std::string_view part) { other.Feed(part, [&](const JawReading&) { ++parts; }); });
  Require(whole == parts);
}

[[maybe_unused]] void TryIgtl(std::string_view bytes, std::size_t chunk) {
  std::size_t whole = 0, parts = 0;
  IgtlReader one, other;
  const bool is_followed = one.Feed(bytes, [&](const IgtlPose& tool) {
    RequirePose(tool.pose.translation, tool.pose.rotation);
    Require(tool.name.size() <= 20);
    ++whole;
  });
  bool is_other_followed = true;
  InChunks(bytes, chunk, [&](std::string_view part) {
    if (is_other_followed) is_other_followed = other.Feed(part, [&](const IgtlPose&) { ++parts; });
  });
  Require(is_followed == is_other_followed && whole == parts);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::size_t chunk = 1 + data[0] % 80;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  constexpr std::string_view kParser = TROCAR_FUZZ_PARSER;
  if constexpr (kParser == "jaw") {
    TryJaw(bytes, chunk);
  } else if constexpr (kParser == "igtl") {
    TryIgtl(bytes, chunk);
  } else {
    static const PolhemusFormat kFormat = trocar::device::FindFormat(kParser).value();
    TryPolhemus(kFormat, bytes, chunk);
  }
  return 0;
}
