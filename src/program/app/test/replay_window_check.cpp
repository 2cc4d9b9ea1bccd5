// SPDX-License-Identifier: Apache-2.0
/// \file replay_window_check.cpp  Uses the replay window as a person does, with real clicks and keys: goes to a moment, plays,
/// turns the camera, takes over, operates, closes both windows. Saves a picture of each step.
#include <X11/keysym.h>

#include <chrono>
#include <cstdio>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "x_screen.h"

namespace {

using std::chrono::seconds;
using trocar::test::Fail;
using trocar::test::kLongest;
using trocar::test::Place;
using trocar::test::Screen;
using trocar::test::WaitFor;
using trocar::test::WindowPicture;

constexpr int kKnob = 12;  // rows of the bar's knob [pixels]

/// Middle of the bar's knob, among the lowest rows.
std::optional<Place> FindKnob(const WindowPicture& picture) {
  const auto is_knob = [](const unsigned char* p) {
    return p[0] > 228 && p[0] < 244 && p[1] > 234 && p[1] < 248 && p[2] > 238 && p[2] < 252;
  };
  for (unsigned x = 60; x < picture.width; ++x) {
    int run = 0;
    for (unsigned y = picture.height - 110; y < picture.height; ++y) {
      run = is_knob(picture.At(x, y)) ? run + 1 : 0;
      if (run >= kKnob) return Place{static_cast<int>(x) + 3, static_cast<int>(y) - kKnob / 2};
    }
  }
  return std::nullopt;
}

/// Pixels of the laparoscope's picture that differ.
int CountDifferent(const WindowPicture& a, const WindowPicture& b) {
  int count = 0;
  for (unsigned y = a.height / 6; y < a.height * 5 / 6; ++y) {
    for (unsigned x = a.width / 40; x < a.width * 3 / 4; ++x) {
      const unsigned char *p = a.At(x, y), *q = b.At(x, y);
      count += std::abs(p[0] - q[0]) + std::abs(p[1] - q[1]) + std::abs(p[2] - q[2]) > 24 ? 1 : 0;
    }
  }
  return count;
}

bool KnobIsAt(const Screen& screen, int x, int within) {
  const auto knob = FindKnob(screen.Look());
  return knob && std::abs(knob->x - x) <= within;
}

/// Goes to a moment, plays, looks from elsewhere. \return 0, or what Fail() gives
int Watch(const Screen& screen, Window window) {
  std::optional<Place> start;
  if (!WaitFor(kLongest, [&] { return (start = FindKnob(screen.Look())).has_value(); }))
    return Fail("there is no bar");
  std::this_thread::sleep_for(seconds(4));  // the first picture is drawn
  start = FindKnob(screen.Look());
  if (!start) return Fail("the bar is gone");
  const WindowPicture at_start = screen.Look();
  screen.Save("1_start.png");
  screen.Focus(window);
  screen.Click(start->x + 420, start->y);
  if (!WaitFor(kLongest, [&] { return KnobIsAt(screen, start->x + 420, 4); }))
    return Fail("a click on the bar does not go there");
  if (!WaitFor(kLongest, [&] { return CountDifferent(at_start, screen.Look()) > 1500; }))
    return Fail("the picture of another moment is the same");
  std::this_thread::sleep_for(seconds(2));
  screen.Save("2_middle.png");
  screen.Press(XK_space);
  if (!WaitFor(kLongest, [&] { return !KnobIsAt(screen, start->x + 420, 12); }))
    return Fail("it does not play");
  screen.Press(XK_space);
  std::this_thread::sleep_for(seconds(2));
  const auto stopped = FindKnob(screen.Look());
  std::this_thread::sleep_for(seconds(2));
  if (!stopped || !KnobIsAt(screen, stopped->x, 1)) return Fail("it does not pause");
  screen.Press(XK_g);
  screen.Press(XK_c);
  std::this_thread::sleep_for(seconds(1));
  const WindowPicture before = screen.Look();
  screen.Drag(400, 350, 150, -60);
  if (!WaitFor(seconds(20), [&] { return CountDifferent(before, screen.Look()) > 5000; }))
    return Fail("the free camera does not turn");
  screen.Save("3_camera.png");
  screen.Press(XK_c);
  screen.Press(XK_h);
  std::this_thread::sleep_for(seconds(1));
  screen.Save("4_help.png");
  screen.Press(XK_Escape);
  screen.Press(XK_b);
  std::this_thread::sleep_for(seconds(2));
  screen.Save("5_list.png");
  screen.Press(XK_Escape);
  return 0;
}

int Check(const Screen& screen) {
  if (!WaitFor(kLongest, [&] { return !screen.Find().empty(); })) return Fail("no window opens");
  const Window replay = screen.Find().back();
  screen.Focus(replay);
  if (const int status = Watch(screen, replay); status != 0) return status;
  screen.Press(XK_t);
  const auto taken = screen.WaitForOther({replay});
  if (!taken) return Fail("nobody takes over");
  std::this_thread::sleep_for(seconds(3));
  screen.Focus(*taken);
  screen.Save("6_taken_over.png");
  screen.Press(XK_space);  // the hands are ready
  std::this_thread::sleep_for(seconds(4));
  screen.Save("7_operating.png");
  screen.Press(XK_q, XK_Control_L);  // asks
  std::this_thread::sleep_for(seconds(1));
  if (screen.Find().size() > 1) screen.Press(XK_q, XK_Control_L);
  if (!screen.WaitUntilClosed(*taken)) return Fail("the window does not close");
  screen.Focus(replay);
  screen.Press(XK_w, XK_Control_L);
  if (!screen.WaitUntilClosed(replay)) return Fail("the replay does not close");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return trocar::test::RunCheck(argc, argv, Check);
}
