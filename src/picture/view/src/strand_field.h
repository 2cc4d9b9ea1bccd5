// SPDX-License-Identifier: Apache-2.0
/// \file strand_field.h  The connective tissue that dissection divides: fibres, lobules of fat, a film of peritoneum.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fat_body.h"
#include "film.h"
#include "trocar/render/renderer.h"
#include "trocar/simulation/operation_snapshot.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/surgery/fat_lobules.h"

namespace trocar::view {

class StrandField {
 public:
  /// \param strands  constant while the scene runs
  /// \param start    positions of their ends at rest [m]
  /// \pre the strands' rows lie in `start` (TROCAR_ASSERT)
  StrandField(std::span<const scene::StrandInfo> strands, std::span<const math::Vec3> start);

  /// Adds the strands that still hold; all of them where the snapshot does not say. Their fat is one surface, made anew
  /// when it has changed, and wet where liquid lies or runs.
  void AddTo(render::Renderer& renderer, render::Frame& frame, const simulation::Snapshot& snapshot,
             const Film& film);
  /// Of those, fibres and films alone. What the bed's strands span is seen where it is drawn.
  void AddFibres(render::Frame& frame, const simulation::Snapshot& snapshot) const;
  /// The fat that was added last.
  std::span<const FatLobule> Fat() const { return wanted_; }

  /// Marks the ends of the bed's strands that are divided.
  /// \param[out] rows  (rows of Snapshot::positions); empty where none is
  void FindRaw(const simulation::Snapshot& snapshot, std::vector<std::uint8_t>& rows) const;

 private:
  struct Strand {
    scene::StrandInfo info;
    double rest_length;  // [m]
    double breadth;      // of its film: of a peritoneal strand, or of the web of the bed [m]
  };
  void AddFat(render::Renderer& renderer, render::Frame& frame, const simulation::Snapshot& snapshot);
  void WetFat(render::Renderer& renderer, const Film& film);

  std::vector<Strand> strands_;
  surgery::FatLobules lobules_;
  FatBody fat_;
  std::vector<FatLobule> shown_, wanted_;    // of the surface that is uploaded; of this snapshot
  std::vector<math::Vec3> normals_, grain_;  // of that surface; where its pattern is taken from
  render::SurfaceId surface_;
  std::vector<render::SurfaceMark> marks_;  // of the fat
  bool is_wet_ = false;
};

}  // namespace trocar::view
