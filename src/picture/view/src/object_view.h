// SPDX-License-Identifier: Apache-2.0
/// \file object_view.h  The things of a training task, its marks, and the box that it stands in.
#pragma once

#include <optional>
#include <vector>

#include "trocar/render/renderer.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// Nothing where a scene has no objects and no task.
class ObjectView {
 public:
  /// Uploads everything.
  /// \param start  the first snapshot: where ducts are that marks belong to
  void Add(render::Renderer& renderer, const scene::Scene& scene, const simulation::Snapshot& start);
  /// Appends what a snapshot shows to a frame; what is to be done next is marked brightly.
  void Append(const simulation::Snapshot& snapshot, std::vector<render::SurfaceDraw>& surfaces) const;
  /// Of the box that the things stand in; names none where they stand in no box.
  render::SurfaceId Walls() const { return walls_; }
  /// Appends what throws a shadow in a box trainer.
  void AppendShades(const simulation::Snapshot& snapshot, render::Frame& frame) const;

 private:
  struct Part {
    render::SurfaceId surface;
    std::size_t object = 0;
    math::Pose X_object_part;
  };
  struct Ring {
    std::size_t object = 0;
    math::Pose X_object_ring;
    double radius = 0, section = 0;  // [m]
  };
  struct Rod {
    std::size_t object = 0;
    math::Pose X_object_rod;
    math::Vec3 half_span;  // from its middle to an end [m]
    double radius = 0;     // [m]
  };
  struct Mark {
    render::SurfaceId idle, next;
    std::size_t region = 0;
    math::Pose X_world_mark;
    // of a mark round a duct: rows of Snapshot::positions, and where between them
    bool is_on_tube = false;
    std::uint32_t a = 0, b = 0;
    double t = 0;
  };
  std::vector<int> FindNextRegions(const scene::TaskSnapshot& now) const;
  void AddStill(render::Renderer& renderer, const scene::Scene& scene);
  void AddShade(std::size_t object, const rigid::RigidShape& shape);
  void AddMark(render::Renderer& renderer, std::size_t region, const simulation::Snapshot& start);

  std::optional<scene::Task> task_;
  std::vector<Part> parts_;
  std::vector<Ring> rings_;
  std::vector<Rod> rods_;
  std::vector<render::Shade> still_shades_;  // of balls that are marks
  render::SurfaceId walls_;
  std::vector<Mark> marks_;
};

render::Material MaterialOf(scene::ObjectColour colour);
/// Along z, closed; half the length between the centres of its ends [m].
geometry::TriangleMesh MakeCapsule(double radius, double half_length);

}  // namespace trocar::view
