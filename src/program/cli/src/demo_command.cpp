// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "attempt_page.h"
#include "command.h"
#include "common_options.h"
#include "console.h"
#include "igtl_option.h"
#include "live_input.h"
#include "own_json.h"
#include "part_folder.h"
#include "picture_size.h"
#include "trocar/base/state_hash.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/version.h"
#include "trocar/record/trace.h"
#include "trocar/training/attempt_metrics.h"
#include "trocar/training/metric_definition.h"
#include "trocar/view/demo.h"

namespace trocar::cli {

using host::Say;
using host::ShownNumber;
using host::Translate;
using host::TranslateComposed;
using host::TranslateWith;

namespace {

namespace fs = std::filesystem;

struct DemoArguments {
  std::string scene;
  std::string patient;  // in place of the scene's
  std::string device;   // in place of the script's hands
  std::string output = "out/demo";
  std::string size = "1280x720";
  double seconds = 0;
  int threads = 1;
  int igtl_port = -1;
  HapticOptions haptics;
};

base::Result<std::shared_ptr<const scene::Scene>> ReadSceneOrBuiltIn(const std::string& path,
                                                                     const std::string& patient) {
  fs::path file = path;
  if (path.empty()) {
    const base::Result<fs::path> folder = host::FindDataFolder();
    if (!folder) return folder.error();
    file = *folder / "scenes/demonstration.json";
  }
  base::Result<scene::Scene> scene = files::ReadScene(file, patient);
  if (!scene) return scene.error();
  return std::make_shared<const scene::Scene>(std::move(scene).value());
}

/// The metrics, what they were measured on, and what force feedback did: null without it.
std::string FormatDemoMetrics(const training::AttemptMetrics& metrics, const scene::Scene& scene,
                              const view::DemoReport& played, const HapticInput* haptics) {
  nlohmann::ordered_json json = {{"program", "trocar " + std::string(host::VersionText())},
                                 {"scene", scene.name},
                                 {"patient", scene.patient.name},
                                 {"seed", scene.seed},
                                 {"ticks", played.ticks},
                                 {"state_hash", base::HashText(played.state_hash)},
                                 {"disclaimer", training::MetricsDisclaimer()}};
  json["metrics"] = ParseOwnJson(training::FormatMetricsJson(metrics));
  json["haptics"] = nullptr;
  if (haptics != nullptr) {
    const std::string summary = session::FormatSummaryJson(haptics->Record().CalcSummary());
    json["haptics"] = ParseOwnJson(summary);
  }
  return host::FormatJson(json, 2) + "\n";
}

base::Result<std::string> MakePage(const scene::Scene& scene, const view::DemoReport& played,
                                   const training::AttemptTrace& trace, const HapticInput* haptics) {
  report::AttemptFacts facts = DescribeScene(scene, {});
  facts.patient = scene.patient.name;
  facts.seed = scene.seed;
  facts.program = host::VersionText();
  auto made = ReportTrace(trace, std::move(facts));
  if (!made.ok()) return made.error();
  report::AttemptReport report = std::move(*made);
  report.film = played.video.filename().string();
  for (const view::DemoPicture& picture : played.pictures) {
    base::Result<std::string> png = host::ReadFile(picture.path);
    if (!png) return png.error();
    report.pictures.push_back(
        {std::move(png).value(), TranslateWith("after {1} s", {ShownNumber(picture.time, 3)})});
  }
  report.origin = {
      {Translate("State hash"), base::HashText(played.state_hash)},
      {Translate("Ticks"),
       TranslateWith("{1} of {2} ms", {std::to_string(played.ticks), ShownNumber(1e3 * scene.tick_seconds)})},
      {Translate("Where the patient comes from"), TranslateComposed(scene.patient.provenance)}};
  if (haptics == nullptr) {
    report.origin.emplace_back(Translate("Force feedback"), Translate("No haptic device took part."));
  } else {
    for (const auto& [what, how] : session::DescribeSummary(haptics->Record().CalcSummary()))
      report.origin.emplace_back(TranslateWith("Force feedback: {1}", {Translate(what)}),
                                 TranslateComposed(how));
  }
  return report::FormatHtml(MakeDocument(report));
}

void PrintSummary(const view::DemoReport& played, const scene::Scene& scene, const fs::path& output) {
  Say("Played {1} s of \"{2}\": {3} ticks, state hash {4}\n",
      ShownNumber(static_cast<double>(played.ticks) * scene.tick_seconds), TranslateComposed(scene.name),
      played.ticks, base::HashText(played.state_hash));
  Say("Drew {1} frames with {2}: median {3} ms, p99 {4} ms a frame\n", played.frames, played.graphics,
      ShownNumber(1e3 * played.draw_median, 3), ShownNumber(1e3 * played.draw_p99, 3));
  Say("Wrote {1}: {2} pictures, {3}, metrics.json, report.html\n", output, played.pictures.size(),
      played.video.filename());
}

base::Status PlayDemo(const DemoArguments& arguments) {
  view::DemoOptions options;
  const auto size = ReadSize(arguments.size);
  if (!size) return size.error();
  options.width = (*size)[0], options.height = (*size)[1];
  const auto scene = ReadSceneOrBuiltIn(arguments.scene, arguments.patient);
  if (!scene) return scene.error();
  PartFolder part(arguments.output);
  options.duration = arguments.seconds;
  options.threads = arguments.threads;
  options.output_folder = part.Path();
  std::optional<record::TraceBuilder> trace;
  std::array<scene::HandControls, instrument::kHandCount> controls{};
  std::unique_ptr<net::IgtlServer> server;
  auto live = LiveInput::Open(arguments.device, **scene);
  if (!live) return live.error();
  options.source = live->get();
  options.on_start = [&](const simulation::Simulation& simulation) -> base::Status {
    trace.emplace(simulation);
    trace->Add(simulation.GetSnapshot());
    if (arguments.igtl_port >= 0) {
      auto listening = ServeViewers(arguments.igtl_port, simulation);
      if (!listening) return listening.error();
      server = std::move(*listening);
    }
    return (*live)->UseHaptics(arguments.haptics, simulation);
  };
  options.after_step = [&](simulation::Simulation& simulation, const scene::Input& input) {
    (*live)->AfterStep(simulation);
    controls = input.controls;
  };
  options.on_tick = [&](const simulation::Snapshot& snapshot) {
    trace->Add(snapshot, controls);
    if (server != nullptr) server->Publish(snapshot);
  };
  host::ProgressBar progress("playing", 1.0);
  options.on_progress = [&](double done) { progress.Show(done); };
  const base::Result<view::DemoReport> played = view::PlayDemonstration(*scene, options);
  progress.Finish();
  if (!played) return played.error();

  const HapticInput* haptics = (*live)->Haptics();
  const training::AttemptTrace attempt = trace->Calc();
  const base::Result<training::AttemptMetrics> metrics = training::CalcAttemptMetrics(attempt);
  if (!metrics) return metrics.error();
  const std::string metrics_text = FormatDemoMetrics(*metrics, **scene, *played, haptics);
  const base::Result<std::string> page = MakePage(**scene, *played, attempt, haptics);
  if (!page) return page.error();
  if (auto status = host::WriteFile(part.Path() / "metrics.json", metrics_text); !status) return status;
  if (auto status = host::WriteFile(part.Path() / "report.html", *page); !status) return status;
  if (auto status = part.Keep(); !status) return status;
  if (haptics != nullptr) {
    if (auto status = haptics->SaveRecord(); !status) return status;
  }
  PrintSummary(*played, **scene, arguments.output);
  return {};
}

}  // namespace

void AddDemoCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "demo");
  auto arguments = std::make_shared<DemoArguments>();
  command
      ->add_option("scene,--scene", arguments->scene,
                   "Scene file (JSON); the built-in demonstration if not given")
      ->type_name("FILE");
  command->add_option("--patient", arguments->patient, "Patient folder in place of the scene's")
      ->type_name("PATIENT");
  AddDeviceOption(*command, arguments->device);
  command->add_option("-o,--output", arguments->output, "Folder to write")
      ->type_name("DIR")
      ->capture_default_str();
  AddSizeOption(*command, arguments->size);
  command->add_option("--seconds", arguments->seconds, "Play so much of the script; all of it if not given")
      ->check(CLI::Range(0.01, 3600.0))
      ->type_name("S");
  AddThreadsOption(*command, arguments->threads);
  AddIgtlOption(*command, arguments->igtl_port);
  AddHapticOptions(*command, arguments->haptics);
  command->footer(
      "Needs OpenGL (in software will do) and no display. When anything fails, the folder stays as it was.\n"
      "Example: trocar demo -o out/demo --size 640x360 --seconds 5");
  command->callback([arguments, &outcome] { outcome.status = PlayDemo(*arguments); });
}

}  // namespace trocar::cli
