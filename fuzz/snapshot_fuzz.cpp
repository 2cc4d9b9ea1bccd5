// SPDX-License-Identifier: Apache-2.0
/// \file snapshot_fuzz.cpp  The reader of snapshots under libFuzzer: whatever the content, with a header and a checksum that fit, it
/// is refused, or its counts and indices can be used and it is the same once more sent. The first byte chooses the header.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "snapshot_samples.h"
#include "trocar/base/checksum.h"
#include "trocar/base/state_hash.h"
#include "trocar/simulation/snapshot_codec.h"

namespace {

using trocar::simulation::Snapshot;
using trocar::simulation::SnapshotDecoder;
using trocar::simulation::SnapshotEncoder;
using trocar::simulation::SnapshotLayout;
using trocar::simulation::SnapshotPrecision;
namespace base = trocar::base;
namespace simulation = trocar::simulation;

constexpr std::size_t kSizeAt = 48, kChecksumAt = 56;

void Require(bool is_true) {
  if (!is_true) std::abort();
}

/// A header that fits the content.
std::vector<std::byte> WithContent(std::span<const std::byte> header, std::span<const std::byte> content) {
  std::vector<std::byte> message(header.begin(), header.end());
  message.insert(message.end(), content.begin(), content.end());
  const auto size = static_cast<std::uint32_t>(content.size());
  std::memcpy(message.data() + kSizeAt, &size, sizeof(size));
  base::StateHash hash;
  hash.Add(base::CalcChecksum(std::span<const std::byte>(message).first(kChecksumAt)));
  hash.Add(base::CalcChecksum(content));
  const std::uint64_t checksum = hash.Value();
  std::memcpy(message.data() + kChecksumAt, &checksum, sizeof(checksum));
  return message;
}

void RequireUsable(const Snapshot& seen) {
  const simulation::OperationSnapshot& o = seen.operation;
  Require(o.clip_count <= o.clips.size() && o.tube_cut_count <= o.tube_cuts.size());
  Require(o.flow.leak_count <= o.flow.leaks.size() && o.flow.ooze_count <= o.flow.oozes.size());
  Require(o.topology.tube_piece_count <= o.topology.tube_pieces.size());
  for (std::size_t i = 0; i < o.topology.first_triangle.size(); ++i) {
    const std::uint64_t last = std::uint64_t{o.topology.first_triangle[i]} + o.topology.triangle_count[i];
    Require(last <= o.topology.triangles.size());
  }
  for (const auto& triangle : o.topology.triangles) {
    for (const std::uint32_t node : triangle) Require(node < seen.positions.size());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const bool is_delta = (data[0] & 1) != 0;
  const auto precision = (data[0] & 2) != 0 ? SnapshotPrecision::kPicture : SnapshotPrecision::kExact;
  static const SnapshotLayout kLayout = simulation::MakeSampleLayout();
  SnapshotEncoder encoder(kLayout, precision);
  SnapshotDecoder decoder(kLayout);
  std::vector<std::byte> message;
  Snapshot received;
  Require(encoder.EncodeWhole(kLayout.shape, message).ok());
  Require(decoder.Decode(message, received).ok());
  Require(encoder.Acknowledge(decoder.LastKept()));
  if (is_delta) Require(encoder.EncodeDelta(kLayout.shape, message, (data[0] & 4) != 0).ok());
  message = WithContent(std::span(message).first(simulation::kSnapshotHeaderSize),
                        std::as_bytes(std::span(data + 1, size - 1)));
  const std::vector<std::uint64_t> before = simulation::BitsOf(received);
  if (!decoder.Decode(message, received).ok()) {
    Require(simulation::BitsOf(received) == before);
    return 0;
  }
  RequireUsable(received);
  SnapshotEncoder again(kLayout);
  Snapshot other;
  Require(again.EncodeWhole(received, message).ok() && decoder.Decode(message, other).ok());
  Require(simulation::BitsOf(other) == simulation::BitsOf(received));
  return 0;
}
