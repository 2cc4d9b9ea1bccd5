// SPDX-License-Identifier: Apache-2.0
#include "rod_elements.h"

#include <cmath>
#include <cstddef>

#include "trocar/math/elementary.h"

namespace trocar::rod {

using math::Vec3;

namespace {

/// Rows of a 3 x 3 matrix.
struct Matrix3 {
  Vec3 row[3];
};
Matrix3 operator+(const Matrix3& a, const Matrix3& b) {
  return {{a.row[0] + b.row[0], a.row[1] + b.row[1], a.row[2] + b.row[2]}};
}
Matrix3 operator-(const Matrix3& a, const Matrix3& b) {
  return {{a.row[0] - b.row[0], a.row[1] - b.row[1], a.row[2] - b.row[2]}};
}
Matrix3 operator*(double s, const Matrix3& a) {
  return {{s * a.row[0], s * a.row[1], s * a.row[2]}};
}
Matrix3 Outer(const Vec3& u, const Vec3& v) {
  return {{u.x * v, u.y * v, u.z * v}};
}
Matrix3 Identity() {
  return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}
Matrix3 Transposed(const Matrix3& m) {
  return {{{m.row[0].x, m.row[1].x, m.row[2].x},
           {m.row[0].y, m.row[1].y, m.row[2].y},
           {m.row[0].z, m.row[1].z, m.row[2].z}}};
}
/// v x, as a matrix
Matrix3 CrossMatrix(const Vec3& v) {
  return {{{0, -v.z, v.y}, {v.z, 0, -v.x}, {-v.y, v.x, 0}}};
}
Matrix3 Product(const Matrix3& a, const Matrix3& b) {
  const Matrix3 columns = Transposed(b);
  Matrix3 product;
  for (int i = 0; i < 3; ++i) {
    product.row[i] = {math::Dot(a.row[i], columns.row[0]), math::Dot(a.row[i], columns.row[1]),
                      math::Dot(a.row[i], columns.row[2])};
  }
  return product;
}
Matrix3 Symmetrised(const Matrix3& m) {
  return 0.5 * (m + Transposed(m));
}

/// Second derivatives of a number by the two segments: (before, before), (behind, before), (behind, behind).
struct SegmentHessian {
  Matrix3 before, mixed, behind;
};

/// A joint that is folded flat has no finite energy; beyond half a degree from it the energy grows no more [-].
constexpr double kLeastChi = 4e-5;

/// Places in the joint's unknowns.
constexpr std::size_t kBefore = 0, kAngleBefore = 3, kMiddle = 4, kAngleBehind = 7, kBehind = 8;

void AddVector(const Vec3& v, std::size_t at, std::array<double, kElementUnknowns>& to) {
  for (int i = 0; i < 3; ++i) to[at + static_cast<std::size_t>(i)] += v[i];
}
void AddBlock(const Matrix3& m, std::size_t row, std::size_t column, ElementDerivatives& to) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (row + i >= column + j) to.stiffness[row + i][column + j] += m.row[i][static_cast<int>(j)];
    }
  }
}

/// A segment is the difference of its nodes.
void AddSegments(const Vec3& by_before, const Vec3& by_behind, std::array<double, kElementUnknowns>& to) {
  AddVector(-by_before, kBefore, to);
  AddVector(by_before - by_behind, kMiddle, to);
  AddVector(by_behind, kBehind, to);
}
void AddSegments(const SegmentHessian& h, ElementDerivatives& to) {
  AddBlock(h.before, kBefore, kBefore, to);
  AddBlock(h.mixed - h.before, kMiddle, kBefore, to);
  AddBlock(h.before - h.mixed - Transposed(h.mixed) + h.behind, kMiddle, kMiddle, to);
  AddBlock(-1.0 * h.mixed, kBehind, kBefore, to);
  AddBlock(h.mixed - h.behind, kBehind, kMiddle, to);
  AddBlock(h.behind, kBehind, kBehind, to);
}

}  // namespace

void AddJoint(const Joint& joint, bool has_stiffness, ElementDerivatives& sum) noexcept {
  const double l1 = math::Norm(joint.before), l2 = math::Norm(joint.behind);
  if (!(l1 > 0.0 && l2 > 0.0)) return;
  const Vec3 t1 = joint.before / l1, t2 = joint.behind / l2;
  const double cosine = math::Dot(t1, t2), chi = math::Max(1.0 + cosine, kLeastChi);
  // bending: 2 B (1 - c) / (1 + c), a function of the cosine alone; by the sine it is exact for small angles, too
  const Vec3 sine = math::Cross(t1, t2);
  const double slope = -4.0 * joint.bending / (chi * chi),
               curvature = 8.0 * joint.bending / (chi * chi * chi);
  sum.energy +=
      2.0 * joint.bending * (cosine > 0.0 ? math::SquaredNorm(sine) / (chi * chi) : (1.0 - cosine) / chi);
  const Vec3 p1 = (t2 - cosine * t1), p2 = (t1 - cosine * t2);
  const Vec3 c1 = p1 / l1, c2 = p2 / l2;  // of the cosine by the segments
  // twist: the reference frames' twist turns with the binormal
  const Vec3 binormal = 2.0 / chi * sine;
  const Vec3 m1 = binormal / (2.0 * l1), m2 = binormal / (2.0 * l2);
  const double moment = joint.twisting * joint.twist;
  sum.energy += 0.5 * moment * joint.twist;
  AddSegments(slope * c1 + moment * m1, slope * c2 + moment * m2, sum.gradient);
  sum.gradient[kAngleBefore] -= moment;
  sum.gradient[kAngleBehind] += moment;
  if (!has_stiffness) return;

  const Matrix3 across1 = Identity() - Outer(t1, t1), across2 = Identity() - Outer(t2, t2);
  const auto own = [&](const Vec3& t, const Vec3& p, const Matrix3& across, double length) {
    return -1.0 / (length * length) * (Outer(t, p) + Outer(p, t) + cosine * across);
  };
  SegmentHessian h;
  h.before = slope * own(t1, p1, across1, l1) + curvature * Outer(c1, c1);
  h.behind = slope * own(t2, p2, across2, l2) + curvature * Outer(c2, c2);
  h.mixed = slope / (l1 * l2) * Product(across2, across1) + curvature * Outer(c2, c1);
  // twist: the square of its first derivative, and its second
  const Vec3 mean = (t1 + t2) / chi;
  const auto own_twist = [&](const Vec3& t, double length) {
    return -1.0 / (2.0 * length * length) * Symmetrised(Outer(binormal, t + mean));
  };
  const Matrix3 before_behind = 1.0 / (2.0 * l1 * l2) * (2.0 / chi * CrossMatrix(t1) - Outer(binormal, mean));
  h.before = h.before + joint.twisting * Outer(m1, m1) + moment * own_twist(t1, l1);
  h.behind = h.behind + joint.twisting * Outer(m2, m2) + moment * own_twist(t2, l2);
  h.mixed = h.mixed + joint.twisting * Outer(m2, m1) + moment * Transposed(before_behind);
  AddSegments(h, sum);
  std::array<double, kElementUnknowns> by_nodes{};
  AddSegments(m1, m2, by_nodes);
  const auto add = [&](std::size_t row, std::size_t column, double value) {
    sum.stiffness[row][column] += joint.twisting * value;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    add(kAngleBefore, kBefore + i, -by_nodes[kBefore + i]);
    add(kMiddle + i, kAngleBefore, -by_nodes[kMiddle + i]);
    add(kBehind + i, kAngleBefore, -by_nodes[kBehind + i]);
    add(kAngleBehind, kBefore + i, by_nodes[kBefore + i]);
    add(kAngleBehind, kMiddle + i, by_nodes[kMiddle + i]);
    add(kBehind + i, kAngleBehind, by_nodes[kBehind + i]);
  }
  add(kAngleBefore, kAngleBefore, 1.0);
  add(kAngleBehind, kAngleBefore, -1.0);
  add(kAngleBehind, kAngleBehind, 1.0);
}

Vec3 Transport(const Vec3& vector, const Vec3& from, const Vec3& to) noexcept {
  const double chi = 1.0 + math::Dot(from, to);
  if (!(chi > 0.0)) return vector;
  // Rodrigues' turn about from x to, whose sine and cosine are at hand
  const Vec3 axis = math::Cross(from, to);
  return vector + math::Cross(axis, vector) + math::Cross(axis, math::Cross(axis, vector)) / chi;
}

double CalcSignedAngle(const Vec3& u, const Vec3& v, const Vec3& axis) noexcept {
  return math::Atan2(math::Dot(axis, math::Cross(u, v)), math::Dot(u, v));
}

Vec3 Turn(const Vec3& vector, const Vec3& axis, double angle) noexcept {
  const auto [sine, cosine] = math::SinCos(angle);
  return cosine * vector + sine * math::Cross(axis, vector);
}

}  // namespace trocar::rod
