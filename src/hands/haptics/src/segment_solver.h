// SPDX-License-Identifier: Apache-2.0
/// \file segment_solver.h  Equilibrium of a cut-out segment with the tool that presses it, by block Gauss-Seidel: every
/// node in turn, and the tool, takes the Newton step of its own three coordinates.
#pragma once

#include <array>

#include "link_stiffness.h"
#include "trocar/tissue/local_patch.h"

namespace trocar::haptics {

/// Nodes move, the tool's point y moves, the hand and the rim stand. Derivatives by the hand follow in the same
/// sweeps: each block is differentiated as it is solved.
class SegmentSolver {
 public:
  /// Starts from the patch with the tool at `p_world_tool`.
  void Load(const tissue::LocalPatch& patch, const math::Vec3& p_world_tool) noexcept;
  /// Turns what the tool carries: contacts' levers and held nodes.
  void SetDirection(const math::Quaternion& hand) noexcept;
  /// One sweep over the nodes, outwards or inwards, and then the tool. The first of a tick renews the blocks of
  /// nodes that nothing presses; the others use them again.
  void Sweep(const math::Vec3& p_world_hand, double coupling_stiffness, bool is_outwards,
             bool is_first) noexcept;
  /// One sweep over the derivatives, with the blocks of the tick; positions stay.
  void SweepDerivative(double coupling_stiffness) noexcept;

  const math::Vec3& GetTool() const noexcept { return tool_; }
  /// d(tool) / d(hand)
  const Matrix3& GetToolDerivative() const noexcept { return tool_derivative_; }

 private:
  struct NodeContact {
    std::uint16_t contact;
    std::uint8_t corner;
  };

  bool IsHeld(std::size_t node) const noexcept {
    return node >= patch_.free_count && node < patch_.free_count + patch_.held_count;
  }
  double CalcDepth(const tissue::LocalPatch::Contact& contact, double turned) const noexcept;
  math::Vec3 CalcLinkForce(std::size_t node) const noexcept;
  math::Vec3 AddLinkForce(std::size_t node, Matrix3& block) const noexcept;
  bool IsPressed(std::size_t node) const noexcept {
    return contact_starts_[node] < contact_starts_[node + 1];
  }
  void RelaxPressed(std::size_t node) noexcept;
  void RelaxUnpressed(std::size_t node, bool renews) noexcept;
  void RelaxTool(const math::Vec3& p_world_hand, double coupling_stiffness) noexcept;
  void MoveHeld() noexcept;
  Matrix3 PullByLinks(std::size_t node, Matrix3& block) const noexcept;
  void DifferentiateNode(std::size_t node) noexcept;
  void DifferentiateTool(double coupling_stiffness) noexcept;

  tissue::LocalPatch patch_;
  math::Quaternion turn_;  // from the cut's tool to the hand's
  math::Vec3 tool_;        // [m]
  Matrix3 tool_derivative_ = Matrix3::Identity();
  std::array<math::Vec3, tissue::LocalPatch::kMaxNodes> position_;      // [m]
  std::array<math::Vec3, tissue::LocalPatch::kMaxNodes> force_at_cut_;  // of the links, free and held [N]
  std::array<Matrix3, tissue::LocalPatch::kMaxNodes> derivative_;       // d(node) / d(hand)
  std::array<Matrix3, tissue::LocalPatch::kMaxNodes>
      inverse_;  // of the blocks of nodes that nothing presses [m/N]
  std::array<double, tissue::LocalPatch::kMaxContacts> turned_;  // depth that the hand's turning adds [m]
  std::array<std::uint16_t, tissue::LocalPatch::kMaxNodes + 1> contact_starts_;
  std::array<NodeContact, 3 * tissue::LocalPatch::kMaxContacts> node_contacts_;
};

}  // namespace trocar::haptics
