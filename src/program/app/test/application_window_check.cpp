// SPDX-License-Identifier: Apache-2.0
/// \file application_window_check.cpp  Finds its way from home with keys and clicks alone: changes a key, makes a patient, and
/// operates on it; or, where that patient has vanished since, is told so at home.
#include <X11/keysym.h>

#include <filesystem>
#include <string>
#include <thread>

#include "x_screen.h"

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using trocar::test::Colour;
using trocar::test::CountColour;
using trocar::test::Fail;
using trocar::test::FindField;
using trocar::test::kButtonColour;
using trocar::test::kLongest;
using trocar::test::kLookColour;
using trocar::test::Screen;
using trocar::test::WaitFor;
using trocar::test::WaitForRecording;
namespace fs = std::filesystem;

constexpr Colour kProblemColour{0xff, 0x8a, 0x7e};

/// The card's first three things are the mouse buttons; then comes the key of the left hand.
int ChangeAKey(const Screen& screen) {
  screen.Press(XK_k, XK_Control_L);
  std::this_thread::sleep_for(seconds(1));
  screen.Save("2_keys.png");
  if (CountColour(screen.Look(), kLookColour) > 20) return Fail("keys are in conflict at first");
  screen.PressTimes(XK_Tab, 3);
  screen.Press(XK_space);
  std::this_thread::sleep_for(milliseconds(500));
  screen.Press(XK_m);  // which switches the round mask
  if (!WaitFor(kLongest, [&] { return CountColour(screen.Look(), kLookColour) > 40; }))
    return Fail("a conflict of keys is not said");
  screen.Save("3_conflict.png");
  screen.Press(XK_Escape);
  std::this_thread::sleep_for(seconds(1));
  return 0;
}

int MakeAPatient(const Screen& screen) {
  screen.Press(XK_p, XK_Control_L);
  std::optional<trocar::test::Place> button;
  if (!WaitFor(kLongest, [&] {
        button = FindField(screen.Look(), kButtonColour, 44);
        return button.has_value();
      }))
    return Fail("there is no button that makes a patient");
  std::this_thread::sleep_for(seconds(4));  // the list is read, and the picture drawn
  screen.Save("4_patients.png");
  button = FindField(screen.Look(), kButtonColour, 44);
  screen.Click(button->x, button->y);
  std::this_thread::sleep_for(milliseconds(700));
  screen.Save("5_made.png");
  const fs::path patient = fs::path(screen.Folder()) / "data" / "patients" / "seed-1" / "patient.json";
  if (!WaitFor(kLongest, [&] { return fs::exists(patient); })) return Fail("no patient was made");
  std::this_thread::sleep_for(seconds(5));
  screen.Save("6_chosen.png");
  screen.Press(XK_Escape);
  std::this_thread::sleep_for(seconds(1));
  screen.Save("7_home.png");
  return 0;
}

/// From home: the third entry is the operation, as long as nothing has been trained; the first row of its list is the whole.
void StartTheOperation(const Screen& screen, int entries) {
  screen.PressTimes(XK_Tab, entries);
  screen.Press(XK_space);
  std::this_thread::sleep_for(seconds(2));
  screen.Save("8_operation.png");
  screen.Press(XK_Tab);  // past the level
  screen.Press(XK_space);
}

int Operate(const Screen& screen) {
  StartTheOperation(screen, 2);
  if (!WaitForRecording(screen)) return Fail("the operation does not begin");
  std::this_thread::sleep_for(seconds(6));
  screen.Save("9_operating.png");
  return 0;
}

/// Esc and the Home key alone, and the file of the patient is no more.
int MeetTheVanished(const Screen& screen) {
  screen.Save("2_home.png");
  if (CountColour(screen.Look(), kProblemColour) > 40)
    return Fail("there is a problem before anything was asked");
  StartTheOperation(screen, 3);  // Continue is there now, too
  if (!WaitFor(kLongest, [&] { return CountColour(screen.Look(), kProblemColour) > 100; }))
    return Fail("nobody says that the patient has vanished");
  screen.Save("3_vanished.png");
  return 0;
}

int Check(const Screen& screen) {
  if (!WaitFor(kLongest, [&] { return !screen.Find().empty(); })) return Fail("no window opens");
  const Window window = screen.Find().back();
  screen.Focus(window);
  std::this_thread::sleep_for(seconds(3));
  screen.Save("1_start.png");
  if (fs::exists(fs::path(screen.Folder()) / "vanished")) {
    if (const int status = MeetTheVanished(screen); status != 0) return status;
  } else {
    for (const auto step : {ChangeAKey, MakeAPatient, Operate}) {
      if (const int status = step(screen); status != 0) return status;
    }
  }
  screen.Press(XK_q, XK_Control_L);
  std::this_thread::sleep_for(seconds(1));
  if (!screen.Find().empty()) screen.Press(XK_q, XK_Control_L);  // it asks where an attempt would be lost
  if (!screen.WaitUntilClosed(window)) return Fail("the window does not close");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return trocar::test::RunCheck(argc, argv, Check);
}
