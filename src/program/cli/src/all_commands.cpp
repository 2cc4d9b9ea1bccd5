// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "command.h"
#include "help_language.h"
#include "trocar/cli/parts.h"
#include "trocar/cli/run_command.h"

namespace trocar::cli {
namespace {

std::vector<Command> AllCommands() {
  std::vector<Command> all;
  for (const std::span<const Command> part :
       {SimulatorCommands(), TrainingCommands(), AnatomyCommands(), ResearchCommands()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

void ListBelow(const CLI::App& app, std::vector<std::string>& words,
               std::vector<std::vector<std::string>>& all) {
  all.push_back(words);
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    words.push_back(command->get_name());
    ListBelow(*command, words, all);
    words.pop_back();
  }
}

}  // namespace

std::vector<std::vector<std::string>> ListCommands() {
  Outcome outcome;
  const std::unique_ptr<CLI::App> app = MakeCommandLine(AllCommands(), outcome);
  std::vector<std::string> words;
  std::vector<std::vector<std::string>> all;
  ListBelow(*app, words, all);
  return all;
}

std::vector<CommandOption> ListOptions(const std::vector<std::string>& words) {
  Outcome outcome;
  const std::unique_ptr<CLI::App> app = MakeCommandLine(AllCommands(), outcome);
  const CLI::App* command = app.get();
  for (const std::string& word : words) command = command->get_subcommand(word);
  std::vector<CommandOption> options;
  for (const CLI::Option* option : command->get_options()) {
    const bool is_positional = option->get_positional();
    const bool takes_value = option->get_items_expected_max() > 0;
    std::string type = takes_value ? option->get_type_name() : "";
    if (takes_value && type.empty()) type = "TEXT";
    options.push_back({option->get_name(is_positional), type, is_positional, option->get_required()});
  }
  return options;
}

void ListHelpTexts(const TextVisitor& visit) {
  Outcome outcome;
  VisitHelpTexts(*MakeCommandLine(AllCommands(), outcome), visit);
}

int RunCommand(int argc, char** argv) {
  return RunCommandOf(AllCommands(), argc, argv);
}

}  // namespace trocar::cli
