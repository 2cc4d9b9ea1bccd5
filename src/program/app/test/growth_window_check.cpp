// SPDX-License-Identifier: Apache-2.0
/// \file growth_window_check.cpp  Lets the liver grow in the contour window as a person does, with real clicks and keys: by the button
/// in the header bar, by the key, given up, taken back; then saves and closes. Saves a picture of each step.
#include <X11/keysym.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>

#include "x_screen.h"

namespace {

using std::chrono::seconds;
using trocar::test::Fail;
using trocar::test::kLongest;
using trocar::test::Place;
using trocar::test::Screen;
using trocar::test::WaitFor;
using trocar::test::WindowPicture;

/// Columns of the canvas that are looked at [pixels]; the panel lies beside it.
constexpr unsigned kLeft = 0, kRight = 900, kTop = 60, kBottom = 740;

constexpr int kLeastCurve = 60;  // [pixels]

/// Whether a pixel has the green of a spline, over grey.
bool IsCurve(const unsigned char* p) {
  return p[1] > 150 && p[1] > p[0] + 70 && p[1] > p[2] + 40;
}
int CountCurve(const WindowPicture& picture) {
  int count = 0;
  for (unsigned y = kTop; y < kBottom; ++y) {
    for (unsigned x = kLeft; x < kRight; ++x) count += IsCurve(picture.At(x, y));
  }
  return count;
}

/// The middle of the largest area of one light grey left of the picture's middle: the liver, as radiology shows it.
std::optional<Place> FindLiver(const WindowPicture& picture) {
  const auto is_liver = [&](unsigned x, unsigned y) {
    const unsigned char* p = picture.At(x, y);
    return p[0] > 130 && p[0] < 200 && std::abs(p[0] - p[1]) < 12 && std::abs(p[1] - p[2]) < 12;
  };
  std::optional<Place> best;
  int most = 0;
  for (unsigned y = kTop + 40; y < kBottom - 40; y += 8) {
    for (unsigned x = kLeft + 100; x < kRight / 2; x += 8) {
      int count = 0;
      for (int dy = -32; dy <= 32; dy += 4) {
        for (int dx = -32; dx <= 32; dx += 4)
          count += is_liver(static_cast<unsigned>(static_cast<int>(x) + dx),
                            static_cast<unsigned>(static_cast<int>(y) + dy));
      }
      if (count > most) most = count, best = Place{static_cast<int>(x), static_cast<int>(y)};
    }
  }
  return most > 230 ? best : std::nullopt;
}

bool WaitForCurve(const Screen& screen, bool is_there) {
  // the first slice that shows the organ, where doing it again leads, shows little of it
  return WaitFor(kLongest, [&] { return (CountCurve(screen.Look()) > kLeastCurve) == is_there; });
}

int Check(const Screen& screen) {
  const auto window = screen.WaitForOther({});
  if (!window) return Fail("the window does not open");
  std::optional<Place> liver;
  if (!WaitFor(kLongest, [&] { return (liver = FindLiver(screen.Look())).has_value(); }))
    return Fail("no liver is seen");
  screen.Focus(*window);
  screen.Save("1_opened.png");
  // the key, then a click into air: a line says what to do
  screen.Press(XK_g, XK_Shift_L);
  screen.Save("2_pointing.png");
  screen.Click(40, 700);
  std::this_thread::sleep_for(seconds(4));
  screen.Save("3_refused.png");
  if (CountCurve(screen.Look()) > kLeastCurve) return Fail("something grew from a click into air");
  // into the liver, given up at once
  screen.Press(XK_g, XK_Shift_L);
  screen.Click(liver->x, liver->y);
  screen.Press(XK_Escape);
  std::this_thread::sleep_for(seconds(4));
  screen.Save("4_given_up.png");
  if (CountCurve(screen.Look()) > kLeastCurve) return Fail("what was given up has grown");
  // and to the end
  screen.Press(XK_g, XK_Shift_L);
  screen.Click(liver->x, liver->y);
  if (!WaitForCurve(screen, true)) return Fail("the liver does not grow");
  std::this_thread::sleep_for(seconds(2));
  screen.Save("5_grown.png");
  screen.Press(XK_z, XK_Control_L);
  if (!WaitForCurve(screen, false)) return Fail("one step does not take it back");
  screen.Press(XK_y, XK_Control_L);
  if (!WaitForCurve(screen, true)) return Fail("it cannot be done again");
  screen.Press(XK_s, XK_Control_L);
  const std::string file = screen.Folder() + "/points.json";
  if (!WaitFor(kLongest, [&] { return std::filesystem::exists(file); })) return Fail("it is not saved");
  std::this_thread::sleep_for(seconds(1));
  screen.Press(XK_q, XK_Control_L);
  if (!screen.WaitUntilClosed(*window)) return Fail("the window does not close");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return trocar::test::RunCheck(argc, argv, Check);
}
