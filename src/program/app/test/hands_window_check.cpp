// SPDX-License-Identifier: Apache-2.0
/// \file hands_window_check.cpp  Works in the window with a mouse and a keyboard alone: takes the first ring of peg transfer, hands
/// it over and sets it down; or closes a clip on a duct. Saves a picture of each step.
#include <cstdio>
#include <string>

#include "hand_driver.h"
#include "trocar/files/task_file.h"

namespace {

using trocar::instrument::kLeft;
using trocar::instrument::kRight;
using trocar::math::Pose;
using trocar::math::Vec3;
using trocar::test::Fail;
using trocar::test::HandDriver;
using trocar::test::kLongest;
using trocar::test::Screen;
using trocar::test::WaitFor;
namespace instrument = trocar::instrument;
namespace math = trocar::math;
namespace files = trocar::files;
namespace scene = trocar::scene;

constexpr double kRim = 0.0095;                 // of the rings [m]
constexpr double kBack = 0.022, kBite = 0.001;  // before, and in a grip [m]
constexpr double kBeyondDuct = 0.005;           // of a clip applier's tip [m]

/// Where open jaws can close across a ring's rim, on one side of it.
Vec3 FindRim(const HandDriver& driver, instrument::Hand hand, const Pose& X_world_ring, const Vec3& side) {
  const Vec3 axis = math::Rotate(X_world_ring.rotation, Vec3{0, 0, 1});
  const Vec3 opening = math::Rotate(driver.Tool(hand).rotation, Vec3{0, 1, 0});
  Vec3 out = math::Normalized(opening - math::Dot(opening, axis) * axis);
  if (math::Dot(out, side) < 0) out = -1.0 * out;
  return X_world_ring.translation + kRim * out;
}

void Grasp(HandDriver& driver, instrument::Hand hand, const Pose& X_world_ring, const Vec3& side) {
  driver.OpenJaws();
  // the direction in which jaws open turns a little with the shaft: twice
  driver.MoveTo(driver.Behind(FindRim(driver, hand, X_world_ring, side), kBack) + Vec3{0, 0, 0.008});
  driver.MoveTo(driver.Behind(FindRim(driver, hand, X_world_ring, side), kBack));
  driver.MoveTo(driver.Behind(FindRim(driver, hand, X_world_ring, side), -kBite));
  driver.CloseJaws();
}

int MoveRing(HandDriver& driver, const Screen& screen, const scene::Scene& scene) {
  const Pose X_world_ring = scene.objects[0].body.X_world_body;
  driver.Choose(kLeft);
  Grasp(driver, kLeft, X_world_ring, {-1, 0, 0});
  screen.Save("2_taken.png");
  const Pose X_left_ring = math::Inverse(driver.Tool(kLeft)) * X_world_ring;
  driver.MoveTo(driver.Tip() + Vec3{0, 0, 0.028});
  driver.MoveTo(driver.FindTip(X_left_ring.translation, {-0.004, 0.020, -0.105}));
  screen.Save("3_lifted.png");
  const Pose X_world_lifted = driver.Tool(kLeft) * X_left_ring;

  driver.Choose(kRight);
  Grasp(driver, kRight, X_world_lifted, {1, 0, 0});
  screen.Save("4_both.png");
  const Pose X_right_ring = math::Inverse(driver.Tool(kRight)) * X_world_lifted;
  driver.Choose(kLeft);
  driver.OpenJaws();
  driver.MoveTo(driver.Behind(driver.Tip(), 0.030));
  screen.Save("5_handed_over.png");

  driver.Choose(kRight);
  const Vec3 peg{0.031, 0.002, -0.1375};
  driver.MoveTo(driver.FindTip(X_right_ring.translation, peg + Vec3{0, 0, 0.030}));
  driver.MoveTo(driver.FindTip(X_right_ring.translation, peg + Vec3{0, 0, 0.012}));
  screen.Save("6_over_the_peg.png");
  driver.OpenJaws();
  driver.MoveTo(driver.Behind(driver.Tip(), 0.025));
  screen.Save("7_set_down.png");
  return 0;
}

int ClipDuct(HandDriver& driver, const Screen& screen, const scene::Scene& scene) {
  const scene::Region& mark = scene.task->regions[0];
  driver.Choose(kRight);
  driver.OpenJaws();
  driver.MoveTo(driver.Behind(mark.centre, 0.025));
  screen.Save("2_before_the_duct.png");
  driver.MoveTo(driver.Behind(mark.centre, -kBeyondDuct));
  screen.Save("3_round_the_duct.png");
  driver.CloseJaws();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  driver.OpenJaws();
  driver.MoveTo(driver.Behind(mark.centre, 0.025));
  screen.Save("4_clipped.png");
  return 0;
}

int Check(Display* display, const std::string& task, const std::string& level, const char* folder) {
  const auto path = files::FindTask(task);
  if (!path.ok()) return Fail(path.error().Text().c_str());
  const auto read = files::ReadTask(*path, {level, 1, {}});
  if (!read.ok()) return Fail(read.error().Text().c_str());
  const Screen screen(display, folder);
  if (!WaitFor(kLongest, [&] { return !screen.Find().empty(); })) return Fail("no window opens");
  screen.Focus(screen.Find().back());
  HandDriver driver(screen, *read);
  std::this_thread::sleep_for(std::chrono::seconds(5));
  if (!WaitFor(kLongest, [&] { return driver.Take(); })) return Fail("there is no picture");
  screen.Save("1_start.png");
  const int status =
      task == "peg_transfer" ? MoveRing(driver, screen, *read) : ClipDuct(driver, screen, *read);
  if (status != 0) return status;
  std::this_thread::sleep_for(std::chrono::seconds(3));
  screen.Save("8_end.png");
  screen.Press(XK_q, XK_Control_L);  // asks
  std::this_thread::sleep_for(std::chrono::seconds(1));
  screen.Save("9_question.png");
  if (screen.Find().empty()) return Fail("an attempt is thrown away without a question");
  screen.Press(XK_q, XK_Control_L);
  if (!WaitFor(kLongest, [&] { return screen.Find().empty(); })) return Fail("the window does not close");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return Fail("usage: hands_window_check TASK LEVEL FOLDER");
  Display* display = XOpenDisplay(nullptr);
  if (display == nullptr) return Fail("there is no display");
  XSetErrorHandler(trocar::test::IgnoreError);
  const int status = Check(display, argv[1], argv[2], argv[3]);
  XCloseDisplay(display);
  return status;
}
