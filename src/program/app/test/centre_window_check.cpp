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
using trocar::test::CountColour;
using trocar::test::Fail;
using trocar::test::FindField;
using trocar::test::kButtonColour;
using trocar::test::kCautionColour;
using trocar::test::kLongest;
using trocar::test::kLookColour;
using trocar::test::kPassedColour;
using trocar::test::Screen;
using trocar::test::WaitFor;
using trocar::test::WindowPicture;

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
  return screen.WaitForOther({simulator});
}

int LookAround(const Screen& screen, Window centre) {
  screen.Focus(centre);
  if (!WaitFor(kLongest, [&] { return CountColour(screen.Look(), kCautionColour) > 10000; }))
    return Fail("the result does not come");
  std::this_thread::sleep_for(seconds(3));
  screen.Save("2_result.png");
  if (CountColour(screen.Look(), kPassedColour) > 500) return Fail("what is not completed is green");
  screen.Press(XK_2, XK_Control_L);
  // the one attempt's outcome, in the colour of what is not completed
  if (!WaitFor(kLongest, [&] {
        const WindowPicture now = screen.Look();
        return CountColour(now, kCautionColour) == 0 && CountColour(now, kLookColour) > 40;
      }))
    return Fail("the history shows no attempt");
  screen.Save("3_history.png");
  screen.Press(XK_3, XK_Control_L);
  if (!WaitFor(kLongest, [&] { return CountColour(screen.Look(), kButtonColour) > 900; }))
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
  // a field as wide as a button: the numbers of the steps are smaller
  const auto button = FindField(screen.Look(), kButtonColour, 44);
  if (!button) return Fail("there is no button that starts the step");
  screen.Click(button->x, button->y);
  std::this_thread::sleep_for(seconds(8));
  screen.Focus(simulator);
  screen.Press(XK_space);  // the hands are ready
  std::this_thread::sleep_for(seconds(4));
  screen.Save("7_step.png");
  screen.Press(XK_e, XK_Control_L);
  std::this_thread::sleep_for(seconds(1));
  screen.Focus(centre);
  if (!WaitFor(kLongest, [&] { return CountColour(screen.Look(), kCautionColour) > 10000; }))
    return Fail("the step's result does not come");
  screen.Save("8_step_result.png");
  return 0;
}

int Check(const Screen& screen) {
  if (!WaitFor(kLongest, [&] { return !screen.Find().empty(); })) return Fail("no window opens");
  const Window simulator = screen.Find().back();
  const auto centre = Play(screen, simulator);
  if (!centre) return Fail("Finish opens no page");
  if (const int status = LookAround(screen, *centre); status != 0) return status;
  if (const int status = StartStep(screen, *centre, simulator); status != 0) return status;
  screen.Focus(*centre);
  screen.Press(XK_w, XK_Control_L);
  if (!screen.WaitUntilClosed(*centre)) return Fail("the page does not close");
  screen.Focus(simulator);
  screen.Press(XK_q, XK_Control_L);
  if (!screen.WaitUntilClosed(simulator)) return Fail("the window does not close");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return trocar::test::RunCheck(argc, argv, Check);
}
