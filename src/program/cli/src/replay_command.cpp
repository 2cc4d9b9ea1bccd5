// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "attempt_recording.h"
#include "command.h"
#include "common_options.h"
#include "console.h"
#include "own_json.h"
#include "picture_size.h"
#include "replay_video.h"
#include "trocar/agent/taking_over.h"
#include "trocar/base/state_hash.h"
#include "trocar/files/state_file.h"
#include "trocar/host/clock.h"
#include "trocar/host/printable.h"
#include "trocar/host/translate.h"
#include "trocar/host/version.h"
#include "trocar/record/outcome.h"
#include "trocar/record/replay.h"
#include "trocar/render/image.h"
#include "trocar/scene/procedure.h"
#include "trocar/view/critical_view_picture.h"

namespace trocar::cli {

using host::ProgressBar;
using host::Say;
using host::ShownNumber;
using host::Translate;

namespace {

using nlohmann::ordered_json;
using record::Recording;
using record::Replay;

struct ReplayChoices {
  std::string file, beside;
  std::string surgeon, save, record;
  ReplayVideoOptions video;
  double at = -1;  // [s]
  double most_seconds = 3600;
  int threads = 1;
  bool is_verify = false, is_json = false, hides_forces = false, is_critical_view = false;
};

base::Status Verify(Replay& replay, const ReplayChoices& arguments, Outcome& outcome) {
  const Recording& recording = replay.GetRecording();
  ProgressBar progress("replaying", 1.0);
  const host::Stopwatch watch;
  const auto verified = replay.Verify([&](double share) { return progress.Show(share), true; });
  progress.Finish();
  if (!verified.ok()) return verified.error();
  const double tick = recording.description.tick_seconds;
  outcome.has_finding = !verified->IsVerified();
  if (arguments.is_json) {
    ordered_json json = {
        {"verified", verified->IsVerified()},
        {"ticks", verified->ticks},
        {"hashes", verified->hashes},
        {"finished", recording.ending.has_value()},
        {"damage", recording.damage.empty() ? ordered_json() : ordered_json(recording.damage)},
        {"diverged_at_s", nullptr},
        {"same_outcome", verified->is_outcome_same},
        {"hash", base::HashText(replay.GetSimulation().Hash())},
        {"replay_seconds", watch.Seconds()},
        {"outcome", ParseOwnJson(verified->outcome)}};
    if (verified->divergence) json["diverged_at_s"] = static_cast<double>(verified->divergence->tick) * tick;
    PrintJson(json);
    return {};
  }
  if (verified->divergence) {
    Say("DIVERGED at {1} s: the state's hash is {2}, recorded was {3}\n",
        host::ShownFixed(static_cast<double>(verified->divergence->tick) * tick, 2),
        base::HashText(verified->divergence->computed), base::HashText(verified->divergence->recorded));
  } else if (!verified->is_outcome_same) {
    constexpr std::size_t kMostShown = 2000;  // a recording of a stranger may hold megabytes
    Say("DIVERGED in the outcome: computed {1}, recorded was {2}\n",
        host::Printable(verified->outcome, kMostShown),
        host::Printable(recording.ending->outcome, kMostShown));
  } else {
    Say(recording.ending
            ? "VERIFIED: {1} ticks, {2} hashes and the outcome are those that were recorded\n"
            : "VERIFIED: {1} ticks, {2} hashes are those that were recorded; the recording has no ending\n",
        verified->ticks, verified->hashes);
  }
  const std::string& program = recording.description.program;
  if (!verified->IsVerified() && program != host::VersionText()) {
    Say("It was recorded by version {1}, and this is {2}: replay it with that one.\n", program,
        host::VersionText());
  }
  if (!recording.damage.empty())
    Say("The file is damaged ({1}): what comes after is missing.\n",
        host::TranslateComposed(recording.damage));
  return {};
}

/// Steps until the view is achieved, or to the end.
view::CriticalViewMoments FindCriticalView(Replay& replay) {
  view::CriticalViewMoments moments;
  ProgressBar progress("looking for the critical view", 1.0);
  const auto last = static_cast<double>(replay.GetRecording().LastTick());
  while (!replay.IsAtEnd() && !moments.IsAchieved()) {
    replay.Step();
    const simulation::Simulation& simulation = replay.GetSimulation();
    moments.AfterStep(simulation.GetSnapshot().operation.procedure.view, simulation.GetSnapshot().time,
                      [&](std::vector<std::byte>& state) { simulation.Save(state); });
    if (replay.Tick() % 120 == 0) progress.Show(static_cast<double>(replay.Tick()) / last);
  }
  progress.Finish();
  return moments;
}

/// Pictures of the moments at which the two views came to count, or of `at`, or of the end.
base::Status DrawCriticalView(Replay& replay, const ReplayChoices& arguments) {
  const auto size = ReadSize(arguments.video.size);
  if (!size.ok()) return size.error();
  if (!replay.GetSimulation().GetOperationResult())
    return base::Error{base::ErrorCode::kUsage, "--critical-view needs the recording of an operation"};
  const Recording& recording = replay.GetRecording();
  view::CriticalViewMoments moments;
  if (arguments.at >= 0) {
    if (const auto status = replay.Seek(TickAt(recording, arguments.at)); !status.ok()) return status;
  } else {
    moments = FindCriticalView(replay);
  }
  const double seconds = static_cast<double>(replay.Tick()) * recording.description.tick_seconds;
  auto front = replay.Branch(1), back = replay.Branch(1);
  if (!front.ok()) return front.error();
  if (!back.ok()) return back.error();
  if (moments.IsAchieved()) {
    if (auto status = front->Restore(moments.Front().state); !status.ok()) return status;
    if (auto status = back->Restore(moments.Behind().state); !status.ok()) return status;
  }
  const double front_seconds = moments.IsAchieved() ? moments.Front().time : seconds,
               back_seconds = moments.IsAchieved() ? moments.Behind().time : seconds;
  const auto doublet = view::RenderCriticalViewDoublet(*front, *back, (*size)[0], (*size)[1]);
  if (!doublet.ok()) return doublet.error();
  const std::filesystem::path folder = arguments.video.output;
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);  // what cannot be made cannot be written to
  const auto write = [&](const char* name, const view::CriticalViewPicture& picture) {
    return render::WritePng(folder / name, picture.image);
  };
  if (auto status = write("front.png", doublet->front); !status.ok()) return status;
  if (auto status = write("back.png", doublet->back); !status.ok()) return status;
  const simulation::OperationResult result = *replay.GetSimulation().GetOperationResult();
  const scene::ViewScore& score = result.procedure.now.view;
  if (arguments.is_json) {
    const auto picture = [](const char* name, double at, const view::CriticalViewPicture& p) {
      return ordered_json{
          {"file", name}, {"at_s", at}, {"azimuth_rad", p.azimuth}, {"shows_triangle", p.shows_triangle}};
    };
    const ordered_json json = {{"at_s", seconds},
                               {"achieved", score.IsAchieved()},
                               {"triangle", score.Points(0)},
                               {"plate", score.Points(1)},
                               {"two_structures", score.Points(2)},
                               {"front", picture("front.png", front_seconds, doublet->front)},
                               {"back", picture("back.png", back_seconds, doublet->back)}};
    PrintJson(json);
    return {};
  }
  Say("{1} holds front.png of {2} s and back.png of {3} s: the critical view is {4}\n",
      arguments.video.output, ShownNumber(front_seconds, 4), ShownNumber(back_seconds, 4),
      score.IsAchieved() ? Translate("achieved") : Translate("not achieved"));
  Say("Triangle cleared {1} of 2, lower third off the plate {2} of 2, two structures {3} of 2\n",
      score.Points(0), score.Points(1), score.Points(2));
  for (const std::string& reason : result.procedure.missing)
    host::PrintLine("  " + host::TranslateComposed(reason));
  return {};
}

/// "What if": somebody else goes on from here.
base::Status TakeOver(const Replay& replay, const ReplayChoices& arguments) {
  record::Description description =
      record::DescribeBranch(replay.GetRecording(), arguments.file, replay.Tick());
  const std::uint64_t seed = description.seed;
  auto branch = replay.Branch(arguments.threads);
  if (!branch.ok()) return branch.error();
  simulation::Simulation& simulation = *branch;
  auto surgeon =
      agent::MakeSurgeonTakingOver(arguments.surgeon, simulation.GetScene(), simulation.GetSnapshot(), seed);
  if (!surgeon.ok()) return surgeon.error();
  description.player = arguments.surgeon + ", taking over from " + description.player;
  auto recording = AttemptRecording::Start(arguments.record, description, simulation);
  if (!recording.ok()) return recording.error();
  ProgressBar progress("playing", 1.0);
  while (!(*surgeon)->HasFinished() && simulation.GetSnapshot().time < arguments.most_seconds) {
    const scene::Input input = (*surgeon)->Act(simulation.GetSnapshot());
    simulation.Step(input);
    recording->Add(input, simulation);
    if (simulation.GetSnapshot().tick % 60 != 0) continue;
    progress.SetLabel(ShownNumber(simulation.GetSnapshot().time, 4) + " s, " +
                      Translate((*surgeon)->Doing()));
    progress.Show(scene::MeasureOf(scene::ProcedureOf(simulation.GetScene()),
                                   simulation.GetSnapshot().operation.procedure, "detached_share"));
  }
  progress.Finish();
  if (const auto finished = recording->Finish(simulation); !finished.ok()) return finished.error();
  ordered_json json = {{"at_s", arguments.at},
                       {"surgeon", arguments.surgeon},
                       {"hash", base::HashText(simulation.Hash())},
                       {"outcome", ParseOwnJson(record::CalcOutcome(simulation))}};
  PrintJson(json);
  return {};
}

/// With the states that lie beside it, where there are any; keeps none.
base::Result<Replay> OpenReplay(Recording recording, const std::string& path, int threads) {
  record::ReplaySettings settings;
  settings.threads = threads;
  settings.visit_seconds = 0;
  std::error_code failure;
  if (const auto index = record::IndexPathOf(path); std::filesystem::exists(index, failure))
    settings.index = index;
  return Replay::Open(std::move(recording), settings);
}

base::Status DrawVideo(Replay& replay, const ReplayChoices& arguments) {
  ReplayVideoOptions options = arguments.video;
  options.has_forces = !arguments.hides_forces;
  if (arguments.beside.empty()) return MakeReplayVideo(replay, nullptr, options);
  auto recording = record::ReadRecording(arguments.beside);
  if (!recording.ok()) return recording.error();
  auto other = OpenReplay(std::move(*recording), arguments.beside, arguments.threads);
  if (!other.ok()) return other.error();
  return MakeReplayVideo(replay, &*other, options);
}

base::Status DoReplay(const ReplayChoices& arguments, Outcome& outcome) {
  const bool branches = !arguments.surgeon.empty() || !arguments.save.empty();
  if (arguments.is_critical_view && (branches || arguments.video.output.empty()))
    return base::Error{base::ErrorCode::kUsage,
                       "--critical-view goes with -o DIR, and with --at where another moment is wanted"};
  if (!arguments.is_critical_view && branches != (arguments.at >= 0))
    return base::Error{base::ErrorCode::kUsage, "--at goes with --surgeon or --save, and these with --at"};
  if (!arguments.record.empty() && arguments.surgeon.empty())
    return base::Error{base::ErrorCode::kUsage,
                       "--record goes with --surgeon: it records what happens instead"};
  if (branches && !arguments.video.output.empty())
    return base::Error{base::ErrorCode::kUsage,
                       "-o shows what was recorded; leave out --at, or record the branch and replay that"};
  if (!arguments.beside.empty() && arguments.video.output.empty())
    return base::Error{base::ErrorCode::kUsage, "--side-by-side goes with -o: name a folder for the video"};
  auto recording = record::ReadRecording(arguments.file);
  if (!recording.ok()) return recording.error();
  const double seconds = static_cast<double>(recording->LastTick()) * recording->description.tick_seconds;
  const double first = branches ? arguments.at : arguments.video.from;
  if (first > seconds) {
    return base::Error{base::ErrorCode::kUsage, "the recording ends at " + ShownNumber(seconds, 4) +
                                                    " s, before " + ShownNumber(first, 4) + " s"};
  }
  auto replay = OpenReplay(std::move(*recording), arguments.file, arguments.threads);
  if (!replay.ok()) return replay.error();
  if (arguments.is_critical_view) return DrawCriticalView(*replay, arguments);
  if (arguments.is_verify || (arguments.video.output.empty() && !branches)) {
    if (const auto status = Verify(*replay, arguments, outcome); !status.ok()) return status;
  }
  if (!arguments.video.output.empty()) return DrawVideo(*replay, arguments);
  if (!branches) return {};
  if (const auto status = replay->Seek(TickAt(replay->GetRecording(), first)); !status.ok()) return status;
  if (!arguments.save.empty()) {
    if (const auto saved = files::WriteStateFile(arguments.save, replay->GetSimulation()); !saved.ok())
      return saved;
  }
  return arguments.surgeon.empty() ? base::Status() : TakeOver(*replay, arguments);
}

}  // namespace

void AddReplayCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "replay");
  auto a = std::make_shared<ReplayChoices>();
  command->add_option("file", a->file, "Recording")->required()->type_name("FILE");
  command->add_flag(
      "--verify", a->is_verify,
      "Compute every tick again and compare hashes and outcome: VERIFIED, or where it DIVERGED (exit "
      "status 1); done where nothing else is asked for");
  command->add_option("-o,--output", a->video.output, "Folder for a video and pictures")->type_name("DIR");
  command->add_option("--from", a->video.from, "Where the video begins [s]")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("S");
  command->add_option("--until", a->video.until, "Where the video ends [s]")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("S");
  AddSizeOption(*command, a->video.size, "Of video and pictures [pixels]");
  command
      ->add_option(
          "--side-by-side", a->beside,
          "Another recording, shown at the right from the same second on: one's own beside the expert's")
      ->type_name("OTHER");
  command->add_option("--speed", a->video.speed, "Of the video: 0.5 is half as fast")
      ->check(CLI::Range(0.125, 64.0))
      ->type_name("X")
      ->capture_default_str();
  command
      ->add_option("--camera", a->video.camera,
                   "As recorded, or from a side of the patient, without abdominal wall")
      ->check(CLI::IsMember(ListReplayCameras()))
      ->type_name("SIDE")
      ->capture_default_str();
  command->add_flag("--no-forces", a->hides_forces, "Without the arrows of the forces on the tools");
  command->add_flag(
      "--ghosts", a->video.has_ghosts,
      "Show the ways of both tips in the last seconds, and with --side-by-side the other's tools, too");
  command->add_flag("--critical-view", a->is_critical_view,
                    "Of an operation: two pictures, front.png and back.png, each of the moment at which that "
                    "view came to count for an achieved critical view (or both of --at, or of the end), to "
                    "be scored by a person");
  command->add_option("--at", a->at, "Moment from which to go on otherwise [s]")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("S");
  command
      ->add_option("--surgeon", a->surgeon,
                   "What if: this scripted surgeon goes on from there (trocar play --list)")
      ->type_name("SURGEON");
  command->add_option("--save", a->save, "Write the state at that moment, for --restore of simulate")
      ->type_name("FILE");
  AddRecordOption(*command, a->record);
  AddThreadsOption(*command, a->threads);
  AddJsonFlag(*command, a->is_json);
  command->footer(
      "Examples:\n"
      "  trocar play novice --task peg_transfer --record attempt.trocar\n"
      "  trocar replay attempt.trocar --verify\n"
      "  trocar replay attempt.trocar --from 10 --until 20 -o video\n"
      "  trocar replay attempt.trocar --side-by-side expert.trocar --ghosts -o video\n"
      "  trocar replay attempt.trocar --at 12.5 --surgeon expert\n"
      "  trocar replay operation.trocar --critical-view -o doublet");
  command->callback([a, &outcome] { outcome.status = DoReplay(*a, outcome); });
}

}  // namespace trocar::cli
