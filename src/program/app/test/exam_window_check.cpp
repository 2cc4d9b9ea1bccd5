// SPDX-License-Identifier: Apache-2.0
/// \file exam_window_check.cpp  Sits an exam as an examinee does, with real keys and clicks, and issues its certificate as the
/// examiner does: with a wrong passphrase, which signs nothing, and then with the key's own. Saves a picture of each step.
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>

#include "x_screen.h"

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using trocar::test::Fail;
using trocar::test::FindField;
using trocar::test::kButtonColour;
using trocar::test::kLongest;
using trocar::test::Place;
using trocar::test::Screen;
using trocar::test::WaitFor;

constexpr int kButtonWidth = 44;    // the least of a button that may be pressed [pixels]
constexpr int kToPassphrase = 150;  // from the button to the middle of the field at its left [pixels]

std::optional<Place> WaitForButton(const Screen& screen) {
  std::optional<Place> button;
  WaitFor(kLongest,
          [&] { return (button = FindField(screen.Look(), kButtonColour, kButtonWidth)).has_value(); });
  return button;
}

/// Starts the exam, moves the hands a little, and finishes. \return the simulator's window, or nothing
std::optional<Window> Sit(const Screen& screen, Window centre) {
  const auto start = WaitForButton(screen);
  if (!start) return std::nullopt;
  std::this_thread::sleep_for(seconds(1));
  screen.Save("1_sealed.png");
  screen.Click(start->x, start->y);
  const auto simulator = screen.WaitForOther({centre});
  if (!simulator) return std::nullopt;
  std::this_thread::sleep_for(seconds(6));  // the scene is read
  screen.Focus(*simulator);
  screen.Press(XK_space);  // the hands are ready
  for (const KeySym key : {XK_i, XK_a, XK_d, XK_w, XK_s, XK_i}) {
    screen.Press(key);
    std::this_thread::sleep_for(milliseconds(500));
  }
  screen.Save("2_sitting.png");
  screen.Press(XK_e, XK_Control_L);
  return simulator;
}

/// Answers a dialog that asks for a file. \return false where none opens or it stays
bool ChooseFile(const Screen& screen, const std::vector<Window>& known, const std::string& path,
                const char* picture) {
  const auto dialog = screen.WaitForOther(known);
  if (!dialog) return false;
  std::this_thread::sleep_for(seconds(1));
  screen.Focus(*dialog);
  screen.Press(XK_a, XK_Control_L);  // in place of the proposed name
  screen.Type(path);
  std::this_thread::sleep_for(seconds(1));
  screen.Save(picture);
  screen.Press(XK_Return);
  if (screen.WaitUntilClosed(*dialog, seconds(5))) return true;
  screen.Press(XK_Return);  // the first closed the list of names that it completes
  return screen.WaitUntilClosed(*dialog);
}

/// Asks for a certificate with this passphrase. \return false where a dialog does not open
bool Issue(const Screen& screen, Window centre, Window simulator, const std::string& passphrase,
           const std::string& certificate) {
  screen.Focus(centre);
  const auto issue = WaitForButton(screen);
  if (!issue) return false;
  screen.Click(issue->x - kToPassphrase, issue->y);
  std::this_thread::sleep_for(milliseconds(500));
  screen.Type(passphrase);
  screen.Click(issue->x, issue->y);
  return ChooseFile(screen, {centre, simulator}, screen.Folder() + "/centre.key", "3_key.png") &&
         ChooseFile(screen, {centre, simulator}, certificate, "4_certificate.png");
}

int Check(const Screen& screen) {
  if (!WaitFor(kLongest, [&] { return !screen.Find().empty(); })) return Fail("no window opens");
  const Window centre = screen.Find().back();
  screen.Focus(centre);
  const auto simulator = Sit(screen, centre);
  if (!simulator) return Fail("the exam does not start");
  std::this_thread::sleep_for(seconds(3));
  const std::string certificate = screen.Folder() + "/certificate.json";
  if (!Issue(screen, centre, *simulator, "seven grey herons", certificate))
    return Fail("nobody asks for key and certificate");
  std::this_thread::sleep_for(seconds(4));
  screen.Focus(centre);
  screen.Save("5_wrong_passphrase.png");
  if (std::filesystem::exists(certificate)) return Fail("a wrong passphrase signs");
  if (!Issue(screen, centre, *simulator, "seven green herons", certificate))
    return Fail("nobody asks for key and certificate a second time");
  if (!WaitFor(kLongest, [&] { return std::filesystem::exists(certificate); }))
    return Fail("no certificate is written");
  std::this_thread::sleep_for(seconds(2));
  screen.Focus(centre);
  screen.Save("6_issued.png");
  screen.Focus(*simulator);
  screen.Press(XK_q, XK_Control_L);
  if (!screen.WaitUntilClosed(*simulator)) return Fail("the simulator does not close");
  screen.Focus(centre);
  screen.Press(XK_w, XK_Control_L);
  if (!screen.WaitUntilClosed(centre)) return Fail("the page does not close");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return trocar::test::RunCheck(argc, argv, Check);
}
