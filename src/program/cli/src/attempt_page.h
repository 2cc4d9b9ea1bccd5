// SPDX-License-Identifier: Apache-2.0
/// \file attempt_page.h  From an attempt to a report and its file: what `trocar report`, `trocar play --report` and `trocar demo` share.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/record/trace.h"
#include "trocar/report/attempt_report.h"
#include "trocar/report/trainee_report.h"
#include "trocar/simulation/simulation.h"
#include "trocar/view/critical_view_picture.h"
#include "trocar/view/demo.h"

namespace trocar::cli {

/// Kinds of report files, by the ending of their name.
enum class ReportKind { kHtml, kPdf, kCsv, kJson };
/// \return kUsage for another ending
base::Result<ReportKind> FindReportKind(const std::string& path);

/// \return kFileUnwritable, or as FindReportKind
base::Status WriteReport(const report::AttemptReport& report, const std::string& path);
/// \return kUsage for CSV and JSON, which are of one attempt
base::Status WriteReport(const report::TraineeReport& report, const std::string& path);

/// A report of a trace, with the coach's advice, the expert set where there is one, and what does not separate levels.
/// \return the error of a file of assets/, or of a trace that is not finite
base::Result<report::AttemptReport> ReportTrace(const training::AttemptTrace& trace,
                                                report::AttemptFacts facts);

/// With the names and the kind of score of a scene.
report::AttemptFacts DescribeScene(const scene::Scene& scene, report::AttemptFacts facts);

/// Replays a recording. The critical view of safety is drawn from both sides where it was achieved and there is OpenGL.
/// \param person  pseudonym, or empty
base::Result<report::AttemptReport> ReportRecording(const std::string& path, const std::string& person,
                                                    int threads);

/// Follows an attempt while it runs, for a report at its end.
class ReportWatch {
 public:
  /// Before the first step.
  /// \pre the simulation's scene lives until MakeReport
  void Start(const simulation::Simulation& simulation);
  /// After each step. \param controls  that were given to it
  void AfterStep(const simulation::Simulation& simulation,
                 const std::array<scene::HandControls, instrument::kHandCount>& controls);
  /// The critical view of safety is drawn from both sides, each as it was when that view came to count.
  base::Result<report::AttemptReport> MakeReport(report::AttemptFacts facts) const;

 private:
  std::optional<record::TraceBuilder> trace_;
  const scene::Scene* scene_ = nullptr;
  view::CriticalViewMoments critical_view_;  // when it was first achieved
  scene::ViewScore last_score_;
};

/// --report of a command that runs a simulation; does nothing where it was not asked for.
class RunReport {
 public:
  RunReport() = default;
  /// \param path  empty: no report
  RunReport(std::string path, report::AttemptFacts facts)
      : path_(std::move(path)), facts_(std::move(facts)) {}

  void Start(const simulation::Simulation& simulation);
  void AfterStep(const simulation::Simulation& simulation, const scene::Input& input);
  /// Has the hooks of a run with pictures do both.
  /// \pre this outlives the run, and nobody else has set these hooks
  void Follow(view::DemoOptions& options);
  /// \param pictures  of a run with pictures: goes into the report
  base::Status Write(const std::vector<view::DemoPicture>& pictures = {}) const;

 private:
  std::string path_;
  report::AttemptFacts facts_;
  ReportWatch watch_;
};

}  // namespace trocar::cli
