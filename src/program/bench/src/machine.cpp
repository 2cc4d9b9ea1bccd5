// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <sstream>
#include <thread>

#include "trocar/bench/benchmark.h"

namespace trocar::bench {

std::string DescribeMachine() {
  // a file of /proc has no size beforehand, so host::ReadFile would take it for empty
  std::ifstream file("/proc/cpuinfo");
  std::ostringstream text;
  text << file.rdbuf();
#if defined(__clang__)
  const std::string compiler =
      "Clang " + std::to_string(__clang_major__) + "." + std::to_string(__clang_minor__);
#else
  const std::string compiler = "GCC " + std::to_string(__GNUC__) + "." + std::to_string(__GNUC_MINOR__);
#endif
#if defined(TROCAR_ENABLE_ASSERTS)
  const char* build = "assertions on";
#else
  const char* build = "assertions off";
#endif
  return DescribeMachine(text.str(), std::thread::hardware_concurrency()) + ", " + compiler + ", " + build;
}

}  // namespace trocar::bench
