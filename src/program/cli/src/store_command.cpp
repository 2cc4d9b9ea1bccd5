// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <chrono>
#include <utility>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "store_console.h"
#include "trocar/host/log.h"
#include "trocar/record/recording.h"
#include "trocar/store/attempts.h"
#include "trocar/store/keep_attempt.h"
#include "trocar/store/maintenance.h"

namespace trocar::cli {

using host::Say;
using host::ShownNumber;
using host::Translate;
using host::TranslateWith;

namespace {

/// How long attempts are kept.
std::string Days(int days) {
  return days == 0 ? Translate("for ever")
                   : host::TranslateCount("{1} day", "{1} days", static_cast<std::size_t>(days));
}

using nlohmann::ordered_json;

std::int64_t NowMilliseconds() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

void AddInfo(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome) {
  CLI::App* command = parent.add_subcommand("info", "Say where the store is, and how much is in it");
  OnStore(*command, options, outcome, [options](StoreSession& session) -> base::Status {
    const auto counts = CountAll(session.store, session.viewer);
    if (!counts.ok()) return counts.error();
    const auto version = session.store.ReadVersion();
    if (!version.ok()) return version.error();
    const auto days = ReadRetention(session.store);
    if (!days.ok()) return days.error();
    const store::Place& place = session.store.GetPlace();
    const store::Spool spool(place);
    if (options->is_json) {
      PrintStoreJson({{"store", place.Text()},
                      {"folder", place.folder.string()},
                      {"database", place.IsPostgres() ? "postgresql" : "sqlite"},
                      {"version", *version},
                      {"people", counts->people},
                      {"groups", counts->groups},
                      {"courses", counts->courses},
                      {"attempts", counts->attempts},
                      {"certificates", counts->certificates},
                      {"waiting", spool.CountWaiting()},
                      {"held", spool.CountHeld()},
                      {"retention_days", *days}});
      return {};
    }
    host::PrintLines(host::FormatFields(
        {{"store", place.Text()},
         {"database",
          TranslateWith("{1}, tables of version {2}",
                        {place.IsPostgres() ? "PostgreSQL" : "SQLite", std::to_string(*version)})},
         {"names, spool, backups", place.folder.string()},
         {"people", TranslateWith("{1} in {2} groups",
                                  {std::to_string(counts->people), std::to_string(counts->groups)})},
         {"courses", std::to_string(counts->courses)},
         {"attempts", std::to_string(counts->attempts)},
         {"certificates", std::to_string(counts->certificates)},
         {"waiting in the spool", TranslateWith("{1}, held {2}", {std::to_string(spool.CountWaiting()),
                                                                  std::to_string(spool.CountHeld())})},
         {"attempts are kept", Days(*days)}}));
    return {};
  });
}

std::string Result(const store::Attempt& attempt) {
  // an outcome that its file made up is none
  if (attempt.mark.state == store::Verification::kRefused) return Translate("refused");
  if (!attempt.is_completed) return Translate("not completed");
  if (!attempt.is_passed) return Translate("completed");
  return *attempt.is_passed ? Translate("passed") : Translate("not passed");
}

ordered_json MarkJson(const store::VerificationMark& mark) {
  return {{"state", store::VerificationName(mark.state)},
          {"why", store::WhyName(mark.why)},
          {"program", JsonText(mark.program)},
          {"time_ms", mark.time_ms ? ordered_json(*mark.time_ms) : ordered_json()},
          {"claim", mark.claim.empty() ? ordered_json() : JsonText(mark.claim)}};
}

/// The same as a word of a table.
std::string MarkWord(const store::VerificationMark& mark) {
  switch (mark.state) {
    case store::Verification::kVerified:
      return Translate("replayed");
    case store::Verification::kRecordedHere:
      return Translate("recorded here");
    default:
      return Translate(store::DescribeMark(mark));
  }
}

ordered_json AttemptJson(const store::StoredAttempt& stored) {
  const store::Attempt& a = stored.attempt;
  return {{"id", stored.id},
          {"recording_id", JsonText(a.recording_id)},
          {"started", JsonText(a.started)},
          {"trainee", a.trainee.empty() ? ordered_json() : JsonText(a.trainee)},
          {"task", JsonText(a.task)},
          {"level", JsonText(a.level)},
          {"patient", JsonText(a.patient)},
          {"seed", std::to_string(a.seed)},
          {"seconds", a.seconds},
          {"completed", a.is_completed},
          {"passed", a.is_passed ? ordered_json(*a.is_passed) : ordered_json()},
          {"score", a.score ? ordered_json(*a.score) : ordered_json()},
          {"verified", a.mark.IsVerified()},
          {"counts", a.mark.Counts()},
          {"verification", MarkJson(a.mark)},
          {"recording", JsonText(a.recording)}};
}

void AddAttempts(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome) {
  CLI::App* command = parent.add_subcommand("attempts", "List attempts, the newest first, a page at a time");
  struct Arguments {
    store::AttemptFilter filter;
    std::string page;
    int limit = 20;
  };
  auto arguments = std::make_shared<Arguments>();
  command->add_option("--trainee", arguments->filter.trainee, "Of one trainee")->type_name("PSEUDONYM");
  command->add_option("--group", arguments->filter.group, "Of the members of a group")->type_name("GROUP");
  command->add_option("--task", arguments->filter.task, "Of one task")->type_name("TASK");
  command->add_option("--limit", arguments->limit, "How many")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--page", arguments->page, "Go on where a page ended: it says how")->type_name("PAGE");
  OnStore(*command, options, outcome, [options, arguments](StoreSession& session) -> base::Status {
    const auto page =
        ListAttempts(session.store, session.viewer, arguments->filter, arguments->page, arguments->limit);
    if (!page.ok()) return page.error();
    if (options->is_json) {
      ordered_json json = {{"attempts", ordered_json::array()},
                           {"next", page->next.empty() ? ordered_json() : ordered_json(page->next)}};
      for (const store::StoredAttempt& stored : page->attempts)
        json["attempts"].push_back(AttemptJson(stored));
      PrintStoreJson(json);
      return {};
    }
    std::vector<std::vector<std::string>> rows = {
        {"started", "trainee", "task", "level", "s", "score", "result", "verified"}};
    bool is_all_verified = true;
    for (const store::StoredAttempt& stored : page->attempts) {
      const store::Attempt& a = stored.attempt;
      rows.push_back({Shown(a.started), a.trainee.empty() ? "-" : Shown(a.trainee), Shown(a.task),
                      Shown(a.level), ShownNumber(a.seconds, 4), a.score ? ShownNumber(*a.score, 3) : "-",
                      Result(a), MarkWord(a.mark)});
      is_all_verified = is_all_verified && a.mark.IsVerified();
    }
    if (page->attempts.empty())
      Say("no attempts\n");
    else
      host::PrintTable(rows);
    if (!page->next.empty()) Say("more: --page {1}\n", page->next);
    if (!is_all_verified)
      Say("what is not verified is as its file says; trocar store verify --attempts replays it\n");
    return {};
  });
}

void AddPercentile(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome) {
  CLI::App* command = parent.add_subcommand(
      "percentile",
      "Compare a trainee, or a value, with a group: each trainee's latest completed attempt counts");
  struct Arguments {
    store::MetricKey key;
    std::string group, trainee;
    double value = 0;
  };
  auto arguments = std::make_shared<Arguments>();
  command->add_option("--task", arguments->key.task, "Which task")->required()->type_name("TASK");
  command->add_option("--level", arguments->key.level, "Which level")->type_name("LEVEL");
  command->add_option("--metric", arguments->key.metric, "Which number: score, seconds, or a metric")
      ->default_str("score")
      ->type_name("METRIC");
  command->add_option("--hand", arguments->key.hand, "left or right, where it is of a hand")
      ->type_name("HAND");
  command->add_option("--group", arguments->group, "Which group; all trainees where none is named")
      ->type_name("GROUP");
  auto* trainee =
      command->add_option("--trainee", arguments->trainee, "Whose latest value")->type_name("PSEUDONYM");
  auto* value = command->add_option("--value", arguments->value, "Which value")->excludes(trainee);
  OnStore(*command, options, outcome, [options, arguments, value](StoreSession& session) -> base::Status {
    if (arguments->key.metric.empty()) arguments->key.metric = "score";
    double compared = arguments->value;
    if (!arguments->trainee.empty()) {
      const auto standing = FindStanding(session.store, session.viewer, arguments->trainee, arguments->key);
      if (!standing.ok()) return standing.error();
      if (!*standing)
        return base::Error{base::ErrorCode::kStoreUnknown, "this trainee has completed no such attempt"};
      compared = (*standing)->latest;
    } else if (value->count() == 0) {
      return base::Error{base::ErrorCode::kUsage, "name --trainee or --value"};
    }
    const auto percentile =
        CalcPercentile(session.store, session.viewer, arguments->group, arguments->key, compared);
    if (!percentile.ok()) return percentile.error();
    if (options->is_json) {
      PrintStoreJson({{"value", compared},
                      {"below", percentile->below},
                      {"equal", percentile->equal},
                      {"trainees", percentile->trainees},
                      {"percentile", percentile->Percent()}});
    } else if (percentile->trainees == 0) {
      Say("nobody there has completed this\n");
    } else {
      Say("{1}: higher than {2} and equal to {3} of {4} trainees (percentile {5})\n", ShownNumber(compared),
          percentile->below, percentile->equal, percentile->trainees, ShownNumber(percentile->Percent(), 3));
    }
    return {};
  });
}

void AddAddAttempt(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome) {
  CLI::App* command =
      parent.add_subcommand("add", "Keep a recorded attempt; it waits where the store is away");
  struct Arguments {
    std::string file, trainee;
    bool is_unverified = false, moves = false;
    int threads = 1;
  };
  auto arguments = std::make_shared<Arguments>();
  command->add_option("recording", arguments->file, "Recording")->required()->type_name("FILE");
  command->add_option("--trainee", arguments->trainee, "Whose attempt it is")->type_name("PSEUDONYM");
  command->add_flag("--unverified", arguments->is_unverified,
                    "Do not replay it now: it counts nowhere until trocar store verify --attempts did");
  command
      ->add_flag("--move", arguments->moves,
                 "It is in the store as somebody else's attempt, and is this trainee's")
      ->needs(command->get_option("--trainee"));
  AddThreadsOption(*command, arguments->threads);
  AddStoreOptions(*command, options);
  command->callback([options, arguments, &outcome] {
    outcome.status = [&]() -> base::Status {
      const auto place = store::FindPlace(options->url);
      if (!place.ok()) return place.error();
      auto recording = record::ReadRecording(arguments->file);
      if (!recording.ok()) return recording.error();
      auto attempt = arguments->is_unverified ? store::DescribeAttempt(*recording, arguments->file)
                                              : ReplayHere(std::move(*recording), arguments->file,
                                                           arguments->threads, "measuring");
      if (!attempt.ok()) return attempt.error();
      attempt->trainee = arguments->trainee;
      if (arguments->moves) {
        auto session = OpenSession(*options);
        if (!session.ok()) return session.error();
        if (auto moved = MoveAttempt(session->store, session->viewer, attempt->recording_id, attempt->started,
                                     attempt->trainee);
            !moved.ok())
          return moved;
      }
      const auto kept = store::KeepAttempt(*place, *attempt);
      if (!kept.ok()) return kept.error();
      if (!kept->rebuilt.empty()) host::Log(host::LogLevel::kWarning, kept->rebuilt);
      if (options->is_json)
        PrintStoreJson({{"in_store", kept->is_in_store},
                        {"completed", attempt->is_completed},
                        {"verified", attempt->mark.IsVerified()},
                        {"verification", MarkJson(attempt->mark)},
                        {"why_not", kept->failure ? ordered_json(kept->failure->Text()) : ordered_json()}});
      else
        Say(kept->is_in_store ? "the attempt is in the store\n" : "the attempt waits in the spool\n");
      if (!options->is_json && !attempt->mark.IsVerified())
        Say("{1}\n", Translate(store::DescribeMark(attempt->mark)));
      // a store that is away is no failure: the attempt is safe; one that is refused wants a person
      if (kept->failure) host::PrintErrorLine("trocar: " + host::ShownText(*kept->failure));
      outcome.has_finding = !kept->is_in_store || attempt->mark.state == store::Verification::kRefused;
      return {};
    }();
  });
}

void AddDeliver(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome) {
  CLI::App* command = parent.add_subcommand("deliver", "Bring waiting attempts into the store");
  auto has_held = std::make_shared<bool>(false);
  command->add_flag("--held", *has_held, "Also those of trainees that the store did not know");
  OnStore(*command, options, outcome, [options, has_held](StoreSession& session) -> base::Status {
    const store::Spool spool(session.store.GetPlace());
    const store::DeliveryReport report =
        *has_held ? spool.DeliverHeld(session.store) : spool.Deliver(session.store);
    if (options->is_json) {
      PrintStoreJson({{"added", report.added},
                      {"known", report.known},
                      {"held", report.held},
                      {"damaged", report.damaged},
                      {"waiting", spool.CountWaiting()}});
    } else {
      Say("{1} attempts are new in the store, {2} were there already, {3} wait\n", report.added, report.known,
          spool.CountWaiting());
      if (report.held > 0)
        Say("{1} are held: their trainee is not known here (add them, then use --held), or the recording is "
            "somebody else's attempt\n",
            report.held);
      if (report.damaged > 0)
        Say("{1} are damaged and lie in {2}\n", report.damaged,
            session.store.GetPlace().SpoolFolder() / "damaged");
    }
    return report.failure ? base::Status(*report.failure) : base::Status();
  });
}

void AddTransfer(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome) {
  auto file = std::make_shared<std::string>();
  CLI::App* exporting = parent.add_subcommand(
      "export",
      "Write everything to a JSON file, or the numbers of all attempts to a CSV file; names are not in it");
  exporting->add_option("file", *file, "New file: .json or .csv")->required()->type_name("FILE");
  OnStore(*exporting, options, outcome, [file, options](StoreSession& session) -> base::Status {
    const bool is_csv = file->ends_with(".csv");
    if (!is_csv && !file->ends_with(".json"))
      return base::Error{base::ErrorCode::kUsage, "the file's name ends with .json or .csv"};
    auto done = is_csv ? ExportCsv(session.store, session.viewer, *file)
                       : ExportJson(session.store, session.viewer, *file);
    if (done.ok())
      options->is_json ? PrintStoreJson({{"written", *file}}) : Say("{1} is written\n", file->c_str());
    return done;
  });
  CLI::App* importing = parent.add_subcommand(
      "import", "Add what an export or a backup of another store holds; what is here stays as it is");
  importing->add_option("file", *file, "Export (JSON) or backup (SQLite)")->required()->type_name("FILE");
  auto is_trusted = std::make_shared<bool>(false);
  importing->add_flag("--trusted", *is_trusted,
                      "It is your own backup: attempts that it says are verified count at once");
  OnStore(*importing, options, outcome, [file, options, is_trusted](StoreSession& session) -> base::Status {
    const auto report = Import(session.store, session.viewer, *file,
                               *is_trusted ? store::Trust::kAsItSays : store::Trust::kNone);
    if (!report.ok()) return report.error();
    if (options->is_json) {
      PrintStoreJson({{"people", report->people},
                      {"groups", report->groups},
                      {"courses", report->courses},
                      {"attempts", report->attempts},
                      {"known", report->known},
                      {"conflicts", report->conflicts}});
    } else {
      Say("new: {1} people, {2} groups, {3} courses, {4} attempts; {5} attempts were here already\n",
          report->people, report->groups, report->courses, report->attempts, report->known);
      if (report->conflicts > 0)
        Say("{1} of these are another person's here, and stay theirs\n", report->conflicts);
      if (report->attempts > 0 && !*is_trusted)
        Say("the new attempts count when trocar store verify --attempts has replayed them\n");
    }
    return {};
  });
}

void AddBackup(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome) {
  auto file = std::make_shared<std::string>();
  CLI::App* backup = parent.add_subcommand("backup",
                                           "Write a checksummed copy of the store, also while others use it; "
                                           "a store by itself, of either database");
  backup->add_option("file", *file, "New file; without it one in the store's own folder, which keeps five")
      ->type_name("FILE");
  OnStore(*backup, options, outcome, [file, options](StoreSession& session) -> base::Status {
    const auto made = BackUp(session.store, session.viewer, *file);
    if (!made.ok()) return made.error();
    options->is_json ? PrintStoreJson({{"backup", made->string()}})
                     : Say("{1} is written and checked\n", made->c_str());
    return {};
  });
  auto checked = std::make_shared<std::string>();
  auto replaying = std::make_shared<ReplayArguments>();
  CLI::App* verify = parent.add_subcommand(
      "verify", "Check every page, reference and sum of the store, or of a backup; or replay attempts");
  auto* of_backup =
      verify->add_option("backup", *checked, "A backup in place of the store")->type_name("FILE");
  auto* of_attempts =
      verify
          ->add_flag("--attempts", replaying->is_wanted,
                     "Replay each attempt that no replay has verified, where its recording is here; may be "
                     "interrupted, and goes on where it was")
          ->excludes(of_backup);
  verify
      ->add_flag("--accept", replaying->accepts,
                 "Let those that cannot be replayed count as they are, and say so wherever they show")
      ->needs(of_attempts);
  AddThreadsOption(*verify, replaying->threads);
  AddStoreOptions(*verify, options);
  verify->callback([checked, replaying, options, &outcome] {
    if (replaying->is_wanted) {
      auto session = OpenSession(*options);
      outcome.status = session.ok() ? ReplayAttempts(*session, *replaying, options->is_json, outcome)
                                    : base::Status(session.error());
      return;
    }
    if (!checked->empty()) {
      outcome.status = store::VerifyBackup(*checked);
    } else {
      store::StoreSettings settings;
      settings.only_look = true;
      auto session = OpenSession(*options, settings);
      outcome.status = session.ok() ? Verify(session->store) : base::Status(session.error());
    }
    if (outcome.status.ok()) options->is_json ? PrintStoreJson({{"is_sound", true}}) : Say("all is sound\n");
  });
  CLI::App* migrate =
      parent.add_subcommand("migrate", "Make the store, or bring its tables to this program's version");
  OnStore(*migrate, options, outcome, [options](StoreSession& session) -> base::Status {
    const auto version = session.store.ReadVersion();
    if (!version.ok()) return version.error();
    options->is_json ? PrintStoreJson({{"version", *version}})
                     : Say("the tables are of version {1}\n", *version);
    return {};
  });
}

void AddKeeping(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome) {
  auto days = std::make_shared<int>(0);
  CLI::App* retain =
      parent.add_subcommand("retain", "Say how long attempts are kept; trocar store tidy applies it");
  retain->add_option("--days", *days, "0: for ever")->required()->check(CLI::Range(0, 36500));
  OnStore(*retain, options, outcome, [days, options](StoreSession& session) -> base::Status {
    auto set = SetRetention(session.store, session.viewer, *days);
    if (set.ok())
      options->is_json ? PrintStoreJson({{"days", *days}}) : Say("attempts are kept {1}\n", Days(*days));
    return set;
  });
  CLI::App* tidy = parent.add_subcommand(
      "tidy", "Remove attempts that are older than they may be, with their recordings, and make a backup");
  auto is_sure = std::make_shared<bool>(false);
  tidy->add_flag(
      "--yes", *is_sure,
      "The clock is right, and so is the number of attempts that are too old: asked for where it looks "
      "wrong");
  OnStore(*tidy, options, outcome, [options, is_sure](StoreSession& session) -> base::Status {
    const auto report = Tidy(session.store, session.viewer, NowMilliseconds(), *is_sure);
    if (!report.ok()) return report.error();
    if (options->is_json)
      PrintStoreJson({{"attempts", report->attempts},
                      {"recordings", report->recordings},
                      {"due", report->due},
                      {"left", report->left},
                      {"backup", report->backup.string()}});
    else
      Say("{1} attempts and {2} recordings are removed; backup: {3}\n", report->attempts, report->recordings,
          report->backup);
    if (!options->is_json) {
      if (report->due > 0)
        Say("{1} attempts are too old, and go {2} days after they were found so; trocar store retain keeps "
            "them "
            "longer\n",
            report->due, store::kGraceDays);
      for (const std::string& left : report->left) Say("not removed here: {1}\n", left);
    }
    return report->unsure ? base::Status(*report->unsure) : base::Status();
  });
}

}  // namespace

base::Result<StoreSession> OpenSession(const StoreOptions& options, store::StoreSettings settings) {
  const auto place = store::FindPlace(options.url);
  if (!place.ok()) return place.error();
  auto opened = store::Store::Open(*place, settings);
  if (!opened.ok()) return opened.error();
  if (!opened->Rebuilt().empty()) host::Log(host::LogLevel::kWarning, opened->Rebuilt());
  store::Viewer viewer = store::Viewer::Owner();
  if (!options.viewer.empty()) {
    const auto found = FindViewer(*opened, options.viewer);
    if (!found.ok()) return found.error();
    viewer = *found;
  }
  return StoreSession{std::move(*opened), viewer};
}

void AddStoreOptions(CLI::App& command, const std::shared_ptr<StoreOptions>& options) {
  command
      .add_option("--store", options->url,
                  "SQLite file or postgresql://... (else TROCAR_STORE, else your own)")
      ->type_name("URL");
  command.add_option("--as", options->viewer, "Ask as this person: see and do what their role allows")
      ->type_name("PSEUDONYM");
  AddJsonFlag(command, options->is_json);
}

void OnStore(CLI::App& command, const std::shared_ptr<StoreOptions>& options, Outcome& outcome,
             StoreWork work) {
  AddStoreOptions(command, options);
  command.callback([options, &outcome, work = std::move(work)] {
    auto session = OpenSession(*options);
    outcome.status = session.ok() ? work(*session) : base::Status(session.error());
  });
}

void PrintStoreJson(const ordered_json& json) {
  PrintJson(json);
}

void AddStoreCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "store");
  command->require_subcommand(1);
  auto options = std::make_shared<StoreOptions>();
  AddInfo(*command, options, outcome);
  AddStorePeopleCommands(*command, options, outcome);
  AddAttempts(*command, options, outcome);
  AddPercentile(*command, options, outcome);
  AddAddAttempt(*command, options, outcome);
  AddDeliver(*command, options, outcome);
  AddTransfer(*command, options, outcome);
  AddBackup(*command, options, outcome);
  AddKeeping(*command, options, outcome);
  command->footer(
      "Example: trocar store trainee add --name \"Ada Lovelace\"\n"
      "         trocar store add attempt.trocar --trainee T-7F3K2Q");
}

}  // namespace trocar::cli
