// SPDX-License-Identifier: Apache-2.0
/// \file orbit_camera.h  A camera that circles a model: turned by dragging, or put where anatomists look
/// from.
#pragma once

#include <optional>
#include <string_view>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/math/pose.h"
#include "trocar/math/vector.h"

namespace trocar::render {

/// Where the viewer stands. Pictures of the body follow the conventions of anatomy and radiology: from front,
/// back and sides the head is up; from above and below the front is up, so that from below the patient's left
/// is at the picture's right, as on a CT slice.
enum class Viewpoint {
  kAnterior,
  kPosterior,
  kRight,
  kLeft,
  kSuperior,
  kInferior,
  kUmbilicus,  ///< from below and in front, as the laparoscope of a cholecystectomy looks
  kCount
};

/// "anterior", "posterior", "right", "left", "superior", "inferior", "umbilicus".
std::string_view ViewpointName(Viewpoint viewpoint) noexcept;
std::optional<Viewpoint> FindViewpoint(std::string_view name) noexcept;

/// Perspective camera that looks at `target` from `distance`; its own axes: x right, y up, looks along -z.
struct OrbitCamera {
  math::Vec3 target;      ///< world frame [m]
  double distance = 0.5;  ///< from the target to the lens [m], > 0
  math::Quaternion R_world_camera;
  double field_of_view = 0.45;  ///< from bottom to top of the picture [rad]

  math::Vec3 Position() const;
  friend bool operator==(const OrbitCamera&, const OrbitCamera&) = default;
};

/// Camera that sees the whole box.
/// \param aspect  width over height of the picture, > 0
OrbitCamera LookFrom(Viewpoint viewpoint, const geometry::Box& box, double aspect);

/// Turns about the target: sideways about the body's long axis, up and down about the picture's horizontal.
/// \param dx, dy  pixels dragged to the right and down; half a turn is as long as the picture is high
void Orbit(OrbitCamera& camera, double dx, double dy, int height);
/// Moves the target with the pointer, so that what lies at its depth stays under it.
/// \param dx, dy  [pixels]
void Pan(OrbitCamera& camera, double dx, double dy, int height);
/// \param steps  of a wheel; > 0 comes nearer. The distance stays between 1 mm and 100 m.
void Zoom(OrbitCamera& camera, double steps);

struct Ray {
  math::Vec3 origin, direction;  ///< world frame [m]; unit
};
/// Ray through a place of the picture.
/// \param x, y  [pixels] from the left and from the top
Ray CalcRay(const OrbitCamera& camera, double x, double y, int width, int height);

/// Where a world point falls in the picture [pixels], x from the left, y from the top; not finite behind the
/// lens.
math::Vec2 CalcPixel(const OrbitCamera& camera, const math::Vec3& p_world, int width, int height);

/// The point under (x, y) at the same depth as `p_world`: how a point is dragged in the plane of the view.
math::Vec3 CalcPointAtDepth(const OrbitCamera& camera, const math::Vec3& p_world, double x, double y,
                            int width, int height);

}  // namespace trocar::render
