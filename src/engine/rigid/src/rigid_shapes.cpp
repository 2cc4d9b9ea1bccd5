// SPDX-License-Identifier: Apache-2.0
#include "rigid_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "trocar/math/elementary.h"

namespace trocar::rigid {

using math::Vec3;

namespace {

constexpr int kRingParts = 16;  // capsules that make a ring

}  // namespace

bool IsPositive(double value) {
  return value > 0 && std::isfinite(value);
}

bool HasSize(const RigidShape& shape) {
  const Vec3& s = shape.size;
  switch (shape.kind) {
    case RigidShape::Kind::kBox:
      return IsPositive(s.x) && IsPositive(s.y) && IsPositive(s.z);
    case RigidShape::Kind::kCylinder:
    case RigidShape::Kind::kCapsule:
      return IsPositive(s.x) && IsPositive(s.z);
    case RigidShape::Kind::kSphere:
      return IsPositive(s.x);
    case RigidShape::Kind::kRing:
      return IsPositive(s.y) && s.x > s.y && std::isfinite(s.x);
  }
  return false;
}

double HalfWidth(const RigidShape& shape) {
  const Vec3& s = shape.size;
  switch (shape.kind) {
    case RigidShape::Kind::kBox:
      return std::min({s.x, s.y, s.z});
    case RigidShape::Kind::kCylinder:
      return std::min(s.x, s.z);
    case RigidShape::Kind::kCapsule:
    case RigidShape::Kind::kSphere:
      return s.x;
    case RigidShape::Kind::kRing:
      return s.y;
  }
  return 0;
}

void MakeShapes(const RigidBody& definition, std::vector<std::unique_ptr<btCollisionShape>>& shapes) {
  auto whole = std::make_unique<btCompoundShape>();
  const auto add = [&](const math::Pose& X_body_shape, std::unique_ptr<btCollisionShape> shape) {
    shape->setMargin(kMargin);
    whole->addChildShape(ToBullet(X_body_shape), shape.get());
    shapes.push_back(std::move(shape));
  };
  const auto along_z = [](double radius, double half_length) {
    auto capsule = std::make_unique<btCapsuleShapeZ>(radius * kScale, 2 * half_length * kScale);
    return capsule;
  };
  for (const RigidShape& shape : definition.shapes) {
    const Vec3& s = shape.size;
    switch (shape.kind) {
      case RigidShape::Kind::kBox: {
        auto box = std::make_unique<btBoxShape>(ToBullet(s));
        box->initializePolyhedralFeatures();
        add(shape.X_body_shape, std::move(box));
        break;
      }
      case RigidShape::Kind::kCylinder:
        add(shape.X_body_shape, std::make_unique<btCylinderShapeZ>(ToBullet(Vec3{s.x, s.x, s.z})));
        break;
      case RigidShape::Kind::kCapsule: {
        auto capsule = along_z(s.x, s.z);
        whole->addChildShape(ToBullet(shape.X_body_shape), capsule.get());
        shapes.push_back(std::move(capsule));
        break;
      }
      case RigidShape::Kind::kSphere: {
        auto sphere = std::make_unique<btSphereShape>(s.x * kScale);
        whole->addChildShape(ToBullet(shape.X_body_shape), sphere.get());
        shapes.push_back(std::move(sphere));
        break;
      }
      case RigidShape::Kind::kRing:
        for (int part = 0; part < kRingParts; ++part) {
          const double angle = 2 * std::numbers::pi * part / kRingParts;
          const math::SineCosine at = math::SinCos(angle);
          const Vec3 out{at.cosine, at.sine, 0}, tangent{-at.sine, at.cosine, 0};
          const math::Pose X_ring_part{math::RotationBetween({0, 0, 1}, tangent), s.x * out};
          auto capsule = along_z(s.y, s.x * math::Tan(std::numbers::pi / kRingParts));
          whole->addChildShape(ToBullet(shape.X_body_shape * X_ring_part), capsule.get());
          shapes.push_back(std::move(capsule));
        }
        break;
    }
  }
  shapes.push_back(std::move(whole));
}

}  // namespace trocar::rigid
