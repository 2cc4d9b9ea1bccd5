// SPDX-License-Identifier: Apache-2.0
/// \file mesh_view.h  Surfaces, lines and points to look at from all sides: drag turns, the right or middle
/// button moves, the wheel zooms, buttons look from where anatomists look. It knows no organ and no patient.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <optional>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/render/figure_renderer.h"

namespace trocar::editor {

/// Result of a pick: what lies under the pointer.
struct MeshPick {
  double x = 0, y = 0;                        ///< place in the widget [pixels]
  std::optional<render::SurfaceHit> surface;  ///< of SetSurfaces
  std::optional<std::size_t> point;           ///< index into the marks' points
  Gdk::ModifierType keys{};                   ///< Shift, Ctrl, ... that are held
};

class MeshView : public Gtk::Overlay {
 public:
  MeshView();
  ~MeshView() override;

  /// Sets the surfaces that are shown. The camera stays, except that the first surfaces are fitted into the picture.
  /// \pre as FigureRenderer::SetSurfaces
  void SetSurfaces(std::vector<render::FigureSurface> surfaces);
  void SetMarks(render::FigureMarks marks);
  const std::vector<render::FigureSurface>& Surfaces() const { return surfaces_; }
  const render::FigureMarks& Marks() const { return marks_; }

  /// Shows everything from there.
  void LookFrom(render::Viewpoint viewpoint);
  /// Brings a place into the middle and comes near it.
  /// \param p_world [m];
  /// \param span  of what is shown [m]
  void LookAt(const math::Vec3& p_world, double span);
  const render::OrbitCamera& Camera() const { return camera_; }
  void SetCamera(const render::OrbitCamera& camera);
  /// Place under (x, y) at the depth of `p_world`: for points that are dragged in the plane of the view.
  math::Vec3 PointAtDepth(const math::Vec3& p_world, double x, double y) const;

  /// The primary button goes down. True: the press and its drag belong to the caller, and the model does not
  /// turn.
  std::function<bool(const MeshPick&)> on_press;
  std::function<void(const MeshPick&)> on_drag;     ///< after a press that was taken
  std::function<void(const MeshPick&)> on_release;  ///< after a press that was taken
  std::function<void(const MeshPick&)> on_hover;    ///< no button is down
  std::function<void()> on_leave;                   ///< the pointer has left
  /// The wheel turns by `steps` (> 0: away from the person). True: it belongs to the caller, no zoom.
  std::function<bool(const MeshPick&, double steps)> on_wheel;

  /// Once, when nothing can be drawn. Never emitted within a frame.
  sigc::signal<void(base::Error)>& SignalFailed() { return signal_failed_; }

 private:
  void MakeButtons();
  void MakeGestures();
  void AddDrag();
  void AddPanning(unsigned button);
  void AddPointer();
  void AddWheel();
  void Realize();
  void Unrealize();
  bool Render();
  void Fail(const base::Error& error);
  void FitIfNew();
  MeshPick Pick(double x, double y, Gdk::ModifierType keys) const;

  Gtk::GLArea area_;
  Gtk::Box buttons_{Gtk::Orientation::HORIZONTAL};
  std::optional<render::FigureRenderer> renderer_;
  std::vector<render::FigureSurface> surfaces_;
  render::FigureMarks marks_;
  render::OrbitCamera camera_;
  bool are_surfaces_new_ = false;  // not yet on the graphics card
  bool is_fitted_ = false;
  render::Viewpoint first_viewpoint_ = render::Viewpoint::kAnterior;
  bool has_failed_ = false;
  bool is_taken_ = false;           // the press belongs to the caller
  double drag_x_ = 0, drag_y_ = 0;  // of the drag so far [pixels]
  double pointer_x_ = 0, pointer_y_ = 0;
  sigc::signal<void(base::Error)> signal_failed_;
};

}  // namespace trocar::editor
