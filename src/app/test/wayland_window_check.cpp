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
// where the small window, 800 x 600 in the display's corner, is clicked, left for, and entered again [pixels]
constexpr unsigned kInside = 350, kBeyond = 1000, kBeside = 200;
constexpr int kDown = 120;  // in the window again [pixels]

void Sleep(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

void Take(trocar::test::WaylandHand& hand, unsigned x, unsigned y) {
  hand.MoveTo(x, y, kWidth, kHeight);
  Sleep(500);
  hand.Click();
  Sleep(1500);
}

void PushAndComeBack(trocar::test::WaylandHand& hand) {
  Take(hand, kWidth - kFromEdge, kHeight / 2);
  hand.MoveBy(kPush, 0, 60);
  Sleep(1500);
  hand.MoveBy(-kPush, 0, 60);
}

void LeaveAndComeBack(trocar::test::WaylandHand& hand) {
  Take(hand, kInside, kInside);
  hand.MoveBy(static_cast<int>(kBeyond - kInside), 0, 60);
  Sleep(1500);
  hand.MoveTo(kBeside, kInside, kWidth, kHeight);
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

/// Prints how far the right hand turned aside at most, and at the end, and how far up or down at the end [mrad].
int Judge(const char* file) {
  const auto recording = trocar::record::ReadRecording(file);
  if (!recording.ok()) return std::fprintf(stderr, "%s\n", recording.error().Text().c_str()), 1;
  if (recording->inputs.empty()) return std::fputs("nothing was recorded\n", stderr), 1;
  const auto hand = [](const auto& input) { return input.hands[trocar::scene::kRight]; };
  const auto first = hand(recording->inputs.front()), last = hand(recording->inputs.back());
  double most = 0;
  for (const auto& input : recording->inputs) most = std::max(most, std::abs(hand(input).pan - first.pan));
  std::printf("%.0f;%.0f;%.0f", 1e3 * most, 1e3 * std::abs(last.pan - first.pan),
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
