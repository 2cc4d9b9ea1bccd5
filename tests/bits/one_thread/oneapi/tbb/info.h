// SPDX-License-Identifier: Apache-2.0
// See global_control.h.
#pragma once
namespace tbb::info {
inline int default_concurrency() {
  return 1;
}
}  // namespace tbb::info
