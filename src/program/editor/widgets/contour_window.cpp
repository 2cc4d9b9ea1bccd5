// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_window.h"

#include <utility>

#include "trocar/editor/contour_run.h"
#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

constexpr int kWidth = 1280, kHeight = 800;

}  // namespace

ContourWindow::ContourWindow(const ContourOptions& options, const host::Stopwatch& since_start)
    : bar_(ContourCommands(), tips_,
           [this](const ContourCommand& command) { pane_.Presenter().Do(command.action); }),
      pane_(options, tips_,
            {[this](const ContourPage& page) { Show(page); },
             [this](ContourAction action) { DoInWindow(action); },
             [this](const images::ImageSeriesOptions&) { return run_ == nullptr || run_->AnswerSizes(); },
             {}}) {
  set_title(host::Translate("Trocar: contours"));
  add_css_class("trocar");
  set_default_size(kWidth, kHeight);
  set_titlebar(bar_);
  set_child(pane_);
  if (!options.IsAttended()) {
    run_ = std::make_unique<ContourRun>(ContourRun::Parts{*this, pane_.Presenter(), pane_.Canvas(),
                                                          pane_.Panel(), pane_.Bars(), pane_.Sizes()},
                                        since_start);
  }
  MakeKeys();
  property_is_active().signal_changed().connect([this] { tips_.End(); });
  signal_close_request().connect([this] { return pane_.Presenter().OnClose(); }, false);
  pane_.Start();
}

ContourWindow::~ContourWindow() {
  run_.reset();
}

void ContourWindow::MakeKeys() {
  const auto keys = Gtk::EventControllerKey::create();
  keys->set_propagation_phase(Gtk::PropagationPhase::CAPTURE);
  keys->signal_key_pressed().connect(
      [this](guint key, guint, Gdk::ModifierType state) { return pane_.OnKey(key, state); }, false);
  keys->signal_key_released().connect(
      [this](guint key, guint, Gdk::ModifierType) { pane_.OnKeyReleased(key); });
  add_controller(keys);
}

void ContourWindow::Show(const ContourPage& page) {
  if (get_title().raw() != page.title) set_title(page.title);
  bar_.Show([this](const ContourCommand& command) { return pane_.Presenter().FindButton(command); });
}

void ContourWindow::DoInWindow(ContourAction action) {
  if (action == ContourAction::kToggleFullscreen) return is_fullscreen() ? unfullscreen() : fullscreen();
  // never within a frame
  if (action == ContourAction::kQuit) Glib::signal_timeout().connect_once([this] { close(); }, 0);
}

}  // namespace trocar::editor
