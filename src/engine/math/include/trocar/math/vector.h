// SPDX-License-Identifier: Apache-2.0
/// \file vector.h  Vectors of three and two doubles.
#pragma once

#include <cmath>

namespace trocar::math {

/// Point, direction or force; unit and frame stand at its use.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  double& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  double operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  Vec3& operator+=(const Vec3& b) {
    x += b.x, y += b.y, z += b.z;
    return *this;
  }
  Vec3& operator-=(const Vec3& b) {
    x -= b.x, y -= b.y, z -= b.z;
    return *this;
  }
  Vec3& operator*=(double s) {
    x *= s, y *= s, z *= s;
    return *this;
  }
  friend Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
  friend Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(Vec3 a, double s) { return a *= s; }
  friend Vec3 operator*(double s, Vec3 a) { return a *= s; }
  friend Vec3 operator/(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

/// Point in a picture [pixels]: x = column, y = row; pixel centres at whole numbers.
struct Vec2 {
  double x = 0, y = 0;

  friend Vec2 operator+(const Vec2& a, const Vec2& b) { return {a.x + b.x, a.y + b.y}; }
  friend Vec2 operator-(const Vec2& a, const Vec2& b) { return {a.x - b.x, a.y - b.y}; }
  friend Vec2 operator*(double s, const Vec2& a) { return {s * a.x, s * a.y}; }
  friend bool operator==(const Vec2&, const Vec2&) = default;
};

inline double Dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double Dot(const Vec2& a, const Vec2& b) {
  return a.x * b.x + a.y * b.y;
}
inline Vec3 Cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double SquaredNorm(const Vec3& a) {
  return Dot(a, a);
}
inline double Norm(const Vec3& a) {
  return std::sqrt(Dot(a, a));
}
inline double Norm(const Vec2& a) {
  return std::sqrt(Dot(a, a));
}
inline double Distance(const Vec3& a, const Vec3& b) {
  return Norm(a - b);
}
inline double SquaredDistance(const Vec3& a, const Vec3& b) {
  return SquaredNorm(a - b);
}

/// a / |a|, or `fallback` where |a| is zero.
inline Vec3 Normalized(const Vec3& a, const Vec3& fallback = {0, 0, 1}) {
  const double norm = Norm(a);
  return norm > 0.0 ? a / norm : fallback;
}

/// The smaller number, not NaN where one of them is none. Of equal ones, zeros of both signs too, the first: std::fmin may give
/// either zero.
inline double Min(double a, double b) {
  return b < a || a != a ? b : a;
}
/// The larger number, as Min.
inline double Max(double a, double b) {
  return b > a || a != a ? b : a;
}
inline Vec3 Min(const Vec3& a, const Vec3& b) {
  return {Min(a.x, b.x), Min(a.y, b.y), Min(a.z, b.z)};
}
inline Vec3 Max(const Vec3& a, const Vec3& b) {
  return {Max(a.x, b.x), Max(a.y, b.y), Max(a.z, b.z)};
}
inline double Lerp(double a, double b, double t) {
  return a + t * (b - a);
}
inline Vec3 Lerp(const Vec3& a, const Vec3& b, double t) {
  return a + t * (b - a);
}
inline bool IsFinite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Any unit vector perpendicular to the unit vector `a`.
inline Vec3 AnyPerpendicular(const Vec3& a) {
  return Normalized(std::fabs(a.x) < 0.6 ? Cross(a, {1, 0, 0}) : Cross(a, {0, 1, 0}));
}

}  // namespace trocar::math
