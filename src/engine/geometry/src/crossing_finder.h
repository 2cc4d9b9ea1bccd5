// SPDX-License-Identifier: Apache-2.0
/// \file crossing_finder.h  Which edges of a surface a flat sweep crosses, and which of them hang together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/blade_sweep.h"
#include "trocar/geometry/editable_mesh.h"

namespace trocar::geometry {

/// An edge that the sweep crosses. Named by its ends, which splits of other edges leave alone.
struct Crossing {
  std::uint32_t a = 0, b = 0;
  double t = 0;                                             ///< from a to b [-]
  std::array<std::uint32_t, 2> triangles = {kNone, kNone};  ///< on either side
  bool is_chosen = false;
};

class CrossingFinder {
 public:
  CrossingFinder(std::size_t vertex_capacity, std::size_t triangle_capacity);

  /// Finds every crossing; none is chosen yet.
  void Find(const FlatSweep& sweep, const EditableMesh& mesh) noexcept;
  std::span<const Crossing> Crossings() const { return crossings_; }

  /// Chooses the crossings that can be reached from some triangles by going over crossed edges.
  void Follow(std::span<const std::uint32_t> from) noexcept;
  /// Chooses every crossing but for connected sets of them that touch a triangle of this tick's earlier paths.
  void ChooseUntouched() noexcept;
  /// Indices of the chosen ones, in the order of choice.
  std::span<const std::uint32_t> Chosen() const { return chosen_; }

  /// Starts a tick: no triangle belongs to a path.
  void StartTick(const EditableMesh& mesh) noexcept;
  /// The triangles reached so far, and those that edits appended, belong to a path.
  bool IsOfPath(std::uint32_t t) const { return t >= first_new_triangle_ || path_stamp_[t] == tick_; }

 private:
  void Reach(std::uint32_t t) noexcept;
  void List(std::uint32_t triangle, std::uint32_t entry) noexcept;

  std::vector<Crossing> crossings_;
  std::vector<std::uint32_t> chosen_;
  std::vector<std::uint32_t> first_entry_;  // (nt) list of a triangle's crossings
  std::vector<std::uint32_t> next_entry_;   // (2 crossings); entry 2 c + side
  std::vector<std::uint32_t> queue_;
  std::vector<std::uint32_t> find_stamp_, reach_stamp_, path_stamp_;  // (nt)
  std::uint32_t find_ = 0, reach_ = 0, tick_ = 0;
  std::size_t first_new_triangle_ = 0;
};

}  // namespace trocar::geometry
