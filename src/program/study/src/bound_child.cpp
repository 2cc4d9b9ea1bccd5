// SPDX-License-Identifier: Apache-2.0
#include "bound_child.h"

#include <sys/prctl.h>
#include <unistd.h>

#include <cstdio>

namespace trocar::study {

pid_t ForkBound(int signal) {
  const pid_t parent = getpid();
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child != 0) return child;
  prctl(PR_SET_PDEATHSIG, static_cast<unsigned long>(signal));
  // it may have died before that was said
  if (getppid() != parent) _exit(1);
  return 0;
}

}  // namespace trocar::study
