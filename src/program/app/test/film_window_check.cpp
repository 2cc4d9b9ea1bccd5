// SPDX-License-Identifier: Apache-2.0
/// \file film_window_check.cpp  Saves a picture and a clip from the replay window with real keys, begins another clip and closes the
/// window while it is being made.
#include <X11/keysym.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "x_screen.h"

namespace {

namespace fs = std::filesystem;
constexpr std::chrono::seconds kClipAtMost{
    240};  // 90 pictures by a busy processor, beside a window that draws
using std::chrono::seconds;
using trocar::test::Fail;
using trocar::test::kLongest;
using trocar::test::Screen;
using trocar::test::WaitFor;

int CountFiles(const std::string& part_of_name) {
  const char* data = std::getenv("TROCAR_DATA_HOME");
  int count = 0;
  std::error_code ignored;
  for (const auto& entry :
       fs::directory_iterator(fs::path(data == nullptr ? "" : data) / "pictures", ignored))
    count += entry.path().filename().string().find(part_of_name) != std::string::npos ? 1 : 0;
  return count;
}
bool IsBeingMade() {
  return CountFiles(".webm.part") > 0;
}
int CountClips() {
  return CountFiles(".webm") - CountFiles(".webm.part");
}

int Check(const Screen& screen) {
  if (!WaitFor(kLongest, [&] { return !screen.Find().empty(); })) return Fail("no window opens");
  const Window replay = screen.Find().back();
  std::this_thread::sleep_for(seconds(8));  // the first picture is drawn
  screen.Focus(replay);
  screen.Press(XK_s, XK_Control_L);
  if (!WaitFor(kLongest, [&] { return CountFiles(".png") == 1; })) return Fail("no picture is saved");
  screen.Press(XK_End);
  std::this_thread::sleep_for(seconds(3));
  screen.Press(XK_m, XK_Control_L);
  if (!WaitFor(kLongest, [&] { return IsBeingMade(); })) return Fail("no clip is begun");
  screen.Save("1_progress.png");
  if (!WaitFor(kClipAtMost, [&] { return CountClips() == 1 && !IsBeingMade(); }))
    return Fail("no clip is finished");
  screen.Save("2_saved.png");
  screen.Press(XK_m, XK_Control_L);
  if (!WaitFor(kLongest, [&] { return IsBeingMade(); })) return Fail("no second clip is begun");
  screen.Press(XK_w, XK_Control_L);
  if (!screen.WaitUntilClosed(replay)) return Fail("the window does not close while a clip is being made");
  if (!WaitFor(kLongest, [&] { return !IsBeingMade(); })) return Fail("half a clip was left");
  return CountClips() == 1 ? 0 : Fail("the clip that was given up was written");
}

}  // namespace

int main(int argc, char** argv) {
  return trocar::test::RunCheck(argc, argv, Check);
}
