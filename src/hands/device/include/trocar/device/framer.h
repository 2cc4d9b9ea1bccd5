// SPDX-License-Identifier: Apache-2.0
/// \file framer.h  Cuts a stream of bytes into records. Any chunking of the same stream gives the same records.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace trocar::device {

/// Verdict of a parser on the first of the bytes that are there.
struct Parsed {
  enum class Verdict {
    kIncomplete,  ///< could become a record
    kRecord,      ///< `length` bytes are a record
    kGarbage      ///< no record starts here
  };
  Verdict verdict = Verdict::kIncomplete;
  std::size_t length = 0;  ///< of the record [bytes]
};

struct FramerCounts {
  std::uint64_t records = 0;
  std::uint64_t garbage = 0;         ///< bytes that belong to no record
  std::uint64_t garbage_in_row = 0;  ///< of them, since the last record
};

/// Feeds a parser and finds the next record after garbage by trying every byte.
///
/// \tparam Parse  Parsed(std::string_view bytes, Record&); must call garbage whatever cannot become a record however it
///                goes on, and decide by at most kCapacity bytes
/// \note Real-time safe where the parser and the sink are: keeps less than one record, in place.
template <typename Record, std::size_t kCapacity>
class Framer {
 public:
  /// \param sink  called with every record, in order: void(const Record&)
  template <typename Parse, typename Sink>
  void Feed(std::string_view bytes, Parse&& parse, Sink&& sink) {
    while (!bytes.empty()) {
      const std::size_t taken = std::min(bytes.size(), kCapacity - size_);
      std::copy_n(bytes.data(), taken, buffer_.data() + size_);
      size_ += taken;
      bytes.remove_prefix(taken);
      Consume(parse, sink);
    }
  }
  /// Forgets a begun record; the counts stay.
  void Restart() noexcept { size_ = 0; }
  const FramerCounts& Counts() const noexcept { return counts_; }

 private:
  template <typename Parse, typename Sink>
  void Consume(Parse&& parse, Sink&& sink) {
    std::size_t done = 0;
    while (done < size_) {
      Record record{};
      const std::string_view rest(buffer_.data() + done, size_ - done);
      Parsed parsed = parse(rest, record);
      if (parsed.verdict == Parsed::Verdict::kIncomplete) {
        if (rest.size() < kCapacity) break;
        parsed.verdict = Parsed::Verdict::kGarbage;
      }
      if (parsed.verdict == Parsed::Verdict::kGarbage) {
        ++counts_.garbage;
        ++counts_.garbage_in_row;
        ++done;
        continue;
      }
      ++counts_.records;
      counts_.garbage_in_row = 0;
      done += parsed.length;
      sink(record);
    }
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(done),
              buffer_.begin() + static_cast<std::ptrdiff_t>(size_), buffer_.begin());
    size_ -= done;
  }

  std::array<char, kCapacity> buffer_{};
  std::size_t size_ = 0;
  FramerCounts counts_;
};

}  // namespace trocar::device
