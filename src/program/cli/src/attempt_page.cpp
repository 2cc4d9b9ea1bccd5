// SPDX-License-Identifier: Apache-2.0
#include "attempt_page.h"

#include <cmath>
#include <filesystem>
#include <utility>

#include "console.h"
#include "trocar/host/printable.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/record/recording.h"
#include "trocar/record/replay.h"
#include "trocar/render/image.h"
#include "trocar/report/report_files.h"
#include "trocar/scene/scene.h"
#include "trocar/training/attempt_metrics.h"
#include "trocar/training/coach.h"
#include "trocar/view/critical_view_picture.h"
#include "validity_note.h"

namespace trocar::cli {

using host::TranslateWith;

namespace {

constexpr int kPictureWidth = 800, kPictureHeight = 450;  // of the critical view [px]

base::Error WrongEnding(const std::string& path, const std::string& endings) {
  return base::Error{base::ErrorCode::kUsage,
                     "\"" + host::Printable(path) + "\": a report ends in " + endings};
}

/// What the published score says of each criterion (0 to 2).
std::string DescribeScore(const scene::ViewScore& score) {
  const auto of = [](int points) { return TranslateWith("{1} of {2}", {std::to_string(points), "2"}); };
  return TranslateWith(
      "hepatocystic triangle cleared {1}, lower gallbladder off the liver {2}, two and only two structures "
      "{3}",
      {of(score.Points(0)), of(score.Points(1)), of(score.Points(2))});
}

/// A simulation as it was at a moment.
base::Result<simulation::Simulation> RestoreMoment(const scene::Scene& scene,
                                                   const view::CriticalViewMoments::Moment& moment) {
  auto made = simulation::Simulation::Make(
      std::shared_ptr<const scene::Scene>(std::shared_ptr<const scene::Scene>(), &scene));
  if (!made.ok()) return made.error();
  if (const auto restored = made->Restore(moment.state); !restored.ok()) return restored.error();
  return made;
}

/// Both pictures, or why there are none.
base::Result<report::DoubletView> DrawDoublet(const scene::Scene& scene,
                                              const view::CriticalViewMoments& moments,
                                              const scene::ViewScore& score) {
  report::DoubletView view;
  view.front_time = moments.Front().time;
  view.back_time = moments.Behind().time;
  const auto front = RestoreMoment(scene, moments.Front()), back = RestoreMoment(scene, moments.Behind());
  if (!front.ok()) return front.error();
  if (!back.ok()) return back.error();
  const auto doublet = view::RenderCriticalViewDoublet(*front, *back, kPictureWidth, kPictureHeight);
  if (!doublet.ok()) {
    view.verdict =
        TranslateWith("It was achieved. It could not be drawn here: {1}", {host::ShownText(doublet.error())});
    return view;
  }
  const auto front_png = render::FormatPng(doublet->front.image),
             back_png = render::FormatPng(doublet->back.image);
  if (front_png.ok() && back_png.ok()) {
    view.front_png = *front_png;
    view.back_png = *back_png;
  }
  view.verdict = TranslateWith(
      "Achieved: {1}; seen from the front and from behind. Each picture shows the moment at which that view "
      "came to count, for a person to judge.",
      {DescribeScore(score)});
  return view;
}

std::vector<report::MetricReference> ListReferences(const training::TaskValidity* task) {
  std::vector<report::MetricReference> references;
  if (task == nullptr) return references;
  for (const training::MeasureValidity& measure : task->measures) {
    if (training::FindMetric(measure.metric) == nullptr) continue;  // the coach's own
    report::MetricReference reference{measure.metric, measure.hand, "", {}, {}, {}, measure.separates};
    if (measure.experts > 1) {
      reference.expert_mean = measure.expert_mean;
      reference.expert_deviation = measure.expert_sd;
    }
    references.push_back(std::move(reference));
  }
  return references;
}

std::vector<report::Advice> ListAdvice(const std::vector<training::Advice>& said) {
  std::vector<report::Advice> advice;
  for (const training::Advice& one : said)
    advice.push_back({one.sentence, one.why, one.exercise, one.practise, one.time});
  return advice;
}

}  // namespace

base::Result<ReportKind> FindReportKind(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".html") return ReportKind::kHtml;
  if (ending == ".pdf") return ReportKind::kPdf;
  if (ending == ".csv") return ReportKind::kCsv;
  if (ending == ".json") return ReportKind::kJson;
  return WrongEnding(path, host::Mark(".html, .pdf, .csv or .json"));
}

base::Status WriteReport(const report::AttemptReport& report, const std::string& path) {
  const auto kind = FindReportKind(path);
  if (!kind.ok()) return kind.error();
  switch (*kind) {
    case ReportKind::kHtml:
      return host::WriteFile(path, report::FormatHtml(MakeDocument(report)));
    case ReportKind::kPdf:
      return host::WriteFile(path, report::FormatPdf(MakeDocument(report)));
    case ReportKind::kCsv:
      return host::WriteFile(path, report::FormatCsv(report));
    case ReportKind::kJson:
      return host::WriteFile(path, report::FormatJson(report));
  }
  return {};
}

base::Status WriteReport(const report::TraineeReport& report, const std::string& path) {
  const auto kind = FindReportKind(path);
  if (!kind.ok()) return kind.error();
  if (*kind == ReportKind::kHtml) return host::WriteFile(path, report::FormatHtml(MakeDocument(report)));
  if (*kind == ReportKind::kPdf) return host::WriteFile(path, report::FormatPdf(MakeDocument(report)));
  return WrongEnding(path,
                     host::Mark(".html or .pdf where it is of several attempts; CSV and JSON are of one"));
}

base::Result<report::AttemptReport> ReportTrace(const training::AttemptTrace& trace,
                                                report::AttemptFacts facts) {
  const auto metrics = training::CalcAttemptMetrics(trace);
  if (!metrics.ok()) return metrics.error();
  const auto validity = ReadValidity();
  if (!validity.ok()) return validity.error();
  const auto rules = ReadCoachRules();
  if (!rules.ok()) return rules.error();
  const training::TaskValidity* task = validity->FindTask(TaskKey(facts.task_key));
  const auto references = ListReferences(task);
  const auto advice = ListAdvice(training::CoachAttempt(trace, *metrics, *rules, task));
  return report::MakeAttemptReport(trace, *metrics, {std::move(facts), references, advice});
}

void ReportWatch::Start(const simulation::Simulation& simulation) {
  trace_.emplace(simulation);
  trace_->Add(simulation.GetSnapshot());
  scene_ = &simulation.GetScene();
}

void ReportWatch::AfterStep(const simulation::Simulation& simulation,
                            const std::array<scene::HandControls, instrument::kHandCount>& controls) {
  const simulation::Snapshot& now = simulation.GetSnapshot();
  trace_->Add(now, controls);
  if (!critical_view_.IsAchieved()) last_score_ = now.operation.procedure.view;
  critical_view_.AfterStep(now.operation.procedure.view, now.time,
                           [&](std::vector<std::byte>& state) { simulation.Save(state); });
}

base::Result<report::AttemptReport> ReportWatch::MakeReport(report::AttemptFacts facts) const {
  auto made = ReportTrace(trace_->Calc(), std::move(facts));
  if (!made.ok()) return made.error();
  report::AttemptReport report = std::move(*made);
  if (critical_view_.IsAchieved()) {
    auto doublet = DrawDoublet(*scene_, critical_view_, last_score_);
    if (!doublet.ok()) return doublet.error();
    report.doublet = std::move(*doublet);
  } else if (report.is_operation) {
    report.doublet =
        report::DoubletView{"", "", report.seconds, report.seconds,
                            TranslateWith("Not achieved. At the end: {1}.", {DescribeScore(last_score_)})};
  }
  return report;
}

report::AttemptFacts DescribeScene(const scene::Scene& scene, report::AttemptFacts facts) {
  facts.task = scene.task ? scene.task->name : scene.name;
  if (scene.task && scene.task->reference_points > 0) facts.best_score = scene.task->best_score;
  return facts;
}

base::Result<report::AttemptReport> ReportRecording(const std::string& path, const std::string& person,
                                                    int threads) {
  auto recording = record::ReadRecording(path);
  if (!recording.ok()) return recording.error();
  auto opened = record::Replay::Open(std::move(*recording), threads);
  if (!opened.ok()) return opened.error();
  record::Replay& replay = *opened;
  const record::Recording& played = replay.GetRecording();
  ReportWatch watch;
  watch.Start(replay.GetSimulation());
  host::ProgressBar progress("replaying", 1.0);
  while (!replay.IsAtEnd()) {
    const std::uint64_t done = replay.Tick() - played.FirstTick();
    replay.Step();
    watch.AfterStep(replay.GetSimulation(), played.inputs[done].controls);
    if (done % 30 == 0) progress.Show(static_cast<double>(done) / static_cast<double>(played.inputs.size()));
  }
  progress.Finish();
  if (replay.GetDivergence()) {
    return base::Error{base::ErrorCode::kRecordingInvalid,
                       host::Printable(path) +
                           " does not replay to the states that were recorded, and a report would be of "
                           "something else (trocar replay --verify)"};
  }
  report::AttemptFacts facts = report::DescribeAttempt(played.description, "");
  facts = DescribeScene(replay.GetSimulation().GetScene(), std::move(facts));
  facts.task_key = TaskKey(facts.task_key);
  facts.person = person;
  facts.recording = std::filesystem::path(path).filename().string();
  facts.is_as_recorded = replay.IsEndingSame();
  return watch.MakeReport(std::move(facts));
}

void RunReport::Start(const simulation::Simulation& simulation) {
  if (!path_.empty()) watch_.Start(simulation);
}

void RunReport::AfterStep(const simulation::Simulation& simulation, const scene::Input& input) {
  if (!path_.empty()) watch_.AfterStep(simulation, input.controls);
}

void RunReport::Follow(view::DemoOptions& options) {
  if (path_.empty()) return;
  options.on_start = [this](const simulation::Simulation& simulation) -> base::Status {
    watch_.Start(simulation);
    return {};
  };
  options.after_step = [this](simulation::Simulation& simulation, const scene::Input& input) {
    watch_.AfterStep(simulation, input.controls);
  };
}

base::Status RunReport::Write(const std::vector<view::DemoPicture>& pictures) const {
  if (path_.empty()) return {};
  auto report = watch_.MakeReport(facts_);
  if (!report.ok()) return report.error();
  for (const view::DemoPicture& picture : pictures) {
    auto png = host::ReadFile(picture.path);
    if (!png.ok()) return png.error();
    report->pictures.push_back(
        {std::move(*png), TranslateWith("after {1} s", {host::ShownNumber(picture.time, 3)})});
  }
  return WriteReport(*report, path_);
}

}  // namespace trocar::cli
