// SPDX-License-Identifier: Apache-2.0
/// \file haptic_victim.cpp  A haptic loop that presses tissue, to be killed or stopped: force goes out on the file
/// whose descriptor is named. Asks for force at every byte on its standard input; ends with it.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "trocar/device/simulated_force_device.h"
#include "trocar/session/haptic_loop.h"

int main(int argument_count, char** arguments) {
  using namespace trocar;
  using namespace trocar::session;
  if (argument_count != 3) return 2;  // DESCRIPTOR SUPERVISOR
  device::SimulatedForceSettings simulated;
  simulated.wire = std::atoi(arguments[1]);
  // nobody but this process and the supervisor holds the wire open
  if (::fcntl(simulated.wire, F_SETFD, FD_CLOEXEC) != 0) return 3;
  simulated.path = [](int, double) { return Vec3{}; };
  auto device = std::make_unique<device::SimulatedForceDevice>(simulated);
  device::SimulatedForceDevice& buttons = *device;
  HapticLoopSettings settings;
  settings.supervisor = arguments[2];
  settings.hands.emplace_back();
  settings.hands[0].p_world_port = {0, 0, 0.15};
  HapticLink link;
  auto loop = HapticLoop::Start(std::move(device), settings, link);
  if (!loop) {
    std::puts(loop.error().Text().c_str());
    return 4;
  }
  bool has_ended = false;
  for (int i = 0; !has_ended; ++i) {
    // tissue that presses once force is on; the check pose, then the safety switch held for good
    const bool is_on = (*loop)->Latest().hands[kRight].state != haptics::ArmState::kUnarmed;
    auto& patch = link.patches[kRight].Back();
    patch.kind = haptics::LocalPatch::Kind::kLinear;
    patch.is_healthy = true;
    patch.force = {is_on ? 2.0 : 0.0, 0, 0};
    link.patches[kRight].Publish();
    if (i == 10) (*loop)->BeginCheckPose();
    buttons.SetButtons(0, i > 30 ? 1 : 0);
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, 0) > 0) {
      char asked[16];
      has_ended = ::read(STDIN_FILENO, asked, sizeof asked) <= 0;
      if ((*loop)->Latest().check_pose == haptics::CheckPoseState::kConfirmed) (*loop)->RequestArm();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(8));
  }
  return 0;
}
