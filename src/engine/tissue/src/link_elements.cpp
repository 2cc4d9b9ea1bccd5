// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/link_elements.h"

#include <cmath>

#include "trocar/math/state_fields.h"
#include "trocar/tissue/spring_law.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

bool IsMagnitude(double value) noexcept {
  return std::isfinite(value) && value >= 0.0;
}

/// k [I -I; -I I]
void AddBetween(double stiffness, ElementStiffness<2>& to) noexcept {
  AddIdentity(to.At(0, 0), stiffness), AddIdentity(to.At(1, 1), stiffness);
  AddIdentity(to.At(0, 1), -stiffness);
}

}  // namespace

// --- springs

double CalcElementEnergy(const SpringElement& element, const ElementVectors<2>& position) noexcept {
  return CalcSpringEnergy(element.law, element.stiffness, element.rest_length,
                          math::Distance(position[0], position[1]));
}

ElementVectors<2> CalcElementForce(const SpringElement& element, const ElementVectors<2>& position) noexcept {
  const Vec3 along = position[1] - position[0];
  const double length = math::Norm(along);
  if (!(length > 0.0)) return {};  // it has no direction
  const double tension = CalcSpringTension(element.law, element.stiffness, element.rest_length, length);
  const Vec3 pull = (tension / length) * along;
  return {pull, -pull};
}

void AddElementStiffness(const SpringElement& element, const ElementVectors<2>& position, StiffnessPart part,
                         ElementStiffness<2>& stiffness) noexcept {
  const Vec3 along = position[1] - position[0];
  const double length = math::Norm(along);
  const double tangent =
      CalcSpringStiffness(element.law, element.stiffness, element.rest_length, math::Max(length, 0.0));
  // whatever its direction
  if (part == StiffnessPart::kBound || !(length > 0.0)) return AddBetween(tangent, stiffness);
  double across = CalcSpringTension(element.law, element.stiffness, element.rest_length, length) / length;
  if (part == StiffnessPart::kFirm) across = math::Max(across, 0.0);
  AddBetween(across, stiffness);
  const Vec3 u = along / length;
  AddOuterProduct(stiffness.At(0, 0), u, u, tangent - across);
  AddOuterProduct(stiffness.At(1, 1), u, u, tangent - across);
  AddOuterProduct(stiffness.At(0, 1), u, u, across - tangent);
}

bool IsElementUsable(const SpringElement& element) noexcept {
  return IsMagnitude(element.stiffness) && IsMagnitude(element.rest_length) &&
         IsMagnitude(element.law.stiffening) && IsMagnitude(element.law.stiffening_strain);
}

void VisitState(base::StateArchive& archive, SpringElement& element) {
  archive.Field("nodes", element.nodes);
  archive.Field("stiffness", element.stiffness);
  archive.Field("rest_length", element.rest_length);
  archive.Field("stiffening", element.law.stiffening);
  archive.Field("stiffening_strain", element.law.stiffening_strain);
  archive.Field("failure_strain", element.law.failure_strain);
  archive.Field("damage_rate", element.law.damage_rate);
  archive.Field("damage_exponent", element.law.damage_exponent);
}

// --- strands

double CalcElementEnergy(const StrandElement& element, const ElementVectors<2>& position) noexcept {
  return 0.5 * element.stiffness * math::SquaredNorm((position[1] - position[0]) - element.rest_offset);
}

ElementVectors<2> CalcElementForce(const StrandElement& element, const ElementVectors<2>& position) noexcept {
  const Vec3 pull = element.stiffness * ((position[1] - position[0]) - element.rest_offset);
  return {pull, -pull};
}

void AddElementStiffness(const StrandElement& element, const ElementVectors<2>& /*position*/,
                         StiffnessPart /*part*/, ElementStiffness<2>& stiffness) noexcept {
  AddBetween(element.stiffness, stiffness);
}

bool IsElementUsable(const StrandElement& element) noexcept {
  return IsMagnitude(element.stiffness) && math::IsFinite(element.rest_offset);
}

void VisitState(base::StateArchive& archive, StrandElement& element) {
  archive.Field("nodes", element.nodes);
  archive.Field("stiffness", element.stiffness);
  archive.Field("rest_offset", element.rest_offset);
}

// --- anchors

double CalcElementEnergy(const AnchorElement& element, const ElementVectors<1>& position) noexcept {
  return 0.5 * element.stiffness * math::SquaredDistance(position[0], element.anchor);
}

ElementVectors<1> CalcElementForce(const AnchorElement& element, const ElementVectors<1>& position) noexcept {
  return {element.stiffness * (element.anchor - position[0])};
}

void AddElementStiffness(const AnchorElement& element, const ElementVectors<1>& /*position*/,
                         StiffnessPart /*part*/, ElementStiffness<1>& stiffness) noexcept {
  AddIdentity(stiffness.At(0, 0), element.stiffness);
}

bool IsElementUsable(const AnchorElement& element) noexcept {
  return IsMagnitude(element.stiffness) && math::IsFinite(element.anchor);
}

void VisitState(base::StateArchive& archive, AnchorElement& element) {
  archive.Field("nodes", element.nodes);
  archive.Field("stiffness", element.stiffness);
  archive.Field("anchor", element.anchor);
}

// --- contacts of tools

namespace {

double CalcDepth(const ContactSpring& element, const ElementVectors<3>& position) noexcept {
  double depth = element.offset;
  for (std::size_t i = 0; i < 3; ++i) depth -= element.weights[i] * math::Dot(element.normal, position[i]);
  return depth;
}

}  // namespace

double CalcElementEnergy(const ContactSpring& element, const ElementVectors<3>& position) noexcept {
  const double depth = math::Max(0.0, CalcDepth(element, position));
  return 0.5 * element.stiffness * depth * depth;
}

ElementVectors<3> CalcElementForce(const ContactSpring& element, const ElementVectors<3>& position) noexcept {
  const double depth = CalcDepth(element, position);
  ElementVectors<3> force;
  if (!(depth > 0.0)) return force;
  for (std::size_t i = 0; i < 3; ++i)
    force[i] = (element.weights[i] * element.stiffness * depth) * element.normal;
  return force;
}

void AddElementStiffness(const ContactSpring& element, const ElementVectors<3>& position, StiffnessPart part,
                         ElementStiffness<3>& stiffness) noexcept {
  if (part != StiffnessPart::kBound && !(CalcDepth(element, position) > 0.0)) return;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      AddOuterProduct(stiffness.At(i, j), element.normal, element.normal,
                      element.weights[i] * element.weights[j] * element.stiffness);
    }
  }
}

bool IsElementUsable(const ContactSpring& element) noexcept {
  return IsMagnitude(element.stiffness) && math::IsFinite(element.normal) && std::isfinite(element.offset) &&
         std::isfinite(element.weights[0]) && std::isfinite(element.weights[1]) &&
         std::isfinite(element.weights[2]);
}

void VisitState(base::StateArchive& archive, ContactSpring& element) {
  archive.Field("nodes", element.nodes);
  archive.Field("weights", element.weights);
  archive.Field("normal", element.normal);
  archive.Field("offset", element.offset);
  archive.Field("stiffness", element.stiffness);
}

}  // namespace trocar::tissue
