// SPDX-License-Identifier: Apache-2.0
/// \file rehearsal_window_check.cpp  Goes from images to an operation with clicks and keys alone: from home to the list of patients, a series, a
/// label map, the built patient, a port that is moved, taken back and moved again; then the window closes. The second time it goes on
/// there and operates.
#include <X11/keysym.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "x_screen.h"

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using trocar::test::Fail;
using trocar::test::kButtonColour;
using trocar::test::kLongest;
using trocar::test::Place;
using trocar::test::Screen;
using trocar::test::WaitFor;
using trocar::test::WaitForRecording;
using trocar::test::WindowPicture;
namespace fs = std::filesystem;

/// The button that leads on, in the line at the bottom; nothing while it does not lead on.
std::optional<Place> FindNext(const WindowPicture& picture) {
  constexpr unsigned kFoot = 90;  // [pixels]
  constexpr int kLeast = 44;
  for (unsigned y = picture.height; y-- > picture.height - kFoot;) {
    int run = 0;
    for (unsigned x = 0; x < picture.width; ++x) {
      run = kButtonColour.Is(picture.At(x, y)) ? run + 1 : 0;
      if (run >= kLeast) return Place{static_cast<int>(x) - kLeast / 2, static_cast<int>(y) - 8};
    }
  }
  return std::nullopt;
}

bool WaitForNext(const Screen& screen) {
  return WaitFor(kLongest, [&] { return FindNext(screen.Look()).has_value(); });
}

void GoOn(const Screen& screen) {
  const auto next = FindNext(screen.Look());
  if (next) screen.Click(next->x, next->y);
  screen.MovePointer(20, 400);  // under the pointer the button has another colour
  std::this_thread::sleep_for(seconds(1));
}

/// What is kept of it so far.
std::string ReadState(const Screen& screen) {
  std::ifstream file(fs::path(screen.Folder()) / "data" / "rehearsal" / "rehearsal.json");
  return {std::istreambuf_iterator<char>(file), {}};
}
bool Says(const Screen& screen, const std::string& text) {
  return ReadState(screen).find(text) != std::string::npos;
}

/// From the list of patients: past the built-in one, the seed, and two buttons. \param entries  patients in it
void OpenFromImages(const Screen& screen, int entries) {
  screen.Press(XK_p, XK_Control_L);
  std::this_thread::sleep_for(seconds(5));  // the list is read, and pictures are drawn
  screen.Save("2_patients.png");
  screen.PressTimes(XK_Tab, 3 + entries);
  screen.Press(XK_space);
  std::this_thread::sleep_for(seconds(2));
}

/// An item of a list that is closed.
void ChooseItem(const Screen& screen, int index) {
  screen.Press(XK_space);
  std::this_thread::sleep_for(milliseconds(500));
  screen.PressTimes(XK_Down, index);
  screen.Press(XK_Return);
  std::this_thread::sleep_for(milliseconds(500));
}

int ChooseImages(const Screen& screen) {
  screen.Save("3_images.png");
  screen.Type(screen.Folder() + "/nothing");
  screen.Press(XK_Return);
  std::this_thread::sleep_for(seconds(2));
  screen.Save("3_nothing.png");
  screen.Press(XK_a, XK_Control_L);
  screen.Type(screen.Folder() + "/phantom/slices");
  screen.Press(XK_Return);
  if (!WaitFor(kLongest, [&] { return Says(screen, "\"series\""); }))
    return Fail("the pictures are not found");
  std::this_thread::sleep_for(seconds(2));
  screen.Save("3_sizes.png");
  if (FindNext(screen.Look())) return Fail("it leads on though nobody knows how large the patient is");
  screen.Type("2");
  screen.Press(XK_Tab);
  screen.Type("3");
  for (const int direction : {1, 4, 6}) {
    screen.Press(XK_Tab);
    ChooseItem(screen, direction);
  }
  screen.Save("3_answered.png");
  screen.Press(XK_Tab);
  screen.Press(XK_space);
  if (!WaitForNext(screen)) return Fail("the series does not open");
  if (!Says(screen, "\"inferior\"")) return Fail("what was said of the pictures is not kept");
  std::this_thread::sleep_for(seconds(1));
  // the wheel goes through the slices
  screen.MovePointer(450, 400);
  const WindowPicture before = screen.Look();
  for (int i = 0; i < 8; ++i) screen.Turn(-1);
  std::this_thread::sleep_for(seconds(1));
  screen.Save("4_slices.png");
  if (before.pixels == screen.Look().pixels) return Fail("the slices cannot be looked through");
  GoOn(screen);
  return 0;
}

int ChooseLabels(const Screen& screen) {
  if (!WaitFor(kLongest, [&] { return Says(screen, "\"step\": \"organs\""); }))
    return Fail("no step of organs");
  std::this_thread::sleep_for(seconds(1));
  screen.Save("5_organs.png");
  screen.Type(screen.Folder() + "/phantom/labels.nrrd");
  screen.Press(XK_Return);
  if (!WaitForNext(screen)) return Fail("the label map is not taken");
  std::this_thread::sleep_for(seconds(1));
  screen.Save("6_overlay.png");
  GoOn(screen);
  return 0;
}

int Build(const Screen& screen) {
  screen.Save("7_building.png");
  if (!WaitFor(kLongest, [&] { return Says(screen, "built_from"); })) return Fail("no patient is built");
  if (!WaitForNext(screen)) return Fail("the patient does not lead on");
  std::this_thread::sleep_for(seconds(2));
  screen.Save("8_patient.png");
  const WindowPicture before = screen.Look();
  screen.Drag(400, 400, 120, 40);
  std::this_thread::sleep_for(seconds(1));
  if (before.pixels == screen.Look().pixels) return Fail("the patient does not turn");
  GoOn(screen);
  return 0;
}

int MovePorts(const Screen& screen) {
  if (!WaitFor(kLongest, [&] { return Says(screen, "\"step\": \"ports\""); }))
    return Fail("no step of ports");
  std::this_thread::sleep_for(seconds(2));
  screen.Save("9_ports.png");
  screen.Press(XK_Down);
  if (!WaitFor(seconds(10), [&] { return Says(screen, "by hand"); })) return Fail("the port does not move");
  screen.Press(XK_z, XK_Control_L);
  if (!WaitFor(seconds(10), [&] { return !Says(screen, "\"plan\""); }))
    return Fail("undo does not bring it back");
  screen.Press(XK_Down);
  if (!WaitFor(seconds(10), [&] { return Says(screen, "by hand"); }))
    return Fail("the port does not move again");
  screen.Save("10_moved.png");
  return 0;
}

int Operate(const Screen& screen) {
  if (!WaitForNext(screen)) return Fail("it does not go on where it was left");
  std::this_thread::sleep_for(seconds(2));
  screen.Save("11_again.png");
  if (!Says(screen, "\"step\": \"ports\"") || !Says(screen, "by hand")) return Fail("what was done is lost");
  GoOn(screen);
  std::this_thread::sleep_for(seconds(1));
  screen.Save("12_operate.png");
  GoOn(screen);
  if (!WaitForRecording(screen)) return Fail("the operation does not begin");
  std::this_thread::sleep_for(seconds(8));
  screen.Save("13_operating.png");
  return 0;
}

int Check(const Screen& screen) {
  if (!WaitFor(kLongest, [&] { return !screen.Find().empty(); })) return Fail("no window opens");
  const Window window = screen.Find().back();
  screen.Focus(window);
  std::this_thread::sleep_for(seconds(3));
  screen.Save("1_home.png");
  OpenFromImages(screen, 1);
  if (fs::exists(fs::path(screen.Folder()) / "again")) {
    if (const int status = Operate(screen); status != 0) return status;
  } else {
    for (const auto step : {ChooseImages, ChooseLabels, Build, MovePorts}) {
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
