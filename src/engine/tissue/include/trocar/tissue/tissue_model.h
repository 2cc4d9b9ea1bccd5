// SPDX-License-Identifier: Apache-2.0
/// \file tissue_model.h  One mass-spring system for every organ: what is constant, what a tick changes, what
/// it is loaded with.
/// Source: "General algorithms for laparoscopic surgical simulators", sections 3.2.1
/// to 3.2.3.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/tissue/element.h"

namespace trocar::base {
class StateArchive;
}

namespace trocar::tissue {

/// Stiffening, damage and failure of a spring beyond Hooke's law. Strains are eps = (|x_b - x_a| - l) / l. See spring_law.h.
struct SpringLaw {
  double stiffening = 0;           ///< beta: growth of the stiffness with strain [-], >= 0; 0 is Hooke's law
  double stiffening_strain = 0.2;  ///< eps_0: up to here Hooke's law holds [-], >= 0
  /// Strain at which the spring tears [-], > 0.
  double failure_strain = std::numeric_limits<double>::infinity();
  /// Damage a second under the tension at failure_strain [1/s], >= 0; one is a tear.
  double damage_rate = 0;
  double damage_exponent = 4;  ///< m: damage grows with tension to this power [-], >= 1

  friend bool operator==(const SpringLaw&, const SpringLaw&) = default;
};

/// Spring between two nodes, f_a = k (|x_b - x_a| - l) u_ab, or as its law says.
struct Spring {
  std::uint32_t a = 0, b = 0;
  double stiffness = 0;      ///< k [N/m], >= 0
  double rest_length = 0;    ///< l [m], >= 0
  std::uint32_t law = 0;     ///< index in TissueDefinition::laws
  std::uint32_t unused = 0;  ///< fills the struct, so that its bytes are its value
};

/// Strand that keeps the rest offset between two nodes, f_a = k ((x_b - x_a) - (rest_b - rest_a)). Strands
/// are a millimetre long: a Hookean spring of that length would turn freely and leave the organs to slide on
/// each other.
struct Strand {
  std::uint32_t a = 0, b = 0;
  double stiffness = 0;  ///< k [N/m], >= 0
};

/// The paper's three boundary conditions (section 3.2.2).
enum class NodeCondition : std::uint8_t {
  kFree,           ///< follows the balance of forces
  kExternalForce,  ///< free, and loaded by a tool
  kPrescribed      ///< position given: by anatomy, or by a grasper
};

/// Description of a system, checked once by MakeTissueModel.
struct TissueDefinition {
  std::vector<math::Vec3> rest;         ///< (n) [m]
  std::vector<double> mass;             ///< (n) [kg], >= 0
  std::vector<double> shape_stiffness;  ///< (n) k_virtual of the spring to the rest position [N/m], >= 0
  std::vector<std::uint32_t> fixed;     ///< nodes held at rest by anatomy
  std::vector<Spring> springs;          ///< structural
  std::vector<SpringLaw> laws{1};       ///< the first: Hooke's, and nothing tears
  std::vector<Strand> strands;          ///< attachments: can be dissected
};

/// Saves and restores the parts of a description that cutting changes: nodes' constants, which nodes are fixed, and springs.
/// Laws and strands stay those of the uncut description. MakeTissueModel makes the model again; the model holds nothing
/// else.
///
/// Restoring refuses numbers of which no model can be made.
/// \pre when restoring: `definition` is the uncut description, with its spare nodes
void VisitState(base::StateArchive& archive, TissueDefinition& definition);

/// Constant while running. Half-springs are stored with each of their two nodes, so that a node gathers its
/// force without writing to another: the result does not depend on the number of threads.
struct TissueModel {
  std::vector<math::Vec3> rest;         ///< (n) [m]
  std::vector<double> mass;             ///< (n) [kg]
  std::vector<double> shape_stiffness;  ///< (n) [N/m]
  std::vector<std::uint8_t> is_fixed;   ///< (n)

  struct HalfSpring {
    std::uint32_t other;
    std::uint32_t spring;  ///< index for TissueState::spring_factor
    double stiffness, rest_length;
  };
  std::vector<std::uint32_t> spring_starts;  ///< (n + 1)
  std::vector<HalfSpring> half_springs;      ///< (2 springs) by node, then by other node

  struct HalfStrand {
    std::uint32_t other;
    std::uint32_t strand;  ///< index for TissueState::strand_is_intact
    double stiffness;
  };
  std::vector<std::uint32_t> strand_starts;  ///< (n + 1)
  std::vector<HalfStrand> half_strands;
  std::size_t strand_count = 0;

  std::vector<SpringLaw> laws;
  std::vector<std::uint32_t> spring_law;  ///< (springs) index in `laws`

  std::size_t Size() const { return rest.size(); }
  std::size_t SpringCount() const { return spring_law.size(); }
};

/// \pre sizes agree, indices are in range, stiffness and masses are finite and >= 0 (TROCAR_ASSERT)
TissueModel MakeTissueModel(const TissueDefinition& definition);

/// State of the tissue: all that a tick changes.
struct TissueState {
  std::vector<math::Vec3> position;            ///< (n) [m]
  std::vector<NodeCondition> condition;        ///< (n)
  std::vector<std::uint8_t> strand_is_intact;  ///< (strands)
  /// (springs) on each spring's stiffness [-]: 1 intact, 0 cut or torn, between them weakened; >= 0. May change
  /// from solve to solve; nothing is rebuilt.
  std::vector<double> spring_factor;
  std::vector<double> spring_damage;  ///< (springs) gathered under load [-]: 1 tears
};

/// \pre when restoring: `state` is one of the model, as MakeRestState makes it
void VisitState(base::StateArchive& archive, TissueState& state);

/// At rest, nothing grasped, every strand and spring intact; fixed nodes prescribed.
TissueState MakeRestState(const TissueModel& model);

/// Most contacts that a solver has the capacity for.
inline constexpr std::size_t kMaxContacts = 1024;

/// One-sided spring between a tool and a point of a triangle: pushes while normal . x < offset. A kind of element
/// (link_elements.h has its functions).
struct ContactSpring {
  static constexpr std::string_view kName = "contacts";
  static constexpr std::size_t kNodes = 3, kCapacity = 256;  // in an array of elements
  static constexpr ElementInvariance kInvariance = ElementInvariance::kNone;
  static constexpr std::array<ElementBond, 3> kBonds = {{{0, 1}, {1, 2}, {2, 0}}};

  std::array<std::uint32_t, 3> nodes{};
  std::array<double, 3> weights{};  ///< barycentric
  math::Vec3 normal;                ///< direction in which tissue is pushed, unit
  double offset = 0;                ///< the tool's surface along the normal [m]
  double stiffness = 0;             ///< [N/m]
};

class ElementArrays;  // element_kinds.h

/// Load on the system in one solve, and the scales of its stiffness.
struct TissueLoad {
  /// Gravity now minus gravity in which the rest shape was imaged [m/s^2]: organs are photographed under
  /// their own weight, so only the difference moves them. For the paper's own experiments, the whole of
  /// gravity.
  math::Vec3 gravity;
  double stiffness_scale = 1;                  ///< on structural springs and strands [-]
  double shape_scale = 1;                      ///< on virtual springs [-]
  std::span<const ContactSpring> contacts;     ///< at most kMaxContacts
  std::span<const math::Vec3> external_force;  ///< (n) or empty [N]
  /// Elements beside the model's links: contacts between moving parts, threads, or null. They have to outlive the solve.
  const ElementArrays* elements = nullptr;
};

/// Force of every spring, strand, load and contact on each node: the residual of the balance (domain facts
/// 0b.4).
/// \param[out] residual  (n) [N]
/// \note Straightforward and slow: the reference for the solvers' own evaluation.
void CalcResidual(const TissueModel& model, const TissueState& state, const TissueLoad& load,
                  std::span<math::Vec3> residual);

/// Stored energy whose negative gradient is CalcResidual [J].
double CalcEnergy(const TissueModel& model, const TissueState& state, const TissueLoad& load);

/// Depth of a contact, offset - normal . x, positive when the tool presses [m].
double CalcContactDepth(const ContactSpring& contact, std::span<const math::Vec3> position) noexcept;

}  // namespace trocar::tissue
