// SPDX-License-Identifier: Apache-2.0
#include "crossing_finder.h"

#include "trocar/geometry/mesh_measures.h"

namespace trocar::geometry {

CrossingFinder::CrossingFinder(std::size_t vertex_capacity, std::size_t triangle_capacity) {
  // a mesh of nt triangles has at most 3 nt edges
  crossings_.reserve(3 * triangle_capacity);
  chosen_.reserve(3 * triangle_capacity);
  next_entry_.reserve(6 * triangle_capacity);
  first_entry_.assign(triangle_capacity, kNone);
  queue_.reserve(triangle_capacity + vertex_capacity);
  find_stamp_.assign(triangle_capacity, 0);
  reach_stamp_.assign(triangle_capacity, 0);
  path_stamp_.assign(triangle_capacity, 0);
}

void CrossingFinder::List(std::uint32_t triangle, std::uint32_t entry) noexcept {
  if (find_stamp_[triangle] != find_) {
    find_stamp_[triangle] = find_;
    first_entry_[triangle] = kNone;
  }
  next_entry_[entry] = first_entry_[triangle];
  first_entry_[triangle] = entry;
}

void CrossingFinder::Find(const FlatSweep& sweep, const EditableMesh& mesh) noexcept {
  ++find_;
  crossings_.clear();
  next_entry_.clear();
  chosen_.clear();
  const Box box = CalcBox(sweep);
  const auto positions = mesh.Positions();
  const auto triangles = mesh.Triangles();
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const math::Vec3 &a = positions[triangles[t][0]], &b = positions[triangles[t][1]],
                     &c = positions[triangles[t][2]];
    if (!BoxesOverlap(box, {math::Min(math::Min(a, b), c), math::Max(math::Max(a, b), c)})) continue;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t twin = mesh.Twin(h);
      if (twin != kNone && twin < h) continue;  // found from the other side, whose box holds the edge too
      const auto at = FindCrossing(sweep, positions[mesh.From(h)], positions[mesh.To(h)]);
      if (!at) continue;
      const auto index = static_cast<std::uint32_t>(crossings_.size());
      crossings_.push_back(
          {mesh.From(h), mesh.To(h), *at, {t, twin == kNone ? kNone : EditableMesh::TriangleOf(twin)}});
      next_entry_.resize(next_entry_.size() + 2, kNone);
      List(t, 2 * index);
      if (twin != kNone) List(EditableMesh::TriangleOf(twin), 2 * index + 1);
    }
  }
}

void CrossingFinder::Reach(std::uint32_t t) noexcept {
  if (reach_stamp_[t] == reach_) return;
  reach_stamp_[t] = reach_;
  queue_.push_back(t);
}

void CrossingFinder::Follow(std::span<const std::uint32_t> from) noexcept {
  ++reach_;
  queue_.clear();
  for (const auto t : from) Reach(t);
  for (std::size_t next = 0; next < queue_.size(); ++next) {
    const std::uint32_t t = queue_[next];
    path_stamp_[t] = tick_;
    if (find_stamp_[t] != find_) continue;
    for (std::uint32_t entry = first_entry_[t]; entry != kNone; entry = next_entry_[entry]) {
      Crossing& crossing = crossings_[entry / 2];
      if (!crossing.is_chosen) {
        crossing.is_chosen = true;
        chosen_.push_back(entry / 2);
      }
      const std::uint32_t beyond = crossing.triangles[1 - entry % 2];
      if (beyond != kNone) Reach(beyond);
    }
  }
}

void CrossingFinder::ChooseUntouched() noexcept {
  ++reach_;
  for (std::uint32_t c = 0; c < crossings_.size(); ++c) {
    if (reach_stamp_[crossings_[c].triangles[0]] == reach_) continue;
    // one connected set of crossed triangles
    queue_.clear();
    Reach(crossings_[c].triangles[0]);
    bool is_touched = false;
    for (std::size_t next = 0; next < queue_.size(); ++next) {
      const std::uint32_t t = queue_[next];
      is_touched = is_touched || IsOfPath(t);
      for (std::uint32_t entry = first_entry_[t]; entry != kNone; entry = next_entry_[entry]) {
        const std::uint32_t beyond = crossings_[entry / 2].triangles[1 - entry % 2];
        if (beyond != kNone) Reach(beyond);
      }
    }
    if (is_touched) continue;
    for (const auto t : queue_) {
      for (std::uint32_t entry = first_entry_[t]; entry != kNone; entry = next_entry_[entry]) {
        Crossing& crossing = crossings_[entry / 2];
        if (crossing.is_chosen) continue;
        crossing.is_chosen = true;
        chosen_.push_back(entry / 2);
      }
    }
  }
  for (const auto c : chosen_) {
    for (const auto t : crossings_[c].triangles) {
      if (t != kNone) path_stamp_[t] = tick_;
    }
  }
}

void CrossingFinder::StartTick(const EditableMesh& mesh) noexcept {
  ++tick_;
  first_new_triangle_ = mesh.TriangleCount();
}

}  // namespace trocar::geometry
