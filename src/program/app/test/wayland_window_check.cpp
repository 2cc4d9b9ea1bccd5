// SPDX-License-Identifier: Apache-2.0
/// \file wayland_window_check.cpp  Takes the pointer under Wayland and, by "push", pushes the mouse far to the right and as far back; by
/// "leave", leaves a small window, comes in elsewhere and goes down. Says from the recording what the hand did.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "trocar/record/recording.h"
#include "trocar/scene/scene.h"
#include "wayland_hand.h"

namespace {

constexpr unsigned kWidth = 1280, kHeight = 800;  // of the display
constexpr unsigned kFromEdge = 100;               // of the pointer, when it is taken [pixels]
constexpr int kPush = 400;                        // [pixels]
// the same where the window, at most 1300 wide in the display's corner, is left; where it is clicked and entered again [pixels]
constexpr unsigned kWideWidth = 2000, kBeyond = 1500, kNearRight = 1050, kBeside = 300, kHigh = 350;
constexpr int kDown = 120;        // in the window again [pixels]
constexpr double kTurned = 0.02;  // more is no trembling [rad]

void Sleep(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

void Take(trocar::test::WaylandHand& hand, unsigned x, unsigned y, unsigned width) {
  hand.MoveTo(x, y, width, kHeight);
  Sleep(500);
  hand.Click();
  Sleep(1500);
}

void PushAndComeBack(trocar::test::WaylandHand& hand) {
  Take(hand, kWidth - kFromEdge, kHeight / 2, kWidth);
  hand.MoveBy(kPush, 0, 60);
  Sleep(1500);
  hand.MoveBy(-kPush, 0, 60);
}

void LeaveAndComeBack(trocar::test::WaylandHand& hand) {
  Take(hand, kNearRight, kHigh, kWideWidth);
  hand.MoveBy(static_cast<int>(kBeyond - kNearRight), 0, 60);
  Sleep(1500);
  hand.MoveTo(kBeside, kHigh, kWideWidth, kHeight);
  Sleep(500);
  hand.MoveBy(0, kDown, 40);
}

int Use(void (*move)(trocar::test::WaylandHand&)) {
  trocar::test::WaylandHand hand;
  if (!hand.IsThere()) return std::fputs("the display takes no mouse of its own\n", stderr), 1;
  move(hand);
  Sleep(2500);
  return 0;
}

/// Prints how far the right hand turned to the side to which it went first, at most and at the end, and how far up or down at the
/// end [mrad].
int Judge(const char* file) {
  const auto recording = trocar::record::ReadRecording(file);
  if (!recording.ok()) return std::fprintf(stderr, "%s\n", recording.error().Text().c_str()), 1;
  if (recording->inputs.empty()) return std::fputs("nothing was recorded\n", stderr), 1;
  const auto hand = [](const auto& input) { return input.hands[trocar::instrument::kRight]; };
  const auto first = hand(recording->inputs.front()), last = hand(recording->inputs.back());
  double most = 0, side = 0;
  for (const auto& input : recording->inputs) {
    const double aside = hand(input).pan - first.pan;
    if (side == 0 && std::abs(aside) > kTurned) side = aside > 0 ? 1 : -1;
    most = std::max(most, side * aside);
  }
  std::printf("%.0f;%.0f;%.0f", 1e3 * most, 1e3 * side * (last.pan - first.pan),
              1e3 * std::abs(last.tilt - first.tilt));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (argc == 2 && what == "push") return Use(PushAndComeBack);
  if (argc == 2 && what == "leave") return Use(LeaveAndComeBack);
  if (argc == 3 && what == "judge") return Judge(argv[2]);
  return std::fputs("wayland_window_check push | leave | judge RECORDING\n", stderr), 2;
}
