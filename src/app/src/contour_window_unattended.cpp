// SPDX-License-Identifier: Apache-2.0
// Runs of the contour window that nobody watches: scripts, screenshots, measurements.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "contour_window.h"
#include "trocar/core/log.h"
#include "trocar/core/safe_file.h"

namespace trocar::app {
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

void ContourWindow::Abandon(const core::Error& error) {
  if (failure_) return;
  failure_ = error;
  core::Log(core::LogLevel::kError, error.Text());
  Glib::signal_timeout().connect_once([this] { close(); }, 0);
}

/// \return whether there is a script, or none was asked for; otherwise the run has ended
bool ContourWindow::ReadScript() {
  if (is_script_read_ || options_.script.empty()) return true;
  is_script_read_ = true;
  const auto text = core::ReadFile(options_.script);
  if (!text.ok()) {
    Abandon(text.error());
    return false;
  }
  auto steps = ParseContourScript(*text, options_.script.filename().string());
  if (!steps.ok()) {
    Abandon(steps.error());
    return false;
  }
  script_.assign(steps->begin(), steps->end());
  return true;
}

void ContourWindow::RunScript() {
  if (!ReadScript()) return;
  while (!script_.empty()) {
    const ScriptStep step = script_.front();
    if (step.verb == "await") {
      const bool is_waiting = step.words[0] == "build"
                                  ? builder_.joinable()
                                  : coarse_timer_.connected() || meshes_->GetState().is_busy;
      if (is_waiting) return;
      script_.pop_front();
      continue;
    }
    script_.pop_front();
    const auto done = RunScriptStep(step, *editor_);
    if (!done.ok()) return Abandon(done.error());
    if (!*done) {
      if (const auto status = RunWindowStep(step); !status.ok()) {
        return Abandon({status.error().code,
                        "line " + std::to_string(step.line) + " of the script: " + status.error().message});
      }
    }
    OnEdited();
  }
}

core::Status ContourWindow::RunWindowStep(const ScriptStep& step) {
  if (step.verb == "show") {
    const bool is_on = step.words[1] == "on";
    const std::string& part = step.words[0];
    auto& options = canvas_.Options();
    if (part == "reference") {
      reference_.set_active(is_on);
    } else if (part == "ghosts") {
      ghosts_.set_active(is_on);
    } else if (part == "points") {
      options.has_points = is_on;
    } else if (part == "fill") {
      options.has_fill = is_on;
    } else if (part == "help") {
      help_.set_active(is_on);
    } else {
      return core::Error{core::ErrorCode::kScriptInvalid, "show reference, ghosts, points, fill or help"};
    }
  } else if (step.verb == "answer") {
    std::string label = step.words[0];
    for (std::size_t i = 1; i < step.words.size(); ++i) label += " " + step.words[i];
    if (!bars_.Press(label)) {
      return core::Error{core::ErrorCode::kScriptInvalid,
                         "no question is shown that \"" + label + "\" answers"};
    }
  } else if (step.verb == "build") {
    if (builder_.joinable() || workspace_->Options().points.empty() || workspace_->Document().IsDirty()) {
      return core::Error{core::ErrorCode::kScriptInvalid,
                         "build needs saved contours, and no patient that is being built"};
    }
    StartBuild(step.words[0]);
  } else if (step.verb == "stop-build") {
    StopBuild();
  } else if (step.verb == "sizes") {
    return core::Error{core::ErrorCode::kScriptInvalid, "the pictures say their sizes, or the options do"};
  }
  return {};
}

bool ContourWindow::OnFrame(const Glib::RefPtr<Gdk::FrameClock>& clock) {
  if (failure_ || is_screenshot_due_) return true;
  if (since_start_.Seconds() > kLongestRun) {
    Abandon(
        {core::ErrorCode::kUsage, "the run did not end in three minutes; this computer is too slow for it"});
    return true;
  }
  if (editor_ == nullptr || canvas_.PaintCount() == 0) return true;
  RunScript();
  if (failure_ || !script_.empty()) return true;
  if (options_.is_measuring) {
    MeasureFrame(1e-6 * static_cast<double>(clock->get_frame_time()));
    return true;
  }
  const bool is_idle = !coarse_timer_.connected() && !meshes_->GetState().is_busy;
  if (since_start_.Seconds() < options_.screenshot_after || !is_idle) {
    canvas_.queue_draw();
    return true;
  }
  is_screenshot_due_ = true;
  // outside of the frame, and after the last surface has been drawn
  Glib::signal_timeout().connect_once(sigc::mem_fun(*this, &ContourWindow::SaveScreenshot), 300);
  return true;
}

void ContourWindow::MeasureFrame(double now) {
  if (measure_begin_ == 0) measure_begin_ = now;
  const auto& here = editor_->Here();
  if (here.contours.empty()) {
    return Abandon({core::ErrorCode::kUsage, "--measure needs a contour to drag: name --points with some"});
  }
  if (now - measure_begin_ > kMeasureSeconds) {
    is_screenshot_due_ = true;
    Glib::signal_timeout().connect_once(sigc::mem_fun(*this, &ContourWindow::FinishMeasuring), 0);
    return;
  }
  if (canvas_.PaintCount() > last_paints_ && last_frame_ > 0) {
    measured_.frame.push_back(now - last_frame_);
    measured_.paint.push_back(canvas_.LastPaintSeconds());
  }
  last_paints_ = canvas_.PaintCount();
  last_frame_ = now;
  // as a hand would: press on a point, move it round in a small circle, each frame another place
  const double angle = 7.0 * (now - measure_begin_);
  if (!editor_->IsDragging()) {
    editor_->Press(ToCanvas(editor_->view, editor_->size, here.contours[0][0]), false);
  }
  const Vec2 start = ToCanvas(editor_->view, editor_->size, here.contours[0][0]);
  const core::Stopwatch stopwatch;
  editor_->Drag(start + Vec2{3 * std::cos(angle), 3 * std::sin(angle)});
  (void)editor_->Fit().ok();
  measured_.fit.push_back(stopwatch.Seconds());
  OnEdited();
}

void ContourWindow::FinishMeasuring() {
  editor_->Do(ContourAction::kCancel);
  for (auto* values : {&measured_.fit, &measured_.paint, &measured_.frame}) {
    values->erase(values->begin(),
                  values->begin() + static_cast<std::ptrdiff_t>(std::min(kWarmUp, values->size())));
  }
  std::string organs;
  for (const auto& [structure, mesh] : panel_.Meshes()) {
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
      canvas_.get_width(), canvas_.get_height(), workspace_->Series().width, workspace_->Series().height,
      measured_.frame.size(), 1e3 * Quantile(measured_.fit, 0.5), 1e3 * Quantile(measured_.fit, 0.95),
      1e3 * Quantile(measured_.paint, 0.5), 1e3 * Quantile(measured_.paint, 0.95),
      1e3 * Quantile(measured_.frame, 0.5), static_cast<double>(measured_.frame.size()) / kMeasureSeconds,
      organs.c_str());
  close();
}

void ContourWindow::SaveScreenshot() {
  const auto paintable = Gtk::WidgetPaintable::create(*this);
  const auto snapshot = Gtk::Snapshot::create();
  paintable->snapshot(snapshot, get_width(), get_height());
  GskRenderNode* node = gtk_snapshot_to_node(snapshot->gobj());
  GdkTexture* texture = node == nullptr ? nullptr
                                        : gsk_renderer_render_texture(
                                              gtk_native_get_renderer(GTK_NATIVE(gobj())), node, nullptr);
  const bool is_saved = texture != nullptr && gdk_texture_save_to_png(texture, options_.screenshot.c_str());
  const bool is_drawn = texture != nullptr;
  if (texture != nullptr) g_object_unref(texture);
  if (node != nullptr) gsk_render_node_unref(node);
  // a window that is being laid out anew has nothing to show for a moment
  if (!is_drawn && ++screenshot_tries_ < kMostTries) {
    Glib::signal_timeout().connect_once(sigc::mem_fun(*this, &ContourWindow::SaveScreenshot), 100);
    return;
  }
  if (!is_saved) {
    return Abandon({core::ErrorCode::kFileUnwritable, "cannot write " + options_.screenshot.string() +
                                                          ": check the folder and its permissions"});
  }
  const auto& document = workspace_->Document();
  std::size_t contoured = 0, triangles = 0;
  for (int s = 0; s < static_cast<int>(document.Points().structures.size()); ++s) {
    contoured += document.ContouredSlices(s).size();
  }
  for (const auto& [structure, mesh] : panel_.Meshes()) triangles += mesh.mesh.triangles.size();
  const nlohmann::ordered_json report = {{"screenshot", options_.screenshot.filename().string()},
                                         {"width", get_width()},
                                         {"height", get_height()},
                                         {"slice", editor_->Slice()},
                                         {"contoured_slices", contoured},
                                         {"surfaces", panel_.Meshes().size()},
                                         {"triangles", triangles},
                                         {"can_undo", document.CanUndo()},
                                         {"is_saved", !document.IsDirty()},
                                         {"has_autosave", autosave_ != nullptr},
                                         {"messages", bars_.Texts()}};
  std::printf("%s\n", report.dump().c_str());
  close();
}

}  // namespace trocar::app
