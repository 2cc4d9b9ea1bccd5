// SPDX-License-Identifier: Apache-2.0
/// \file command_runs.h  `trocar` in a process of its own, and what is wrong with what it printed.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace trocar::printed_texts {

/// What nobody but a forger begins a line with.
inline constexpr std::string_view kForgedLine = "FORGED-LINE";

/// A text that is whole UTF-8, as JSON may hold it: line ends with forged lines behind them, sequences that clear the screen, name the
/// window and reach the clipboard, delete, C1 controls, marks that turn the direction, and a tag.
std::string MakeHostileText();
/// The same between many letters.
std::string MakeLongText();
/// The same with bytes that are no UTF-8.
std::string MakeBrokenText();

struct CommandRun {
  int status = -1;  ///< 128 + signal where one ended it
  bool is_late = false;
  std::string out, err;
};

/// Runs `trocar WORDS` in a child, in `folder`, which is its home, too. It is ended after so many seconds.
CommandRun RunInChild(const std::vector<std::string>& words, const std::filesystem::path& folder,
                      unsigned most_seconds = 60);

/// What a stranger's text has done to a run: empty, or what is wrong.
/// \param is_json  its output must be JSON, where there is any
std::string FindFault(const CommandRun& run, bool is_json);

}  // namespace trocar::printed_texts
