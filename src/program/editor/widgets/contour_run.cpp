// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "trocar/gui/window_screenshot.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"

namespace trocar::editor {
namespace {

constexpr double kLongestRun = 180;    // a run that hangs must not hang a test [s]
constexpr double kMeasureSeconds = 6;  // of dragging
constexpr int kMostTries = 20;         // for a screenshot
constexpr std::size_t kWarmUp = 10;    // first frames do not count

double Quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

}  // namespace

ContourRun::ContourRun(const Parts& parts, const host::Stopwatch& since_start)
    : at_(parts), since_start_(since_start) {
  tick_ = at_.canvas.add_tick_callback([this](const Glib::RefPtr<Gdk::FrameClock>& clock) {
    return OnFrame(1e-6 * static_cast<double>(clock->get_frame_time()));
  });
}

ContourRun::~ContourRun() {
  timer_.disconnect();
  at_.canvas.remove_tick_callback(tick_);
}

void ContourRun::After(unsigned milliseconds, void (ContourRun::*act)()) {
  timer_ = Glib::signal_timeout().connect(
      [this, act] {
        (this->*act)();
        return false;
      },
      milliseconds);
}

bool ContourRun::AnswerSizes() {
  if (!ReadScript()) return true;
  if (script_.empty() || script_.front().verb != "sizes") return false;
  const std::vector<std::string> words = script_.front().words;
  script_.pop_front();
  at_.series_bar.Fill({words[0], words[1], {words[2], words[3], words[4]}});
  at_.series_bar.Answer();
  if (const std::string complaint = at_.series_bar.Complaint(); !complaint.empty())
    at_.presenter.Abandon({base::ErrorCode::kScriptInvalid, complaint});
  return true;
}

/// \return whether there is a script, or none was asked for; otherwise the run has ended
bool ContourRun::ReadScript() {
  if (is_script_read_ || at_.presenter.GetOptions().script.empty()) return true;
  is_script_read_ = true;
  const auto text = host::ReadFile(at_.presenter.GetOptions().script);
  if (!text.ok()) {
    at_.presenter.Abandon(text.error());
    return false;
  }
  auto steps = ParseContourScript(*text, at_.presenter.GetOptions().script.filename().string());
  if (!steps.ok()) {
    at_.presenter.Abandon(steps.error());
    return false;
  }
  script_.assign(steps->begin(), steps->end());
  return true;
}

void ContourRun::RunScript() {
  if (!ReadScript()) return;
  while (!script_.empty()) {
    const ScriptStep step = script_.front();
    if (step.verb == "await") {
      const bool is_waiting =
          step.words[0] == "build" ? at_.presenter.IsBuilding() : !at_.presenter.AreSurfacesDone();
      if (is_waiting) return;
      script_.pop_front();
      continue;
    }
    script_.pop_front();
    const auto done = RunScriptStep(step, *at_.presenter.Editor());
    if (!done.ok()) return at_.presenter.Abandon(done.error());
    if (!*done) {
      if (const auto status = DoStep(step); !status.ok()) {
        return at_.presenter.Abandon({status.error().code, "line " + std::to_string(step.line) +
                                                               " of the script: " + status.error().message});
      }
    }
    at_.presenter.OnEdited();
  }
}

base::Status ContourRun::DoStep(const ScriptStep& step) {
  if (step.verb == "show") {
    if (!at_.presenter.SetPart(step.words[0], step.words[1] == "on"))
      return base::Error{base::ErrorCode::kScriptInvalid, "show reference, ghosts, points, fill or help"};
  } else if (step.verb == "answer") {
    std::string label = step.words[0];
    for (std::size_t i = 1; i < step.words.size(); ++i) label += " " + step.words[i];
    if (!at_.bars.Press(label)) {
      return base::Error{base::ErrorCode::kScriptInvalid,
                         "no question is shown that \"" + label + "\" answers"};
    }
  } else if (step.verb == "build") {
    if (!at_.presenter.CanBuild()) {
      return base::Error{base::ErrorCode::kScriptInvalid,
                         "build needs saved contours, and no patient that is being built"};
    }
    at_.presenter.StartBuild(step.words[0]);
  } else if (step.verb == "stop-build") {
    at_.presenter.Stop();
  } else if (step.verb == "sizes") {
    return base::Error{base::ErrorCode::kScriptInvalid, "the pictures say their sizes, or the options do"};
  }
  return {};
}

bool ContourRun::OnFrame(double now) {
  if (at_.presenter.GetFailure() || is_over_) return true;
  if (since_start_.Seconds() > kLongestRun) {
    at_.presenter.Abandon(
        {base::ErrorCode::kUsage, "the run did not end in three minutes; this computer is too slow for it"});
    return true;
  }
  if (at_.presenter.Editor() == nullptr || at_.canvas.PaintCount() == 0) return true;
  RunScript();
  if (at_.presenter.GetFailure() || !script_.empty()) return true;
  if (at_.presenter.GetOptions().is_measuring) {
    MeasureFrame(now);
    return true;
  }
  const bool is_idle = at_.presenter.AreSurfacesDone();
  if (since_start_.Seconds() < at_.presenter.GetOptions().run.screenshot_after || !is_idle) {
    at_.canvas.queue_draw();
    return true;
  }
  is_over_ = true;
  // outside of the frame, and after the last surface has been drawn
  After(300, &ContourRun::SaveScreenshot);
  return true;
}

void ContourRun::MeasureFrame(double now) {
  if (measure_begin_ == 0) measure_begin_ = now;
  ContourEditor& editor = *at_.presenter.Editor();
  const auto& here = editor.Here();
  if (here.contours.empty()) {
    return at_.presenter.Abandon(
        {base::ErrorCode::kUsage, "--measure needs a contour to drag: name --points with some"});
  }
  if (now - measure_begin_ > kMeasureSeconds) {
    is_over_ = true;
    After(0, &ContourRun::FinishMeasuring);
    return;
  }
  if (at_.canvas.PaintCount() > last_paints_ && last_frame_ > 0) {
    measured_.frame.push_back(now - last_frame_);
    measured_.paint.push_back(at_.canvas.LastPaintSeconds());
  }
  last_paints_ = at_.canvas.PaintCount();
  last_frame_ = now;
  // as a hand would: press on a point, move it round in a small circle, each frame another place
  const double angle = 7.0 * (now - measure_begin_);
  if (!editor.IsDragging()) {
    editor.Press(ToCanvas(editor.view, editor.size, here.contours[0][0]), false);
  }
  const math::Vec2 start = ToCanvas(editor.view, editor.size, here.contours[0][0]);
  const host::Stopwatch stopwatch;
  editor.Drag(start + math::Vec2{3 * std::cos(angle), 3 * std::sin(angle)});
  (void)editor.Fit().ok();
  measured_.fit.push_back(stopwatch.Seconds());
  at_.presenter.OnEdited();
}

void ContourRun::FinishMeasuring() {
  at_.presenter.Editor()->Do(ContourAction::kCancel);
  for (auto* values : {&measured_.fit, &measured_.paint, &measured_.frame}) {
    values->erase(values->begin(),
                  values->begin() + static_cast<std::ptrdiff_t>(std::min(kWarmUp, values->size())));
  }
  std::string organs;
  for (const auto& [structure, mesh] : at_.panel.Presenter().Meshes()) {
    char text[160];
    std::snprintf(text, sizeof(text),
                  "%s{\"triangles\": %zu, \"volume_ml\": %.1f, \"spacing_mm\": %.2f, \"s\": %.3f}",
                  organs.empty() ? "" : ", ", mesh.mesh.triangles.size(), mesh.volume_ml, mesh.spacing_mm,
                  mesh.seconds);
    organs += text;
  }
  std::printf(
      "{\"canvas\": [%d, %d], \"picture\": [%d, %d], \"frames\": %zu, \"refit_median_ms\": %.2f, "
      "\"refit_p95_ms\": %.2f, \"paint_median_ms\": %.2f, \"paint_p95_ms\": %.2f, \"frame_median_ms\": %.2f, "
      "\"redraws_per_second\": %.1f, \"previews\": [%s]}\n",
      at_.canvas.get_width(), at_.canvas.get_height(), at_.presenter.Workspace()->Series().width,
      at_.presenter.Workspace()->Series().height, measured_.frame.size(), 1e3 * Quantile(measured_.fit, 0.5),
      1e3 * Quantile(measured_.fit, 0.95), 1e3 * Quantile(measured_.paint, 0.5),
      1e3 * Quantile(measured_.paint, 0.95), 1e3 * Quantile(measured_.frame, 0.5),
      static_cast<double>(measured_.frame.size()) / kMeasureSeconds, organs.c_str());
  at_.window.close();
}

void ContourRun::SaveScreenshot() {
  const auto saved = gui::TrySaveScreenshot(at_.window, at_.presenter.GetOptions().run.screenshot);
  if (!saved.ok()) return at_.presenter.Abandon(saved.error());
  // a window that is being laid out anew has nothing to show for a moment
  if (!*saved && ++screenshot_tries_ < kMostTries) return After(100, &ContourRun::SaveScreenshot);
  if (!*saved)
    return at_.presenter.Abandon({base::ErrorCode::kNoGraphics, "the window shows nothing; try again"});
  PrintReport();
  at_.window.close();
}

void ContourRun::PrintReport() const {
  const auto& document = at_.presenter.Workspace()->Document();
  std::size_t contoured = 0, triangles = 0;
  for (int s = 0; s < static_cast<int>(document.Points().structures.size()); ++s) {
    contoured += document.ContouredSlices(s).size();
  }
  for (const auto& [structure, mesh] : at_.panel.Presenter().Meshes())
    triangles += mesh.mesh.triangles.size();
  const nlohmann::ordered_json report = {
      {"screenshot", at_.presenter.GetOptions().run.screenshot.filename().string()},
      {"width", at_.window.get_width()},
      {"height", at_.window.get_height()},
      {"slice", at_.presenter.Editor()->Slice()},
      {"contoured_slices", contoured},
      {"surfaces", at_.panel.Presenter().Meshes().size()},
      {"triangles", triangles},
      {"can_undo", document.CanUndo()},
      {"is_saved", !document.IsDirty()},
      {"has_autosave", at_.presenter.SideFile().IsKeeping()},
      {"messages", at_.bars.Texts()}};
  std::printf("%s\n", host::FormatJson(report).c_str());
}

}  // namespace trocar::editor
