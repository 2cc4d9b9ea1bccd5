// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_canvas.h"

#include <algorithm>
#include <cmath>

#include "trocar/host/clock.h"

namespace trocar::editor {

using math::Vec2;

namespace {

constexpr guint kLeftButton = 1, kMiddleButton = 2, kRightButton = 3;
constexpr double kZoomStep = 1.15;     // a notch of the wheel
constexpr double kClickSlop = 4;       // a right press that moves less is a click [pixels]
constexpr double kWindowPerPixel = 2;  // grey values a pixel of the drag, of a width of 400

}  // namespace

ContourCanvas::ContourCanvas() {
  set_hexpand(true);
  set_vexpand(true);
  set_focusable(true);
  set_size_request(320, 240);
  add_css_class("picture");
  set_draw_func(sigc::mem_fun(*this, &ContourCanvas::Draw));
  MakeGestures();
}

void ContourCanvas::SetEditor(ContourEditor* editor) {
  editor_ = editor;
  is_fitted_ = false;
  painter_ = {};
  if (editor_ != nullptr) options_.window = editor_->Workspace().Series().suggested_window;
  queue_draw();
}

void ContourCanvas::HoldSpace(bool is_held) {
  is_space_held_ = is_held;
  UpdateCursor();
}

void ContourCanvas::SetReadOnly(bool is_read_only) {
  is_read_only_ = is_read_only;
  UpdateCursor();
}

void ContourCanvas::UpdateCursor() {
  set_cursor(is_space_held_ || is_read_only_ || is_panning_ ? "grab" : "crosshair");
}

void ContourCanvas::Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height) {
  if (editor_ == nullptr) return;
  const host::Stopwatch stopwatch;
  const CanvasSize size{static_cast<double>(width), static_cast<double>(height)};
  editor_->size = size;
  if (!is_fitted_ && width > 1 && height > 1) {
    is_fitted_ = true;
    MirrorForRadiology(editor_->view, editor_->Workspace().Series().axes);
    editor_->Do(ContourAction::kFitView);
  }
  const auto status = painter_.Paint(cairo, *editor_, options_, get_scale_factor());
  last_paint_ = stopwatch.Seconds();
  ++paints_;
  const std::string failure = status.ok() ? "" : status.error().Text();
  if (failure != last_failure_ && !failure.empty()) {
    // not within the frame: the listener changes widgets
    Glib::signal_idle().connect_once([this, error = status.error()] { signal_failed_.emit(error); });
  }
  last_failure_ = failure;
}

void ContourCanvas::MakeGestures() {
  AddClicks();
  AddDrags();
  AddPanning();
  AddWindowing();
  AddPointer();
  AddWheel();
  UpdateCursor();
}

void ContourCanvas::BeginPan() {
  is_panning_ = true;
  pan_x_ = pan_y_ = 0;
  UpdateCursor();
}

/// \param dx, dy  since BeginPan() [pixels of the window]
void ContourCanvas::Pan(double dx, double dy) {
  if (editor_ == nullptr) return;
  const auto& info = editor_->Workspace().Series();
  PanBy(editor_->view, dx - pan_x_, dy - pan_y_, info.width, info.height);
  pan_x_ = dx, pan_y_ = dy;
  queue_draw();
}

void ContourCanvas::EndPan() {
  is_panning_ = false;
  UpdateCursor();
}

void ContourCanvas::AddClicks() {
  const auto click = Gtk::GestureClick::create();
  click->set_button(kLeftButton);
  click->signal_pressed().connect([this](int count, double x, double y) {
    grab_focus();
    if (editor_ == nullptr || is_space_held_ || is_read_only_) return;
    editor_->Press({x, y}, count == 2);
    signal_edited_.emit();
  });
  click->signal_released().connect([this](int, double, double) { Release(); });
  add_controller(click);
}

void ContourCanvas::Release() {
  if (editor_ == nullptr) return;
  editor_->Release();
  signal_edited_.emit();
}

/// The left button edits, or pans while space is held.
void ContourCanvas::AddDrags() {
  const auto left = Gtk::GestureDrag::create();
  left->set_button(kLeftButton);
  left->signal_drag_begin().connect([this](double, double) {
    if (is_space_held_ || is_read_only_) BeginPan();
  });
  left->signal_drag_update().connect([this, gesture = left.get()](double dx, double dy) {
    if (is_panning_) return Pan(dx, dy);
    if (editor_ == nullptr) return;
    double x = 0, y = 0;
    gesture->get_start_point(x, y);
    editor_->Drag({x + dx, y + dy});
    if (editor_->IsDragging()) signal_edited_.emit();
    signal_pointed_.emit();
  });
  left->signal_drag_end().connect([this](double, double) {
    EndPan();
    Release();
  });
  add_controller(left);
}

void ContourCanvas::AddPanning() {
  const auto middle = Gtk::GestureDrag::create();
  middle->set_button(kMiddleButton);
  middle->signal_drag_begin().connect([this](double, double) { BeginPan(); });
  middle->signal_drag_update().connect([this](double dx, double dy) { Pan(dx, dy); });
  middle->signal_drag_end().connect([this](double, double) { EndPan(); });
  add_controller(middle);
}

/// The right button deletes where it clicks, and sets window and level where it drags.
void ContourCanvas::AddWindowing() {
  const auto right = Gtk::GestureDrag::create();
  right->set_button(kRightButton);
  right->signal_drag_begin().connect([this](double, double) {
    grab_focus();
    is_windowing_ = false;
    window_before_ = options_.window;
  });
  right->signal_drag_update().connect([this](double dx, double dy) {
    if (editor_ == nullptr || editor_->Workspace().Series().is_color) return;
    if (!is_windowing_ && std::hypot(dx, dy) < kClickSlop) return;
    is_windowing_ = true;
    const double rate = kWindowPerPixel * window_before_.width / 400.0;
    options_.window.width = std::max(1.0, window_before_.width + rate * dx);
    options_.window.centre = window_before_.centre + rate * dy;
    signal_window_.emit();
    queue_draw();
  });
  right->signal_drag_end().connect([this, gesture = right.get()](double dx, double dy) {
    if (editor_ == nullptr || is_read_only_ || is_windowing_ || std::hypot(dx, dy) >= kClickSlop) return;
    double x = 0, y = 0;
    gesture->get_start_point(x, y);
    editor_->SecondaryPress({x, y});
    signal_edited_.emit();
  });
  add_controller(right);
}

void ContourCanvas::AddPointer() {
  const auto motion = Gtk::EventControllerMotion::create();
  const auto hover = [this](const std::optional<Vec2>& at) {
    if (editor_ == nullptr) return;
    if (!at || !editor_->IsDragging()) editor_->Hover(at);
    if (!editor_->Here().open.empty()) queue_draw();
    signal_pointed_.emit();
  };
  motion->signal_motion().connect([hover](double x, double y) { hover(Vec2{x, y}); });
  motion->signal_leave().connect([hover] { hover(std::nullopt); });
  add_controller(motion);
}

void ContourCanvas::AddWheel() {
  const auto wheel = Gtk::EventControllerScroll::create();
  wheel->set_flags(Gtk::EventControllerScroll::Flags::VERTICAL);
  wheel->signal_scroll().connect(
      [this, controller = wheel.get()](double, double dy) {
        const auto keys = controller->get_current_event_state();
        const bool is_zoom = (keys & Gdk::ModifierType::CONTROL_MASK) != Gdk::ModifierType{};
        if (editor_ != nullptr) is_zoom ? Zoom(dy) : Step(dy);
        return true;
      },
      false);
  add_controller(wheel);
}

void ContourCanvas::Zoom(double notches) {
  const auto& pointer = editor_->Pointer();
  const Vec2 at = pointer ? ToCanvas(editor_->view, editor_->size, *pointer)
                          : Vec2{0.5 * editor_->size.width, 0.5 * editor_->size.height};
  ZoomAt(editor_->view, editor_->size, at, std::pow(kZoomStep, -notches));
  queue_draw();
}

void ContourCanvas::Step(double notches) {
  wheel_ -= notches;
  const int steps = static_cast<int>(wheel_);
  wheel_ -= steps;
  if (steps != 0) signal_step_.emit(steps);
}

}  // namespace trocar::editor
