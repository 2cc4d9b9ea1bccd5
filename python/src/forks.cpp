// SPDX-License-Identifier: Apache-2.0
#include "forks.h"

#include <pthread.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace trocar::python {

void ExpectThreadsOfLibraries() {
  static const int registered = ::pthread_atfork(nullptr, nullptr, [] {
    // the last that is registered runs first
    static_cast<void>(::on_exit(
        [](int status, void*) {
          std::fflush(nullptr);
          ::_exit(status);
        },
        nullptr));
  });
  static_cast<void>(registered);
}

}  // namespace trocar::python
