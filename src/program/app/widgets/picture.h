// SPDX-License-Identifier: Apache-2.0
/// \file picture.h  The laparoscope's picture in a GLArea.
///
/// Where the processor draws, the area's own picture of full size would cost more than what it shows: to be filled, fetched and
/// converted. There the scene is drawn off-screen with as many pixels as there is time for, and the toolkit enlarges them.
#pragma once

#include <gtkmm.h>

#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "trocar/base/result.h"
#include "trocar/host/clock.h"
#include "trocar/presenter/picture_detail.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/simulation/simulation.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::app {

class Picture : public Gtk::GLArea {
 public:
  Picture();

  /// Sets the scene to draw; it and the data of both spans must outlive the picture's last frame. The view itself is made in the
  /// next frame.
  void SetScene(const scene::Scene* scene, std::span<const scene::SurfaceInfo> surfaces,
                std::span<const scene::StrandInfo> strands);
  /// State of the next frame; null draws an empty picture. Valid until the next call.
  void SetSnapshot(const simulation::Snapshot* snapshot) { snapshot_ = snapshot; }
  /// Sets what is shown besides the scene, until the next call.
  void SetOverlay(view::Overlay overlay) { overlay_ = std::move(overlay); }
  /// Angle that CirclePixels() span in the picture [rad].
  double FieldOfView() const;
  /// Diameter of the laparoscope's round picture on the screen [pixels of the window].
  double CirclePixels() const;
  const view::ViewOptions& GetOptions() const { return options_; }
  void SetOptions(const view::ViewOptions& options) { options_ = options; }

  /// After each frame that shows the scene.
  sigc::signal<void()>& SignalDrawn() { return signal_drawn_; }
  /// Once, when nothing can be drawn. Never emitted within a frame.
  sigc::signal<void(base::Error)>& SignalFailed() { return signal_failed_; }

 protected:
  void on_realize() override;
  void on_unrealize() override;
  bool on_render(const Glib::RefPtr<Gdk::GLContext>& context) override;
  void snapshot_vfunc(const Glib::RefPtr<Gtk::Snapshot>& snapshot) override;

 private:
  void Fail(const base::Error& error);
  bool MakeView();
  void DrawView(int width, int height, double resolution);
  base::Status DrawOffscreen(Gtk::Snapshot& snapshot);
  void MeasurePainting();

  const scene::Scene* scene_ = nullptr;
  std::span<const scene::SurfaceInfo> surfaces_;
  std::span<const scene::StrandInfo> strands_;
  const simulation::Snapshot* snapshot_ = nullptr;
  std::optional<view::LaparoscopeView> view_;
  bool is_drawn_by_processor_ = false;
  std::optional<render::OffscreenTarget> target_;  // where the processor draws
  render::Image image_;                            // read from it
  view::ViewOptions options_;
  presenter::PictureDetail detail_;
  host::Stopwatch painting_;  // of the window, until its picture is on the screen
  bool is_scene_in_painting_ = false;
  Glib::RefPtr<Gdk::FrameClock> clock_;        // of the window, while the picture is realised
  std::array<gulong, 2> painting_handlers_{};  // of that
  view::Overlay overlay_;
  bool has_failed_ = false;
  sigc::signal<void()> signal_drawn_;
  sigc::signal<void(base::Error)> signal_failed_;
};

}  // namespace trocar::app
