// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "trocar/base/state_hash.h"
#include "trocar/host/json.h"
#include "trocar/record/recording.h"
#include "trocar/record/replay.h"
#include "trocar/simulation/engine_bits.h"

namespace trocar::cli {

using host::PrintLine;
using host::Say;
using host::ShownNumber;
using host::TranslateComposed;
using host::TranslateWith;

namespace {

using nlohmann::ordered_json;
using record::Recording;

constexpr std::size_t kShownErrors = 20;

ordered_json InfoJson(const Recording& recording) {
  const record::Description& d = recording.description;
  ordered_json json = {{"of", d.name},
                       {"level", d.level},
                       {"patient", d.patient},
                       {"seed", d.seed},
                       {"player", d.player},
                       {"started", d.started},
                       {"program", d.program},
                       {"engine_bits", d.engine_bits},
                       {"compiler", d.compiler},
                       {"first_tick", recording.FirstTick()},
                       {"branched", nullptr},
                       {"ticks", recording.inputs.size()},
                       {"seconds", recording.Seconds()},
                       {"hashes", recording.hashes.size()},
                       {"keyframes", recording.KeyframeTicks().size()},
                       {"bytes", recording.file_bytes},
                       {"whole_bytes", recording.whole_bytes},
                       {"damage", recording.damage.empty() ? ordered_json() : ordered_json(recording.damage)},
                       {"finished", recording.ending.has_value()},
                       {"events", ordered_json::array()},
                       {"marks", ordered_json::array()},
                       {"outcome", nullptr},
                       {"outcome_verified", false}};
  if (!d.branched_from.empty()) {
    json["branched"] = {{"from", d.branched_from},
                        {"id", base::HashText(d.branched_id)},
                        {"tick", d.branched_tick},
                        {"time_s", static_cast<double>(d.branched_tick) * d.tick_seconds}};
  }
  for (const record::EventMark& event : recording.events) {
    json["events"].push_back({{"time_s", static_cast<double>(event.tick) * d.tick_seconds},
                              {"kind", event.kind},
                              {"about", event.about},
                              {"error", event.is_error},
                              {"hand", event.hand}});
  }
  for (const record::TextMark& mark : recording.marks)
    json["marks"].push_back(
        {{"time_s", static_cast<double>(mark.tick) * d.tick_seconds}, {"text", mark.text}});
  if (!recording.ending) return json;
  auto outcome = host::ParseJson<ordered_json>(recording.ending->outcome, "outcome", host::kSmallJson);
  if (outcome.ok()) {
    json["outcome"] = std::move(*outcome);
  } else {
    json["outcome_unreadable"] = outcome.error().Text();
  }
  return json;
}

std::string HowItEnded(const Recording& recording) {
  if (!recording.damage.empty()) {
    return TranslateWith("damaged: {1}; {2} of {3} bytes are whole (trocar record repair)",
                         {TranslateComposed(recording.damage), std::to_string(recording.whole_bytes),
                          std::to_string(recording.file_bytes)});
  }
  return host::Translate(
      recording.ending
          ? host::Mark("finished")
          : host::Mark("not finished: the program ended before the attempt; what is there is whole"));
}

/// "    12.30 s  "
std::string FormatMoment(std::uint64_t tick, const record::Description& description) {
  const std::string time = host::ShownFixed(static_cast<double>(tick) * description.tick_seconds, 2);
  return std::string(time.size() < 10 ? 10 - time.size() : 0, ' ') + time + " s  ";
}

void PrintInfo(const Recording& recording) {
  const record::Description& d = recording.description;
  const std::string what = (d.level.empty() ? d.name : TranslateWith("{1}, level {2}", {d.name, d.level})) +
                           (d.patient.empty() ? "" : TranslateWith(", patient {1}", {d.patient})) +
                           TranslateWith(", seed {1}", {std::to_string(d.seed)});
  host::PrintLines(host::FormatFields(
      {{"recording of", what},
       {"played by", TranslateComposed(d.player)},
       {"started", d.started},
       {"written by", "trocar " + d.program + ", " + d.compiler},
       {"engine",
        d.engine_bits == simulation::kEngineBits
            ? std::to_string(d.engine_bits)
            : TranslateWith("{1}; this program has engine {2} and cannot replay it, one of engine {1} can",
                            {std::to_string(d.engine_bits), std::to_string(simulation::kEngineBits)})},
       {"goes on from",
        d.branched_from.empty()
            ? "-"
            : TranslateWith(
                  "{1} at {2} s",
                  {d.branched_from, ShownNumber(static_cast<double>(d.branched_tick) * d.tick_seconds, 4)})},
       {"length", TranslateWith("{1} s, {2} ticks", {ShownNumber(recording.Seconds(), 4),
                                                     std::to_string(recording.inputs.size())})},
       {"size", TranslateWith("{1} MB, with {2} keyframes and {3} hashes",
                              {ShownNumber(1e-6 * static_cast<double>(recording.file_bytes), 3),
                               std::to_string(recording.KeyframeTicks().size()),
                               std::to_string(recording.hashes.size())})},
       {"state", HowItEnded(recording)}}));
  const auto errors = std::count_if(recording.events.begin(), recording.events.end(),
                                    [](const record::EventMark& event) { return event.is_error; });
  if (errors > 0) Say("\n{1} errors:\n", errors);
  std::size_t shown = 0;
  for (const record::EventMark& event : recording.events) {
    if (!event.is_error || ++shown > kShownErrors) continue;
    PrintLine(FormatMoment(event.tick, d) + host::Translate(event.kind) +
              (event.about.empty() ? "" : ": " + TranslateComposed(event.about)));
  }
  if (shown > kShownErrors) Say("  and {1} more (--json)\n", shown - kShownErrors);
  for (const record::TextMark& mark : recording.marks)
    PrintLine(FormatMoment(mark.tick, d) + "\"" + mark.text + "\"");
}

void AddInfo(CLI::App& record, Outcome& outcome) {
  CLI::App* command = record.add_subcommand("info", "Say what a recording is of, and how it ended");
  auto path = std::make_shared<std::string>();
  auto is_json = std::make_shared<bool>(false);
  command->add_option("file", *path, "Recording")->required()->type_name("FILE");
  AddJsonFlag(*command, *is_json, "Machine-readable, with all events");
  command->callback([path, is_json, &outcome] {
    const auto recording = record::ReadRecording(*path);
    if (!recording.ok()) {
      outcome.status = recording.error();
    } else if (*is_json) {
      PrintJson(InfoJson(*recording));
    } else {
      PrintInfo(*recording);
    }
  });
}

void AddVerify(CLI::App& record, Outcome& outcome) {
  CLI::App* command = record.add_subcommand(
      "verify", "Check every byte of a recording by its checksums; trocar replay --verify computes it again");
  auto path = std::make_shared<std::string>();
  command->add_option("file", *path, "Recording")->required()->type_name("FILE");
  command->callback([path, &outcome] {
    const auto recording = record::ReadRecording(*path);
    if (!recording.ok()) {
      outcome.status = recording.error();
      return;
    }
    for (std::size_t frame = 0; frame < recording->KeyframeTicks().size(); ++frame) {
      if (const auto state = recording->ReadKeyframe(frame); !state.ok()) {
        outcome.status = state.error();
        return;
      }
    }
    PrintLine(*path + ": " + HowItEnded(*recording));
    outcome.has_finding = !recording->damage.empty();
  });
}

void AddRepair(CLI::App& record, Outcome& outcome) {
  CLI::App* command =
      record.add_subcommand("repair", "Write what is whole of a damaged recording to a new file");
  auto from = std::make_shared<std::string>(), to = std::make_shared<std::string>();
  command->add_option("file", *from, "Recording")->required()->type_name("FILE");
  command->add_option("-o,--output", *to, "New file")->required()->type_name("FILE");
  command->callback([from, to, &outcome] {
    outcome.status = record::RepairRecording(*from, *to);
    if (!outcome.status.ok()) return;
    const auto repaired = record::ReadRecording(*to);
    if (repaired.ok()) {
      Say("{1} holds {2} s; the damage and what came after it are left out\n", to->c_str(),
          ShownNumber(repaired->Seconds(), 4));
    }
  });
}

base::Status MakeIndex(const std::string& path, double seconds, int threads) {
  auto recording = record::ReadRecording(path);
  if (!recording.ok()) return recording.error();
  record::ReplaySettings settings;
  settings.threads = threads;
  settings.index = record::IndexPathOf(path);
  settings.visit_seconds = 0;
  auto replay = record::Replay::Open(std::move(*recording), settings);
  if (!replay.ok()) return replay.error();
  if (!replay->KeepsStatesOnDisk()) {
    return base::Error{base::ErrorCode::kFileUnwritable,
                       settings.index.string() +
                           " cannot be written, or another program does so; check the folder and its rights"};
  }
  host::ProgressBar progress("replaying", 1.0);
  for (;;) {
    const auto filled = replay->FillGap(replay->Tick(), seconds);
    if (!filled.ok()) return filled.error();
    if (!*filled) break;
    const record::Recording& of = replay->GetRecording();
    progress.Show(static_cast<double>(replay->Tick() - of.FirstTick()) /
                  static_cast<double>(std::max<std::size_t>(1, of.inputs.size())));
  }
  progress.Finish();
  if (const auto& divergence = replay->GetDivergence()) {
    return base::Error{base::ErrorCode::kRecordingInvalid, path + " is not replayed to the bit from tick " +
                                                               std::to_string(divergence->tick) +
                                                               " on; trocar replay --verify says more"};
  }
  std::error_code failure;
  const auto bytes = std::filesystem::file_size(settings.index, failure);
  Say("{1} holds {2} states, {3} MB; any moment is at most {4} s after one\n", settings.index,
      replay->KnownTicks().size(), ShownNumber(1e-6 * static_cast<double>(bytes), 3),
      ShownNumber(seconds, 3));
  return {};
}

void AddIndex(CLI::App& record, Outcome& outcome) {
  CLI::App* command = record.add_subcommand(
      "index", "Replay once and keep saved states beside a recording, so that any moment is found quickly");
  auto path = std::make_shared<std::string>();
  auto seconds = std::make_shared<double>(record::kIndexSeconds);
  auto threads = std::make_shared<int>(1);
  command->add_option("file", *path, "Recording")->required()->type_name("FILE");
  command->add_option("--seconds", *seconds, "Between two states [s]")
      ->check(CLI::Range(0.1, 600.0))
      ->type_name("S")
      ->capture_default_str();
  AddThreadsOption(*command, *threads);
  command->callback(
      [path, seconds, threads, &outcome] { outcome.status = MakeIndex(*path, *seconds, *threads); });
}

}  // namespace

void AddRecordCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "record");
  command->require_subcommand(1);
  AddInfo(*command, outcome);
  AddVerify(*command, outcome);
  AddRepair(*command, outcome);
  AddIndex(*command, outcome);
  command->footer(
      "trocar play and trocar simulate write one with --record FILE.\n"
      "Example: trocar record info attempt.trocar");
}

}  // namespace trocar::cli
