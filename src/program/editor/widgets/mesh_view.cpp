// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/mesh_view.h"

#include <algorithm>
#include <cmath>

#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

/// The viewpoints that have a button, with the letter on it.
struct ViewButton {
  render::Viewpoint viewpoint;
  const char* letter;
  const char* tooltip;
};
constexpr ViewButton kButtons[] = {
    {render::Viewpoint::kAnterior, "A", host::Mark("Look from anterior (the patient's front)")},
    {render::Viewpoint::kPosterior, "P", host::Mark("Look from posterior (the back)")},
    {render::Viewpoint::kRight, "R", host::Mark("Look from the patient's right")},
    {render::Viewpoint::kLeft, "L", host::Mark("Look from the patient's left")},
    {render::Viewpoint::kSuperior, "S", host::Mark("Look from superior (the head)")},
    {render::Viewpoint::kInferior, "I", host::Mark("Look from inferior (the feet), as on a CT slice")},
    {render::Viewpoint::kUmbilicus, "U", host::Mark("Look from the umbilicus, as the laparoscope does")},
};

}  // namespace

MeshView::MeshView() {
  area_.set_required_version(3, 3);
  area_.set_has_depth_buffer(true);
  area_.set_auto_render(false);
  area_.set_hexpand(true);
  area_.set_vexpand(true);
  area_.set_focusable(true);
  area_.set_size_request(200, 160);
  area_.add_css_class("picture");
  area_.signal_realize().connect(sigc::mem_fun(*this, &MeshView::Realize));
  // before the area gives its context back
  area_.signal_unrealize().connect(sigc::mem_fun(*this, &MeshView::Unrealize), false);
  area_.signal_render().connect([this](const Glib::RefPtr<Gdk::GLContext>&) { return Render(); }, false);
  set_child(area_);
  MakeButtons();
  MakeGestures();
}

MeshView::~MeshView() = default;

void MeshView::MakeButtons() {
  buttons_.set_halign(Gtk::Align::END);
  buttons_.set_valign(Gtk::Align::START);
  buttons_.set_margin(8);
  buttons_.add_css_class("linked");
  const auto add = [this](const char* text, const char* tooltip, std::function<void()> act) {
    auto* button = Gtk::make_managed<Gtk::Button>(host::Translate(text));
    button->add_css_class("small");
    button->set_tooltip_text(host::Translate(tooltip));
    button->set_focus_on_click(false);
    button->signal_clicked().connect(std::move(act));
    buttons_.append(*button);
  };
  for (const ViewButton& each : kButtons)
    add(each.letter, each.tooltip, [this, viewpoint = each.viewpoint] { LookFrom(viewpoint); });
  add(host::Mark("Fit"), host::Mark("Show everything again"), [this] { LookFrom(first_viewpoint_); });
  add_overlay(buttons_);
}

void MeshView::MakeGestures() {
  AddDrag();
  for (const guint number : {GDK_BUTTON_SECONDARY, GDK_BUTTON_MIDDLE}) AddPanning(number);
  AddPointer();
  AddWheel();
}

/// The primary button turns, or does what the caller takes it for.
void MeshView::AddDrag() {
  const auto primary = Gtk::GestureDrag::create();
  primary->set_button(GDK_BUTTON_PRIMARY);
  auto* drag = primary.get();
  const auto pick_at = [this, drag](double dx, double dy) {
    double x = 0, y = 0;
    drag->get_start_point(x, y);
    return Pick(x + dx, y + dy, drag->get_current_event_state());
  };
  primary->signal_drag_begin().connect([this, pick_at](double, double) {
    area_.grab_focus();
    drag_x_ = drag_y_ = 0;
    is_taken_ = on_press && on_press(pick_at(0, 0));
  });
  primary->signal_drag_update().connect([this, pick_at](double dx, double dy) {
    if (is_taken_) {
      if (on_drag) on_drag(pick_at(dx, dy));
    } else {
      render::Orbit(camera_, dx - drag_x_, dy - drag_y_, get_height());
      area_.queue_render();
    }
    drag_x_ = dx, drag_y_ = dy;
  });
  primary->signal_drag_end().connect([this, pick_at](double dx, double dy) {
    if (is_taken_ && on_release) on_release(pick_at(dx, dy));
    is_taken_ = false;
  });
  area_.add_controller(primary);
}

void MeshView::AddPanning(unsigned button) {
  const auto pan = Gtk::GestureDrag::create();
  pan->set_button(button);
  pan->signal_drag_begin().connect([this](double, double) { drag_x_ = drag_y_ = 0; });
  pan->signal_drag_update().connect([this](double dx, double dy) {
    render::Pan(camera_, dx - drag_x_, dy - drag_y_, get_height());
    drag_x_ = dx, drag_y_ = dy;
    area_.queue_render();
  });
  area_.add_controller(pan);
}

void MeshView::AddPointer() {
  const auto motion = Gtk::EventControllerMotion::create();
  auto* moved = motion.get();
  motion->signal_motion().connect([this, moved](double x, double y) {
    pointer_x_ = x, pointer_y_ = y;
    const auto state = moved->get_current_event_state();
    const bool is_pressed = (state & (Gdk::ModifierType::BUTTON1_MASK | Gdk::ModifierType::BUTTON2_MASK |
                                      Gdk::ModifierType::BUTTON3_MASK)) != Gdk::ModifierType{};
    if (on_hover && !is_pressed) on_hover(Pick(x, y, state));
  });
  motion->signal_leave().connect([this] {
    if (on_leave) on_leave();
  });
  area_.add_controller(motion);
}

void MeshView::AddWheel() {
  const auto wheel = Gtk::EventControllerScroll::create();
  wheel->set_flags(Gtk::EventControllerScroll::Flags::VERTICAL);
  auto* turned = wheel.get();
  wheel->signal_scroll().connect(
      [this, turned](double, double dy) {
        if (on_wheel && on_wheel(Pick(pointer_x_, pointer_y_, turned->get_current_event_state()), -dy))
          return true;
        render::Zoom(camera_, -dy);
        area_.queue_render();
        return true;
      },
      false);
  area_.add_controller(wheel);
}

MeshPick MeshView::Pick(double x, double y, Gdk::ModifierType keys) const {
  const int width = std::max(get_width(), 1), height = std::max(get_height(), 1);
  MeshPick pick{x, y, render::PickSurface(surfaces_, render::CalcRay(camera_, x, y, width, height)),
                render::PickPoint(marks_.points, camera_, x, y, width, height), keys};
  return pick;
}

void MeshView::SetSurfaces(std::vector<render::FigureSurface> surfaces) {
  surfaces_ = std::move(surfaces);
  are_surfaces_new_ = true;
  FitIfNew();
  area_.queue_render();
}

void MeshView::SetMarks(render::FigureMarks marks) {
  marks_ = std::move(marks);
  area_.queue_render();
}

void MeshView::FitIfNew() {
  if (is_fitted_ || surfaces_.empty() || get_height() < 2) return;
  is_fitted_ = true;
  LookFrom(first_viewpoint_);
}

void MeshView::LookFrom(render::Viewpoint viewpoint) {
  first_viewpoint_ = viewpoint;
  camera_ = render::LookFrom(viewpoint, render::CalcFigureBox(surfaces_),
                             static_cast<double>(std::max(get_width(), 1)) / std::max(get_height(), 1));
  area_.queue_render();
}

void MeshView::LookAt(const math::Vec3& p_world, double span) {
  is_fitted_ = true;
  camera_.target = p_world;
  camera_.distance = 0.5 * span / std::tan(0.5 * camera_.field_of_view);
  area_.queue_render();
}

void MeshView::SetCamera(const render::OrbitCamera& camera) {
  camera_ = camera;
  is_fitted_ = true;
  area_.queue_render();
}

math::Vec3 MeshView::PointAtDepth(const math::Vec3& p_world, double x, double y) const {
  return render::CalcPointAtDepth(camera_, p_world, x, y, std::max(get_width(), 1),
                                  std::max(get_height(), 1));
}

void MeshView::Fail(const base::Error& error) {
  if (has_failed_) return;
  has_failed_ = true;
  // never within a frame: the window may close on it
  Glib::signal_timeout().connect_once([this, error] { signal_failed_.emit(error); }, 0);
}

void MeshView::Realize() {
  if (const GError* error = gtk_gl_area_get_error(area_.gobj()); error != nullptr) {
    Fail({base::ErrorCode::kNoGraphics,
          std::string("the window gets no OpenGL 3.3 (") + error->message +
              "): install the graphics driver, or Mesa's software driver (package libgl1-mesa-dri); "
              "LIBGL_ALWAYS_SOFTWARE=1 forces the latter"});
  }
}

void MeshView::Unrealize() {
  if (!renderer_) return;
  area_.make_current();
  renderer_.reset();
  are_surfaces_new_ = true;
}

bool MeshView::Render() {
  if (has_failed_) return false;
  if (!renderer_) {
    auto made = render::FigureRenderer::Make();
    if (!made) {
      Fail(made.error());
      return false;
    }
    renderer_.emplace(std::move(made).value());
  }
  FitIfNew();
  if (are_surfaces_new_) renderer_->SetSurfaces(surfaces_);
  are_surfaces_new_ = false;
  const int scale = get_scale_factor();
  render::FigureOptions options;
  options.pixel_scale = scale;
  renderer_->Draw(camera_, marks_, options, get_width() * scale, get_height() * scale);
  return true;
}

}  // namespace trocar::editor
