// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "trocar/base/to_integer.h"
#include "trocar/host/clock.h"
#include "trocar/host/printable_output.h"
#include "trocar/host/translate.h"

namespace trocar::host {
namespace {

constexpr long long kQuietNanoseconds = 500'000'000;   // work shorter than this shows nothing
constexpr long long kRedrawNanoseconds = 100'000'000;  // ten times a second is enough for eyes
constexpr int kBarCells = 30;

}  // namespace

ProgressBar::ProgressBar(std::string_view label, double total)
    : label_(label), total_(total), is_terminal_(::isatty(STDERR_FILENO) == 1), start_(NowNanoseconds()) {}

ProgressBar::~ProgressBar() {
  Finish();
}

void ProgressBar::Show(double done) {
  if (!is_terminal_) return;
  const long long now = NowNanoseconds();
  if (now - start_ < kQuietNanoseconds || now - last_ < kRedrawNanoseconds) return;
  last_ = now;
  is_drawn_ = true;
  const double fraction = total_ > 0 ? std::clamp(done / total_, 0.0, 1.0) : 0.0;
  const int full = base::TruncateTo<int>(fraction * kBarCells);
  const std::string bar = std::string(static_cast<std::size_t>(full), '#') +
                          std::string(static_cast<std::size_t>(kBarCells - full), '.');
  WriteControl(stderr, "\r");
  std::fprintf(stderr, "%s [%s] %3.0f %%", PrintableLine(TranslateComposed(label_)).c_str(), bar.c_str(),
               100 * fraction);
  WriteControl(stderr, "\033[K");
  std::fflush(stderr);
}

void ProgressBar::Finish() {
  if (is_drawn_) WriteControl(stderr, "\r\033[K");
  is_drawn_ = false;
}

}  // namespace trocar::host
