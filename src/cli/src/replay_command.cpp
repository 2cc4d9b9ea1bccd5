// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "attempt_recording.h"
#include "command.h"
#include "console.h"
#include "part_folder.h"
#include "picture_size.h"
#include "trocar/agent/surgeon.h"
#include "trocar/core/clock.h"
#include "trocar/core/state_hash.h"
#include "trocar/record/outcome.h"
#include "trocar/record/replay.h"
#include "trocar/render/image.h"
#include "trocar/simulation/state_file.h"
#include "trocar/training/critical_view.h"
#include "trocar/view/critical_view_picture.h"
#include "trocar/view/demo.h"

namespace trocar::cli {
namespace {

using nlohmann::ordered_json;
using record::Recording;
using record::Replay;

struct ReplayArguments {
  std::string file, output, size = "1280x720";
  std::string surgeon, save, record;
  double from = 0, until = std::numeric_limits<double>::infinity(), at = -1;  // [s]
  double most_seconds = 3600;
  int threads = 1;
  bool is_verify = false, is_json = false, is_critical_view = false;
};

/// The recorded hands in the place of a surgeon's.
class RecordedHands final : public agent::Surgeon {
 public:
  RecordedHands(const Recording& recording, std::uint64_t last_tick)
      : recording_(recording), last_tick_(last_tick) {}
  scene::Input Act(const simulation::Snapshot& seen) override {
    tick_ = seen.tick + 1;
    return recording_.inputs[seen.tick - recording_.FirstTick()];
  }
  bool HasFinished() const override { return tick_ >= last_tick_; }
  void VisitState(core::StateArchive& archive) override { archive.Field("tick", tick_); }
  std::string_view Doing() const override { return "replaying"; }

 private:
  const Recording& recording_;
  std::uint64_t last_tick_, tick_ = 0;
};

std::uint64_t TickAt(const Recording& recording, double seconds) {
  const double last = static_cast<double>(recording.LastTick());
  const double tick = std::floor(std::min(seconds / recording.description.tick_seconds, last) + 0.5);
  return tick <= static_cast<double>(recording.FirstTick()) ? recording.FirstTick()
                                                            : static_cast<std::uint64_t>(tick);
}

core::Status Verify(Replay& replay, const ReplayArguments& arguments, Outcome& outcome) {
  const Recording& recording = replay.GetRecording();
  ProgressBar progress("replaying", 1.0);
  const core::Stopwatch watch;
  const auto verified = replay.Verify([&](double share) { progress.Show(share); });
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
        {"hash", core::HashText(replay.GetSimulation().Hash())},
        {"replay_seconds", watch.Seconds()},
        {"outcome", ordered_json::parse(verified->outcome, nullptr, false)}};
    if (verified->divergence) json["diverged_at_s"] = static_cast<double>(verified->divergence->tick) * tick;
    std::printf("%s\n", json.dump(2, ' ', false, ordered_json::error_handler_t::replace).c_str());
    return {};
  }
  if (verified->divergence) {
    std::printf("DIVERGED at %.2f s: the state's hash is %s, recorded was %s\n",
                static_cast<double>(verified->divergence->tick) * tick,
                core::HashText(verified->divergence->computed).c_str(),
                core::HashText(verified->divergence->recorded).c_str());
  } else if (!verified->is_outcome_same) {
    std::printf("DIVERGED in the outcome: computed %s, recorded was %s\n", verified->outcome.c_str(),
                recording.ending->outcome.c_str());
  } else {
    std::printf("VERIFIED: %llu ticks, %llu hashes%s\n", static_cast<unsigned long long>(verified->ticks),
                static_cast<unsigned long long>(verified->hashes),
                recording.ending ? " and the outcome are those that were recorded"
                                 : " are those that were recorded; the recording has no ending");
  }
  if (!recording.damage.empty())
    std::printf("The file is damaged (%s): what comes after is missing.\n", recording.damage.c_str());
  return {};
}

core::Status MakeVideo(const Replay& replay, const ReplayArguments& arguments) {
  const auto size = ReadSize(arguments.size);
  if (!size.ok()) return size.error();
  const Recording& recording = replay.GetRecording();
  const std::uint64_t last = TickAt(recording, arguments.until);
  if (last <= replay.Tick())
    return core::Error{core::ErrorCode::kUsage, "--from and --until leave nothing to show"};
  RecordedHands hands(recording, last);
  PartFolder part(arguments.output);
  view::DemoOptions options;
  options.width = (*size)[0], options.height = (*size)[1];
  options.threads = arguments.threads;
  options.output_folder = part.Path();
  options.surgeon = &hands;
  options.duration = static_cast<double>(last - replay.Tick()) * recording.description.tick_seconds;
  replay.GetSimulation().Save(options.start);
  ProgressBar progress("drawing", 1.0);
  options.on_progress = [&](double share) { progress.Show(share); };
  // the scene is that of the simulation, which outlives the drawing
  const auto played =
      view::PlayDemonstration(std::shared_ptr<const scene::Scene>(std::shared_ptr<const scene::Scene>(),
                                                                  &replay.GetSimulation().GetScene()),
                              options);
  progress.Finish();
  if (!played.ok()) return played.error();
  if (const auto kept = part.Keep(); !kept.ok()) return kept.error();
  std::printf(
      "%s holds demo.webm and %zu pictures, from %s s to %s s\n", arguments.output.c_str(),
      played->pictures.size(),
      FormatNumber(static_cast<double>(replay.Tick()) * recording.description.tick_seconds, 4).c_str(),
      FormatNumber(static_cast<double>(last) * recording.description.tick_seconds, 4).c_str());
  return {};
}

/// Pictures of the moment at which the view was achieved, or of `at`, or of the end.
core::Status DrawCriticalView(Replay& replay, const ReplayArguments& arguments) {
  const auto size = ReadSize(arguments.size);
  if (!size.ok()) return size.error();
  if (!replay.GetSimulation().GetOperationResult())
    return core::Error{core::ErrorCode::kUsage, "--critical-view needs the recording of an operation"};
  const Recording& recording = replay.GetRecording();
  const auto is_achieved = [&] {
    return replay.GetSimulation().GetSnapshot().operation.critical_view.IsAchieved();
  };
  if (arguments.at >= 0) {
    if (const auto status = replay.Seek(TickAt(recording, arguments.at)); !status.ok()) return status;
  } else {
    ProgressBar progress("looking for the critical view", 1.0);
    while (!replay.IsAtEnd() && !is_achieved()) {
      replay.Step();
      if (replay.Tick() % 120 == 0)
        progress.Show(static_cast<double>(replay.Tick()) / static_cast<double>(recording.LastTick()));
    }
    progress.Finish();
  }
  const auto doublet = view::RenderCriticalViewDoublet(replay.GetSimulation(), (*size)[0], (*size)[1]);
  if (!doublet.ok()) return doublet.error();
  const std::filesystem::path folder = arguments.output;
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);  // what cannot be made cannot be written to
  const auto write = [&](const char* name, const view::CriticalViewPicture& picture) {
    return render::WritePng(folder / name, picture.image);
  };
  if (auto status = write("front.png", doublet->front); !status.ok()) return status;
  if (auto status = write("back.png", doublet->back); !status.ok()) return status;
  const simulation::OperationResult result = *replay.GetSimulation().GetOperationResult();
  const double seconds = static_cast<double>(replay.Tick()) * recording.description.tick_seconds;
  const auto& score = result.critical_view;
  if (arguments.is_json) {
    const auto picture = [](const char* name, const view::CriticalViewPicture& p) {
      return ordered_json{{"file", name}, {"azimuth_rad", p.azimuth}, {"shows_triangle", p.shows_triangle}};
    };
    const ordered_json json = {{"at_s", seconds},
                               {"achieved", score.IsAchieved()},
                               {"triangle", score.criteria[0]},
                               {"plate", score.criteria[1]},
                               {"two_structures", score.criteria[2]},
                               {"front", picture("front.png", doublet->front)},
                               {"back", picture("back.png", doublet->back)}};
    std::printf("%s\n", json.dump(2).c_str());
    return {};
  }
  std::printf("%s holds front.png and back.png of %s s: the critical view is %s\n", arguments.output.c_str(),
              FormatNumber(seconds, 4).c_str(), score.IsAchieved() ? "achieved" : "not achieved");
  std::printf("Triangle cleared %d of 2, lower third off the plate %d of 2, two structures %d of 2\n",
              score.criteria[0], score.criteria[1], score.criteria[2]);
  for (const std::string& reason : training::ExplainCriticalView(result.facts, score))
    std::printf("  %s\n", reason.c_str());
  return {};
}

/// "What if": somebody else goes on from here.
core::Status TakeOver(Replay replay, const ReplayArguments& arguments) {
  record::Description description = replay.GetRecording().description;
  const std::uint64_t seed = description.seed;
  simulation::Simulation simulation = std::move(replay).Branch();
  const std::shared_ptr<const scene::Scene> scene(std::shared_ptr<const scene::Scene>(),
                                                  &simulation.GetScene());
  auto surgeon = agent::MakeSurgeon(arguments.surgeon, scene, seed);
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
    progress.SetLabel(FormatNumber(simulation.GetSnapshot().time, 4) + " s, " +
                      std::string((*surgeon)->Doing()));
    progress.Show(simulation.GetSnapshot().operation.facts.detached_share);
  }
  progress.Finish();
  if (const auto finished = recording->Finish(simulation); !finished.ok()) return finished.error();
  ordered_json json = {{"at_s", arguments.at},
                       {"surgeon", arguments.surgeon},
                       {"hash", core::HashText(simulation.Hash())},
                       {"outcome", ordered_json::parse(record::CalcOutcome(simulation), nullptr, false)}};
  std::printf("%s\n", json.dump(2, ' ', false, ordered_json::error_handler_t::replace).c_str());
  return {};
}

core::Status DoReplay(const ReplayArguments& arguments, Outcome& outcome) {
  const bool branches = !arguments.surgeon.empty() || !arguments.save.empty();
  if (arguments.is_critical_view && (branches || arguments.output.empty()))
    return core::Error{core::ErrorCode::kUsage,
                       "--critical-view goes with -o DIR, and with --at where another moment is wanted"};
  if (!arguments.is_critical_view && branches != (arguments.at >= 0))
    return core::Error{core::ErrorCode::kUsage, "--at goes with --surgeon or --save, and these with --at"};
  if (!arguments.record.empty() && arguments.surgeon.empty())
    return core::Error{core::ErrorCode::kUsage,
                       "--record goes with --surgeon: it records what happens instead"};
  if (branches && !arguments.output.empty())
    return core::Error{core::ErrorCode::kUsage,
                       "-o shows what was recorded; leave out --at, or record the branch and replay that"};
  auto recording = record::ReadRecording(arguments.file);
  if (!recording.ok()) return recording.error();
  const double seconds = static_cast<double>(recording->LastTick()) * recording->description.tick_seconds;
  const double first = branches ? arguments.at : arguments.from;
  if (first > seconds) {
    return core::Error{core::ErrorCode::kUsage, "the recording ends at " + FormatNumber(seconds, 4) +
                                                    " s, before " + FormatNumber(first, 4) + " s"};
  }
  auto replay = Replay::Open(std::move(*recording), arguments.threads);
  if (!replay.ok()) return replay.error();
  if (arguments.is_critical_view) return DrawCriticalView(*replay, arguments);
  if (arguments.is_verify || (arguments.output.empty() && !branches)) {
    if (const auto status = Verify(*replay, arguments, outcome); !status.ok()) return status;
  }
  if (arguments.output.empty() && !branches) return {};
  if (const auto status = replay->Seek(TickAt(replay->GetRecording(), first)); !status.ok()) return status;
  if (!arguments.output.empty()) return MakeVideo(*replay, arguments);
  if (!arguments.save.empty()) {
    if (const auto saved = simulation::WriteStateFile(arguments.save, replay->GetSimulation()); !saved.ok())
      return saved;
  }
  return arguments.surgeon.empty() ? core::Status() : TakeOver(std::move(*replay), arguments);
}

}  // namespace

void AddReplayCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = app.add_subcommand(
      "replay", "Play a recording again: verify it to the bit, draw it, or go on from any moment of it");
  auto a = std::make_shared<ReplayArguments>();
  command->add_option("file", a->file, "Recording")->required()->type_name("FILE");
  command->add_flag(
      "--verify", a->is_verify,
      "Compute every tick again and compare hashes and outcome: VERIFIED, or where it DIVERGED (exit "
      "status 1); done where nothing else is asked for");
  command->add_option("-o,--output", a->output, "Folder for a video and pictures")->type_name("DIR");
  command->add_option("--from", a->from, "Where the video begins [s]")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("S");
  command->add_option("--until", a->until, "Where the video ends [s]")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("S");
  command->add_option("--size", a->size, "Of video and pictures [pixels]")
      ->type_name("WxH")
      ->capture_default_str();
  command->add_flag(
      "--critical-view", a->is_critical_view,
      "Of an operation: two pictures, front.png and back.png, of the moment at which the critical view was "
      "achieved (or of --at, or of the end), to be scored by a person");
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
  command->add_option("--threads", a->threads, "Of the solver; the result is the same for any number")
      ->check(CLI::Range(1, 256))
      ->type_name("T")
      ->capture_default_str();
  command->add_flag("--json", a->is_json, "Machine-readable");
  command->footer(
      "Examples:\n"
      "  trocar play novice --task peg_transfer --record attempt.trocar\n"
      "  trocar replay attempt.trocar --verify\n"
      "  trocar replay attempt.trocar --from 10 --until 20 -o video\n"
      "  trocar replay attempt.trocar --at 12.5 --surgeon expert\n"
      "  trocar replay operation.trocar --critical-view -o doublet");
  command->callback([a, &outcome] { outcome.status = DoReplay(*a, outcome); });
}

}  // namespace trocar::cli
