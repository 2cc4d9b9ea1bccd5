// SPDX-License-Identifier: Apache-2.0
/// \file supervisor_main.cpp  The program trocar-supervisor. The simulator starts it; by hand it does nothing.
#include <fcntl.h>

#include <cstdio>
#include <cstring>

#include "supervisor_protocol.h"
#include "trocar/session/supervisor_link.h"

int main(int argument_count, char** arguments) {
  using namespace trocar::session;
  const bool is_started_by_simulator = argument_count == 2 && std::strcmp(arguments[1], "--watch") == 0 &&
                                       ::fcntl(kSupervisorSocket, F_GETFD) >= 0 &&
                                       ::fcntl(kSupervisorPage, F_GETFD) >= 0;
  if (!is_started_by_simulator) {
    std::puts(
        "trocar-supervisor sends zero force to haptic devices when the simulator dies or hangs.\n"
        "The simulator starts it by itself; there is nothing to do by hand.");
    return argument_count == 2 && std::strcmp(arguments[1], "--help") == 0 ? 0 : 2;
  }
  return RunSupervisor(kSupervisorSocket, kSupervisorPage);
}
