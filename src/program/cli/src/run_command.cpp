// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"
#include "command_list.h"
#include "help_language.h"
#include "start_program.h"
#include "trocar/base/simd_choice.h"
#include "trocar/host/console.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/printable_output.h"
#include "trocar/host/program.h"
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

const Command* FindOwn(std::span<const Command> own, std::string_view name) {
  const auto found =
      std::find_if(own.begin(), own.end(), [&](const Command& each) { return each.name == name; });
  return found == own.end() ? nullptr : &*found;
}

/// Starts the program whose command was called, where it is not this one: then this does not come back.
base::Status StartElsewhere(std::span<const Command> own, int argc, char** argv) {
  if (argc < 2 || FindOwn(own, argv[1]) != nullptr) return {};
  const ListedCommand* const called = FindListed(argv[1]);
  if (called == nullptr) return {};
  const std::filesystem::path program = called->program == "trocar"
                                            ? host::FindMainProgram(called->program)
                                            : host::FindCompanionProgram(called->program);
  const int why = ReplaceProgram(program, {argv, argv + argc});
  const std::string name(called->name), part(called->program);
  if (why == ENOENT) {
    return base::Error{base::ErrorCode::kFileMissing, part + " is not beside this program: build it (./run " +
                                                          name + " --help, or ninja command-" + name +
                                                          " in the build folder), or install Trocar again"};
  }
  return base::Error{base::ErrorCode::kFileUnreadable, part + " does not start: " + std::strerror(why) +
                                                           "; build it again (ninja command-" + name + ")"};
}

int ParseAndRun(std::span<const Command> own, int argc, char** argv) {
  Outcome outcome;
  const std::unique_ptr<CLI::App> made = MakeCommandLine(own, outcome);
  CLI::App& app = *made;
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

}  // namespace

std::unique_ptr<CLI::App> MakeCommandLine(std::span<const Command> own, Outcome& outcome) {
  auto app = std::make_unique<CLI::App>(kDescription, "trocar");
  app->set_version_flag("--version", "trocar " + std::string(host::VersionText()));
  app->footer(kExamples);
  app->require_subcommand(1);
  for (const ListedCommand& listed : ListedCommands()) {
    if (const Command* const command = FindOwn(own, listed.name)) {
      command->add(*app, outcome);
    } else {
      AddListed(*app, listed.name);
    }
  }
  return app;
}

int RunCommandOf(std::span<const Command> own, int argc, char** argv) {
  // first of all: the other program sets up its output and its signals itself
  const base::Status started = StartElsewhere(own, argc, argv);
  const host::PrintableOutput fence;
  host::RemovePartialPathsOnSignals();
  std::set_terminate(OnTerminate);
  host::UseLanguage(host::FindLocaleFolder());
  if (!started) return Fail(started.error(), kExitError);
  if (const base::Status level = base::CheckSimdLevel(); !level) return Fail(level.error(), kExitUsage);
  // the last fence: nothing below should throw, and if memory ends the person still gets a line
  try {
    return CheckOutput(ParseAndRun(own, argc, argv));
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
