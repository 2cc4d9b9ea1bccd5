// SPDX-License-Identifier: Apache-2.0
#include "connective_tissue.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/to_integer.h"
#include "trocar/collision/queries.h"
#include "trocar/collision/triangle_tree.h"
#include "trocar/math/random.h"
#include "trocar/patient/patient.h"

namespace trocar::scene {

using math::Vec3;

namespace {

/// Layers of lobules from front to back; the outer two carry the peritoneum.
constexpr int kLayers = 4;
/// The fat reaches this far beyond the cystic duct and the hepatic duct, as shares of the way between them.
constexpr double kBeyond = 0.2;
/// A lobule is shaken by this share of the spacing.
constexpr double kShake = 0.25;
/// Neighbours nearer than this, in spacings, are joined, but no lobule to more than so many.
constexpr double kReach = 1.55;
constexpr std::size_t kMostNeighbours = 6, kMostTies = 2;
/// Clear of the organs' surfaces [m].
constexpr double kClearance = 0.0004;

/// A tube's line from the end that is nearer to `start`.
std::vector<Vec3> LineFrom(const patient::Tube& tube, const Vec3& start) {
  std::vector<Vec3> points = tube.line.points;
  if (math::Distance(points.back(), start) < math::Distance(points.front(), start))
    std::reverse(points.begin(), points.end());
  return points;
}

/// Point at a share of a line's length.
Vec3 PointAt(const std::vector<Vec3>& line, double share) {
  std::vector<double> arc{0.0};
  for (std::size_t i = 1; i < line.size(); ++i)
    arc.push_back(arc.back() + math::Distance(line[i - 1], line[i]));
  const double wanted = std::clamp(share, 0.0, 1.0) * arc.back();
  std::size_t i = 1;
  while (i + 1 < line.size() && arc[i] < wanted) ++i;
  const double piece = arc[i] - arc[i - 1];
  return math::Lerp(line[i - 1], line[i], piece > 0.0 ? (wanted - arc[i - 1]) / piece : 0.0);
}

double Length(const std::vector<Vec3>& line) {
  double length = 0;
  for (std::size_t i = 1; i < line.size(); ++i) length += math::Distance(line[i - 1], line[i]);
  return length;
}

/// Organs and tubes, asked where a lobule may lie and what is near.
class Surroundings {
 public:
  explicit Surroundings(const patient::Patient& patient) : patient_(patient) {
    for (const patient::Organ& organ : patient.organs) {
      auto tree = collision::TriangleTree::Make(organ.mesh.positions, organ.mesh.triangles);
      trees_.push_back(tree.ok() ? std::move(*tree) : collision::TriangleTree());
      around_.push_back(geometry::FindVertexTriangles(organ.mesh.triangles, organ.mesh.positions.size()));
    }
  }

  bool IsFree(const Vec3& p) const {
    for (std::size_t i = 0; i < trees_.size(); ++i) {
      const auto& mesh = patient_.organs[i].mesh;
      const auto nearest = trees_[i].FindNearest(mesh.positions, p);
      if (!nearest.Found()) continue;
      if (collision::FindSide(mesh.positions, mesh.triangles, around_[i], p, nearest).distance < kClearance)
        return false;
    }
    return std::all_of(patient_.tubes.begin(), patient_.tubes.end(), [&](const patient::Tube& tube) {
      for (std::size_t k = 0; k < tube.line.points.size(); ++k) {
        if (math::Distance(tube.line.points[k], p) < tube.line.radii[k] + kClearance) return false;
      }
      return true;
    });
  }

  /// The nearest points of organs and tubes within `reach` of their surface, at most kMostTies of each.
  std::vector<std::pair<double, FibreEnd>> FindTies(const Vec3& p, double reach) const {
    std::vector<std::pair<double, FibreEnd>> ties;
    const auto add = [&](FibreEnd::Of of, std::size_t which, const std::vector<Vec3>& points,
                         const std::vector<double>* radii) {
      std::vector<std::pair<double, std::uint32_t>> near;
      for (std::uint32_t k = 0; k < points.size(); ++k) {
        const double distance = math::Distance(points[k], p);
        if (distance - (radii != nullptr ? (*radii)[k] : 0.0) <= reach) near.emplace_back(distance, k);
      }
      std::sort(near.begin(), near.end());
      near.resize(std::min(near.size(), kMostTies));
      for (const auto& [distance, k] : near)
        ties.push_back({distance, {of, static_cast<std::uint32_t>(which), k}});
    };
    for (std::size_t i = 0; i < patient_.organs.size(); ++i)
      add(FibreEnd::Of::kOrgan, i, patient_.organs[i].mesh.positions, nullptr);
    for (std::size_t i = 0; i < patient_.tubes.size(); ++i)
      add(FibreEnd::Of::kTube, i, patient_.tubes[i].line.points, &patient_.tubes[i].line.radii);
    return ties;
  }

 private:
  const patient::Patient& patient_;
  std::vector<collision::TriangleTree> trees_;
  std::vector<geometry::Rows> around_;
};

}  // namespace

ConnectiveTissue MakeConnectiveTissue(const patient::Patient& patient, double spacing, std::uint64_t seed) {
  ConnectiveTissue made;
  const int cystic_index = patient.TubeOf(roles::TubeRole::kCysticDuct),
            hepatic_index = patient.TubeOf(roles::TubeRole::kCommonHepaticDuct);
  if (cystic_index < 0 || hepatic_index < 0) return made;
  const patient::Tube &cystic = patient.tubes[cystic_index], &hepatic = patient.tubes[hepatic_index];
  // both lines lead away from where the ducts meet
  const auto near_hepatic = [&](const Vec3& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& q : hepatic.line.points) least = std::min(least, math::Distance(p, q));
    return least;
  };
  const auto& ends = cystic.line.points;
  const Vec3 junction = near_hepatic(ends.front()) < near_hepatic(ends.back()) ? ends.front() : ends.back();
  const std::vector<Vec3> duct = LineFrom(cystic, junction), plate = LineFrom(hepatic, junction);
  const Vec3 across = duct.back() - duct.front(), up = plate.back() - plate.front();
  const Vec3 normal = math::Normalized(math::Cross(across, up), {0, 0, 1});

  const Surroundings surroundings(patient);
  math::Random random(seed ^ 0x6661740aULL);
  std::vector<int> layers;
  const int rows = std::max(2, base::RoundTo<int>(Length(duct) / spacing));
  for (int row = 0; row <= rows; ++row) {
    const double u = static_cast<double>(row) / rows;
    const Vec3 from = PointAt(duct, u), to = PointAt(plate, u);
    const double width = math::Distance(from, to);
    const int columns = std::max(1, base::RoundTo<int>(width / spacing));
    const int beyond = std::max(2, base::RoundTo<int>(kBeyond * width / spacing));
    const Vec3 step =
        math::Normalized(to - from, math::Normalized(up)) * (width > spacing ? width / columns : spacing);
    for (int column = -beyond; column <= columns + beyond; ++column) {
      for (int layer = 0; layer < kLayers; ++layer) {
        const Vec3 shake{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
        const Vec3 p = from + step * static_cast<double>(column) +
                       normal * ((layer - 0.5 * (kLayers - 1)) * spacing) + shake * (kShake * spacing);
        const bool is_apart = std::none_of(made.lobules.begin(), made.lobules.end(), [&](const Vec3& other) {
          return math::Distance(p, other) < 0.6 * spacing;
        });
        if (!is_apart || !surroundings.IsFree(p)) continue;
        made.lobules.push_back(p);
        layers.push_back(layer);
      }
    }
  }

  const auto is_outer = [&](std::size_t i) { return layers[i] == 0 || layers[i] == kLayers - 1; };
  std::vector<std::size_t> neighbours(made.lobules.size(), 0);
  for (std::uint32_t i = 0; i < made.lobules.size(); ++i) {
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t j = i + 1; j < made.lobules.size(); ++j) {
      const double distance = math::Distance(made.lobules[i], made.lobules[j]);
      if (distance < kReach * spacing) near.emplace_back(distance, j);
    }
    std::sort(near.begin(), near.end());
    for (const auto& [distance, j] : near) {
      if (neighbours[i] >= kMostNeighbours || neighbours[j] >= kMostNeighbours) continue;
      ++neighbours[i], ++neighbours[j];
      const bool is_peritoneum = is_outer(i) && is_outer(j) && layers[i] == layers[j];
      made.fibres.push_back(
          {{FibreEnd::Of::kLobule, i, 0}, {FibreEnd::Of::kLobule, j, 0}, distance, is_peritoneum});
    }
    for (const auto& [distance, end] : surroundings.FindTies(made.lobules[i], kReach * spacing))
      made.fibres.push_back({{FibreEnd::Of::kLobule, i, 0}, end, distance, false});
  }
  return made;
}

}  // namespace trocar::scene
