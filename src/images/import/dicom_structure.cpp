// SPDX-License-Identifier: Apache-2.0
#include "dicom_structure.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <string_view>
#include <vector>

#include "header_text.h"

namespace trocar::images::import {
namespace {

using core::ErrorCode;

constexpr std::uint32_t kOpen = 0xFFFFFFFF;  // a length that is ended by a delimiter
constexpr std::size_t kDeepest = 64;
constexpr std::uint32_t kItemBegins = 0xFFFEE000, kItemEnds = 0xFFFEE00D, kSequenceEnds = 0xFFFEE0DD;
constexpr std::uint32_t kPixelData = 0x7FE00010, kTransferSyntax = 0x00020010;

/// The file's bytes; should it shrink meanwhile, this process ends, as it is there to do.
class MappedFile {
 public:
  explicit MappedFile(const InputFile& file) : size_(file.bytes) {
    if (size_ == 0) return;
    void* begin = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.fd, 0);
    if (begin == MAP_FAILED) throw std::bad_alloc();
    begin_ = static_cast<const char*>(begin);
  }
  ~MappedFile() {
    if (begin_ != nullptr) ::munmap(const_cast<char*>(begin_), size_);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  std::string_view Bytes() const { return {begin_, size_}; }

 private:
  const char* begin_ = nullptr;
  std::size_t size_;
};

/// How elements are written.
struct Syntax {
  bool is_explicit = true, is_big_endian = false;
};

struct ElementHead {
  std::uint32_t tag = 0, length = 0;
  std::string_view type;    // "SQ"; empty where it is not written
  std::uint64_t value = 0;  // where it begins
};

[[noreturn]] void Throw(ErrorCode code, const char* why) {
  throw Failure{code, why};
}

class Walker {
 public:
  explicit Walker(std::string_view bytes) : bytes_(bytes) {}

  DicomStructure Walk() {
    at_ = bytes_.size() >= 132 && bytes_.substr(128, 4) == "DICM" ? 132 : 0;
    const Syntax syntax = ReadMeta();
    while (CloseFullLevels()) Step(Current(syntax));
    return structure_;
  }

 private:
  enum class Kind { kSequence, kItem, kFragments };
  struct Level {
    Kind kind;
    std::uint64_t end;  // kNoEnd: until its delimiter
    bool is_implicit;   // unknown types hold elements of implicit type
  };
  static constexpr std::uint64_t kNoEnd = ~std::uint64_t{0};

  template <typename Number>
  Number Load(std::uint64_t at, bool is_big_endian) const {
    std::array<char, sizeof(Number)> raw;
    std::memcpy(raw.data(), bytes_.data() + at, raw.size());
    if (is_big_endian) std::reverse(raw.begin(), raw.end());
    Number number;
    std::memcpy(&number, raw.data(), raw.size());
    return number;
  }

  ElementHead ReadHead(std::uint64_t at, const Syntax& syntax) const {
    const auto need = [&](std::uint64_t bytes) {
      if (bytes_.size() - at < bytes) Throw(ErrorCode::kImageTruncated, "it ends within an element");
    };
    need(8);
    ElementHead head;
    head.tag = std::uint32_t{Load<std::uint16_t>(at, syntax.is_big_endian)} << 16 |
               Load<std::uint16_t>(at + 2, syntax.is_big_endian);
    if (!syntax.is_explicit || head.tag >> 16 == 0xFFFE) {
      head.length = Load<std::uint32_t>(at + 4, syntax.is_big_endian);
      head.value = at + 8;
      return head;
    }
    head.type = bytes_.substr(at + 4, 2);
    constexpr std::string_view kLong[] = {"OB", "OW", "OF", "OD", "OL", "OV", "SQ",
                                          "UC", "UR", "UT", "UN", "SV", "UV"};
    if (std::find(std::begin(kLong), std::end(kLong), head.type) != std::end(kLong)) {
      need(12);
      head.length = Load<std::uint32_t>(at + 8, syntax.is_big_endian);
      head.value = at + 12;
    } else {
      head.length = Load<std::uint16_t>(at + 6, syntax.is_big_endian);
      head.value = at + 8;
    }
    return head;
  }

  /// Group 2, which is always explicit and little endian, says how the rest is written.
  Syntax ReadMeta() {
    std::string name;
    while (bytes_.size() - at_ >= 8 && Load<std::uint16_t>(at_, false) == 2) {
      const ElementHead head = ReadHead(at_, {});
      CheckFits(head, bytes_.size());
      if (head.tag == kTransferSyntax) {
        const std::string_view value = bytes_.substr(head.value, head.length);
        name = Trimmed(value.substr(0, value.find('\0')));
      }
      at_ = head.value + head.length;
    }
    if (name == "1.2.840.10008.1.2.1.99") Throw(ErrorCode::kImageUnsupported, "it is deflated as a whole");
    if (name == "1.2.840.10008.1.2") return {false, false};
    if (name == "1.2.840.10008.1.2.2") return {true, true};
    if (!name.empty()) return {true, false};
    // without group 2: a type is two capital letters
    const std::string_view type = bytes_.size() - at_ >= 6 ? bytes_.substr(at_ + 4, 2) : std::string_view();
    const bool is_explicit =
        type.size() == 2 && type[0] >= 'A' && type[0] <= 'Z' && type[1] >= 'A' && type[1] <= 'Z';
    return {is_explicit, false};
  }

  static void CheckFits(const ElementHead& head, std::uint64_t limit) {
    if (head.length == kOpen || head.value > limit || limit - head.value < head.length)
      Throw(ErrorCode::kImageTruncated, "one of its elements is longer than what holds it");
  }

  Syntax Current(Syntax syntax) const {
    if (!levels_.empty() && levels_.back().is_implicit) syntax = {false, false};
    return syntax;
  }

  std::uint64_t Limit() const {
    for (auto level = levels_.rbegin(); level != levels_.rend(); ++level) {
      if (level->end != kNoEnd) return level->end;
    }
    return bytes_.size();
  }

  /// \return whether anything follows
  bool CloseFullLevels() {
    while (!levels_.empty() && levels_.back().end == at_) levels_.pop_back();
    if (at_ < bytes_.size()) return true;
    if (!levels_.empty()) Throw(ErrorCode::kImageTruncated, "it ends within a sequence");
    return false;
  }

  void Open(Kind kind, const ElementHead& head, bool is_implicit) {
    if (levels_.size() >= kDeepest) Throw(ErrorCode::kImageUndecodable, "its sequences are nested too deep");
    if (head.length != kOpen) CheckFits(head, Limit());
    levels_.push_back({kind, head.length == kOpen ? kNoEnd : head.value + head.length, is_implicit});
    at_ = head.value;
  }

  void Close(Kind kind, Kind other, const ElementHead& head) {
    if (levels_.empty() || levels_.back().end != kNoEnd ||
        (levels_.back().kind != kind && levels_.back().kind != other))
      Throw(ErrorCode::kImageUndecodable, "its sequences end where they did not begin");
    levels_.pop_back();
    at_ = head.value;
  }

  void Skip(const ElementHead& head) {
    CheckFits(head, Limit());
    at_ = head.value + head.length;
  }

  void Step(const Syntax& syntax) {
    const ElementHead head = ReadHead(at_, syntax);
    const bool is_in_list = !levels_.empty() && levels_.back().kind != Kind::kItem;
    const bool is_implicit = !levels_.empty() && levels_.back().is_implicit;
    if (head.tag == kItemEnds) return Close(Kind::kItem, Kind::kItem, head);
    if (head.tag == kSequenceEnds) return Close(Kind::kSequence, Kind::kFragments, head);
    if (head.tag == kItemBegins) {
      if (!is_in_list) Throw(ErrorCode::kImageUndecodable, "it has an item outside any sequence");
      return levels_.back().kind == Kind::kFragments ? Skip(head) : Open(Kind::kItem, head, is_implicit);
    }
    if (is_in_list) Throw(ErrorCode::kImageUndecodable, "it has a sequence of something else than items");
    const bool is_pixels = head.tag == kPixelData && levels_.empty();
    if (is_pixels) {
      structure_.has_pixels = true;
      structure_.is_encapsulated = head.length == kOpen;
      structure_.pixel_bytes = structure_.is_encapsulated ? 0 : head.length;
    }
    if (head.length == kOpen) {
      const bool is_fragments = head.tag == kPixelData;
      return Open(is_fragments ? Kind::kFragments : Kind::kSequence, head, is_implicit || head.type == "UN");
    }
    return head.type == "SQ" ? Open(Kind::kSequence, head, is_implicit) : Skip(head);
  }

  std::string_view bytes_;
  std::uint64_t at_ = 0;
  std::vector<Level> levels_;
  DicomStructure structure_;
};

}  // namespace

DicomStructure CheckStructure(const InputFile& file) {
  const MappedFile mapped(file);
  return Walker(mapped.Bytes()).Walk();
}

}  // namespace trocar::images::import
