// SPDX-License-Identifier: Apache-2.0
/// \file supervisor_main.cpp  The program trocar-supervisor. The simulator starts it; by hand it does nothing.
#include <fcntl.h>

#include <cstdio>
#include <cstring>

#include "trocar/device/companion.h"
#include "trocar/device/open_haptics.h"
#include "trocar/session/supervisor_link.h"

int main(int argument_count, char** arguments) {
  using trocar::device::Companion;
  const auto is_option = [&](const char* option) {
    return argument_count == 2 && std::strcmp(arguments[1], option) == 0;
  };
  const bool is_started_by_simulator =
      ::fcntl(Companion::kSocket, F_GETFD) >= 0 && ::fcntl(Companion::kPage, F_GETFD) >= 0;
  if (is_started_by_simulator && is_option("--watch"))
    return trocar::session::RunSupervisor(Companion::kSocket, Companion::kPage);
  if (is_started_by_simulator && is_option("--openhaptics"))
    return trocar::device::RunOpenHapticsHost(Companion::kSocket, Companion::kPage);
  std::puts(
      "trocar-supervisor sends zero force to haptic devices when the simulator dies or hangs.\n"
      "The simulator starts it by itself; there is nothing to do by hand.");
  return is_option("--help") ? 0 : 2;
}
