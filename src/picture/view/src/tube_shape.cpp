// SPDX-License-Identifier: Apache-2.0
#include "tube_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "organ_shape.h"
#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/tube.h"
#include "trocar/math/random.h"

namespace trocar::view {

using math::Vec3;

namespace {

constexpr int kSides = TubeCourse::kSides;
constexpr double kLumenShare = 0.62;     // of the outer radius
constexpr double kLumenProud = 0.00006;  // m, ahead of the end, so that it is seen
constexpr double kClipReach = 0.0065;    // m, of a clip's legs from its middle, and what lies beside them
constexpr double kClipFlat = 0.0007;     // m to both sides along the tube that a clip presses flat
constexpr double kClipFade = 0.0040;     // m over which the tube becomes round again
constexpr double kThinnest = 0.0002;     // m, half of what is left between the legs
constexpr std::uint32_t kRags = 3;       // remnants at each node
constexpr double kRagProud = 0.00025;    // m that a rag stands off the wall
constexpr double kRagLength = 0.0022;    // m, of one that hangs free
constexpr double kRagBreadth = 0.0011, kRagBreadthGain = 0.0012;  // m
constexpr double kThreadBreadth = 0.00013;                        // m

/// Between two marks.
render::SurfaceMark MixMarks(const render::SurfaceMark& a, const render::SurfaceMark& b, double share) {
  const auto mix = [share](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround((1.0 - share) * from + share * to));
  };
  render::SurfaceMark mark;
  mark.blanching = mix(a.blanching, b.blanching);
  mark.charring = mix(a.charring, b.charring);
  return mark;
}

/// Between the legs of a clip the walls lie on each other and spread to the sides.
Vec3 PressFlat(const Vec3& p_world, const math::Pose& X_clip_world, const surgery::ClipSnapshot& clip) {
  Vec3 p = X_clip_world * p_world;
  const double far = std::abs(p.z);
  if (far > kClipFlat + kClipFade || std::abs(p.x) > kClipReach || std::abs(p.y) > kClipReach) return p_world;
  const double half = std::max(0.5 * clip.gap, kThinnest);
  if (std::abs(p.y) <= half) return p_world;
  const double fade = std::clamp((far - kClipFlat) / kClipFade, 0.0, 1.0);
  const double share = 1.0 - fade * fade * (3.0 - 2.0 * fade);
  p.y += share * (std::clamp(p.y, -half, half) - p.y);
  return clip.X_world_clip * p;
}

}  // namespace

std::vector<TubeChain> FindChains(std::span<const surgery::TubePiece> pieces, std::uint32_t surface,
                                  const scene::SurfaceInfo& info) {
  struct Node {
    std::vector<std::uint32_t> neighbours;
    double radius = 0;
  };
  std::map<std::uint32_t, Node> nodes;
  for (const surgery::TubePiece& piece : pieces) {
    if (piece.surface != surface || piece.a == piece.b) continue;
    nodes[piece.a].neighbours.push_back(piece.b);
    nodes[piece.b].neighbours.push_back(piece.a);
    nodes[piece.a].radius = piece.radius_a;
    nodes[piece.b].radius = piece.radius_b;
  }
  for (auto& [row, node] : nodes) std::sort(node.neighbours.begin(), node.neighbours.end());
  const auto is_own_end = [&info](std::uint32_t row) {
    return row == info.first_node || row + 1 == info.first_node + info.node_count;
  };
  std::vector<TubeChain> chains;
  const auto walk = [&](std::uint32_t first, std::uint32_t next) {
    TubeChain chain;
    chain.rows = {first};
    for (std::uint32_t last = first, row = next;;) {
      chain.rows.push_back(row);
      const Node& node = nodes.at(row);
      if (node.neighbours.size() != 2 || row == first) break;
      const std::uint32_t onward = node.neighbours[node.neighbours[0] == last ? 1 : 0];
      last = row;
      row = onward;
    }
    for (const std::uint32_t row : chain.rows) chain.radii.push_back(nodes.at(row).radius);
    const auto is_open = [&](std::uint32_t row) {
      return nodes.at(row).neighbours.size() == 1 && !is_own_end(row);
    };
    chain.is_open_first = is_open(chain.rows.front());
    chain.is_open_last = is_open(chain.rows.back());
    chains.push_back(std::move(chain));
  };
  for (const auto& [row, node] : nodes) {
    if (node.neighbours.size() == 2) continue;
    for (const std::uint32_t next : node.neighbours) {
      // each run once, from the end with the lower row
      const std::size_t before = chains.size();
      walk(row, next);
      if (chains[before].rows.back() < row) chains.pop_back();
    }
  }
  return chains;
}

TubeShape::TubeShape(const scene::SurfaceInfo& info, std::uint32_t index, render::Material material,
                     std::span<const Vec3> start, TubeLook look)
    : info_(info),
      index_(index),
      material_(material),
      look_(look),
      own_rest_(start.begin() + info.first_node, start.begin() + info.first_node + info.node_count) {
  TubeChain chain;
  for (std::uint32_t i = 0; i < info.node_count; ++i) chain.rows.push_back(info.first_node + i);
  chain.radii = info.radii;
  chains_.push_back(std::move(chain));
  Resize(start);
}

/// \param rest_of_rows  of the rows of all chains [m]
void TubeShape::Resize(std::span<const Vec3> rest_of_rows) {
  const std::array<Vec3, 2> fixed = {own_rest_.front(), own_rest_.back()};
  triangles_.clear();
  lumen_triangles_.clear();
  courses_.clear();
  std::uint32_t offset = 0, lumens = 0;
  for (const TubeChain& chain : chains_) {
    nodes_.resize(chain.rows.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i] = rest_of_rows[chain.rows[i]];
    const TubeCourse& course = courses_.emplace_back(nodes_, chain.radii, fixed, look_);
    for (const auto& [a, b, c] : geometry::MakeTubeTriangles(course.RingCount(), kSides))
      triangles_.push_back({a + offset, b + offset, c + offset});
    offset += static_cast<std::uint32_t>(course.SkinSize());
    for (const bool is_open : {chain.is_open_first, chain.is_open_last}) {
      if (!is_open) continue;
      for (std::uint32_t side = 0; side < kSides; ++side)
        lumen_triangles_.push_back({lumens, lumens + 1 + side, lumens + 1 + (side + 1) % kSides});
      lumens += kSides + 1;
    }
  }
  positions_.resize(offset);
  normals_.resize(offset);
  lumen_positions_.resize(lumens);
  lumen_normals_.resize(lumens);
  marks_.clear();
}

void TubeShape::SetPieces(std::span<const surgery::TubePiece> pieces, RowMemory& memory,
                          std::span<const Vec3> positions) {
  std::vector<TubeChain> chains = FindChains(pieces, index_, info_);
  if (chains == chains_) return;
  chains_ = std::move(chains);
  for (const TubeChain& chain : chains_) {
    // forwards, then backwards, so that every new row has a known one before it
    const auto learn = [&](std::uint32_t row, std::uint32_t before) {
      if (memory.is_known[row] == 0 && memory.is_known[before] != 0)
        memory.Learn(row, before, positions[row] - positions[before]);
    };
    const std::vector<std::uint32_t>& rows = chain.rows;
    for (std::size_t i = 1; i < rows.size(); ++i) learn(rows[i], rows[i - 1]);
    for (std::size_t i = rows.size(); i-- > 1;) learn(rows[i - 1], rows[i]);
    for (const std::uint32_t row : rows)
      if (memory.is_known[row] == 0) memory.Set(row, positions[row], 1.0);
  }
  Resize(memory.rest);
  is_changed_ = true;
}

void TubeShape::Update(const simulation::Snapshot& snapshot, const Film& film) {
  const simulation::OperationSnapshot& operation = snapshot.operation;
  std::size_t offset = 0;
  for (std::size_t c = 0; c < chains_.size(); ++c) {
    const std::vector<std::uint32_t>& rows = chains_[c].rows;
    nodes_.resize(rows.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i] = snapshot.positions[rows[i]];
    courses_[c].CalcSkin(nodes_, std::span(positions_).subspan(offset, courses_[c].SkinSize()));
    offset += courses_[c].SkinSize();
  }
  for (std::size_t i = 0; i < std::min(operation.clip_count, operation.clips.size()); ++i) {
    const surgery::ClipSnapshot& clip = operation.clips[i];
    if (clip.is_lost) continue;
    const math::Pose X_clip_world = math::Inverse(clip.X_world_clip);
    for (Vec3& p : positions_) p = PressFlat(p, X_clip_world, clip);
  }
  geometry::CalcVertexNormals(positions_, triangles_, normals_);
  UpdateLumens();

  if (operation.blanching.empty() && operation.charring.empty() && film.IsEmpty() && !has_marks_) return;
  marks_.resize(positions_.size());
  bool has_any = false;
  offset = 0;
  for (std::size_t c = 0; c < chains_.size(); ++c) {
    const std::vector<std::uint32_t>& rows = chains_[c].rows;
    for (std::size_t v = 0; v < courses_[c].SkinSize(); ++v) {
      render::SurfaceMark& mark = marks_[offset + v];
      const TubeCourse::Place place = courses_[c].PlaceOf(v);
      mark = HeatMark(operation, rows[place.node]);
      if (place.share > 0.0) mark = MixMarks(mark, HeatMark(operation, rows[place.node + 1]), place.share);
      film.Wet(positions_[offset + v], mark);
      has_any = has_any || mark != render::SurfaceMark{};
    }
    offset += courses_[c].SkinSize();
  }
  if (!has_any && !has_marks_) marks_.clear();
}

/// Discs before the ends that are open, drawn in from the rim.
void TubeShape::UpdateLumens() {
  std::size_t offset = 0, lumen = 0;
  for (std::size_t c = 0; c < chains_.size(); ++c) {
    const TubeChain& chain = chains_[c];
    const std::size_t rings = courses_[c].RingCount() * kSides;
    for (const bool is_first : {true, false}) {
      if (!(is_first ? chain.is_open_first : chain.is_open_last)) continue;
      const Vec3 centre = positions_[offset + rings + (is_first ? 0 : 1)];
      const std::size_t ring = offset + (is_first ? 0 : rings - kSides);
      const std::size_t inner = offset + (is_first ? kSides : rings - 2 * kSides);
      Vec3 behind;
      for (std::size_t side = 0; side < kSides; ++side) behind += positions_[inner + side] / kSides;
      const Vec3 out = math::Normalized(centre - behind);
      lumen_positions_[lumen] = centre + kLumenProud * out;
      lumen_normals_[lumen] = out;
      for (std::size_t side = 0; side < kSides; ++side) {
        // counter-clockwise seen from outside: the first end looks back along the rings
        const std::size_t at = ring + (is_first ? (kSides - side) % kSides : side);
        lumen_positions_[lumen + 1 + side] =
            centre + kLumenShare * (positions_[at] - centre) + kLumenProud * out;
        lumen_normals_[lumen + 1 + side] = out;
      }
      lumen += kSides + 1;
    }
    offset += courses_[c].SkinSize();
  }
}

void TubeShape::Add(render::Renderer& renderer, std::span<const double> ambient_occlusion,
                    RowMemory& memory) {
  const std::vector<std::uint32_t>& rows = chains_[0].rows;
  std::vector<double> open(rows.size(), 0), count(rows.size(), 0);
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    const std::size_t node = courses_[0].PlaceOf(v).node;
    open[node] += ambient_occlusion[v];
    count[node] += 1;
  }
  for (std::size_t i = 0; i < rows.size(); ++i) memory.Set(rows[i], own_rest_[i], open[i] / count[i]);
  AddSurface(renderer, memory);
}

void TubeShape::AddSurface(render::Renderer& renderer, const RowMemory& memory) {
  std::vector<Vec3> rest(positions_.size());
  std::vector<double> ambient_occlusion(positions_.size());
  std::size_t offset = 0;
  for (std::size_t c = 0; c < chains_.size(); ++c) {
    const std::vector<std::uint32_t>& rows = chains_[c].rows;
    nodes_.resize(rows.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i] = memory.rest[rows[i]];
    courses_[c].CalcSkin(nodes_, std::span(rest).subspan(offset, courses_[c].SkinSize()));
    for (std::size_t v = 0; v < courses_[c].SkinSize(); ++v) {
      const TubeCourse::Place place = courses_[c].PlaceOf(v);
      const double here = memory.ambient_occlusion[rows[place.node]];
      const double next = memory.ambient_occlusion[rows[std::min(place.node + 1, rows.size() - 1)]];
      ambient_occlusion[offset + v] = (1.0 - place.share) * here + place.share * next;
    }
    offset += courses_[c].SkinSize();
  }
  surface_ = renderer.AddSurface(triangles_, rest, material_, ambient_occlusion);
  lumens_ = {};
  if (!lumen_triangles_.empty())
    lumens_ = renderer.AddSurface(lumen_triangles_, lumen_positions_, render::Material::kLumen);
}

void TubeShape::AddRemnants(render::Frame& frame) const {
  if (look_ != TubeLook::kLiving) return;
  std::size_t offset = 0;
  for (std::size_t c = 0; c < chains_.size(); ++c) {
    const std::vector<std::uint32_t>& rows = chains_[c].rows;
    for (std::size_t node = 0; node + 1 < rows.size(); ++node) {
      for (std::uint32_t rag = 0; rag < kRags; ++rag)
        AddRemnant(frame, offset, courses_[c], node, kRags * rows[node] + rag);
    }
    offset += courses_[c].SkinSize();
  }
}

/// One rag that lies along the wall, a thread over it, or a shred that hangs off it.
/// \param offset  of the first vertex of the chain
/// \param seed    the same for the same node, whatever was cut elsewhere
void TubeShape::AddRemnant(render::Frame& frame, std::size_t offset, const TubeCourse& course,
                           std::size_t node, std::uint32_t seed) const {
  math::Random random(seed);
  const std::size_t steps = course.Steps();
  const auto pick = [&random](std::size_t count) {
    return static_cast<std::size_t>(random.Uniform() * static_cast<double>(count));
  };
  const std::size_t from = node * steps + pick(steps), side = pick(kSides);
  const std::size_t to = std::min(from + 1 + pick(steps + 2), course.RingCount() - 1);
  const std::size_t turned = (side + kSides - 2 + pick(5)) % kSides;
  const std::size_t a = offset + from * kSides + side, b = offset + to * kSides + turned;
  const double kind = random.Uniform(), size = random.Uniform();
  const Vec3 p = positions_[a] + kRagProud * normals_[a], q = positions_[b] + kRagProud * normals_[b];
  if (kind < 0.5) {
    frame.fibres.push_back(
        {p, q, kRagBreadth + kRagBreadthGain * size, 0.0003, render::Material::kFilm, seed});
  } else if (kind < 0.8) {
    frame.fibres.push_back({p, q, kThreadBreadth * (0.7 + size), 0.0005, render::Material::kFibre, seed});
  } else {
    const Vec3 free =
        p + kRagLength * (0.5 + size) *
                math::Normalized(normals_[a] +
                                 Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)});
    frame.fibres.push_back(
        {positions_[a], free, kRagBreadth * (0.6 + 0.8 * size), 0.0004, render::Material::kFilm, seed});
  }
}

void TubeShape::Upload(render::Renderer& renderer, const RowMemory& memory) {
  if (is_changed_) {
    renderer.RemoveSurface(surface_);
    renderer.RemoveSurface(lumens_);
    AddSurface(renderer, memory);
    is_changed_ = false;
  }
  renderer.UpdateSurface(surface_, positions_, normals_);
  if (!lumen_triangles_.empty()) renderer.UpdateSurface(lumens_, lumen_positions_, lumen_normals_);
  if (marks_.empty()) return;
  renderer.UpdateMarks(surface_, marks_);
  has_marks_ = true;
}

}  // namespace trocar::view
