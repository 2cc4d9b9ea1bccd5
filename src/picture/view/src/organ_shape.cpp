// SPDX-License-Identifier: Apache-2.0
#include "organ_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pressed_tissue.h"
#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/mesh_topology.h"

namespace trocar::view {

using geometry::Triangle;
using math::Vec3;

namespace {

constexpr double kFirstStretch = 1.30, kFullStretch = 2.4;  // of the area: it begins to whiten, it is white

/// (vertices) area of the triangles round each [m^2].
void SumAreas(std::span<const Triangle> triangles, std::span<const Vec3> positions,
              std::vector<double>& areas) {
  areas.assign(positions.size(), 0.0);
  for (const auto& [a, b, c] : triangles) {
    const double area =
        0.5 * math::Norm(math::Cross(positions[b] - positions[a], positions[c] - positions[a]));
    for (const std::uint32_t v : {a, b, c}) areas[v] += area;
  }
}

std::uint8_t ToByte(float share) {
  return static_cast<std::uint8_t>(255.0f * std::clamp(share, 0.0f, 1.0f) + 0.5f);
}

/// Rows that are new learn from the nearest neighbour that is known; those that no known one surrounds lie as they are.
void LearnRows(std::span<const std::uint32_t> rows, std::span<const Triangle> triangles,
               std::span<const Vec3> positions, RowMemory& memory) {
  const geometry::Rows neighbours = geometry::FindVertexNeighbours(triangles, rows.size());
  for (bool has_learnt = true; has_learnt;) {
    has_learnt = false;
    for (std::size_t v = 0; v < rows.size(); ++v) {
      const std::uint32_t row = rows[v];
      if (memory.is_known[row] != 0) continue;
      double nearest = std::numeric_limits<double>::infinity();
      std::uint32_t teacher = row;
      for (const std::uint32_t u : neighbours.Row(v)) {
        const double distance = math::Distance(positions[rows[u]], positions[row]);
        if (memory.is_known[rows[u]] == 0 || distance >= nearest) continue;
        nearest = distance;
        teacher = rows[u];
      }
      if (teacher == row) continue;
      memory.Learn(row, teacher, positions[row] - positions[teacher]);
      has_learnt = true;
    }
  }
  for (const std::uint32_t row : rows)
    if (memory.is_known[row] == 0) memory.Set(row, positions[row], 1.0);
}

}  // namespace

void RefineMarks(std::span<const geometry::Edge> edges, std::size_t coarse,
                 std::vector<render::SurfaceMark>& marks) {
  TROCAR_ASSERT(marks.size() == coarse + edges.size());
  const auto mean = [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>((a + b) / 2); };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const render::SurfaceMark a = marks[edges[i][0]], b = marks[edges[i][1]];
    marks[coarse + i] = {mean(a.blanching, b.blanching), mean(a.charring, b.charring), mean(a.blood, b.blood),
                         mean(a.bile, b.bile), mean(a.pallor, b.pallor)};
  }
}

std::uint8_t CalcPallor(double stretch) noexcept {
  const double share = std::clamp((stretch - kFirstStretch) / (kFullStretch - kFirstStretch), 0.0, 1.0);
  return ToByte(static_cast<float>(share));
}

render::SurfaceMark HeatMark(const simulation::OperationSnapshot& operation, std::size_t row) {
  render::SurfaceMark mark;
  if (row < operation.blanching.size()) mark.blanching = ToByte(operation.blanching[row]);
  if (row < operation.charring.size()) mark.charring = ToByte(operation.charring[row]);
  return mark;
}

OrganShape::OrganShape(const scene::SurfaceInfo& info, std::uint32_t index, render::Material material)
    : surface_index_(static_cast<std::int32_t>(index)), material_(material), triangles_(info.triangles) {
  rows_.resize(info.node_count);
  for (std::uint32_t i = 0; i < info.node_count; ++i) rows_[i] = info.first_node + i;
  Resize();
}

void OrganShape::Resize() {
  positions_.resize(rows_.size());
  normals_.resize(rows_.size());
  refiner_.emplace(triangles_, rows_.size());
  fine_positions_.resize(refiner_->VertexCount());
  fine_normals_.resize(refiner_->VertexCount());
  marks_.clear();
}

void OrganShape::SetTriangles(std::span<const Triangle> triangles, std::span<const Vec3> positions,
                              RowMemory& memory) {
  if (std::equal(triangles.begin(), triangles.end(), row_triangles_.begin(), row_triangles_.end())) return;
  row_triangles_.assign(triangles.begin(), triangles.end());
  rows_.clear();
  for (const Triangle& triangle : triangles) rows_.insert(rows_.end(), triangle.begin(), triangle.end());
  std::sort(rows_.begin(), rows_.end());
  rows_.erase(std::unique(rows_.begin(), rows_.end()), rows_.end());
  TROCAR_ASSERT(rows_.empty() || rows_.back() < positions.size());
  triangles_.assign(triangles.begin(), triangles.end());
  for (Triangle& triangle : triangles_) {
    for (std::uint32_t& v : triangle)
      v = static_cast<std::uint32_t>(std::lower_bound(rows_.begin(), rows_.end(), v) - rows_.begin());
  }
  LearnRows(rows_, triangles_, positions, memory);
  Resize();
  LearnAreas(memory);
  is_changed_ = true;
}

void OrganShape::Update(const simulation::Snapshot& snapshot, const Film& film) {
  for (std::size_t v = 0; v < rows_.size(); ++v) positions_[v] = snapshot.positions[rows_[v]];
  geometry::CalcVertexNormals(positions_, triangles_, normals_);
  refiner_->Refine(positions_, normals_, fine_positions_, fine_normals_);

  const simulation::OperationSnapshot& operation = snapshot.operation;
  marks_.resize(refiner_->VertexCount());
  SumAreas(triangles_, positions_, areas_);
  const std::vector<Press> presses = FindPresses(snapshot);
  bool has_any = false;
  for (std::size_t v = 0; v < rows_.size(); ++v) {
    marks_[v] = HeatMark(operation, rows_[v]);
    if (rest_areas_.size() == areas_.size() && rest_areas_[v] > 0.0)
      marks_[v].pallor = CalcPallor(areas_[v] / rest_areas_[v]);
    if (!presses.empty())
      marks_[v].pallor =
          std::max(marks_[v].pallor,
                   ToByte(static_cast<float>(CalcPressedPallor(presses, surface_index_, positions_[v]))));
    film.Wet(positions_[v], rows_[v], marks_[v]);
    has_any = has_any || marks_[v] != render::SurfaceMark{};
  }
  // what has never been marked needs no upload
  if (has_any || has_marks_) {
    RefineMarks(refiner_->Edges(), rows_.size(), marks_);
  } else {
    marks_.clear();
  }
}

/// Areas round each vertex before anything moved.
void OrganShape::LearnAreas(const RowMemory& memory) {
  std::vector<Vec3> rest(rows_.size());
  for (std::size_t v = 0; v < rows_.size(); ++v) rest[v] = memory.rest[rows_[v]];
  SumAreas(triangles_, rest, rest_areas_);
}

void OrganShape::AddSurface(render::Renderer& renderer, const RowMemory& memory) {
  std::vector<Vec3> rest(rows_.size()), normals(rows_.size()), fine_rest(refiner_->VertexCount()),
      fine_normals(refiner_->VertexCount());
  std::vector<double> ambient_occlusion(refiner_->VertexCount());
  for (std::size_t v = 0; v < rows_.size(); ++v) {
    rest[v] = memory.rest[rows_[v]];
    ambient_occlusion[v] = memory.ambient_occlusion[rows_[v]];
  }
  geometry::CalcVertexNormals(rest, triangles_, normals);
  refiner_->Refine(rest, normals, fine_rest, fine_normals);
  const auto edges = refiner_->Edges();
  for (std::size_t i = 0; i < edges.size(); ++i)
    ambient_occlusion[rows_.size() + i] =
        0.5 * (ambient_occlusion[edges[i][0]] + ambient_occlusion[edges[i][1]]);
  surface_ = renderer.AddSurface(refiner_->Triangles(), fine_rest, material_, ambient_occlusion, triangles_);
}

void OrganShape::Add(render::Renderer& renderer, std::span<const double> ambient_occlusion,
                     RowMemory& memory) {
  for (std::size_t v = 0; v < rows_.size(); ++v) memory.Set(rows_[v], positions_[v], ambient_occlusion[v]);
  LearnAreas(memory);
  AddSurface(renderer, memory);
}

void OrganShape::Upload(render::Renderer& renderer, const RowMemory& memory) {
  if (is_changed_) {
    renderer.RemoveSurface(surface_);
    AddSurface(renderer, memory);
    shown_.clear();
    is_changed_ = false;
  }
  renderer.UpdateSurface(surface_, fine_positions_, fine_normals_);
  if (marks_.empty() || marks_ == shown_) return;
  renderer.UpdateMarks(surface_, marks_);
  shown_ = marks_;
  has_marks_ = true;
}

}  // namespace trocar::view
