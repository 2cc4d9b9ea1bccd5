// SPDX-License-Identifier: Apache-2.0
/// \file tool_tip_check.cpp  Rests the pointer on the buttons of the window that is open and looks how long their tool-tips
/// stay. GTK keeps a tip for as long as the pointer rests on its widget, over whatever lies below it.
#include <chrono>
#include <optional>
#include <thread>

#include "x_screen.h"

namespace {

using trocar::test::Fail;
using trocar::test::Screen;
using trocar::test::WaitFor;

constexpr int kHeaderHeight = 24;                // half of it: the middle of the buttons [pixels]
constexpr int kStep = 20;                        // between two places on the header bar [pixels]
constexpr std::chrono::milliseconds kRest{900};  // GTK shows a tip after half a second
constexpr std::chrono::seconds kLongest{8};      // gui::TipClock::kLongest, and time for a busy computer
constexpr std::chrono::seconds kOpen{60};        // until the window is there

std::optional<Screen::Shown> FindMain(const Screen& screen) {
  for (const Screen::Shown& window : screen.FindAll()) {
    if (window.width >= trocar::test::kLeastWidth) return window;
  }
  return std::nullopt;
}

bool HasTip(const Screen& screen) {
  return screen.FindAll().size() > 1;
}

/// A hand moves over the widgets on its way.
void Rest(const Screen& screen, int x, int y) {
  for (const int dx : {3, 2, 1, 0}) {
    screen.MovePointer(x + dx, y);
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
  }
}

/// Moves the pointer along the header bar until a tip opens. \return where it rests, or nothing
std::optional<int> FindTip(const Screen& screen, const Screen::Shown& main, int from) {
  for (int x = from; x < static_cast<int>(main.width); x += kStep) {
    Rest(screen, main.x + x, main.y + kHeaderHeight);
    if (WaitFor(kRest, [&] { return HasTip(screen); })) return x;
  }
  return std::nullopt;
}

int Check(const Screen& screen) {
  if (!WaitFor(kOpen, [&] { return FindMain(screen).has_value(); })) return Fail("no window opens");
  std::this_thread::sleep_for(std::chrono::seconds(2));  // it is laid out
  const Screen::Shown main = *FindMain(screen);
  const auto first = FindTip(screen, main, kStep);
  if (!first) return Fail("no button of the header bar has a tool-tip");
  // the pointer rests: the tip goes by itself, and stays away
  if (!WaitFor(kLongest, [&] { return !HasTip(screen); })) return Fail("a tool-tip stays open");
  if (WaitFor(std::chrono::seconds(2), [&] { return HasTip(screen); }))
    return Fail("a tool-tip opens again although the pointer has not left");
  // the next visit shows it again, and it goes when the pointer moves into the picture
  const int middle = static_cast<int>(main.height) / 2;
  Rest(screen, main.x + 200, main.y + middle);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  if (!FindTip(screen, main, *first)) return Fail("no tool-tip opens at the second visit");
  Rest(screen, main.x + 200, main.y + middle);
  if (!WaitFor(std::chrono::seconds(2), [&] { return !HasTip(screen); }))
    return Fail("a tool-tip stays open over the picture");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return trocar::test::RunCheck(argc, argv, Check);
}
