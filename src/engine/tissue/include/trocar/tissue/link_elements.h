// SPDX-License-Identifier: Apache-2.0
/// \file link_elements.h  The model's own links as kinds of elements: springs, strands, virtual springs, contacts of tools.
///
/// A model has thousands of them, and a tick as many contacts: kernels evaluate those (kernel_balance.h, linearisation.cpp), and
/// tests hold the kernels against the functions here. In an array of elements stand the few that come and go without a change of
/// topology.
#pragma once

#include "trocar/tissue/element.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// Spring between two nodes, by its own law.
struct SpringElement {
  static constexpr std::string_view kName = "springs";
  static constexpr std::size_t kNodes = 2, kCapacity = 256;
  static constexpr ElementInvariance kInvariance = ElementInvariance::kMotions;
  static constexpr std::array<ElementBond, 0> kBonds{};

  std::array<std::uint32_t, kNodes> nodes{};
  double stiffness = 0;    ///< k [N/m], >= 0
  double rest_length = 0;  ///< l [m], >= 0
  SpringLaw law;           ///< failure is not the element's: TearSprings
};

/// Strand: keeps the offset between two nodes.
struct StrandElement {
  static constexpr std::string_view kName = "strands";
  static constexpr std::size_t kNodes = 2, kCapacity = 256;
  static constexpr ElementInvariance kInvariance = ElementInvariance::kShifts;
  static constexpr std::array<ElementBond, 0> kBonds{};

  std::array<std::uint32_t, kNodes> nodes{};
  double stiffness = 0;    ///< k [N/m], >= 0
  math::Vec3 rest_offset;  ///< from the first to the second [m]
};

/// Virtual spring from a node to a point of space.
struct AnchorElement {
  static constexpr std::string_view kName = "anchors";
  static constexpr std::size_t kNodes = 1, kCapacity = 256;
  static constexpr ElementInvariance kInvariance = ElementInvariance::kNone;
  static constexpr std::array<ElementBond, 0> kBonds{};

  std::array<std::uint32_t, kNodes> nodes{};
  double stiffness = 0;  ///< k [N/m], >= 0
  math::Vec3 anchor;     ///< [m], world frame
};

double CalcElementEnergy(const SpringElement& element, const ElementVectors<2>& position) noexcept;
ElementVectors<2> CalcElementForce(const SpringElement& element, const ElementVectors<2>& position) noexcept;
void AddElementStiffness(const SpringElement& element, const ElementVectors<2>& position, StiffnessPart part,
                         ElementStiffness<2>& stiffness) noexcept;
bool IsElementUsable(const SpringElement& element) noexcept;
void VisitState(base::StateArchive& archive, SpringElement& element);

double CalcElementEnergy(const StrandElement& element, const ElementVectors<2>& position) noexcept;
ElementVectors<2> CalcElementForce(const StrandElement& element, const ElementVectors<2>& position) noexcept;
void AddElementStiffness(const StrandElement& element, const ElementVectors<2>& position, StiffnessPart part,
                         ElementStiffness<2>& stiffness) noexcept;
bool IsElementUsable(const StrandElement& element) noexcept;
void VisitState(base::StateArchive& archive, StrandElement& element);

double CalcElementEnergy(const AnchorElement& element, const ElementVectors<1>& position) noexcept;
ElementVectors<1> CalcElementForce(const AnchorElement& element, const ElementVectors<1>& position) noexcept;
void AddElementStiffness(const AnchorElement& element, const ElementVectors<1>& position, StiffnessPart part,
                         ElementStiffness<1>& stiffness) noexcept;
bool IsElementUsable(const AnchorElement& element) noexcept;
void VisitState(base::StateArchive& archive, AnchorElement& element);

double CalcElementEnergy(const ContactSpring& element, const ElementVectors<3>& position) noexcept;
ElementVectors<3> CalcElementForce(const ContactSpring& element, const ElementVectors<3>& position) noexcept;
void AddElementStiffness(const ContactSpring& element, const ElementVectors<3>& position, StiffnessPart part,
                         ElementStiffness<3>& stiffness) noexcept;
bool IsElementUsable(const ContactSpring& element) noexcept;
void VisitState(base::StateArchive& archive, ContactSpring& element);

}  // namespace trocar::tissue
