// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/rest_frame.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"

namespace trocar::tissue {

using math::Quaternion;
using math::Vec3;

namespace {

/// Weight of the previous rotation against the points [-]: decides only what the points leave open.
constexpr double kPriorShare = 1e-6;
/// Sweeps of Jacobi's method; a symmetric 4 x 4 matrix needs five or six.
constexpr int kMaxSweeps = 24;
/// Set in a root's entry while regions are found; models have far fewer nodes.
constexpr std::uint32_t kPinnedMark = 0x80000000u;

using Matrix3 = std::array<double, 9>;
using Matrix4 = std::array<std::array<double, 4>, 4>;

Matrix3 ToMatrix(const Quaternion& q) noexcept {
  const Vec3 x = math::Rotate(q, {1, 0, 0}), y = math::Rotate(q, {0, 1, 0}), z = math::Rotate(q, {0, 0, 1});
  return {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z};
}

void AddOuter(Matrix3& m, double w, const Vec3& x, const Vec3& r) noexcept {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) m[3 * row + column] += w * x[row] * r[column];
  }
}

/// FollowerStiffness a and its eigenvectors v by the rotation that clears a[p][q].
void RotatePair(Matrix4& a, Matrix4& v, int p, int q) noexcept {
  if (a[p][q] == 0.0) return;
  const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
  const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1.0));
  const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
  for (int i = 0; i < 4; ++i) {
    const double ip = a[i][p], iq = a[i][q];
    a[i][p] = c * ip - s * iq;
    a[i][q] = s * ip + c * iq;
  }
  for (int i = 0; i < 4; ++i) {
    const double pi = a[p][i], qi = a[q][i];
    a[p][i] = c * pi - s * qi;
    a[q][i] = s * pi + c * qi;
    const double vp = v[i][p], vq = v[i][q];
    v[i][p] = c * vp - s * vq;
    v[i][q] = s * vp + c * vq;
  }
}

/// Unit eigenvector of the largest eigenvalue.
std::array<double, 4> FindLargestEigenvector(Matrix4 a) noexcept {
  Matrix4 v{};
  for (int i = 0; i < 4; ++i) v[i][i] = 1.0;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double off = 0, on = 0;
    for (int i = 0; i < 4; ++i) {
      on += a[i][i] * a[i][i];
      for (int j = i + 1; j < 4; ++j) off += a[i][j] * a[i][j];
    }
    if (off <= 1e-32 * on) break;
    for (int p = 0; p < 3; ++p) {
      for (int q = p + 1; q < 4; ++q) RotatePair(a, v, p, q);
    }
  }
  int largest = 0;
  for (int i = 1; i < 4; ++i) {
    if (a[i][i] > a[largest][largest]) largest = i;
  }
  return {v[0][largest], v[1][largest], v[2][largest], v[3][largest]};
}

/// Rotation R that makes the trace of R^T m largest.
Quaternion FindRotation(const Matrix3& m) noexcept {
  // Horn's S_ab = sum r_a x_b is the transpose of m
  const double xx = m[0], xy = m[3], xz = m[6], yx = m[1], yy = m[4], yz = m[7], zx = m[2], zy = m[5],
               zz = m[8];
  const Matrix4 n{{{xx + yy + zz, yz - zy, zx - xz, xy - yx},
                   {yz - zy, xx - yy - zz, xy + yx, zx + xz},
                   {zx - xz, xy + yx, -xx + yy - zz, yz + zy},
                   {xy - yx, zx + xz, yz + zy, -xx - yy + zz}}};
  const auto q = FindLargestEigenvector(n);
  return math::Normalized(Quaternion{q[0], q[1], q[2], q[3]});
}

/// Root of a node in the forest that `parent` is; paths are halved on the way.
std::uint32_t FindRoot(std::span<std::uint32_t> parent, std::uint32_t node) noexcept {
  while (parent[node] != node) {
    parent[node] = parent[parent[node]];
    node = parent[node];
  }
  return node;
}

/// Joins two trees under the lower root, so that a root is its tree's lowest node.
void Join(std::span<std::uint32_t> parent, std::uint32_t a, std::uint32_t b) noexcept {
  a = FindRoot(parent, a), b = FindRoot(parent, b);
  parent[std::max(a, b)] = std::min(a, b);
}

}  // namespace

void MotionMoments::AddPoint(double w, const Vec3& rest, const Vec3& position) noexcept {
  if (!(w > 0.0)) return;
  if (weight == 0.0) rest_origin = rest, origin = position;
  const Vec3 r = rest - rest_origin, x = position - origin;
  weight += w;
  rest_sum += w * r;
  sum += w * x;
  AddOuter(outer, w, x, r);
}

void MotionMoments::AddOffset(double w, const Vec3& rest_offset, const Vec3& offset) noexcept {
  AddOuter(outer, w, offset, rest_offset);
}

math::Pose FitRigidMotion(const MotionMoments& moments, const Quaternion& previous) noexcept {
  if (!(moments.weight > 0.0)) return {previous, {}};
  const Vec3 rest_centre = moments.rest_sum / moments.weight, centre = moments.sum / moments.weight;
  Matrix3 m = moments.outer;
  AddOuter(m, -moments.weight, centre, rest_centre);
  double largest = 0;
  for (const double entry : m) largest = math::Max(largest, std::fabs(entry));
  const Matrix3 prior = ToMatrix(previous);
  // a lone point has no extent at all: any positive weight then makes the prior decide
  const double trace = largest > 0.0 ? kPriorShare * largest : 1.0;
  for (int i = 0; i < 9; ++i) m[i] += trace * prior[i];
  Quaternion rotation = FindRotation(m);
  const double same =
      rotation.w * previous.w + rotation.x * previous.x + rotation.y * previous.y + rotation.z * previous.z;
  if (same < 0.0) rotation = {-rotation.w, -rotation.x, -rotation.y, -rotation.z};
  return {rotation, moments.origin + centre - math::Rotate(rotation, moments.rest_origin + rest_centre)};
}

void FindFreeRegions(const TissueModel& model, std::span<const std::uint8_t> strand_is_intact,
                     std::span<const std::uint8_t> strand_binds, std::span<const double> spring_factor,
                     FreeRegions& regions) noexcept {
  const auto n = static_cast<std::uint32_t>(model.Size());
  TROCAR_ASSERT(regions.of_node.size() == n && strand_is_intact.size() == model.strand_count);
  TROCAR_ASSERT(strand_binds.empty() || strand_binds.size() == model.strand_count);
  TROCAR_ASSERT(spring_factor.empty() || spring_factor.size() == model.SpringCount());
  const std::span<std::uint32_t> parent = regions.of_node;
  for (std::uint32_t i = 0; i < n; ++i) parent[i] = i;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const auto& half = model.half_springs[h];
      if (spring_factor.empty() || spring_factor[half.spring] > 0.0) Join(parent, i, half.other);
    }
    for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
      const auto& strand = model.half_strands[h];
      const bool binds = strand_binds.empty() || strand_binds[strand.strand];
      if (binds && strand_is_intact[strand.strand]) Join(parent, i, strand.other);
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) parent[i] = FindRoot(parent, i);
  // a fixed node pins its whole piece: a mark in the root's own entry, to which no other node's entry leads
  // now
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t root = parent[i] & ~kPinnedMark;
    if (model.is_fixed[i]) parent[root] = root | kPinnedMark;
  }
  std::array<std::uint32_t, kMaxFreeRegions> roots{};
  regions.count = regions.beyond_count = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (parent[i] != i) continue;
    if (regions.count < kMaxFreeRegions) {
      roots[regions.count++] = i;
    } else {
      ++regions.beyond_count;
    }
  }
  const auto last = roots.begin() + regions.count;
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto found = std::lower_bound(roots.begin(), last, parent[i]);
    const bool is_free = found != last && *found == parent[i];
    regions.of_node[i] = is_free ? static_cast<std::uint32_t>(found - roots.begin()) : kPinnedRegion;
  }
}

}  // namespace trocar::tissue
