// SPDX-License-Identifier: Apache-2.0
#include "picture.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>

#include "trocar/gui/software_renderer.h"

namespace trocar::app {

Picture::Picture() {
  set_required_version(3, 3);
  set_has_depth_buffer(true);
  set_auto_render(false);
  set_hexpand(true);
  set_vexpand(true);
  set_focusable(true);
  set_size_request(320, 240);
  add_css_class("picture");
}

void Picture::SetScene(const scene::Scene* scene, std::span<const scene::SurfaceInfo> surfaces,
                       std::span<const scene::StrandInfo> strands) {
  scene_ = scene;
  surfaces_ = surfaces;
  strands_ = strands;
  if (!view_ || !get_realized()) return;
  make_current();
  view_.reset();
}

double Picture::FieldOfView() const {
  return scene_ == nullptr ? 1.0 : scene_->laparoscope.field_of_view;
}

double Picture::CirclePixels() const {
  return render::kMaskDiameter * get_height();
}

void Picture::Fail(const base::Error& error) {
  if (has_failed_) return;
  has_failed_ = true;
  // never within a frame: the window may close on it
  Glib::signal_timeout().connect_once([this, error] { signal_failed_.emit(error); }, 0);
}

void Picture::on_realize() {
  Gtk::GLArea::on_realize();
  if (const GError* error = gtk_gl_area_get_error(gobj()); error != nullptr) {
    Fail({base::ErrorCode::kNoGraphics,
          std::string("the window gets no OpenGL 3.3 (") + error->message +
              "): install the graphics driver, or Mesa's software driver (package libgl1-mesa-dri); "
              "LIBGL_ALWAYS_SOFTWARE=1 forces the latter"});
    return;
  }
  make_current();
  const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  is_drawn_by_processor_ = renderer != nullptr && gui::IsSoftwareRenderer(renderer);
  detail_ = presenter::PictureDetail(is_drawn_by_processor_);
  MeasurePainting();
}

/// All that a window paints in one go, with the toolkit's own part.
void Picture::MeasurePainting() {
  clock_ = get_frame_clock();
  const auto begin = +[](GdkFrameClock*, gpointer self) {
    auto& picture = *static_cast<Picture*>(self);
    picture.painting_ = host::Stopwatch();
    picture.is_scene_in_painting_ = false;
  };
  const auto end = +[](GdkFrameClock*, gpointer self) {
    auto& picture = *static_cast<Picture*>(self);
    if (picture.is_scene_in_painting_) picture.detail_.AddPicture(picture.painting_.Seconds());
  };
  painting_handlers_ = {g_signal_connect(clock_->gobj(), "before-paint", G_CALLBACK(begin), this),
                        g_signal_connect(clock_->gobj(), "after-paint", G_CALLBACK(end), this)};
}

void Picture::on_unrealize() {
  if (clock_) {
    for (const gulong handler : painting_handlers_) g_signal_handler_disconnect(clock_->gobj(), handler);
    clock_.reset();
  }
  if (view_ || target_) {
    make_current();
    view_.reset();
    target_.reset();
  }
  Gtk::GLArea::on_unrealize();
}

/// \return whether there is something to draw
bool Picture::MakeView() {
  if (has_failed_ || scene_ == nullptr || snapshot_ == nullptr) return false;
  if (view_) return true;
  base::Result<view::LaparoscopeView> made =
      view::LaparoscopeView::Make(*scene_, surfaces_, *snapshot_, strands_);
  if (!made) {
    Fail(made.error());
    return false;
  }
  view_.emplace(std::move(made).value());
  return true;
}

void Picture::DrawView(int width, int height, double resolution) {
  view::ViewOptions options = options_;
  options.quality = detail_.Now().quality;
  options.resolution = resolution;
  if (view_->GetOptions() != options) view_->SetOptions(options);
  view_->SetOverlay(overlay_);
  view_->Update(*snapshot_);
  view_->Draw(width, height);
  is_scene_in_painting_ = true;
}

bool Picture::on_render(const Glib::RefPtr<Gdk::GLContext>&) {
  if (!MakeView()) return false;
  DrawView(get_width() * get_scale_factor(), get_height() * get_scale_factor(), detail_.Now().resolution);
  signal_drawn_.emit();
  return true;
}

void Picture::snapshot_vfunc(const Glib::RefPtr<Gtk::Snapshot>& snapshot) {
  if (!is_drawn_by_processor_) return Gtk::GLArea::snapshot_vfunc(snapshot);
  make_current();
  if (!MakeView()) return;
  if (const auto drawn = DrawOffscreen(*snapshot.get()); !drawn) return Fail(drawn.error());
  signal_drawn_.emit();
}

base::Status Picture::DrawOffscreen(Gtk::Snapshot& snapshot) {
  const double pixels = detail_.Now().resolution * get_scale_factor();
  const int width = std::max(1, static_cast<int>(std::lround(pixels * get_width())));
  const int height = std::max(1, static_cast<int>(std::lround(pixels * get_height())));
  if (!target_ || target_->Width() != width || target_->Height() != height) {
    target_.reset();
    auto made = render::OffscreenTarget::Make(width, height);
    if (!made) return made.error();
    target_.emplace(std::move(*made));
  }
  target_->Bind();
  DrawView(width, height, 1);
  target_->Read(image_);
  const auto texture = Gdk::MemoryTexture::create(
      width, height, Gdk::MemoryTexture::Format::R8G8B8,
      Glib::Bytes::create(image_.pixels.data(), image_.pixels.size()), 3 * static_cast<gsize>(width));
  snapshot.append_texture(texture, Gdk::Rectangle(0, 0, get_width(), get_height()));
  return {};
}

}  // namespace trocar::app
