// SPDX-License-Identifier: Apache-2.0
/// \file figure.h  A model to look at outside of the operation: surfaces with a colour a vertex, lines and
/// points; and what lies under the pointer.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/render/orbit_camera.h"

namespace trocar::render {

/// Red, green, blue, sRGB [0, 1].
using SrgbColour = std::array<double, 3>;

/// One surface.
struct FigureSurface {
  std::vector<geometry::Triangle> triangles;
  std::vector<math::Vec3> positions;  ///< (nv) world frame [m]
  std::vector<SrgbColour> colours;    ///< (nv), or one for all
  double opacity = 1;                 ///< 1 hides what lies behind; less: a veil over it [0, 1]
  bool has_edges = false;             ///< its triangles' edges are drawn too
  bool is_pickable = true;            ///< PickSurface sees it
};

/// Polyline of constant width in the picture.
struct FigureLine {
  std::vector<math::Vec3> points;  ///< world frame [m]
  SrgbColour colour{1, 1, 1};
  double width = 2;        ///< [pixels]
  bool is_on_top = false;  ///< no surface hides it
};

/// Disc of constant size in the picture.
struct FigurePoint {
  math::Vec3 position;  ///< world frame [m]
  SrgbColour colour{1, 1, 1};
  double diameter = 9;     ///< [pixels]
  bool is_on_top = false;  ///< no surface hides it
};

/// Marks that are drawn over the surfaces, without lighting.
struct FigureMarks {
  std::vector<FigureLine> lines;
  std::vector<FigurePoint> points;
};

/// Box of all surfaces and marks; of 0.1 m about the origin where there is none.
geometry::Box CalcFigureBox(std::span<const FigureSurface> surfaces, const FigureMarks& marks = {});

struct SurfaceHit {
  std::size_t surface = 0;
  std::uint32_t triangle = 0;
  std::uint32_t vertex = 0;  ///< the triangle's corner that is nearest to the point
  math::Vec3 point;          ///< world frame [m]
  double distance = 0;       ///< along the ray [m]
};

/// First pickable surface that the ray meets from in front.
std::optional<SurfaceHit> PickSurface(std::span<const FigureSurface> surfaces, const Ray& ray);

/// Point whose disc, grown by `reach` [pixels], holds the place (x, y); the nearest to it of several.
std::optional<std::size_t> PickPoint(std::span<const FigurePoint> points, const OrbitCamera& camera, double x,
                                     double y, int width, int height, double reach = 4);

}  // namespace trocar::render
