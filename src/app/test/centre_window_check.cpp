// SPDX-License-Identifier: Apache-2.0
/// \file centre_window_check.cpp  Uses the window as a trainee does, with real keys and clicks: plays a little, finishes, looks at the
/// result, the replay, the history and the course map, and closes everything. Saves a picture of each step.
#include <X11/keysym.h>

#include <cstdio>
#include <optional>
#include <string>
#include <thread>

#include "x_screen.h"

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using trocar::test::Fail;
using trocar::test::kLongest;
using trocar::test::Screen;
using trocar::test::WaitFor;
using trocar::test::WindowPicture;

struct Colour {
  int red, green, blue;
};
// of assets/looks/window.css
constexpr Colour kCaution{0x33, 0x29, 0x0f}, kPassed{0x16, 0x30, 0x1f}, kButton{0x1d, 0x7a, 0x8c},
    kLook{0xff, 0xc2, 0x4d};

int CountColour(const WindowPicture& picture, Colour colour, unsigned right = 0) {
  return picture.Count(0, 0, right > 0 ? right : picture.width, picture.height, [&](const unsigned char* p) {
    return std::abs(p[0] - colour.red) < 3 && std::abs(p[1] - colour.green) < 3 &&
           std::abs(p[2] - colour.blue) < 3;
  });
}

/// The first row and column of a field of the colour.
bool FindField(const WindowPicture& picture, Colour colour, int width, int& x, int& y) {
  for (unsigned row = 60; row < picture.height; ++row) {
    int run = 0;
    for (unsigned column = 0; column < picture.width; ++column) {
      const unsigned char* p = picture.At(column, row);
      const bool is_it = std::abs(p[0] - colour.red) < 3 && std::abs(p[1] - colour.green) < 3 &&
                         std::abs(p[2] - colour.blue) < 3;
      run = is_it ? run + 1 : 0;
      if (run < width) continue;
      x = static_cast<int>(column), y = static_cast<int>(row);
      return true;
    }
  }
  return false;
}

/// Plays a little and finishes. \return the centre's window, or nothing
std::optional<Window> Play(const Screen& screen, Window simulator) {
  screen.Focus(simulator);
  std::this_thread::sleep_for(seconds(6));  // the scene is read
  for (const KeySym key : {XK_i, XK_a, XK_d, XK_w, XK_s, XK_i}) {
    screen.Press(key);
    std::this_thread::sleep_for(milliseconds(500));
  }
  screen.Save("1_operating.png");
  screen.Press(XK_e, XK_Control_L);
  std::optional<Window> centre;
  WaitFor(kLongest, [&] {
    for (const Window window : screen.Find()) {
      if (window != simulator) centre = window;
    }
    return centre.has_value();
  });
  return centre;
}

int LookAround(const Screen& screen, Window centre) {
  screen.Focus(centre);
  if (!WaitFor(kLongest, [&] { return CountColour(screen.Look(), kCaution) > 10000; }))
    return Fail("the result does not come");
  std::this_thread::sleep_for(seconds(3));
  screen.Save("2_result.png");
  if (CountColour(screen.Look(), kPassed) > 500) return Fail("what is not completed is green");
  screen.Press(XK_2, XK_Control_L);
  // the one attempt's outcome, in the colour of what is not completed
  if (!WaitFor(kLongest, [&] {
        const WindowPicture now = screen.Look();
        return CountColour(now, kCaution) == 0 && CountColour(now, kLook) > 40;
      }))
    return Fail("the history shows no attempt");
  screen.Save("3_history.png");
  screen.Press(XK_3, XK_Control_L);
  if (!WaitFor(kLongest, [&] { return CountColour(screen.Look(), kButton) > 900; }))
    return Fail("the course map shows no step that is open");
  std::this_thread::sleep_for(seconds(1));
  screen.Save("4_courses.png");
  screen.Press(XK_5, XK_Control_L);
  std::this_thread::sleep_for(seconds(2));
  screen.Save("5_exam.png");
  screen.Press(XK_F1);
  std::this_thread::sleep_for(seconds(1));
  screen.Save("6_help.png");
  screen.Press(XK_Escape);
  return 0;
}

/// Starts the step that comes next with a click, as a trainee does.
int StartStep(const Screen& screen, Window centre, Window simulator) {
  screen.Focus(centre);
  screen.Press(XK_3, XK_Control_L);
  std::this_thread::sleep_for(seconds(3));
  int x = 0, y = 0;
  // a field as wide as a button: the numbers of the steps are smaller
  if (!FindField(screen.Look(), kButton, 44, x, y)) return Fail("there is no button that starts the step");
  screen.Click(x - 8, y + 8);
  std::this_thread::sleep_for(seconds(8));
  screen.Focus(simulator);
  screen.Save("7_step.png");
  return 0;
}

int Check(Display* display, const char* folder) {
  const Screen screen(display, folder);
  if (!WaitFor(kLongest, [&] { return !screen.Find().empty(); })) return Fail("no window opens");
  const Window simulator = screen.Find().back();
  const auto centre = Play(screen, simulator);
  if (!centre) {
    screen.Save("failed.png");
    return Fail("Finish opens no page");
  }
  int status = LookAround(screen, *centre);
  if (status == 0) status = StartStep(screen, *centre, simulator);
  if (status != 0) {
    screen.Save("failed.png");
    return status;
  }
  screen.Focus(*centre);
  screen.Press(XK_w, XK_Control_L);
  if (!WaitFor(kLongest, [&] { return screen.Find().size() == 1; })) return Fail("the page does not close");
  screen.Focus(simulator);
  screen.Press(XK_q, XK_Control_L);
  if (!WaitFor(kLongest, [&] { return screen.Find().empty(); })) return Fail("the window does not close");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return Fail("usage: centre_window_check FOLDER");
  Display* display = XOpenDisplay(nullptr);
  if (display == nullptr) return Fail("there is no display");
  XSetErrorHandler(trocar::test::IgnoreError);
  const int status = Check(display, argv[1]);
  XCloseDisplay(display);
  return status;
}
