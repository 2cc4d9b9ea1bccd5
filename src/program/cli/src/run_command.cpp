// SPDX-License-Identifier: Apache-2.0
#include "trocar/cli/run_command.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "command.h"
#include "help_language.h"
#include "trocar/base/simd_choice.h"
#include "trocar/host/console.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/printable_output.h"
#include "trocar/host/translate.h"
#include "trocar/host/version.h"

namespace trocar::cli {
namespace {

constexpr int kExitGood = 0;
constexpr int kExitError = 1;
constexpr int kExitUsage = 2;

constexpr const char* kDescription =
    "Trocar: an open laparoscopic surgery simulator.\n"
    "Two instruments through two trocars, a laparoscope, a liver and a gallbladder made from real "
    "cross-sections.";

constexpr const char* kExamples =
    "Examples:\n"
    "  trocar window                                   operate, with mouse and keyboard\n"
    "  trocar demo -o out/demo                         pictures, a video and a report of the scripted "
    "demonstration\n"
    "  trocar play expert --task peg_transfer          a scripted surgeon does a training task\n"
    "  trocar simulate scenes/demonstration.json --ticks 240 --threads 2\n"
    "                                                  run without pictures; print state hash and stage "
    "times\n"
    "  trocar doctor                                   what this computer can do, and how to mend what it "
    "cannot\n"
    "  trocar SUBCOMMAND --help                        the options of one subcommand\n"
    "\n"
    "Exit status: 0 good, 1 an error (its code and remedy on standard error), 2 wrong usage.\n"
    "Every error code: trocar errors.";

int Fail(const base::Error& error, int exit_status) {
  std::fflush(stdout);
  // one error is one line, whatever the names in it
  const std::string text = host::ShownText(error), meaning = host::TranslatedMeaning(error.code);
  // the catalogue has the messages that a window can show; of others it says at least what the code means
  if (!meaning.empty() && text == error.Text()) host::PrintErrorLine("trocar: " + meaning);
  host::PrintErrorLine("trocar: " + text);
  return exit_status;
}

/// The subcommand that was named, for a hint on its help.
std::string FindChosen(const CLI::App& app) {
  std::string chosen = "trocar";
  const CLI::App* level = &app;
  while (!level->get_subcommands().empty()) {
    level = level->get_subcommands().front();
    chosen += " " + level->get_name();
  }
  return chosen;
}

/// What is wrong with the command line. CLI11 notices a missing subcommand before a misspelt one.
std::string Explain(const CLI::App& app, const CLI::ParseError& complaint) {
  const std::vector<std::string> unknown = app.remaining(true);
  if (complaint.get_name() != "RequiredError" || unknown.empty() || unknown.front().starts_with('-')) {
    return complaint.what();
  }
  return "there is no subcommand \"" + unknown.front() + "\"";
}

void AddCommands(CLI::App& app, Outcome& outcome) {
  app.set_version_flag("--version", "trocar " + std::string(host::VersionText()));
  app.footer(kExamples);
  app.require_subcommand(1);
  AddWindowCommand(app, outcome);
  AddDemoCommand(app, outcome);
  AddPlayCommand(app, outcome);
  AddPicturesCommand(app, outcome);
  AddSimulateCommand(app, outcome);
  AddReplayCommand(app, outcome);
  AddCoachCommand(app, outcome);
  AddDatasetCommand(app, outcome);
  AddStudyCommand(app, outcome);
  AddMetricsCommand(app, outcome);
  AddReportCommand(app, outcome);
  AddRatingCommand(app, outcome);
  AddXapiCommand(app, outcome);
  AddRecordCommand(app, outcome);
  AddCourseCommand(app, outcome);
  AddLevelsCommand(app, outcome);
  AddExamCommand(app, outcome);
  AddCertificateCommand(app, outcome);
  AddStoreCommand(app, outcome);
  AddAnatomyCommand(app, outcome);
  AddDevicesCommand(app, outcome);
  AddBenchCommand(app, outcome);
  AddReproduceCommand(app, outcome);
  AddDoctorCommand(app, outcome);
  AddErrorsCommand(app, outcome);
}

int ParseAndRun(int argc, char** argv) {
  CLI::App app(kDescription, "trocar");
  Outcome outcome;
  AddCommands(app, outcome);
  TranslateHelp(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& complaint) {
    // --help and --version arrive as exceptions that mean success
    if (complaint.get_exit_code() == 0) return app.exit(complaint);
    return Fail({base::ErrorCode::kUsage, Explain(app, complaint) + "; see " + FindChosen(app) + " --help"},
                kExitUsage);
  }
  if (!outcome.status) {
    const bool is_usage = outcome.status.error().code == base::ErrorCode::kUsage;
    return Fail(outcome.status.error(), is_usage ? kExitUsage : kExitError);
  }
  return outcome.has_finding ? kExitError : kExitGood;
}

/// What was printed and did not arrive is no success, whichever command printed it.
int CheckOutput(int exit_status) {
  errno = 0;
  const bool is_flushed = std::fflush(stdout) == 0;
  const int why = errno;
  std::cout.flush();
  if (is_flushed && std::ferror(stdout) == 0 && std::cout.good()) return exit_status;
  std::clearerr(stdout);
  std::cout.clear();
  const int failed =
      Fail({base::ErrorCode::kFileUnwritable,
            "standard output" + (why == 0 ? std::string() : std::string(": ") + std::strerror(why)) +
                "; not all of the output was written: free space, or write it elsewhere"},
           kExitError);
  return exit_status == kExitGood ? failed : exit_status;
}

/// Without a conversion that would need memory.
constexpr const char* kNoMemory =
    "trocar: E-SIM-005 the system refused memory; close other programs, raise the limit (ulimit -v), or ask "
    "for less: "
    "fewer pixels, triangles or threads\n";

/// Where an exception leaves a thread, or a function that promised none: no stack is unwound any more.
[[noreturn]] void OnTerminate() {
  host::RemovePartialPaths();
  if (const std::exception_ptr failure = std::current_exception()) {
    try {
      std::rethrow_exception(failure);
    } catch (const std::bad_alloc&) {
      std::fputs(kNoMemory, stderr);
      std::_Exit(kExitError);
    } catch (...) {
      std::fputs("trocar: stopped by an unexpected exception in a thread; please report this\n", stderr);
    }
  }
  std::abort();
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
  CLI::App app(kDescription, "trocar");
  Outcome outcome;
  AddCommands(app, outcome);
  std::vector<std::string> words;
  std::vector<std::vector<std::string>> all;
  ListBelow(app, words, all);
  return all;
}

std::vector<CommandOption> ListOptions(const std::vector<std::string>& words) {
  CLI::App app(kDescription, "trocar");
  Outcome outcome;
  AddCommands(app, outcome);
  const CLI::App* command = &app;
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
  CLI::App app(kDescription, "trocar");
  Outcome outcome;
  AddCommands(app, outcome);
  VisitHelpTexts(app, visit);
}

int RunCommand(int argc, char** argv) {
  const host::PrintableOutput fence;
  host::RemovePartialPathsOnSignals();
  std::set_terminate(OnTerminate);
  host::UseLanguage(host::FindLocaleFolder());
  if (const base::Status level = base::CheckSimdLevel(); !level) return Fail(level.error(), kExitUsage);
  // the last fence: nothing below should throw, and if memory ends the person still gets a line
  try {
    return CheckOutput(ParseAndRun(argc, argv));
  } catch (const std::bad_alloc&) {
    std::fputs(kNoMemory, stderr);
    return kExitError;
  } catch (const std::exception& failure) {
    host::PrintErrorLine("trocar: stopped by an unexpected exception: " + std::string(failure.what()) +
                         "; please report this");
    return kExitError;
  }
}

}  // namespace trocar::cli
