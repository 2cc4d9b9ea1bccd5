// SPDX-License-Identifier: Apache-2.0
/// \file tool_tip_check.cpp  Rests the pointer on the buttons of the window that is open and looks how long their tool-tips
/// stay. GTK keeps a tip for as long as the pointer rests on its widget, over whatever lies below it.
#include <X11/Xlib.h>

#include <chrono>
#include <cstdio>
#include <optional>
#include <thread>
#include <vector>

#include "trocar_test/window_picture.h"

namespace {

using trocar::test::Fail;
using Clock = std::chrono::steady_clock;

constexpr int kHeaderHeight = 24;                // half of it: the middle of the buttons [pixels]
constexpr int kStep = 20;                        // between two places on the header bar [pixels]
constexpr unsigned kLeastWidth = 600;            // of the window: a tip is smaller [pixels]
constexpr std::chrono::milliseconds kRest{900};  // GTK shows a tip after half a second
constexpr std::chrono::seconds kLongest{8};      // gui::TipClock::kLongest, and time for a busy computer
constexpr std::chrono::seconds kOpen{60};        // until the window is there

class Screen {
 public:
  explicit Screen(Display* display) : display_(display) {}

  struct Shown {
    int x, y;
    unsigned width, height;
  };
  /// Windows of the screen that are seen.
  std::vector<Shown> Find() const {
    Window root = DefaultRootWindow(display_), parent = 0, *children = nullptr;
    unsigned count = 0;
    std::vector<Shown> shown;
    if (XQueryTree(display_, root, &root, &parent, &children, &count) == 0) return shown;
    for (unsigned i = 0; i < count; ++i) {
      XWindowAttributes attributes;
      if (XGetWindowAttributes(display_, children[i], &attributes) != 0 &&
          attributes.map_state == IsViewable && attributes.width > 1 && attributes.height > 1)
        shown.push_back({attributes.x, attributes.y, static_cast<unsigned>(attributes.width),
                         static_cast<unsigned>(attributes.height)});
    }
    if (children != nullptr) XFree(children);
    return shown;
  }
  std::optional<Shown> FindMain() const {
    for (const Shown& window : Find()) {
      if (window.width >= kLeastWidth) return window;
    }
    return std::nullopt;
  }
  bool HasTip() const { return Find().size() > 1; }
  void MovePointer(int x, int y) const {
    // a hand moves over the widgets on its way
    for (const int dx : {3, 2, 1, 0}) {
      XWarpPointer(display_, None, DefaultRootWindow(display_), 0, 0, 0, 0, x + dx, y);
      XSync(display_, False);
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
  }

 private:
  Display* display_;
};

/// A window may be gone between two questions.
int Ignore(Display*, XErrorEvent*) {
  return 0;
}

template <typename Is>
bool WaitFor(Clock::duration longest, Is is) {
  for (const auto end = Clock::now() + longest; Clock::now() < end;) {
    if (is()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

/// Moves the pointer along the header bar until a tip opens. \return where it rests, or nothing
std::optional<int> FindTip(const Screen& screen, const Screen::Shown& main, int from) {
  for (int x = from; x < static_cast<int>(main.width); x += kStep) {
    screen.MovePointer(main.x + x, main.y + kHeaderHeight);
    if (WaitFor(kRest, [&] { return screen.HasTip(); })) return x;
  }
  return std::nullopt;
}

int Check(Display* display) {
  const Screen screen(display);
  if (!WaitFor(kOpen, [&] { return screen.FindMain().has_value(); })) return Fail("no window opens");
  std::this_thread::sleep_for(std::chrono::seconds(2));  // it is laid out
  const Screen::Shown main = *screen.FindMain();
  const auto first = FindTip(screen, main, kStep);
  if (!first) return Fail("no button of the header bar has a tool-tip");
  // the pointer rests: the tip goes by itself, and stays away
  if (!WaitFor(kLongest, [&] { return !screen.HasTip(); })) return Fail("a tool-tip stays open");
  if (WaitFor(std::chrono::seconds(2), [&] { return screen.HasTip(); }))
    return Fail("a tool-tip opens again although the pointer has not left");
  // the next visit shows it again, and it goes when the pointer moves into the picture
  const int middle = static_cast<int>(main.height) / 2;
  screen.MovePointer(main.x + 200, main.y + middle);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  if (!FindTip(screen, main, *first)) return Fail("no tool-tip opens at the second visit");
  screen.MovePointer(main.x + 200, main.y + middle);
  if (!WaitFor(std::chrono::seconds(2), [&] { return !screen.HasTip(); }))
    return Fail("a tool-tip stays open over the picture");
  return 0;
}

}  // namespace

int main() {
  Display* display = XOpenDisplay(nullptr);
  if (display == nullptr) return Fail("there is no display");
  XSetErrorHandler(Ignore);
  const int status = Check(display);
  XCloseDisplay(display);
  return status;
}
