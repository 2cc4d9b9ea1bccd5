// SPDX-License-Identifier: Apache-2.0
/// \file element_examples.h  One element of each kind that acts, drawn by chance: what the tests of all kinds run on.
///
/// A kind without an example does not compile in element_kinds_test.cpp.
#pragma once

#include "trocar/math/random.h"
#include "trocar/tissue/element_kinds.h"

namespace trocar::tissue {

/// An element on the nodes 0, 1, 2 and so on, and where they are.
template <typename Kind>
struct ElementExample {
  Kind element;
  ElementVectors<Kind::kNodes> position;
};

inline math::Vec3 DrawVector(math::Random& random, double size) {
  return {random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
}
/// Corners of a triangle of about a centimetre, counterclockwise as seen from +z.
inline std::array<math::Vec3, 3> DrawTriangle(math::Random& random) {
  std::array<math::Vec3, 3> corners = {math::Vec3{0, 0, 0}, {0.01, 0, 0}, {0.003, 0.009, 0}};
  for (math::Vec3& corner : corners) corner += DrawVector(random, 0.001);
  return corners;
}
inline std::array<double, 3> DrawWeights(math::Random& random) {
  const double a = random.Uniform(0.1, 0.5), b = random.Uniform(0.1, 0.4);
  return {a, b, 1.0 - a - b};
}

template <typename Kind>
ElementExample<Kind> MakeExample(math::Random& random);

template <>
inline ElementExample<SpringElement> MakeExample(math::Random& random) {
  SpringElement spring{.nodes = {0, 1}, .stiffness = random.Uniform(50, 200), .rest_length = 0.01, .law = {}};
  spring.law.stiffening = 2.0;
  // compressed, stretched, and beyond the strain from which it stiffens
  const math::Vec3 along = random.Uniform(0.006, 0.015) * math::Normalized(DrawVector(random, 1));
  const math::Vec3 from = DrawVector(random, 0.05);
  return {spring, {from, from + along}};
}

template <>
inline ElementExample<StrandElement> MakeExample(math::Random& random) {
  const StrandElement strand{
      .nodes = {0, 1}, .stiffness = random.Uniform(50, 200), .rest_offset = DrawVector(random, 0.002)};
  const math::Vec3 from = DrawVector(random, 0.05);
  return {strand, {from, from + DrawVector(random, 0.004)}};
}

template <>
inline ElementExample<AnchorElement> MakeExample(math::Random& random) {
  const AnchorElement anchor{
      .nodes = {0}, .stiffness = random.Uniform(50, 200), .anchor = DrawVector(random, 0.05)};
  return {anchor, {anchor.anchor + DrawVector(random, 0.003)}};
}

template <>
inline ElementExample<ContactSpring> MakeExample(math::Random& random) {
  ElementExample<ContactSpring> made;
  made.position = DrawTriangle(random);
  made.element = {.nodes = {0, 1, 2},
                  .weights = DrawWeights(random),
                  .normal = math::Normalized(DrawVector(random, 1)),
                  .offset = random.Uniform(1e-4, 1e-3),
                  .stiffness = random.Uniform(100, 400)};
  for (std::size_t i = 0; i < 3; ++i)
    made.element.offset += made.element.weights[i] * math::Dot(made.element.normal, made.position[i]);
  return made;
}

template <>
inline ElementExample<SurfaceContact> MakeExample(math::Random& random) {
  const std::array<math::Vec3, 3> corners = DrawTriangle(random);
  const std::array<double, 3> weights = DrawWeights(random);
  const math::Vec3 foot = weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
  const SurfaceContact contact{.nodes = {0, 1, 2, 3}, .stiffness = random.Uniform(100, 400), .gap = 0.001};
  return {contact,
          {foot + math::Vec3{0, 0, random.Uniform(-0.001, 0.0005)}, corners[0], corners[1], corners[2]}};
}

template <>
inline ElementExample<SlidingConstraint> MakeExample(math::Random& random) {
  const std::array<math::Vec3, 3> corners = DrawTriangle(random);
  const std::array<double, 3> weights = DrawWeights(random);
  const math::Vec3 puncture = weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
  const SlidingConstraint slide{
      .nodes = {0, 1, 2, 3, 4}, .weights = weights, .stiffness = random.Uniform(100, 400)};
  const math::Vec3 aside = DrawVector(random, 0.0007);
  // within the segment, or beyond one of its ends
  const double shift = random.Uniform(-0.008, 0.008);
  return {slide,
          {corners[0], corners[1], corners[2], puncture + aside + math::Vec3{0.001, 0, shift - 0.005},
           puncture + aside + math::Vec3{-0.001, 0.0005, shift + 0.005}}};
}

}  // namespace trocar::tissue
