// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "attempt_page.h"
#include "command.h"
#include "common_options.h"
#include "console.h"
#include "pseudonym_option.h"
#include "trocar/report/xapi.h"
#include "trocar/report/xapi_delivery.h"

namespace trocar::cli {

using host::Say;

namespace {

struct XapiArguments {
  std::string file, person, home_page, queue, endpoint, credentials, verdict;
  double give_up_seconds = 60;
  int threads = 1;
};

report::XapiQueue OpenQueue(const XapiArguments& arguments) {
  return report::XapiQueue(arguments.queue.empty() ? report::XapiQueue::FindFolder()
                                                   : std::filesystem::path(arguments.queue));
}

base::Status Queue(const XapiArguments& arguments) {
  report::XapiSettings settings{arguments.home_page, {}};
  if (!arguments.verdict.empty()) settings.is_passed = arguments.verdict == "passed";
  // what is wrong with the settings is told before minutes of replaying
  report::AttemptReport nothing;
  nothing.facts.person = arguments.person;
  if (const auto tried = report::MakeStatements(nothing, settings); !tried.ok()) return tried.error();
  auto made = ReportRecording(arguments.file, arguments.person, arguments.threads);
  if (!made.ok()) return made.error();
  const auto statements = report::MakeStatements(*made, settings);
  if (!statements.ok()) return statements.error();
  report::XapiQueue queue = OpenQueue(arguments);
  for (const report::XapiStatement& statement : *statements) {
    if (const auto added = queue.Add(statement); !added.ok()) return added;
  }
  Say("{1} statements wait in {2}\n", queue.List().size(), queue.Folder());
  return {};
}

base::Status ListWaiting(const XapiArguments& arguments) {
  const report::XapiQueue queue = OpenQueue(arguments);
  for (const report::XapiStatement& statement : queue.List()) host::PrintLine(statement.json);
  for (const auto& path : queue.ListRefused())
    host::PrintErrorLine(host::TranslateWith("refused: {1}", {path.string()}));
  return {};
}

base::Status Deliver(const XapiArguments& arguments) {
  const auto endpoint = report::ParseEndpoint(arguments.endpoint);
  if (!endpoint.ok()) return endpoint.error();
  report::DeliverySettings settings;
  if (!arguments.credentials.empty()) {
    auto credentials = report::ReadCredentials(arguments.credentials);
    if (!credentials.ok()) return credentials.error();
    settings.credentials = std::move(*credentials);
  }
  settings.give_up_seconds = arguments.give_up_seconds;
  settings.on_trouble = [](const std::string& text) { host::PrintErrorLine(host::TranslateComposed(text)); };
  report::XapiQueue queue = OpenQueue(arguments);
  const auto delivered = report::DeliverQueue(queue, *endpoint, settings);
  if (!delivered.ok()) return delivered.error();
  Say("{1} delivered, {2} refused, {3} waiting\n", delivered->delivered, delivered->refused,
      delivered->waiting);
  if (delivered->refused > 0)
    Say("What was refused lies in {1} with the reason\n", queue.Folder() / "refused");
  return delivered->failure ? base::Status(*delivered->failure) : base::Status();
}

void Erase(const XapiArguments& arguments, Outcome& outcome) {
  const auto erased = OpenQueue(arguments).Erase(arguments.person);
  Say("{1} statements of this person were taken out of the queue\n", erased.statements);
  for (const std::string& left : erased.left) Say("not erased here: {1}\n", left);
  outcome.has_finding = !erased.left.empty();
}

void AddQueueOption(CLI::App& command, XapiArguments& arguments) {
  command
      .add_option("--queue", arguments.queue,
                  "Folder in which statements wait [xapi in the user's data folder]")
      ->type_name("DIR");
}

}  // namespace

void AddXapiCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* xapi = AddListed(app, "xapi");
  xapi->require_subcommand(1);
  auto arguments = std::make_shared<XapiArguments>();
  CLI::App* queue =
      xapi->add_subcommand("queue", "Make the statements of a recorded attempt; they wait on the disk");
  queue->add_option("file", arguments->file, "Recording")->required()->type_name("FILE");
  AddPseudonymOption(*queue, "--person", arguments->person,
                     "Pseudonym of whose attempt it is; no name ever leaves")
      ->required();
  queue->add_option("--home-page", arguments->home_page, "Of the accounts: an address of the training centre")
      ->required()
      ->type_name("URL");
  queue->add_option("--verdict", arguments->verdict, "By the centre's thresholds: passed or failed")
      ->check(CLI::IsMember({"passed", "failed"}))
      ->type_name("VERDICT");
  AddThreadsOption(*queue, arguments->threads, "Of the solver; the statements are the same for any number");
  AddQueueOption(*queue, *arguments);
  queue->callback([arguments, &outcome] { outcome.status = Queue(*arguments); });
  CLI::App* list = xapi->add_subcommand("list", "Show the statements that wait, one in a line");
  AddQueueOption(*list, *arguments);
  list->callback([arguments, &outcome] { outcome.status = ListWaiting(*arguments); });
  CLI::App* deliver = xapi->add_subcommand(
      "deliver", "Send what waits; each statement arrives once, however often it is tried");
  deliver->add_option("--endpoint", arguments->endpoint, "Address of the store; http only on this machine")
      ->required()
      ->type_name("URL");
  deliver
      ->add_option("--credentials", arguments->credentials,
                   "File with user:password that nobody else may read (chmod 600)")
      ->type_name("FILE");
  deliver
      ->add_option("--give-up", arguments->give_up_seconds,
                   "After so long without success [s]; what waits stays")
      ->check(CLI::Range(0.0, 1e9))
      ->type_name("S")
      ->capture_default_str();
  AddQueueOption(*deliver, *arguments);
  deliver->callback([arguments, &outcome] { outcome.status = Deliver(*arguments); });
  CLI::App* erase = xapi->add_subcommand(
      "erase",
      "Take everything of one person out of the queue; exit status 1 if something could not be read");
  erase->add_option("person", arguments->person, "Pseudonym")->required()->type_name("PSEUDONYM");
  AddQueueOption(*erase, *arguments);
  erase->callback([arguments, &outcome] { Erase(*arguments, outcome); });
  xapi->footer(
      "Examples:\n"
      "  trocar xapi queue attempt.trocar --person T-7F3K2Q --home-page https://training.hospital.example\n"
      "  trocar xapi deliver --endpoint https://lrs.hospital.example/xapi --credentials "
      "~/.config/trocar/lrs");
}

}  // namespace trocar::cli
