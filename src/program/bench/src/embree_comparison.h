// SPDX-License-Identifier: Apache-2.0
/// \file embree_comparison.h  Embree's refit and point query on the same mesh, to measure our own against.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::bench {

/// A mesh in Embree, refitted on one thread. The library is loaded when this is made; nothing links to it.
class EmbreeMesh {
 public:
  /// \param[out] why_not  set where the answer is nullptr: built without Embree's headers, or the library is
  /// not installed
  static std::unique_ptr<EmbreeMesh> Make(const geometry::TriangleMesh& mesh, std::string& why_not);
  ~EmbreeMesh();
  EmbreeMesh(const EmbreeMesh&) = delete;
  EmbreeMesh& operator=(const EmbreeMesh&) = delete;

  /// Hands over moved vertices, in single precision.
  void SetPositions(std::span<const math::Vec3> positions);
  /// Refits the tree: what is timed begins here.
  void Refit();
  /// Distance to the nearest triangle, in single precision [m].
  double FindDistance(const math::Vec3& p) const;
  /// "Embree 3.13.5"
  static std::string Version();

 private:
  struct Content;
  explicit EmbreeMesh(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::bench
