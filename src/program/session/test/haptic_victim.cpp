// SPDX-License-Identifier: Apache-2.0
/// \file haptic_victim.cpp  A haptic loop that presses tissue, to be killed, stopped or hung, with one device of a kind:
///
///     haptic_victim SUPERVISOR simulated DESCRIPTOR    force goes out on that file
///     haptic_victim SUPERVISOR openhaptics LIBRARY     a stand-in, whose button it holds itself
///     haptic_victim SUPERVISOR haply PORT              a service, which holds the button
///
/// Asks for force at every 'a' on its standard input, lets its loop hang at an 'h', and ends with it.
#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>

#include "stand_in_hd.h"
#include "trocar/device/haply.h"
#include "trocar/device/open_haptics.h"
#include "trocar/device/simulated_force_device.h"
#include "trocar/device/tcp_port.h"
#include "trocar/session/haptic_loop.h"

namespace {

using namespace trocar;
using namespace trocar::session;

std::atomic<bool> is_hanging{false};
/// Called in the loop's thread.
std::uint64_t HangIfTold() noexcept {
  while (is_hanging) {
  }
  return 0;
}

StandInState* FindStandIn() {
  const char* path = std::getenv(kStandInPage);
  const int file = ::open(path != nullptr ? path : "", O_RDWR | O_CLOEXEC);
  void* memory = ::mmap(nullptr, sizeof(StandInState), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  return memory == MAP_FAILED ? nullptr : static_cast<StandInState*>(memory);
}

struct Device {
  std::unique_ptr<device::ForceDriver> driver;
  std::function<void(bool is_held)> hold = [](bool) {};
};

Device MakeDevice(const std::string& kind, const std::string& word, const char* supervisor) {
  if (kind == "simulated") {
    device::SimulatedForceSettings settings;
    settings.wire = std::stoi(word);
    settings.path = [](int, double) { return math::Vec3{}; };
    auto made = std::make_unique<device::SimulatedForceDevice>(settings);
    device::SimulatedForceDevice& simulated = *made;
    return {std::move(made), [&simulated](bool is_held) { simulated.SetButtons(0, is_held ? 1 : 0); }};
  }
  if (kind == "openhaptics") {
    StandInState* const motors = FindStandIn();
    if (motors == nullptr) return {};
    motors->is_led = 1;
    device::OpenHapticsSettings settings;
    settings.hd_file = word;
    settings.names = {"Right"};
    settings.host = supervisor;
    return {std::make_unique<device::OpenHaptics>(settings),
            [motors](bool is_held) { motors->buttons[0] = is_held ? 1 : 0; }};
  }
  if (kind == "haply") {
    const int port = std::stoi(word);
    return {std::make_unique<device::Haply>(device::HaplySettings{},
                                            [port] { return device::ConnectTcp("127.0.0.1", port); })};
  }
  return {};
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 4) return 2;
  Device device = MakeDevice(arguments[2], arguments[3], arguments[1]);
  if (device.driver == nullptr) return 3;
  // nobody but this process and the supervisor holds the wire open
  if (std::string(arguments[2]) == "simulated") ::fcntl(std::atoi(arguments[3]), F_SETFD, FD_CLOEXEC);
  HapticLoopSettings settings;
  settings.supervisor = arguments[1];
  settings.hands.emplace_back();
  settings.hands[0].p_world_port = {0, 0, 0.15};
  settings.count_allocations = HangIfTold;
  HapticLink link;
  auto loop = HapticLoop::Start(std::move(device.driver), settings, link);
  if (!loop) {
    std::puts(loop.error().Text().c_str());
    return 4;
  }
  bool has_ended = false;
  for (int i = 0; !has_ended; ++i) {
    // tissue that presses once force is on; the check pose, then the safety switch held for good
    const bool is_on = (*loop)->Latest().hands[instrument::kRight].state != haptics::ArmState::kUnarmed;
    auto& patch = link.patches[instrument::kRight].Back();
    patch.kind = tissue::LocalPatch::Kind::kLinear;
    patch.is_healthy = true;
    patch.force = {is_on ? 2.0 : 0.0, 0, 0};
    link.patches[instrument::kRight].Publish();
    // on a busy machine more than once
    const bool is_confirmed = (*loop)->Latest().check_pose == haptics::CheckPoseState::kConfirmed;
    const int step = i % 120;
    if (step == 10 && !is_confirmed) (*loop)->BeginCheckPose();
    device.hold(is_confirmed || step > 30);
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, 0) > 0) {
      char asked[16];
      const ssize_t size = ::read(STDIN_FILENO, asked, sizeof asked);
      has_ended = size <= 0;
      if (size > 0 && asked[size - 1] == 'h') is_hanging = true;
      if (is_confirmed) (*loop)->RequestArm();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(8));
  }
  return 0;
}
