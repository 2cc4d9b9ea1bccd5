// SPDX-License-Identifier: Apache-2.0
#include "trocar/simulation/snapshot_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <utility>

#include "snapshot_words.h"
#include "trocar/base/assert.h"
#include "trocar/base/checksum.h"
#include "trocar/base/state_hash.h"
#include "trocar/base/to_integer.h"

namespace trocar::simulation {
namespace {

enum class Kind : std::uint8_t { kWhole, kDelta };

/// Before the content of a message.
struct Header {
  std::array<char, 4> magic{};
  std::uint16_t version = 0;
  Kind kind = Kind::kWhole;
  std::uint8_t precision = 0;
  std::uint64_t model = 0;   // fingerprint of scene, patient and tissue
  std::uint64_t layout = 0;  // fingerprint of the fields and lengths
  std::uint64_t tick = 0;
  std::uint64_t base = 0;       // message from which this is a difference; 0: none
  std::uint64_t base_tick = 0;  // its tick
  std::uint32_t size = 0;       // of the content [bytes]
  std::uint32_t is_offered = 0;
  std::uint64_t checksum = 0;  // of all before it and of the content; identifies the message
};
static_assert(sizeof(Header) == kSnapshotHeaderSize);
constexpr std::array<char, 4> kMagic{'T', 'R', 'S', 'N'};
/// Counts up whenever the meaning of a byte changes. The layout's fingerprint changes by itself.
constexpr std::uint16_t kVersion = 1;

/// A snapshot as words, kept for differences from it.
struct Kept {
  std::vector<std::uint64_t> words;
  std::uint64_t message = 0, tick = 0;  // message 0: none
  std::uint8_t precision = 0;
};

base::Error Refuse(std::string why) {
  return {base::ErrorCode::kStateInvalid, std::move(why)};
}

/// Never 0.
std::uint64_t CalcMessageChecksum(const Header& header, std::span<const std::byte> content) {
  base::StateHash hash;
  hash.Add(base::CalcChecksum(
      std::as_bytes(std::span(&header, 1)).first(sizeof(Header) - sizeof(header.checksum))));
  hash.Add(base::CalcChecksum(content));
  return std::max<std::uint64_t>(hash.Value(), 1);
}

/// Numbers of cells from 0, exact up to here.
constexpr double kFarthestCell = 0x1p52;

/// Positions as numbers of cells.
/// \return false where one has no cell
bool PutOnGrid(std::span<std::uint64_t> words) noexcept {
  for (std::uint64_t& word : words) {
    const double cell = std::floor(std::bit_cast<double>(word) / kPictureGrid + 0.5);
    if (!(std::fabs(cell) <= kFarthestCell)) return false;
    word = static_cast<std::uint64_t>(base::TruncateTo<std::int64_t>(cell));
  }
  return true;
}

void TakeFromGrid(std::span<std::uint64_t> words) noexcept {
  for (std::uint64_t& word : words)
    word = std::bit_cast<std::uint64_t>(kPictureGrid * static_cast<double>(static_cast<std::int64_t>(word)));
}

bool IsIndexOrNone(std::int64_t index, std::size_t count) noexcept {
  return index >= -1 && index < static_cast<std::int64_t>(count);
}

template <typename List>
bool AreTruthValues(const List& list) noexcept {
  return std::all_of(list.begin(), list.end(), [](std::uint8_t value) { return value <= 1; });
}

/// Whether each count and index of an operation names something that there is.
bool IsWithin(const OperationSnapshot& o, const SnapshotLayout& layout) noexcept {
  const std::size_t nodes = layout.shape.positions.size();
  const TopologySnapshot& topology = o.topology;
  for (std::size_t hand = 0; hand < o.tools.size(); ++hand) {
    if (o.tools[hand] >= layout.tools[hand]) return false;
  }
  for (std::size_t i = 0; i < topology.first_triangle.size(); ++i) {
    const std::uint64_t last = std::uint64_t{topology.first_triangle[i]} + topology.triangle_count[i];
    if (last > topology.triangles.size()) return false;
  }
  for (const auto& triangle : topology.triangles) {
    if (std::max({triangle[0], triangle[1], triangle[2]}) >= nodes) return false;
  }
  // what lies behind a count is nobody's
  if (topology.tube_piece_count > topology.tube_pieces.size()) return false;
  for (const surgery::TubePiece& piece : std::span(topology.tube_pieces).first(topology.tube_piece_count)) {
    if (std::max(piece.a, piece.b) >= nodes || piece.surface >= layout.surfaces) return false;
  }
  for (const surgery::StoneSnapshot& stone : o.stones) {
    if (!IsIndexOrNone(stone.hand, instrument::kHandCount)) return false;
  }
  const scene::ProcedureSnapshot& procedure = o.procedure;
  if (procedure.phase > 0 && procedure.phase >= layout.phases) return false;
  if (std::any_of(procedure.view.criteria.begin(), procedure.view.criteria.end(),
                  [](std::uint8_t grade) { return grade > scene::ViewScore::kWhole; }))
    return false;
  return o.clip_count <= o.clips.size() && o.tube_cut_count <= o.tube_cuts.size() &&
         o.flow.leak_count <= o.flow.leaks.size() && o.flow.ooze_count <= o.flow.oozes.size() &&
         AreTruthValues(o.strand_is_intact) && AreTruthValues(o.band_is_whole) &&
         AreTruthValues(procedure.view.sights);
}

bool IsWithin(const scene::TaskSnapshot& task, const SnapshotLayout& layout) noexcept {
  for (std::size_t i = 0; i < task.goals.size(); ++i) {
    const scene::GoalSnapshot& goal = task.goals[i];
    const std::size_t steps = layout.goal_steps[i];
    // the step that an open goal has come to is looked up
    if (goal.steps_done > steps || (!goal.is_done && steps > 0 && goal.steps_done == steps)) return false;
  }
  return std::all_of(task.last_errors.begin(), task.last_errors.end(), [&](const scene::TaskError& error) {
    return IsIndexOrNone(error.rule, layout.rules) &&
           IsIndexOrNone(error.object, layout.shape.objects.size()) &&
           IsIndexOrNone(error.hand, instrument::kHandCount);
  });
}

bool IsWithin(const Snapshot& snapshot, const SnapshotLayout& layout) noexcept {
  constexpr std::uint8_t kHands = (1U << instrument::kHandCount) - 1;
  const std::size_t objects = snapshot.objects.size();
  for (const InstrumentSnapshot& tool : snapshot.instruments) {
    if (!IsIndexOrNone(tool.organ, layout.surfaces) || !IsIndexOrNone(tool.object, objects)) return false;
  }
  for (const scene::ObjectSnapshot& object : snapshot.objects) {
    const bool touches_others = objects < scene::kMaxObjects && (object.touches >> objects) != 0;
    if (object.held_by > kHands || object.touched_by > kHands || touches_others) return false;
  }
  for (const surgery::Dent& dent : snapshot.dents) {
    if (!IsIndexOrNone(dent.neighbour, layout.neighbours)) return false;
  }
  // entries of the ring that no event has taken yet say nothing
  const std::uint64_t events = std::min<std::uint64_t>(snapshot.event_count, snapshot.events.size());
  for (const scene::Event& event : std::span(snapshot.events).first(static_cast<std::size_t>(events))) {
    if (!IsIndexOrNone(event.hand, instrument::kHandCount) || !IsIndexOrNone(event.organ, layout.surfaces) ||
        !IsIndexOrNone(event.object, objects) || !IsIndexOrNone(event.error, layout.procedure_errors))
      return false;
  }
  if (snapshot.fact_count > snapshot.facts.size()) return false;
  for (const surgery::Fact& fact : std::span(snapshot.facts).first(snapshot.fact_count)) {
    if (!IsIndexOrNone(fact.hand, instrument::kHandCount) || !IsIndexOrNone(fact.object, objects) ||
        !IsIndexOrNone(fact.surface, layout.surfaces) ||
        !IsIndexOrNone(fact.strand, snapshot.operation.strand_is_intact.size()))
      return false;
  }
  return IsWithin(snapshot.operation, layout) && IsWithin(snapshot.task, layout);
}

}  // namespace

struct SnapshotEncoder::Content {
  Content(const SnapshotLayout& layout, SnapshotPrecision wanted)
      : precision(wanted), model(layout.model), row(DescribeRow(layout.shape)) {
    for (auto* words : {&now, &nothing, &base.words, &offered.words}) words->resize(row.count);
    buffer.resize(sizeof(Header) + MostDeltaBytes(row.count));
  }

  base::Status Encode(const Snapshot& snapshot, Kind kind, bool is_offered, std::vector<std::byte>& message) {
    message.clear();
    if (!WriteWords(snapshot, row, now)) {
      return Refuse(
          "a list of the snapshot has another length than in its layout; describe the scene that it is of");
    }
    if (precision == SnapshotPrecision::kPicture &&
        !PutOnGrid(std::span(now).subspan(row.first_position, row.positions))) {
      return base::Error{
          base::ErrorCode::kStateNotFinite,
          "a position is too far away for a picture, or not finite; send the snapshot exactly"};
    }
    const bool is_delta = kind == Kind::kDelta;
    const std::span content = std::span(buffer).subspan(sizeof(Header));
    Header header{kMagic, kVersion, kind, static_cast<std::uint8_t>(precision), model, row.fingerprint};
    header.tick = snapshot.tick;
    if (is_delta) header.base = base.message, header.base_tick = base.tick;
    header.is_offered = is_offered ? 1 : 0;
    header.size = static_cast<std::uint32_t>(PutDelta(now, is_delta ? base.words : nothing, content));
    header.checksum = CalcMessageChecksum(header, content.first(header.size));
    std::memcpy(buffer.data(), &header, sizeof(header));
    message.assign(buffer.begin(),
                   buffer.begin() + static_cast<std::ptrdiff_t>(sizeof(Header) + header.size));
    last = header.checksum;
    if (is_offered) {
      offered.words.swap(now);
      offered.message = last, offered.tick = snapshot.tick;
    }
    return {};
  }

  // constant
  SnapshotPrecision precision;
  std::uint64_t model;
  WordRow row;
  std::vector<std::uint64_t> nothing;  // from which a whole one is the difference

  Kept base, offered;
  std::uint64_t last = 0;

  // scratch
  std::vector<std::uint64_t> now;
  std::vector<std::byte> buffer;
};

SnapshotEncoder::SnapshotEncoder(const SnapshotLayout& layout, SnapshotPrecision precision)
    : content_(std::make_unique<Content>(layout, precision)) {}
SnapshotEncoder::SnapshotEncoder(SnapshotEncoder&&) noexcept = default;
SnapshotEncoder& SnapshotEncoder::operator=(SnapshotEncoder&&) noexcept = default;
SnapshotEncoder::~SnapshotEncoder() = default;

base::Status SnapshotEncoder::EncodeWhole(const Snapshot& snapshot, std::vector<std::byte>& message,
                                          bool is_offered) {
  base::Status encoded = content_->Encode(snapshot, Kind::kWhole, is_offered, message);
  if (encoded.ok() && is_offered) content_->base.message = 0;
  return encoded;
}

base::Status SnapshotEncoder::EncodeDelta(const Snapshot& snapshot, std::vector<std::byte>& message,
                                          bool is_offered) {
  TROCAR_ASSERT(HasBase());
  return content_->Encode(snapshot, Kind::kDelta, is_offered, message);
}

bool SnapshotEncoder::Acknowledge(std::uint64_t message) noexcept {
  Content& c = *content_;
  if (message == 0 || message != c.offered.message) return false;
  std::swap(c.base, c.offered);
  c.offered.message = 0;
  return true;
}

bool SnapshotEncoder::HasBase() const noexcept {
  return content_->base.message != 0;
}

std::uint64_t SnapshotEncoder::LastMessage() const noexcept {
  return content_->last;
}

struct SnapshotDecoder::Content {
  explicit Content(const SnapshotLayout& described)
      : layout(described), row(DescribeRow(layout.shape)), read(layout.shape) {
    for (auto* words : {&now, &nothing, &kept[0].words, &kept[1].words}) words->resize(row.count);
    grid.resize(row.positions);
  }

  /// The header of a message that is whole, and of this scene.
  base::Result<Header> ReadHeader(std::span<const std::byte> message) const {
    Header header;
    if (message.size() < sizeof(header)) return Refuse("a snapshot's message ends within its header");
    std::memcpy(&header, message.data(), sizeof(header));
    const auto content = message.subspan(sizeof(header));
    if (header.magic != kMagic) return Refuse("this is no message with a snapshot of Trocar");
    if (header.version != kVersion) {
      return Refuse("the snapshot is sent in version " + std::to_string(header.version) +
                    ", this program reads " + std::to_string(kVersion) +
                    "; use the same program on both sides");
    }
    if (header.size != content.size() || header.checksum != CalcMessageChecksum(header, content))
      return Refuse("the snapshot's message is damaged: its checksum does not fit; ask for a whole snapshot");
    if (header.model != layout.model)
      return Refuse("the snapshot is of another scene, patient or seed; open the one that is sent");
    if (header.layout != row.fingerprint)
      return Refuse("the sender's snapshots have other fields; use the same program on both sides");
    const bool has_base = header.base != 0;
    if (header.kind > Kind::kDelta || (header.kind == Kind::kDelta) != has_base ||
        header.precision > static_cast<std::uint8_t>(SnapshotPrecision::kPicture) || header.is_offered > 1)
      return Refuse("the header of the snapshot's message contradicts itself");
    return header;
  }

  base::Status Decode(std::span<const std::byte> message, Snapshot& into) {
    const auto checked = ReadHeader(message);
    if (!checked) return checked.error();
    const Header& header = *checked;
    const bool is_delta = header.kind == Kind::kDelta;
    const Kept* base = nullptr;
    if (is_delta) {
      for (const Kept& one : kept) {
        if (one.message == header.base) base = &one;
      }
      if (base == nullptr) {
        return Refuse("the snapshot is a difference from tick " + std::to_string(header.base_tick) +
                      ", which is not here; ask for a whole snapshot");
      }
      if (base->precision != header.precision)
        return Refuse("the header of the snapshot's message contradicts itself");
    }
    const auto content = message.subspan(sizeof(Header));
    if (!TakeDelta(content, is_delta ? base->words : nothing, now) || !ReadValues(header))
      return Refuse("the snapshot has a value that its scene does not allow; do not trust its sender");
    into = read;
    if (header.is_offered != 0) Keep(header, base);
    return {};
  }

  /// Values of `now`. \return false where one is none of its field, or is not within the layout
  bool ReadValues(const Header& header) noexcept {
    const bool is_on_grid = header.precision == static_cast<std::uint8_t>(SnapshotPrecision::kPicture);
    const std::span positions = std::span(now).subspan(row.first_position, row.positions);
    if (is_on_grid) {
      std::copy(positions.begin(), positions.end(), grid.begin());
      TakeFromGrid(positions);
    }
    const bool is_read = ReadWords(now, read);
    if (is_on_grid) std::copy(grid.begin(), grid.end(), positions.begin());
    return is_read && read.tick == header.tick && IsWithin(read, layout);
  }

  /// Keeps `now` for differences that will be from it, and what it is a difference from.
  void Keep(const Header& header, const Kept* base) noexcept {
    Kept& place = base == &kept[0] ? kept[1] : kept[0];
    if (base == nullptr) {
      // a whole one begins anew
      kept[1].message = 0;
    } else if (place.message != 0 && place.tick > header.tick) {
      return;  // it comes late: a newer one may be the sender's base already
    }
    place.words.swap(now);
    place.message = header.checksum, place.tick = header.tick, place.precision = header.precision;
    last_kept = header.checksum;
  }

  // constant
  SnapshotLayout layout;
  WordRow row;
  std::vector<std::uint64_t> nothing;  // from which a whole one is the difference

  std::array<Kept, 2> kept;  // the sender's base, and what was offered since
  std::uint64_t last_kept = 0;

  // scratch
  std::vector<std::uint64_t> now, grid;
  Snapshot read;
};

SnapshotDecoder::SnapshotDecoder(const SnapshotLayout& layout)
    : content_(std::make_unique<Content>(layout)) {}
SnapshotDecoder::SnapshotDecoder(SnapshotDecoder&&) noexcept = default;
SnapshotDecoder& SnapshotDecoder::operator=(SnapshotDecoder&&) noexcept = default;
SnapshotDecoder::~SnapshotDecoder() = default;

base::Status SnapshotDecoder::Decode(std::span<const std::byte> message, Snapshot& into) {
  return content_->Decode(message, into);
}

std::uint64_t SnapshotDecoder::LastKept() const noexcept {
  return content_->last_kept;
}

}  // namespace trocar::simulation
