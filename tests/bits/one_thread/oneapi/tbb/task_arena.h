// SPDX-License-Identifier: Apache-2.0
// See global_control.h.
#pragma once
namespace tbb {
struct task_arena {
  void initialize(int) {}
  template <typename Work>
  void execute(const Work& work) {
    work();
  }
};
}  // namespace tbb
