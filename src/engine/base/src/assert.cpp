// SPDX-License-Identifier: Apache-2.0
#include "trocar/base/assert.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace trocar::base {
namespace {

void PrintAndAbort(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "trocar: a bug, please report it: %s does not hold at %s:%d\n", condition, file, line);
  std::abort();
}

std::atomic<AssertHandler> g_handler{&PrintAndAbort};

}  // namespace

AssertHandler SetAssertHandler(AssertHandler handler) noexcept {
  return g_handler.exchange(handler != nullptr ? handler : &PrintAndAbort);
}

void FailAssert(const char* condition, const char* file, int line) {
  g_handler.load()(condition, file, line);
  std::abort();
}

}  // namespace trocar::base
