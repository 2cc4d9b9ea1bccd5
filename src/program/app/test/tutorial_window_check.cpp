// SPDX-License-Identifier: Apache-2.0
/// \file tutorial_window_check.cpp  Does the tutorial's last step from home with real keys, presses the button with which it ends, and
/// plays: what comes after the tutorial is an attempt. Esc leaves full screen's place: here it frees the pointer first.
#include <X11/keysym.h>

#include <filesystem>
#include <optional>
#include <string>
#include <thread>

#include "x_screen.h"

namespace {

using std::chrono::seconds;
using trocar::test::Fail;
using trocar::test::FindField;
using trocar::test::kButtonColour;
using trocar::test::kLongest;
using trocar::test::Place;
using trocar::test::Screen;
using trocar::test::WaitFor;
using trocar::test::WaitForRecording;

bool HasRecording(const Screen& screen) {
  for (const auto& file :
       std::filesystem::directory_iterator(std::filesystem::path(screen.Folder()) / "recordings")) {
    if (file.path().extension() == ".trocar") return true;
  }
  return false;
}

int Check(const Screen& screen) {
  if (!WaitFor(kLongest, [&] { return !screen.Find().empty(); })) return Fail("no window opens");
  const Window window = screen.Find().back();
  screen.Focus(window);
  // the display begins with the pointer where the button will be, which would be drawn as under a pointer
  screen.MovePointer(40, 700);
  std::this_thread::sleep_for(seconds(3));
  screen.Save("1_home.png");
  screen.Press(XK_space);  // the first entry: the tutorial
  std::this_thread::sleep_for(seconds(8));
  screen.Save("2_last_step.png");
  std::optional<Place> button;
  // everything stands still, and goes on: the last step
  if (!WaitFor(kLongest, [&] {
        screen.Press(XK_space);
        std::this_thread::sleep_for(seconds(1));
        screen.Press(XK_space);
        std::this_thread::sleep_for(seconds(1));
        button = FindField(screen.Look(), kButtonColour, 70);
        return button.has_value();
      }))
    return Fail("the tutorial does not end with a button");
  screen.Save("3_done.png");
  if (HasRecording(screen)) return Fail("the tutorial was recorded");
  screen.Click(button->x, button->y);
  if (!WaitForRecording(screen)) return Fail("what comes after the tutorial is no attempt");
  std::this_thread::sleep_for(seconds(7));
  screen.Save("4_attempt.png");
  screen.Press(XK_7);  // asks: an attempt would be thrown away
  std::this_thread::sleep_for(seconds(1));
  screen.Save("5_question.png");
  if (!FindField(screen.Look(), kButtonColour, 60))
    return Fail("the tutorial throws an attempt away without a question");
  screen.Press(XK_Escape);
  screen.Press(XK_q, XK_Control_L);
  std::this_thread::sleep_for(seconds(1));
  if (!screen.Find().empty()) screen.Press(XK_q, XK_Control_L);
  if (!screen.WaitUntilClosed(window)) return Fail("the window does not close");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return trocar::test::RunCheck(argc, argv, Check);
}
