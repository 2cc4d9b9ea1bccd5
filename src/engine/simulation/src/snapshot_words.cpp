// SPDX-License-Identifier: Apache-2.0
#include "snapshot_words.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

#include "trocar/base/assert.h"
#include "trocar/base/state_hash.h"
#include "trocar/simulation/snapshot_fields.h"

namespace trocar::simulation {
namespace {

static_assert(std::endian::native == std::endian::little, "a message is little-endian");

/// How many enumerators a field's type has; those of a new type belong here.
template <typename Enum>
inline constexpr std::uint64_t kEnumerators = 0;
template <>
inline constexpr std::uint64_t kEnumerators<surgery::FactKind> = surgery::kFactKindCount;
template <>
inline constexpr std::uint64_t kEnumerators<instrument::ToolKind> = instrument::kToolKindCount;
template <>
inline constexpr std::uint64_t kEnumerators<scene::TaskPhase> =
    static_cast<std::uint64_t>(scene::TaskPhase::kEnded) + 1;
template <>
inline constexpr std::uint64_t kEnumerators<surgery::Fluid> = surgery::kFluidCount;
template <>
inline constexpr std::uint64_t kEnumerators<surgery::StonePlace> =
    static_cast<std::uint64_t>(surgery::StonePlace::kTakenOut) + 1;

template <typename T>
std::uint64_t WordOf(const T& value) noexcept {
  if constexpr (std::is_same_v<T, double>) {
    return std::bit_cast<std::uint64_t>(value);
  } else if constexpr (std::is_same_v<T, float>) {
    return std::bit_cast<std::uint32_t>(value);
  } else if constexpr (std::is_signed_v<T>) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
  } else {
    return static_cast<std::uint64_t>(value);
  }
}

template <typename T>
bool TakeWord(std::uint64_t word, T& value) noexcept {
  if constexpr (std::is_same_v<T, double>) {
    value = std::bit_cast<double>(word);
    return true;
  } else if constexpr (std::is_same_v<T, float>) {
    value = std::bit_cast<float>(static_cast<std::uint32_t>(word));
    return word <= std::numeric_limits<std::uint32_t>::max();
  } else if constexpr (std::is_same_v<T, bool>) {
    value = word != 0;
    return word <= 1;
  } else if constexpr (std::is_enum_v<T>) {
    static_assert(kEnumerators<T> > 0, "say above how many enumerators it has");
    value = static_cast<T>(word);
    return word < kEnumerators<T>;
  } else {
    value = static_cast<T>(word);
    return WordOf(value) == word;
  }
}

/// The kind of a field, for the fingerprint. A size has eight bytes on every platform.
template <typename T>
constexpr std::uint64_t KindOf() noexcept {
  if constexpr (std::is_same_v<T, bool>) {
    return 1;
  } else if constexpr (std::is_floating_point_v<T>) {
    return 0x100 + sizeof(T);
  } else if constexpr (std::is_enum_v<T>) {
    return 0x1000 + kEnumerators<T>;
  } else if constexpr (std::is_same_v<T, std::size_t>) {
    return 0x200 + sizeof(std::uint64_t);
  } else {
    return (std::is_signed_v<T> ? 0x300 : 0x200) + sizeof(T);
  }
}

class RowDescriber {
 public:
  RowDescriber(WordRow& row, const void* positions) : row_(row), positions_(positions) {}

  template <typename T>
  void Value(const T&) {
    hash_.Add(KindOf<T>());
    ++row_.count;
  }
  template <typename List>
  void Length(const List& list) {
    hash_.Add(std::uint64_t{list.size()});
    row_.lengths.push_back(list.size());
    if (&list != positions_) return;
    row_.first_position = row_.count;
    row_.positions = 3 * list.size();
  }
  std::uint64_t Hash() const { return hash_.Value(); }

 private:
  WordRow& row_;
  const void* positions_;
  base::StateHash hash_;
};

class WordWriter {
 public:
  WordWriter(const WordRow& row, std::span<std::uint64_t> words) : row_(row), words_(words) {}

  template <typename T>
  void Value(const T& value) noexcept {
    if (fits_) words_[at_++] = WordOf(value);
  }
  template <typename List>
  void Length(const List& list) noexcept {
    fits_ = fits_ && list.size() == row_.lengths[length_++];
  }
  bool Fits() const { return fits_; }

 private:
  const WordRow& row_;
  std::span<std::uint64_t> words_;
  std::size_t at_ = 0, length_ = 0;
  bool fits_ = true;
};

class WordReader {
 public:
  explicit WordReader(std::span<const std::uint64_t> words) : words_(words) {}

  template <typename T>
  void Value(T& value) noexcept {
    if (!TakeWord(words_[at_++], value)) fits_ = false;
  }
  template <typename List>
  void Length(const List&) noexcept {}
  bool Fits() const { return fits_; }

 private:
  std::span<const std::uint64_t> words_;
  std::size_t at_ = 0;
  bool fits_ = true;
};

constexpr std::size_t kBlock = 8;  // words
// The first byte of a block says how many bits each of its words has; of blocks that did not change, only how many there are.
constexpr unsigned kMostBits = 64, kMostUnchanged = 255 - kMostBits;

/// Small for small differences of either sign. Doubles of one sign count how many lie between them.
std::uint64_t FoldDelta(std::uint64_t now, std::uint64_t base) noexcept {
  const std::uint64_t delta = now - base;
  return (delta << 1) ^ (0 - (delta >> 63));
}
std::uint64_t Unfold(std::uint64_t folded, std::uint64_t base) noexcept {
  return base + ((folded >> 1) ^ (0 - (folded & 1)));
}

}  // namespace

WordRow DescribeRow(const Snapshot& shape) {
  WordRow row;
  RowDescriber describer(row, &shape.positions);
  VisitFields(shape, describer);
  row.fingerprint = describer.Hash();
  return row;
}

bool WriteWords(const Snapshot& snapshot, const WordRow& row, std::span<std::uint64_t> words) noexcept {
  TROCAR_ASSERT(words.size() == row.count);
  WordWriter writer(row, words);
  VisitFields(snapshot, writer);
  return writer.Fits();
}

bool ReadWords(std::span<const std::uint64_t> words, Snapshot& snapshot) noexcept {
  WordReader reader(words);
  VisitFields(snapshot, reader);
  return reader.Fits();
}

std::size_t MostDeltaBytes(std::size_t words) noexcept {
  return (words / kBlock + 1) * (1 + kMostBits) + sizeof(std::uint64_t);
}

std::size_t PutDelta(std::span<const std::uint64_t> now, std::span<const std::uint64_t> base,
                     std::span<std::byte> bytes) noexcept {
  TROCAR_ASSERT(now.size() == base.size() && bytes.size() >= MostDeltaBytes(now.size()));
  std::byte* out = bytes.data();
  unsigned unchanged = 0;
  const auto end_unchanged = [&] {
    if (unchanged > 0) *out++ = static_cast<std::byte>(kMostBits + unchanged);
    unchanged = 0;
  };
  for (std::size_t first = 0; first < now.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, now.size() - first);
    std::array<std::uint64_t, kBlock> delta{};
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < count; ++i) all |= delta[i] = FoldDelta(now[first + i], base[first + i]);
    if (all == 0) {
      if (++unchanged == kMostUnchanged) end_unchanged();
      continue;
    }
    end_unchanged();
    const auto bits = static_cast<unsigned>(std::bit_width(all));
    *out++ = static_cast<std::byte>(bits);
    // eight words of so many bits are as many bytes
    std::uint64_t word = 0;
    unsigned filled = 0;
    for (const std::uint64_t value : delta) {
      word |= value << filled;
      filled += bits;
      if (filled < 64) continue;
      std::memcpy(out, &word, sizeof(word));
      out += sizeof(word);
      filled -= 64;
      word = filled > 0 ? value >> (bits - filled) : 0;
    }
    std::memcpy(out, &word, sizeof(word));
    out += filled / 8;
  }
  end_unchanged();
  return static_cast<std::size_t>(out - bytes.data());
}

bool TakeDelta(std::span<const std::byte> bytes, std::span<const std::uint64_t> base,
               std::span<std::uint64_t> now) noexcept {
  TROCAR_ASSERT(now.size() == base.size());
  std::size_t first = 0;
  while (first < now.size()) {
    if (bytes.empty()) return false;
    const auto bits = static_cast<unsigned>(bytes.front());
    bytes = bytes.subspan(1);
    if (bits == 0) return false;
    if (bits > kMostBits) {
      const std::size_t blocks = bits - kMostBits;
      if (blocks > (now.size() - first + kBlock - 1) / kBlock) return false;
      const std::size_t count = std::min(blocks * kBlock, now.size() - first);
      std::copy_n(base.begin() + static_cast<std::ptrdiff_t>(first), count,
                  now.begin() + static_cast<std::ptrdiff_t>(first));
      first += count;
      continue;
    }
    if (bytes.size() < bits) return false;
    std::array<std::uint64_t, kBlock + 1> packed{};
    std::memcpy(packed.data(), bytes.data(), bits);
    bytes = bytes.subspan(bits);
    const std::size_t count = std::min(kBlock, now.size() - first);
    const std::uint64_t mask = ~std::uint64_t{0} >> (64 - bits);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = i * bits / 64, shift = i * bits % 64;
      std::uint64_t value = packed[at] >> shift;
      if (shift + bits > 64) value |= packed[at + 1] << (64 - shift);
      now[first + i] = Unfold(value & mask, base[first + i]);
    }
    first += count;
  }
  return bytes.empty();
}

}  // namespace trocar::simulation
