// SPDX-License-Identifier: Apache-2.0
/// \file camera.h  Picture of a simulation's laparoscope, drawn off-screen.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trocar/environment/environment.h"
#include "trocar/render/geometry_picture.h"
#include "trocar/render/image.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::python {

/// In a context of its own that any thread may use in turn. Knows no Python.
class Camera {
 public:
  /// \return kUsage for a size out of range, or the graphics' error
  static base::Result<std::unique_ptr<Camera>> Make(int width, int height);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// \param light  power of the head light, in the usual one [-]
  base::Status Draw(const simulation::Simulation& simulation, double light, render::Image& image);
  /// \param has_flow  also the flow since this was asked for last
  base::Status LookAt(const simulation::Simulation& simulation, bool has_flow,
                      render::GeometryPicture& picture);
  double FocalLength() const { return focal_length_; }  ///< of the last picture [pixels]

 private:
  /// Objects that need the context to be current when they are destroyed.
  struct Graphics {
    render::OffscreenContext context;
    render::OffscreenTarget target;
    std::optional<view::LaparoscopeView> view;
  };
  explicit Camera(std::unique_ptr<Graphics> graphics) : graphics_(std::move(graphics)) {}
  template <typename Work>
  base::Status InContext(const Work& work);
  base::Status Show(const simulation::Simulation& simulation);

  std::unique_ptr<Graphics> graphics_;
  const scene::Scene* scene_ = nullptr;  // that the view is of
  std::uint64_t model_ = 0;
  double focal_length_ = 0;
};

/// Pictures of a pool's environments: each is drawn by the pool's thread that has stepped it.
class PoolPictures {
 public:
  /// Which of them are drawn.
  struct Parts {
    bool has_picture = false, has_depth = false, has_masks = false, has_normals = false, has_contacts = false;
    bool HasGeometry() const { return has_depth || has_masks || has_normals; }
    bool IsDrawn() const { return has_picture || HasGeometry(); }
  };
  /// Row i is environment i's, first row of a picture at the top; empty where a part is not drawn.
  struct Rows {
    std::vector<std::uint8_t> picture;  ///< (count, height, width, 3)
    std::vector<float> depth;           ///< (count, height, width) [m]
    std::vector<std::uint8_t> masks;    ///< (count, height, width)
    std::vector<float> normals;         ///< (count, height, width, 3)
    std::vector<float> contacts;        ///< (count, kContactRows, kContactNumbers)
  };

  PoolPictures(int count, int width, int height, const Parts& parts);
  /// \param is_final  of an episode that is over, while the next one begins at once
  base::Status Observe(std::int32_t id, const environment::Environment& environment, bool is_final);
  const Rows& Now() const { return now_; }
  const Rows& Final() const { return final_; }
  int Width() const { return width_; }
  int Height() const { return height_; }
  const Parts& GetParts() const { return parts_; }

 private:
  /// An environment's own: views remember what surgery has left on surfaces.
  struct Eye {
    std::unique_ptr<Camera> camera;
    render::Image image;
    render::GeometryPicture geometry;
  };
  int width_, height_;
  Parts parts_;
  Rows now_, final_;
  std::vector<Eye> eyes_;
};

}  // namespace trocar::python
