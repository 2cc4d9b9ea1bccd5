// SPDX-License-Identifier: Apache-2.0
#include "dicom_structure.h"

#include <sys/mman.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <vector>

#include "dicom_content.h"
#include "header_text.h"

namespace trocar::images::import {
namespace {

using base::ErrorCode;

constexpr std::uint32_t kOpen = 0xFFFFFFFF;  // a length that is ended by a delimiter
constexpr std::size_t kDeepest = 64;
constexpr std::uint32_t kItemBegins = 0xFFFEE000, kItemEnds = 0xFFFEE00D, kSequenceEnds = 0xFFFEE0DD;
constexpr std::uint32_t kPixelData = 0x7FE00010, kTransferSyntax = 0x00020010;
constexpr std::uint32_t kMediaClass = 0x00020002;  // of the file, before its elements say it
constexpr std::uint32_t kSopClass = 0x00080016, kModality = 0x00080060, kSeries = 0x0020000E,
                        kRows = 0x00280010;
constexpr std::string_view kImplicit = "1.2.840.10008.1.2", kExplicit = "1.2.840.10008.1.2.1",
                           kDeflated = "1.2.840.10008.1.2.1.99", kBigEndian = "1.2.840.10008.1.2.2";
constexpr std::string_view kPreamble = "DICM";
constexpr std::size_t kPreambleBytes = 128;

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

/// A value padded with a blank or a zero byte.
std::string_view TextOf(std::string_view value) {
  return Trimmed(value.substr(0, value.find('\0')));
}

class Walker {
 public:
  Walker(std::string_view bytes, DicomStructure& structure) : bytes_(bytes), structure_(structure) {}

  void Walk() {
    const Syntax syntax = ReadMeta();
    if (at_ == bytes_.size())
      Throw(ErrorCode::kImageTruncated, "it ends before the first element of its image");
    while (CloseFullLevels() && !IsPadding()) Step(Current(syntax));
    structure_.end = at_;
  }

  /// Group 2, which is always explicit and little endian, says how the rest is written; what the rest looks like counts more.
  Syntax ReadMeta() {
    at_ = bytes_.size() > kPreambleBytes && bytes_.substr(kPreambleBytes, kPreamble.size()) == kPreamble
              ? kPreambleBytes + kPreamble.size()
              : 0;
    while (bytes_.size() - at_ >= 8 && Load<std::uint16_t>(at_, false) == 2) {
      const ElementHead head = ReadHead(at_, {});
      CheckFits(head, bytes_.size());
      const std::string_view value = bytes_.substr(head.value, head.length);
      if (head.tag == kTransferSyntax) structure_.transfer_syntax = TextOf(value);
      if (head.tag == kMediaClass) structure_.sop_class = TextOf(value);
      at_ = head.value + head.length;
    }
    // less than an element of group 2: what follows is not yet the image
    const std::string_view rest = bytes_.substr(at_);
    if (!rest.empty() && rest.size() < 8 && std::string_view("\x02\0", 2).starts_with(rest.substr(0, 2)))
      Throw(ErrorCode::kImageTruncated, "it ends within an element");
    const std::string_view name = structure_.transfer_syntax;
    if (name == kBigEndian) return {true, true};
    if (name == kDeflated) return {true, false};
    if (name.empty() || name == kImplicit || name == kExplicit) return {LooksExplicit(), false};
    return {true, false};
  }
  /// Where group 2 ends, after ReadMeta.
  std::uint64_t At() const { return at_; }

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

  /// Types are two letters, of which there are few.
  bool LooksExplicit() const {
    constexpr std::string_view kTypes =
        "AE AS AT CS DA DS DT FD FL IS LO LT OB OD OF OL OV OW PN SH SL SQ SS ST SV TM UC UI UL UN UR US UT "
        "UV";
    if (bytes_.size() - at_ < 6) return structure_.transfer_syntax != kImplicit;
    const std::string_view type = bytes_.substr(at_ + 4, 2);
    return type[0] >= 'A' && type[1] >= 'A' && kTypes.find(type) != std::string_view::npos;
  }

  /// Whether only filling follows the pixels: zeros, or too little for an element.
  bool IsPadding() const {
    if (!structure_.has_pixels || !levels_.empty()) return false;
    const std::string_view rest = bytes_.substr(at_);
    return rest.size() < 8 || rest.find_first_not_of('\0') == std::string_view::npos;
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
    if (levels_.empty()) Remember(head);
    at_ = head.value + head.length;
  }

  void Remember(const ElementHead& head) {
    const auto text = [&] { return std::string(TextOf(bytes_.substr(head.value, head.length))); };
    if (head.tag == kSopClass) structure_.sop_class = text();
    if (head.tag == kModality) structure_.modality = text();
    if (head.tag == kSeries) structure_.series = text();
    if (head.tag == kRows) structure_.has_rows = true;
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
  DicomStructure& structure_;
};

/// The elements from `begin` on, unpacked.
std::string Inflate(std::string_view packed, std::uint64_t most_bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  struct Closer {
    z_stream* stream;
    ~Closer() { inflateEnd(stream); }
  } closer{&stream};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  std::uint64_t left = packed.size();
  std::string plain;
  std::array<char, 1 << 16> chunk;
  for (;;) {
    if (stream.avail_in == 0) {
      if (left == 0) Throw(ErrorCode::kImageTruncated, "its deflated elements end too early");
      const auto now = static_cast<uInt>(std::min<std::uint64_t>(left, 1u << 30));
      stream.avail_in = now;
      left -= now;
    }
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    const int state = ::inflate(&stream, Z_NO_FLUSH);
    if (state != Z_OK && state != Z_STREAM_END && state != Z_BUF_ERROR)
      Throw(ErrorCode::kImageUndecodable, "its deflated elements are damaged");
    plain.append(chunk.data(), chunk.size() - stream.avail_out);
    if (plain.size() > most_bytes)
      throw Failure{ErrorCode::kImageTooLarge, "its deflated elements unpack to more than the " +
                                                   std::to_string(most_bytes >> 20) + " MiB allowed"};
    if (state == Z_STREAM_END) return plain;
  }
}

/// Elements with a new group 2.
std::string MakeFile(std::string_view transfer_syntax, std::string_view elements) {
  std::string value(transfer_syntax);
  if (value.size() % 2 != 0) value += '\0';
  std::string file(kPreambleBytes, '\0');
  file += kPreamble;
  const auto size = static_cast<char>(value.size());
  file += std::string("\x02\0\0\0UL\4\0", 8) + static_cast<char>(size + 8) + std::string(3, '\0');
  file += std::string("\x02\0\x10\0UI", 6) + size + std::string(1, '\0') + value;
  return file.append(elements);
}

}  // namespace

DicomBytes::DicomBytes(const InputFile& file, std::uint64_t most_bytes) {
  if (file.bytes == 0) return;
  // should the file shrink meanwhile, this process ends, as it is there to do
  void* begin = ::mmap(nullptr, file.bytes, PROT_READ, MAP_PRIVATE, file.fd, 0);
  if (begin == MAP_FAILED) throw std::bad_alloc();
  mapped_ = {static_cast<const char*>(begin), file.bytes};
  try {
    DicomStructure structure;
    Walker walker(mapped_, structure);
    const Syntax syntax = walker.ReadMeta();
    const std::string_view elements = mapped_.substr(walker.At());
    const std::string_view name = structure.transfer_syntax;
    if (name == kDeflated) {
      rewritten_ = MakeFile(kExplicit, Inflate(elements, most_bytes));
    } else if ((name == kImplicit && syntax.is_explicit) || (name == kExplicit && !syntax.is_explicit)) {
      if (elements.size() > most_bytes) Throw(ErrorCode::kImageTooLarge, "it is larger than is allowed");
      if (!elements.empty()) rewritten_ = MakeFile(syntax.is_explicit ? kExplicit : kImplicit, elements);
    }
  } catch (...) {
    ::munmap(begin, file.bytes);
    throw;
  }
}

DicomBytes::~DicomBytes() {
  if (!mapped_.empty()) ::munmap(const_cast<char*>(mapped_.data()), mapped_.size());
}

void CheckStructure(std::string_view bytes, DicomStructure& structure) {
  Walker(bytes, structure).Walk();
  if (const char* problem = FindPackingProblem(structure.transfer_syntax))
    Throw(ErrorCode::kImageUnsupported, problem);
}

}  // namespace trocar::images::import
