// SPDX-License-Identifier: Apache-2.0
/// \file child_process.h  Asking a driver something in a process that may die of it.
#pragma once

#include <functional>
#include <string>

namespace trocar::doctor {

enum class ChildEnd { kAnswered, kFailed, kCrashed, kTimedOut };

/// How a child ended, and what it wrote: its answer, or why it has none.
struct ChildAnswer {
  ChildEnd end = ChildEnd::kFailed;
  std::string text;
};

/// Runs `question` in a fork of this process. A crash, an abort or an endless wait there does not reach the
/// caller.
///
/// \param question  returns whether it succeeded, and writes its answer or complaint into the text (at most
/// 4096 bytes)
/// \param timeout   then the child is ended [s]
/// \pre the calling process has one thread
ChildAnswer AskChild(const std::function<bool(std::string& text)>& question, double timeout);

}  // namespace trocar::doctor
