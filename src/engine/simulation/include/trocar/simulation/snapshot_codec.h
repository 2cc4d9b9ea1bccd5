// SPDX-License-Identifier: Apache-2.0
/// \file snapshot_codec.h  Snapshots as bytes for another process, another machine or a page: whole, or as a difference from a
/// snapshot that the receiver has. docs/snapshots.md describes the bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::simulation {

class Simulation;

/// Lengths of the lists in every snapshot of one scene, and how large its indices may be. Sender and receiver describe the
/// scene each for itself.
struct SnapshotLayout {
  Snapshot shape;                                           ///< its lists have the lengths
  std::uint64_t model = 0;                                  ///< Simulation::ModelFingerprint
  std::size_t surfaces = 0, neighbours = 0, rules = 0;      ///< Surfaces(), Patient::neighbours, Task::errors
  std::size_t phases = 0, procedure_errors = 0;             ///< Procedure::phases, Procedure::errors
  std::array<std::size_t, instrument::kHandCount> tools{};  ///< of each tray; one where there is none
  std::vector<std::size_t> goal_steps;                      ///< (Task::goals) of each
};

/// \note Not real-time safe: allocates. The simulation is not needed afterwards.
SnapshotLayout DescribeSnapshots(const Simulation& simulation);

enum class SnapshotPrecision : std::uint8_t {
  kExact,   ///< every bit of every field
  kPicture  ///< Snapshot::positions on a grid of kPictureGrid, at most half of it off; all other fields exact
};
inline constexpr double kPictureGrid = 0x1p-20;  ///< 0.95 micrometres [m]

/// Bytes of a message before its content.
inline constexpr std::size_t kSnapshotHeaderSize = 64;

/// Makes the messages of one stream. A difference is from the base, a snapshot that the receiver is known to have: a lost
/// difference makes no other message unreadable.
///
///     encoder.EncodeWhole(snapshot, message);         // send it; decoder.LastKept() comes back
///     encoder.Acknowledge(last_kept);                 // now it is the base
///     encoder.EncodeDelta(snapshot, message);         // each tick; now and then one is offered as the next base
///
/// Where nothing is lost on the way, every message may be offered and acknowledged at once.
class SnapshotEncoder {
 public:
  explicit SnapshotEncoder(const SnapshotLayout& layout,
                           SnapshotPrecision precision = SnapshotPrecision::kExact);
  SnapshotEncoder(SnapshotEncoder&&) noexcept;
  SnapshotEncoder& operator=(SnapshotEncoder&&) noexcept;
  ~SnapshotEncoder();

  /// A message that needs no other.
  /// \param snapshot  of the layout's scene
  /// \param[out] message  replaced; its memory is used again
  /// \param is_offered  as the base: the stream begins anew, without a base until this is acknowledged
  /// \return kStateInvalid where a list has another length than the layout's; kStateNotFinite where a position does not fit
  /// the grid of kPicture. Then `message` is empty and nothing changes.
  /// \note Real-time safe where `message` has the capacity and nothing is refused.
  base::Status EncodeWhole(const Snapshot& snapshot, std::vector<std::byte>& message, bool is_offered = true);
  /// The difference from the base.
  /// \param is_offered  as the next base, in place of what was offered before
  /// \pre HasBase() (TROCAR_ASSERT)
  /// \return as EncodeWhole
  /// \note Real-time safe where `message` has the capacity and nothing is refused.
  base::Status EncodeDelta(const Snapshot& snapshot, std::vector<std::byte>& message,
                           bool is_offered = false);

  /// Makes what was offered last the base.
  /// \param message  that the receiver has read
  /// \return false where another was offered last; then nothing changes
  bool Acknowledge(std::uint64_t message) noexcept;
  bool HasBase() const noexcept;
  /// Identifies the message that was made last; 0: none.
  std::uint64_t LastMessage() const noexcept;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

/// Reads the messages of a SnapshotEncoder of the same scene. They may come from anybody: what is damaged, of another scene or
/// version, or out of range is refused.
class SnapshotDecoder {
 public:
  explicit SnapshotDecoder(const SnapshotLayout& layout);
  SnapshotDecoder(SnapshotDecoder&&) noexcept;
  SnapshotDecoder& operator=(SnapshotDecoder&&) noexcept;
  ~SnapshotDecoder();

  /// \param[in,out] into  any snapshot; unchanged where the message is refused. Its lists get the layout's lengths; truth
  /// values, enumerators, counts and indices are within them. Real numbers may be any, infinite ones and NaN too.
  /// \return kStateInvalid with the reason. After a difference from a snapshot that is not here, ask for a whole one.
  /// \note Real-time safe where `into` has been used before and nothing is refused.
  base::Status Decode(std::span<const std::byte> message, Snapshot& into);

  /// Identifies the newest message that was offered as a base and is kept, for SnapshotEncoder::Acknowledge; 0: none.
  std::uint64_t LastKept() const noexcept;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::simulation
