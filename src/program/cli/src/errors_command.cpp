// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "console.h"
#include "trocar/base/error_codes.h"
#include "trocar/host/translate.h"

namespace trocar::cli {
namespace {

void PrintErrors() {
  std::vector<std::vector<std::string>> rows = {{"code", "meaning"}};
  for (const base::ErrorEntry& entry : base::ErrorTable()) {
    if (entry.code != base::ErrorCode::kNone)
      rows.push_back({std::string(entry.text), host::Translate(entry.meaning)});
  }
  host::PrintTable(rows);
}

void PrintMarkdown() {
  std::fputs(
      "# Error codes\n"
      "\n"
      "Every error that the program reports begins with one of these codes; what follows says where it "
      "happened and\n"
      "what to do next. A code keeps its meaning for ever. This page is the output of `trocar errors "
      "--markdown`, and a\n"
      "test compares the two.\n"
      "\n"
      "| code | meaning |\n"
      "|---|---|\n",
      stdout);
  for (const base::ErrorEntry& entry : base::ErrorTable()) {
    if (entry.code == base::ErrorCode::kNone) continue;
    host::PrintLine("| `" + std::string(entry.text) + "` | " + std::string(entry.meaning) + " |");
  }
}

}  // namespace

void AddErrorsCommand(CLI::App& app, Outcome&) {
  CLI::App* command = AddListed(app, "errors");
  auto is_markdown = std::make_shared<bool>(false);
  command->add_flag("--markdown", *is_markdown, "As the page docs/errors.md");
  command->callback([is_markdown] { *is_markdown ? PrintMarkdown() : PrintErrors(); });
}

}  // namespace trocar::cli
