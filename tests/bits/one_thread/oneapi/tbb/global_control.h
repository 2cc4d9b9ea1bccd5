// SPDX-License-Identifier: Apache-2.0
// Stands in for TBB where there are no threads: on the include path of check_processors.sh alone. The calling thread takes every
// chunk of a loop, for workers that never get a processor delay nobody (src/engine/tissue/src/workers.h).
#pragma once
#include <cstddef>
namespace tbb {
struct global_control {
  enum parameter { max_allowed_parallelism };
  global_control(parameter, std::size_t) {}
};
}  // namespace tbb
