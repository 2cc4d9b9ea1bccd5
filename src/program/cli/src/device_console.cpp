// SPDX-License-Identifier: Apache-2.0
#include "device_console.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

#include "console.h"
#include "trocar/device/ports.h"
#include "trocar/host/printable_output.h"

namespace trocar::cli {
namespace {

constexpr double kReadPeriod = 0.002;   // [s]
constexpr double kDrawPeriod = 0.050;   // [s]
constexpr double kPrintPeriod = 0.500;  // without a terminal [s]
constexpr double kDegrees = 57.29577951308232;

volatile std::sig_atomic_t is_interrupted = 0;

void OnInterrupt(int) {
  is_interrupted = 1;
}

/// "[-----|--#--]": where `value` lies between low and high.
std::string Bar(double value, double low, double high) {
  constexpr int kCells = 15;
  const double place = std::clamp((value - low) / (high - low), 0.0, 1.0);
  std::string bar(kCells, '-');
  if (low < 0.0) bar[kCells / 2] = '|';
  bar[static_cast<std::size_t>(std::lround(place * (kCells - 1)))] = '#';
  return "[" + bar + "]";
}

}  // namespace

InterruptWatch::InterruptWatch() {
  is_interrupted = 0;
  former_ = {std::signal(SIGINT, OnInterrupt), std::signal(SIGTERM, OnInterrupt)};
}

InterruptWatch::~InterruptWatch() {
  std::signal(SIGINT, former_[0]);
  std::signal(SIGTERM, former_[1]);
}

bool InterruptWatch::IsInterrupted() const noexcept {
  return is_interrupted != 0;
}

base::Result<WatchReport> WatchDevice(device::Driver& driver, double seconds,
                                      const std::function<void(const HandSamples&, double)>& on_sample,
                                      const std::function<void(const HandSamples&, double)>& on_idle) {
  const InterruptWatch interrupt;
  if (const base::Status done = driver.Configure(); !done) return done.error();
  if (const base::Status done = driver.Activate(); !done) return done.error();
  device::Clock& clock = device::SystemClock();
  const double start = clock.Now();
  WatchReport report;
  HandSamples samples, before;
  double next_draw = 0;
  while (!interrupt.IsInterrupted() && (seconds <= 0.0 || report.seconds < seconds)) {
    const device::ReadStatus status = driver.Read(samples);
    report.seconds = clock.Now() - start;
    if (status == device::ReadStatus::kLost) {
      report.is_lost = true;
      break;
    }
    if (status == device::ReadStatus::kFresh) {
      for (std::size_t hand = 0; hand < samples.size(); ++hand) {
        report.fresh[hand] += samples[hand].is_valid && samples[hand] != before[hand] ? 1 : 0;
        report.unseen[hand] += !samples[hand].is_valid && before[hand].is_valid ? 1 : 0;
      }
      before = samples;
      on_sample(samples, report.seconds);
    }
    if (on_idle && report.seconds >= next_draw) {
      next_draw = report.seconds + kDrawPeriod;
      on_idle(samples, report.seconds);
    }
    clock.Sleep(kReadPeriod);
  }
  report.held_back = driver.DescribeHeldBack();
  report.received = driver.DescribeReceived();
  driver.Finalize();
  return report;
}

void PrintHeldBack(const WatchReport& report) {
  for (const std::string& sentence : report.held_back)
    host::Say("Not used: {1}\n", host::TranslateComposed(sentence));
}

namespace {

/// Numbers of those that are down, "-" for none.
std::string FormatButtons(std::uint32_t buttons) {
  std::string text;
  for (int i = 0; i < 32; ++i) {
    if ((buttons >> i & 1u) != 0) text += (text.empty() ? "" : " ") + std::to_string(i + 1);
  }
  return text.empty() ? "-" : text;
}

}  // namespace

std::string FormatHands(const HandSamples& samples) {
  static constexpr const char* kNames[] = {"left", "right", "laparoscope"};
  std::string text;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const device::HandSample& hand = samples[i];
    const auto number = [](double value, std::size_t width) {
      const std::string shown = host::ShownFixed(value, 1);
      return std::string(width - std::min(width, shown.size()), ' ') + shown;
    };
    std::string name = host::Translate(kNames[i]);
    name.resize(std::max<std::size_t>(name.size(), 11), ' ');
    if (!hand.is_valid) {
      text += name + " " + host::Translate("not seen") + "\n";
      continue;
    }
    text += host::TranslateWith("{1} pan {2}  tilt {3}  spin {4}  depth {5}  jaw {6}  buttons {7}",
                                {name, number(kDegrees * hand.pan, 6) + " " + Bar(hand.pan, -1.4, 1.4),
                                 number(kDegrees * hand.tilt, 6) + " " + Bar(hand.tilt, -1.4, 1.4),
                                 number(kDegrees * hand.spin, 7),
                                 number(1e3 * hand.depth, 6) + " mm " + Bar(hand.depth, 0.0, 0.28),
                                 number(kDegrees * hand.jaw, 5) + " " + Bar(hand.jaw, 0.0, 1.05),
                                 FormatButtons(hand.buttons)}) +
            "\n";
  }
  return text;
}

HandPlot::HandPlot() : is_terminal_(::isatty(STDOUT_FILENO) == 1) {}

void HandPlot::Show(const HandSamples& samples, double time) {
  if (!is_terminal_) {
    if (time < next_) return;
    next_ = time + kPrintPeriod;
    host::PrintLines(host::ShownFixed(time, 1) + " s\n" + FormatHands(samples));
    std::fflush(stdout);
    return;
  }
  // back over the last drawing, and wipe each line to its end
  if (is_drawn_) host::WriteControl(stdout, "\033[" + std::to_string(samples.size()) + "A");
  is_drawn_ = true;
  const std::string text = FormatHands(samples);
  for (std::size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
    host::Print(text.substr(at, end - at));
    host::WriteControl(stdout, "\033[K");
    host::PrintLine();
  }
  std::fflush(stdout);
}

}  // namespace trocar::cli
