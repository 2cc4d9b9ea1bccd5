// SPDX-License-Identifier: Apache-2.0
#include "segment_solver.h"

#include <algorithm>

namespace trocar::haptics {
namespace {

/// A contact this close to closing counts in the block, so that a step into it does not overshoot [m].
constexpr double kNearlyTouching = 0.0002;
/// Added to each block so that a node that nothing holds in one direction keeps its place there [N/m].
constexpr double kLeastStiffness = 1e-3;
/// A block that is older than the sweep serves for steps up to this [m]: a flat sheet is soft across until it is
/// stretched, and a long step with the soft block would overshoot.
constexpr double kStepOfOldBlock = 0.0001;

math::Vec3 Solve(const Matrix3& block, const math::Vec3& force) noexcept {
  return FromEigen(block.inverse() * ToEigen(force));
}

/// u v^T m
Matrix3 Project(const math::Vec3& u, const math::Vec3& v, const Matrix3& m) noexcept {
  return ToEigen(u) * (ToEigen(v).transpose() * m);
}

}  // namespace

void SegmentSolver::Load(const tissue::LocalPatch& patch, const math::Vec3& p_world_tool) noexcept {
  patch_ = patch;
  turn_ = {};
  tool_ = p_world_tool;
  tool_derivative_ = Matrix3::Identity();
  for (std::size_t i = 0; i < patch_.node_count; ++i) {
    position_[i] = patch_.position[i];
    derivative_[i] = IsHeld(i) ? Matrix3(Matrix3::Identity()) : Matrix3(Matrix3::Zero());
  }
  for (std::size_t i = 0; i < patch_.free_count + patch_.held_count; ++i) force_at_cut_[i] = CalcLinkForce(i);
  turned_.fill(0.0);
  // contacts by node: count, sum, fill
  contact_starts_.fill(0);
  const auto for_each_corner = [this](auto&& visit) {
    for (std::uint32_t c = 0; c < patch_.contact_count; ++c) {
      for (int i = 0; i < 3; ++i) {
        if (patch_.contacts[c].nodes[i] < patch_.free_count) visit(c, i, patch_.contacts[c].nodes[i]);
      }
    }
  };
  for_each_corner([this](std::uint32_t, int, std::size_t node) { ++contact_starts_[node + 1]; });
  for (std::size_t i = 0; i < patch_.free_count; ++i) {
    contact_starts_[i + 1] = static_cast<std::uint16_t>(contact_starts_[i + 1] + contact_starts_[i]);
  }
  std::array<std::uint16_t, tissue::LocalPatch::kMaxNodes + 1> next = contact_starts_;
  for_each_corner([&](std::uint32_t c, int i, std::size_t node) {
    node_contacts_[next[node]++] = {static_cast<std::uint16_t>(c), static_cast<std::uint8_t>(i)};
  });
  MoveHeld();
}

void SegmentSolver::SetDirection(const math::Quaternion& hand) noexcept {
  turn_ = hand * math::Inverse(patch_.X_world_tool.rotation);
  for (std::uint32_t c = 0; c < patch_.contact_count; ++c) {
    const tissue::LocalPatch::Contact& contact = patch_.contacts[c];
    // in a trocar the shaft turns with the tip, which tip_normal takes in
    turned_[c] = patch_.has_pivot
                     ? 0.0
                     : math::Dot(contact.normal, math::Rotate(turn_, contact.lever) - contact.lever);
  }
  MoveHeld();
}

void SegmentSolver::MoveHeld() noexcept {
  for (std::size_t i = patch_.free_count; i < patch_.free_count + patch_.held_count; ++i)
    position_[i] = tool_ + math::Rotate(turn_, patch_.position[i] - patch_.X_world_tool.translation);
}

double SegmentSolver::CalcDepth(const tissue::LocalPatch::Contact& contact, double turned) const noexcept {
  math::Vec3 given_way;
  for (int i = 0; i < 3; ++i) {
    const std::uint16_t node = contact.nodes[i];
    given_way += contact.weights[i] * (position_[node] - patch_.position[node]);
  }
  return contact.depth + turned + math::Dot(contact.tip_normal, tool_ - patch_.X_world_tool.translation) -
         math::Dot(contact.normal, given_way);
}

/// Springs and strands on a node, strands from their offset at the cut; `block` takes their stiffness.
math::Vec3 SegmentSolver::AddLinkForce(std::size_t node, Matrix3& block) const noexcept {
  const math::Vec3 here = position_[node];
  math::Vec3 force;
  for (std::size_t l = patch_.link_starts[node]; l < patch_.link_starts[node + 1]; ++l) {
    const tissue::LocalPatch::Link& link = patch_.links[l];
    if (IsHeld(node) && IsHeld(link.other)) continue;  // both move with the jaws
    const math::Vec3 along = position_[link.other] - here;
    if (link.is_strand) {
      force += link.stiffness * (along - (patch_.position[link.other] - patch_.position[node]));
      AddIsotropic(block, link.stiffness);
      continue;
    }
    const double length = math::Norm(along);
    const tissue::LinkStiffness stiffness =
        tissue::CalcLinkStiffness(along, length, link.stiffness, link.rest_length);
    force += (link.stiffness * (length - link.rest_length)) * stiffness.direction;
    AddLink(block, stiffness);
  }
  return force;
}

/// The same force alone.
math::Vec3 SegmentSolver::CalcLinkForce(std::size_t node) const noexcept {
  const math::Vec3 here = position_[node];
  math::Vec3 force;
  for (std::size_t l = patch_.link_starts[node]; l < patch_.link_starts[node + 1]; ++l) {
    const tissue::LocalPatch::Link& link = patch_.links[l];
    if (IsHeld(node) && IsHeld(link.other)) continue;
    const math::Vec3 along = position_[link.other] - here;
    if (link.is_strand) {
      force += link.stiffness * (along - (patch_.position[link.other] - patch_.position[node]));
      continue;
    }
    const double length = math::Norm(along);
    if (length > 0.0) force += (link.stiffness * (1.0 - link.rest_length / length)) * along;
  }
  return force;
}

void SegmentSolver::RelaxUnpressed(std::size_t node, bool renews) noexcept {
  const math::Vec3 others =
      patch_.own_stiffness[node] * (patch_.position[node] - position_[node]) - force_at_cut_[node];
  if (!renews) {
    const math::Vec3 step = FromEigen(inverse_[node] * ToEigen(others + CalcLinkForce(node)));
    if (math::SquaredNorm(step) < kStepOfOldBlock * kStepOfOldBlock) {
      position_[node] += step;
      return;
    }
  }
  Matrix3 block = Matrix3::Zero();
  AddIsotropic(block, patch_.own_stiffness[node] + kLeastStiffness);
  const math::Vec3 force = others + AddLinkForce(node, block);
  inverse_[node] = block.inverse();
  position_[node] += FromEigen(inverse_[node] * ToEigen(force));
}

void SegmentSolver::RelaxPressed(std::size_t node) noexcept {
  Matrix3 block = Matrix3::Zero();
  AddIsotropic(block, patch_.own_stiffness[node] + kLeastStiffness);
  // what acts beside links and contacts is what balanced them at the cut
  math::Vec3 force = AddLinkForce(node, block) - force_at_cut_[node] +
                     patch_.own_stiffness[node] * (patch_.position[node] - position_[node]);
  for (std::size_t k = contact_starts_[node]; k < contact_starts_[node + 1]; ++k) {
    const tissue::LocalPatch::Contact& contact = patch_.contacts[node_contacts_[k].contact];
    const double weight = contact.weights[node_contacts_[k].corner];
    const double depth = CalcDepth(contact, turned_[node_contacts_[k].contact]);
    const double change = std::max(depth, 0.0) - std::max(contact.depth, 0.0);
    force += (weight * contact.stiffness * change) * contact.normal;
    if (depth > -kNearlyTouching) AddAxial(block, contact.normal, weight * weight * contact.stiffness);
  }
  position_[node] += Solve(block, force);
}

void SegmentSolver::RelaxTool(const math::Vec3& p_world_hand, double coupling_stiffness) noexcept {
  Matrix3 block = Matrix3::Zero();
  AddIsotropic(block, coupling_stiffness);
  math::Vec3 force = patch_.force + coupling_stiffness * (p_world_hand - tool_);
  for (std::uint32_t c = 0; c < patch_.contact_count; ++c) {
    const tissue::LocalPatch::Contact& contact = patch_.contacts[c];
    const double depth = CalcDepth(contact, turned_[c]);
    const double change = std::max(depth, 0.0) - std::max(contact.depth, 0.0);
    force -= (contact.stiffness * change) * contact.tip_normal;
    if (depth > -kNearlyTouching) AddAxial(block, contact.tip_normal, contact.stiffness);
  }
  for (std::size_t i = patch_.free_count; i < patch_.free_count + patch_.held_count; ++i)
    force += AddLinkForce(i, block) - force_at_cut_[i];
  tool_ += Solve(block, force);
  MoveHeld();
}

void SegmentSolver::Sweep(const math::Vec3& p_world_hand, double coupling_stiffness, bool is_outwards,
                          bool is_first) noexcept {
  for (std::size_t i = 0; i < patch_.free_count; ++i) {
    const std::size_t node = is_outwards ? i : patch_.free_count - 1 - i;
    if (IsPressed(node)) {
      RelaxPressed(node);
    } else {
      RelaxUnpressed(node, is_first);
    }
  }
  RelaxTool(p_world_hand, coupling_stiffness);
}

/// What the neighbours of a node move it by, times its block; `block` takes the links' stiffness.
Matrix3 SegmentSolver::PullByLinks(std::size_t node, Matrix3& block) const noexcept {
  Matrix3 pull = Matrix3::Zero();
  for (std::size_t l = patch_.link_starts[node]; l < patch_.link_starts[node + 1]; ++l) {
    const tissue::LocalPatch::Link& link = patch_.links[l];
    if (IsHeld(node) && IsHeld(link.other)) continue;
    const Matrix3& other = derivative_[link.other];
    if (link.is_strand) {
      AddIsotropic(block, link.stiffness);
      pull += link.stiffness * other;
      continue;
    }
    const math::Vec3 along = position_[link.other] - position_[node];
    const tissue::LinkStiffness stiffness =
        tissue::CalcLinkStiffness(along, math::Norm(along), link.stiffness, link.rest_length);
    AddLink(block, stiffness);
    pull += stiffness.isotropic * other +
            stiffness.axial * Project(stiffness.direction, stiffness.direction, other);
  }
  return pull;
}

void SegmentSolver::DifferentiateNode(std::size_t node) noexcept {
  Matrix3 block = Matrix3::Zero();
  AddIsotropic(block, patch_.own_stiffness[node] + kLeastStiffness);
  Matrix3 pull = PullByLinks(node, block) + kLeastStiffness * derivative_[node];
  if (!IsPressed(node)) {
    derivative_[node] = inverse_[node] * pull;
    return;
  }
  for (std::size_t k = contact_starts_[node]; k < contact_starts_[node + 1]; ++k) {
    const tissue::LocalPatch::Contact& contact = patch_.contacts[node_contacts_[k].contact];
    if (!(CalcDepth(contact, turned_[node_contacts_[k].contact]) > 0.0)) continue;
    const int corner = node_contacts_[k].corner;
    Matrix3 nodes = Matrix3::Zero();
    for (int i = 0; i < 3; ++i) {
      if (i != corner) nodes += contact.weights[i] * derivative_[contact.nodes[i]];
    }
    AddAxial(block, contact.normal, contact.weights[corner] * contact.weights[corner] * contact.stiffness);
    pull += contact.weights[corner] * contact.stiffness *
            (Project(contact.normal, contact.tip_normal, tool_derivative_) -
             Project(contact.normal, contact.normal, nodes));
  }
  derivative_[node] = block.inverse() * pull;
}

void SegmentSolver::DifferentiateTool(double coupling_stiffness) noexcept {
  Matrix3 block = coupling_stiffness * Matrix3::Identity();
  Matrix3 pull = block;
  for (std::uint32_t c = 0; c < patch_.contact_count; ++c) {
    const tissue::LocalPatch::Contact& contact = patch_.contacts[c];
    if (!(CalcDepth(contact, turned_[c]) > 0.0)) continue;
    Matrix3 nodes = Matrix3::Zero();
    for (int i = 0; i < 3; ++i) nodes += contact.weights[i] * derivative_[contact.nodes[i]];
    AddAxial(block, contact.tip_normal, contact.stiffness);
    pull += contact.stiffness * Project(contact.tip_normal, contact.normal, nodes);
  }
  for (std::size_t i = patch_.free_count; i < patch_.free_count + patch_.held_count; ++i)
    pull += PullByLinks(i, block);
  tool_derivative_ = block.inverse() * pull;
  for (std::size_t i = patch_.free_count; i < patch_.free_count + patch_.held_count; ++i)
    derivative_[i] = tool_derivative_;
}

void SegmentSolver::SweepDerivative(double coupling_stiffness) noexcept {
  for (std::size_t i = 0; i < patch_.free_count; ++i) DifferentiateNode(i);
  DifferentiateTool(coupling_stiffness);
}

}  // namespace trocar::haptics
