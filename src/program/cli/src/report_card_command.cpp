// SPDX-License-Identifier: Apache-2.0
/// \file report_card_command.cpp  `trocar reproduce report-card`.
#include <CLI/App.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "console.h"
#include "trocar/bench/benchmark.h"
#include "trocar/bench/physics_checks.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/safe_file.h"
#include "trocar/scene/scene.h"

namespace trocar::cli {

using host::Mark;

namespace {

struct ReportCardOptions {
  std::string folder, scene;
  bool is_quick = false;
};

base::Result<std::vector<bench::PhysicsCheck>> RunChecks(const ReportCardOptions& options) {
  const std::vector<std::function<bench::PhysicsCheck()>> analytic{
      bench::CheckPatch,       bench::CheckHangingChain,   bench::CheckIndentation, bench::CheckSelfWeight,
      bench::CheckEnergy,      bench::CheckMeshRefinement, bench::CheckFreedOrgan,  bench::CheckRodCantilever,
      bench::CheckRodBuckling, bench::CheckRodRing,        bench::CheckRodCatenary};
  std::vector<bench::PhysicsCheck> checks;
  host::ProgressBar progress("analytic cases", static_cast<double>(analytic.size()));
  for (const auto& run : analytic) {
    checks.push_back(run());
    progress.Show(static_cast<double>(checks.size()));
  }
  progress.Finish();
  if (options.is_quick) return checks;
  std::filesystem::path scene = options.scene, demonstration;
  const auto data = host::FindDataFolder();
  if (!data.ok()) return data.error();
  demonstration = *data / "scenes" / "demonstration.json";
  if (scene.empty()) scene = *data / "scenes" / "retraction.json";
  auto volume = bench::CheckVolume(scene);
  if (!volume.ok()) return volume.error();
  checks.push_back(std::move(*volume));
  auto rate = bench::CheckTickRate(demonstration, 3.6);
  if (!rate.ok()) return rate.error();
  checks.push_back(std::move(*rate));
  return checks;
}

base::Result<int> WriteReportCard(const ReportCardOptions& options) {
  auto checks = RunChecks(options);
  if (!checks.ok()) return checks.error();
  std::error_code failure;
  std::filesystem::create_directories(options.folder, failure);
  const auto page = std::filesystem::path(options.folder) / "report-card.html";
  if (const auto status = host::WriteFile(page, bench::FormatReportCard(*checks, bench::DescribeMachine()));
      !status.ok())
    return status.error();
  std::vector<std::vector<std::string>> rows = {{"figure", "measured", "unit", ""}};
  for (const bench::PhysicsCheck& check : *checks) {
    for (const bench::CheckFigure& figure : check.figures) {
      rows.push_back({figure.name, host::ShownNumber(figure.value), figure.unit,
                      host::Translate(figure.Passes()         ? Mark("passes")
                                      : figure.is_known_limit ? Mark("known limit")
                                                              : Mark("FAILS"))});
    }
  }
  host::PrintTable(rows);
  host::Say("\nPage: {1}\n", page.string());
  return bench::CountFailures(*checks);
}

}  // namespace

void AddReportCardCommand(CLI::App& reproduce, Outcome& outcome) {
  CLI::App* card = reproduce.add_subcommand(
      "report-card",
      "Physics against analytic cases and promises: HTML with plots; exit status 1 when a figure fails");
  const auto options = std::make_shared<ReportCardOptions>();
  card->add_option("-o,--output", options->folder, "Folder for report-card.html")->required();
  card->add_option("--scene", options->scene, "Scene whose script is watched [scenes/retraction.json]");
  card->add_flag("--quick", options->is_quick, "Analytic cases only: seconds instead of minutes");
  card->callback([options, &outcome] {
    const auto failures = WriteReportCard(*options);
    if (!failures.ok()) {
      outcome.status = failures.error();
    } else {
      outcome.has_finding = *failures > 0;
    }
  });
}

}  // namespace trocar::cli
