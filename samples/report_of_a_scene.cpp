// SPDX-License-Identifier: Apache-2.0
/// \file report_of_a_scene.cpp  Two seconds of a scene, and the page and PDF that a person would read of them.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "trocar/files/scene_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/record/trace.h"
#include "trocar/report/attempt_report.h"
#include "trocar/training/attempt_metrics.h"

namespace {

using namespace trocar;

base::Status Report(const std::string& scene_file, const std::filesystem::path& folder) {
  auto read = files::ReadScene(scene_file);
  if (!read.ok()) return read.error();
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto simulation = simulation::Simulation::Make(scene);
  if (!simulation.ok()) return simulation.error();
  record::TraceBuilder trace(*simulation);
  trace.Add(simulation->GetSnapshot());
  for (int tick = 0; tick < 240; ++tick) {
    const scene::Input input = scene::CalcScriptInput(*scene, simulation->GetSnapshot().time);
    simulation->Step(input);
    trace.Add(simulation->GetSnapshot(), input.controls);
  }
  const training::AttemptTrace attempt = trace.Calc();
  const auto metrics = training::CalcAttemptMetrics(attempt);
  if (!metrics.ok()) return metrics.error();
  report::AttemptFacts facts;
  facts.task = scene->name;
  facts.person = "T-SAMPLE";
  facts.seed = scene->seed;
  const report::Document document =
      report::MakeDocument(report::MakeAttemptReport(attempt, *metrics, {facts, {}, {}}));
  for (const report::Section& section : document.sections) std::printf("  %s\n", section.title.c_str());
  if (auto written = host::WriteFile(folder / "report.html", report::FormatHtml(document)); !written.ok())
    return written;
  if (auto written = host::WriteFile(folder / "report.pdf", report::FormatPdf(document)); !written.ok())
    return written;
  std::printf("one page and one PDF in %s\n", folder.c_str());
  return {};
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2 && count != 3) {
    std::fprintf(stderr, "usage: %s scenes/demonstration.json [FOLDER]\n", arguments[0]);
    return 2;
  }
  const bool is_kept = count == 3;
  const std::filesystem::path folder =
      is_kept ? std::filesystem::path(arguments[2])
              : std::filesystem::temp_directory_path() / ("sample_report_" + std::to_string(::getpid()));
  const base::Status reported = Report(arguments[1], folder);
  if (!is_kept) std::filesystem::remove_all(folder);
  if (reported.ok()) return 0;
  std::fprintf(stderr, "%s\n", reported.error().Text().c_str());
  return 1;
}
