// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "trocar/device/jaw_sensor.h"

namespace trocar::device {
namespace {

using Verdict = Parsed::Verdict;

/// Reads one line from the front; every character has to fit where it stands.
class LineReader {
 public:
  explicit LineReader(std::string_view bytes) noexcept : bytes_(bytes) {}

  void Expect(char wanted) noexcept {
    if (verdict_ != Verdict::kRecord) return;
    if (at_ == bytes_.size()) {
      verdict_ = Verdict::kIncomplete;
    } else if (bytes_[at_++] != wanted) {
      verdict_ = Verdict::kGarbage;
    }
  }
  /// A whole number up to `most` without leading zeros, ended by something else.
  std::uint32_t Number(std::uint64_t most) noexcept {
    std::uint64_t value = 0;
    std::size_t digits = 0;
    while (verdict_ == Verdict::kRecord) {
      if (at_ == bytes_.size()) {
        verdict_ = Verdict::kIncomplete;
        break;
      }
      const char mark = bytes_[at_];
      if (mark < '0' || mark > '9') break;
      if (digits == 1 && value == 0) verdict_ = Verdict::kGarbage;
      value = 10 * value + static_cast<std::uint64_t>(mark - '0');
      if (value > most) verdict_ = Verdict::kGarbage;
      ++digits;
      ++at_;
    }
    if (verdict_ == Verdict::kRecord && digits == 0) verdict_ = Verdict::kGarbage;
    return static_cast<std::uint32_t>(value);
  }
  bool IsNext(char mark) const noexcept { return at_ < bytes_.size() && bytes_[at_] == mark; }
  Parsed Result() const noexcept { return {verdict_, verdict_ == Verdict::kRecord ? at_ : 0}; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  Verdict verdict_ = Verdict::kRecord;
};

}  // namespace

Parsed JawFramer::Parse(std::string_view bytes, JawReading& reading) noexcept {
  LineReader line(bytes);
  line.Expect('J');
  line.Expect(',');
  reading.tool = static_cast<int>(line.Number(kJawTools - 1));
  line.Expect(',');
  reading.milliseconds = line.Number(0xffffffff);
  line.Expect(',');
  reading.raw = static_cast<int>(line.Number(kMaxJawRaw));
  if (line.IsNext('\r')) line.Expect('\r');
  line.Expect('\n');
  return line.Result();
}

HidReport ParseHidReport(std::string_view bytes) noexcept {
  HidReport report;
  if (bytes.size() != kHidReportSize && bytes.size() != kHidReportSizeWithoutClock) return report;
  const auto word = [&](std::size_t n) {
    return static_cast<unsigned char>(bytes[2 * n]) | static_cast<unsigned char>(bytes[2 * n + 1]) << 8;
  };
  for (std::size_t tool = 0; tool < report.raw.size(); ++tool) {
    if (const int raw = word(tool); raw <= kMaxJawRaw) report.raw[tool] = raw;
  }
  if (bytes.size() == kHidReportSize) report.milliseconds = static_cast<std::uint16_t>(word(kJawTools));
  return report;
}

std::string FormatHidReport(const std::array<int, kJawTools>& raw, std::uint16_t milliseconds) {
  std::string report;
  for (const int value : {raw[0], raw[1], static_cast<int>(milliseconds)})
    report += {static_cast<char>(value & 0xff), static_cast<char>(value >> 8)};
  return report;
}

std::string FormatReading(const JawReading& reading) {
  char text[48];
  std::snprintf(text, sizeof text, "J,%d,%u,%d\r\n", reading.tool, reading.milliseconds, reading.raw);
  return text;
}

}  // namespace trocar::device
