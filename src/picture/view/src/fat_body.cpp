// SPDX-License-Identifier: Apache-2.0
#include "fat_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/base/assert.h"

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kCell = 0.00105;       // m; half a lobule
constexpr double kMostPoints = 150000;  // of the grid; a wider body gets larger cells
constexpr double kReach = 1.8;          // of a lobule's share, in its radii
/// Sum of squared shares on the surface: a lone lobule's share (1 - q)^3 at its radius, q = 1 / kReach^2.
const double kLevel = std::pow(1.0 - 1.0 / (kReach * kReach), 6.0);
constexpr double kGrooveShade = 0.60;  // of the light that is lost in a groove [-]

}  // namespace

void FatBody::Make(std::span<const FatLobule> lobules) {
  mesh_.positions.clear();
  mesh_.triangles.clear();
  rest_.clear();
  occlusion_.clear();
  if (lobules.empty()) return;
  TROCAR_ASSERT(lobules.size() < std::numeric_limits<std::uint16_t>::max());
  Vec3 low = lobules[0].centre, high = low;
  double widest = 0;
  for (const FatLobule& lobule : lobules) {
    low = math::Min(low, lobule.centre);
    high = math::Max(high, lobule.centre);
    widest = std::max(widest, lobule.radius);
  }
  const Vec3 margin = (kReach * widest) * Vec3{1, 1, 1};
  const Vec3 span = high - low + 2.0 * margin;
  cell_ = std::max(kCell, std::cbrt(span.x * span.y * span.z / kMostPoints));
  // on a lattice that stays where it is, so that a body at rest does not shimmer
  const auto snap = [this](double x) { return cell_ * (std::floor(x / cell_) - 1.0); };
  corner_ = {snap(low.x - margin.x), snap(low.y - margin.y), snap(low.z - margin.z)};
  const Vec3 all = high + margin - corner_;
  size_ = {static_cast<int>(all.x / cell_) + 3, static_cast<int>(all.y / cell_) + 3,
           static_cast<int>(all.z / cell_) + 3};
  Fill(lobules);
  AddVertices(lobules);
  AddTriangles();
}

void FatBody::Fill(std::span<const FatLobule> lobules) {
  const std::size_t points = At(size_[0] - 1, size_[1] - 1, size_[2] - 1) + 1;
  field_.assign(points, 0.0f);
  best_.assign(points, 0.0f);
  second_.assign(points, 0.0f);
  owner_.assign(points, 0);
  for (std::size_t i = 0; i < lobules.size(); ++i) {
    const Vec3 centre = (lobules[i].centre - corner_) / cell_;
    const double reach = kReach * lobules[i].radius / cell_;
    const auto inverse = static_cast<float>(1.0 / (reach * reach));
    std::array<int, 3> from{}, to{};
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      from[axis] = std::max(0, static_cast<int>(std::ceil(centre[k] - reach)));
      to[axis] = std::min(size_[axis] - 1, static_cast<int>(std::floor(centre[k] + reach)));
    }
    for (int z = from[2]; z <= to[2]; ++z) {
      const double dz = z - centre.z;
      for (int y = from[1]; y <= to[1]; ++y) {
        const double dy = y - centre.y;
        const std::size_t row = At(0, y, z);
        for (int x = from[0]; x <= to[0]; ++x) {
          const auto dx = static_cast<float>(x - centre.x);
          const float left = 1.0f - (dx * dx + static_cast<float>(dy * dy + dz * dz)) * inverse;
          if (left <= 0.0f) continue;
          const float share = left * left * left;
          const std::size_t at = row + static_cast<std::size_t>(x);
          field_[at] += share * share;
          if (share > best_[at]) {
            second_[at] = best_[at];
            best_[at] = share;
            owner_[at] = static_cast<std::uint16_t>(i);
          } else {
            second_[at] = std::max(second_[at], share);
          }
        }
      }
    }
  }
}

void FatBody::AddVertices(std::span<const FatLobule> lobules) {
  vertex_.assign(field_.size(), -1);
  const auto level = static_cast<float>(kLevel);
  for (int z = 0; z + 1 < size_[2]; ++z) {
    for (int y = 0; y + 1 < size_[1]; ++y) {
      for (int x = 0; x + 1 < size_[0]; ++x) {
        std::array<float, 8> f{};
        int inside = 0;
        for (int c = 0; c < 8; ++c) {
          f[static_cast<std::size_t>(c)] = field_[At(x + (c & 1), y + ((c >> 1) & 1), z + (c >> 2))];
          inside += f[static_cast<std::size_t>(c)] > level ? 1 : 0;
        }
        if (inside == 0 || inside == 8) continue;
        // mean of where the cell's edges cross the surface
        Vec3 sum;
        int crossings = 0;
        for (int c = 0; c < 8; ++c) {
          for (const int bit : {1, 2, 4}) {
            if ((c & bit) != 0) continue;
            const float a = f[static_cast<std::size_t>(c)], b = f[static_cast<std::size_t>(c | bit)];
            if ((a > level) == (b > level)) continue;
            const double t = double{level - a} / double{b - a};
            sum += Vec3{double(c & 1), double((c >> 1) & 1), double(c >> 2)} +
                   t * Vec3{bit == 1 ? 1.0 : 0.0, bit == 2 ? 1.0 : 0.0, bit == 4 ? 1.0 : 0.0};
            ++crossings;
          }
        }
        const Vec3 p = corner_ + cell_ * (Vec3{double(x), double(y), double(z)} + sum / crossings);
        const std::size_t at = At(x, y, z);
        std::size_t nearest = at;
        float best = 0, second = 0;
        for (int c = 0; c < 8; ++c) {
          const std::size_t other = At(x + (c & 1), y + ((c >> 1) & 1), z + (c >> 2));
          if (best_[other] > best_[nearest]) nearest = other;
          best += best_[other];
          second += second_[other];
        }
        vertex_[at] = static_cast<std::int32_t>(mesh_.positions.size());
        mesh_.positions.push_back(p);
        const FatLobule& lobule = lobules[owner_[nearest]];
        rest_.push_back(p + (lobule.rest - lobule.centre));
        // shares fall with the cube
        const double groove = std::cbrt(double{second} / std::max(1e-6, double{best}));
        occlusion_.push_back(1.0 - kGrooveShade * groove * groove);
      }
    }
  }
}

/// A quad round each edge of the grid that crosses the surface, between the four cells at it.
void FatBody::AddTriangles() {
  const auto level = static_cast<float>(kLevel);
  const auto quad = [this](std::size_t a, std::size_t b, std::size_t c, std::size_t d, bool is_turned) {
    const auto at = [this](std::size_t cell) { return static_cast<std::uint32_t>(vertex_[cell]); };
    if (is_turned) std::swap(b, d);
    mesh_.triangles.push_back({at(a), at(b), at(c)});
    mesh_.triangles.push_back({at(a), at(c), at(d)});
  };
  for (int z = 1; z + 1 < size_[2]; ++z) {
    for (int y = 1; y + 1 < size_[1]; ++y) {
      for (int x = 1; x + 1 < size_[0]; ++x) {
        const bool is_in = field_[At(x, y, z)] > level;
        if (is_in != (field_[At(x + 1, y, z)] > level))
          quad(At(x, y - 1, z - 1), At(x, y, z - 1), At(x, y, z), At(x, y - 1, z), !is_in);
        if (is_in != (field_[At(x, y + 1, z)] > level))
          quad(At(x - 1, y, z - 1), At(x - 1, y, z), At(x, y, z), At(x, y, z - 1), !is_in);
        if (is_in != (field_[At(x, y, z + 1)] > level))
          quad(At(x - 1, y - 1, z), At(x, y - 1, z), At(x, y, z), At(x - 1, y, z), !is_in);
      }
    }
  }
}

}  // namespace trocar::view
