// SPDX-License-Identifier: Apache-2.0
/// \file wayland_window_check.cpp  Takes the pointer near the picture's right edge under Wayland, pushes the mouse far to the right and
/// as far back, and says from the recording what the hand did.
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

void Sleep(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

int Use() {
  trocar::test::WaylandHand hand;
  if (!hand.IsThere()) return std::fputs("the display takes no mouse of its own\n", stderr), 1;
  hand.MoveTo(kWidth - kFromEdge, kHeight / 2, kWidth, kHeight);
  Sleep(500);
  hand.Click();
  Sleep(1500);
  hand.MoveBy(kPush, 0, 60);
  Sleep(1500);
  hand.MoveBy(-kPush, 0, 60);
  Sleep(2500);
  return 0;
}

/// Prints how far the right hand turned aside at most, and at the end [mrad].
int Judge(const char* file) {
  const auto recording = trocar::record::ReadRecording(file);
  if (!recording.ok()) return std::fprintf(stderr, "%s\n", recording.error().Text().c_str()), 1;
  if (recording->inputs.empty()) return std::fputs("nothing was recorded\n", stderr), 1;
  const auto pan = [&](const auto& input) { return input.hands[trocar::scene::kRight].pan; };
  const double start = pan(recording->inputs.front());
  double most = 0;
  for (const auto& input : recording->inputs) most = std::max(most, std::abs(pan(input) - start));
  std::printf("%.0f;%.0f", 1e3 * most, 1e3 * std::abs(pan(recording->inputs.back()) - start));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "use") return Use();
  if (argc == 3 && std::string(argv[1]) == "judge") return Judge(argv[2]);
  return std::fputs("wayland_window_check use | judge RECORDING\n", stderr), 2;
}
