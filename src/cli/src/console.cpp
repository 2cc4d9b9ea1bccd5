// SPDX-License-Identifier: Apache-2.0
#include "console.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "trocar/core/clock.h"

namespace trocar::cli {
namespace {

constexpr long long kQuietNanoseconds = 500'000'000;   // work shorter than this shows nothing
constexpr long long kRedrawNanoseconds = 100'000'000;  // ten times a second is enough for eyes
constexpr int kBarCells = 30;

bool IsNumber(const std::string& cell) {
  if (cell.empty()) return false;
  char* end = nullptr;
  std::strtod(cell.c_str(), &end);
  return end == cell.c_str() + cell.size();
}

/// Characters, not bytes: continuation bytes of UTF-8 take no room.
std::size_t CountColumns(const std::string& cell) {
  return static_cast<std::size_t>(std::count_if(
      cell.begin(), cell.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

}  // namespace

std::string FormatNumber(double value, int digits) {
  if (!std::isfinite(value)) return "not a number";
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  if (std::string(text).find('e') != std::string::npos && std::fabs(value) >= 1 && std::fabs(value) < 1e15) {
    std::snprintf(text, sizeof text, "%.0f", value);
  }
  return text;
}

std::string FormatTable(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], CountColumns(row[i]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string padding(widths[i] - CountColumns(row[i]), ' ');
      if (i > 0) line += "  ";
      line += IsNumber(row[i]) ? padding + row[i] : row[i] + padding;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

ProgressBar::ProgressBar(std::string label, double total)
    : label_(std::move(label)),
      total_(total),
      is_terminal_(::isatty(STDERR_FILENO) == 1),
      start_(core::NowNanoseconds()) {}

ProgressBar::~ProgressBar() {
  Finish();
}

void ProgressBar::Show(double done) {
  if (!is_terminal_) return;
  const long long now = core::NowNanoseconds();
  if (now - start_ < kQuietNanoseconds || now - last_ < kRedrawNanoseconds) return;
  last_ = now;
  is_drawn_ = true;
  const double fraction = total_ > 0 ? std::clamp(done / total_, 0.0, 1.0) : 0.0;
  const int full = static_cast<int>(fraction * kBarCells);
  const std::string bar = std::string(static_cast<std::size_t>(full), '#') +
                          std::string(static_cast<std::size_t>(kBarCells - full), '.');
  std::fprintf(stderr, "\r%s [%s] %3.0f %%\033[K", label_.c_str(), bar.c_str(), 100 * fraction);
  std::fflush(stderr);
}

void ProgressBar::Finish() {
  if (is_drawn_) std::fprintf(stderr, "\r\033[K");
  is_drawn_ = false;
}

}  // namespace trocar::cli
