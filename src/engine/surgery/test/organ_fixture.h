// SPDX-License-Identifier: Apache-2.0
/// \file organ_fixture.h  A spherical organ and a duct beside it on foundations, for tests of what tools do to
/// them.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/surgery/tool_proxy.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/material.h"

namespace trocar::surgery {

class OrganFixture : public testing::Test {
 protected:
  static constexpr std::uint32_t kDuctNodes = 21;
  static constexpr double kDuctRadius = 0.0015;

  OrganFixture() {
    mesh_ = geometry::MakeSphere({0, 0, 0}, 0.02, 3);
    tissue::TissueDefinition definition;
    definition.rest = mesh_.positions;
    definition.mass.assign(mesh_.positions.size(), 1e-4);
    const auto areas = geometry::CalcVertexAreas(mesh_.positions, mesh_.triangles);
    definition.shape_stiffness = tissue::CalcFoundationStiffness(areas, 5400, 0.02);
    const auto edges = geometry::FindEdges(mesh_.triangles);
    const auto stiffness = tissue::CalcEdgeStiffness(mesh_.positions, mesh_.triangles, edges, 40);
    const auto join = [&](std::uint32_t a, std::uint32_t b, double k) {
      definition.springs.push_back({a, b, k, math::Distance(definition.rest[a], definition.rest[b])});
    };
    for (std::size_t i = 0; i < edges.size(); ++i) join(edges[i][0], edges[i][1], stiffness[i]);
    // a duct 8 cm long along x, free in the air at y = 6 cm, fixed at both ends
    first_duct_node_ = static_cast<std::uint32_t>(mesh_.positions.size());
    for (std::uint32_t i = 0; i < kDuctNodes; ++i) {
      definition.rest.push_back({-0.04 + 0.004 * i, 0.06, 0});
      definition.mass.push_back(1e-5);
      definition.shape_stiffness.push_back(2.0);
      if (i > 0) join(first_duct_node_ + i - 1, first_duct_node_ + i, 300);
    }
    definition.fixed = {first_duct_node_, first_duct_node_ + kDuctNodes - 1};
    model_ = tissue::MakeTissueModel(definition);
    state_ = tissue::MakeRestState(model_);
    auto surface = MakeOrganSurface(state_.position, 0, mesh_);
    EXPECT_TRUE(surface.ok());
    organs_.push_back(std::move(*surface));
    auto tubes = MakeTubeSet(state_.position,
                             {{first_duct_node_, kDuctNodes, std::vector<double>(kDuctNodes, kDuctRadius)}});
    EXPECT_TRUE(tubes.ok());
    tubes_ = std::move(*tubes);
    before_ = state_.position;
    solver_.emplace(model_);
  }

  /// Pose of the tool at joints, through a trocar 15 cm above the organ's middle.
  math::Pose PoseAt(const instrument::TrocarJoints& joints) const {
    return instrument::CalcToolPose(kPort, joints);
  }
  /// Joints that bring a closed tool's tip to a place.
  instrument::TrocarJoints JointsAt(const math::Vec3& tip, double jaw = 0.0) const {
    return instrument::FindJoints(kPort, tip, 0.0, jaw);
  }

  /// One tick of one hand: contacts, equilibrium, reaction, and where the tool that is seen comes to stand.
  ContactReaction Tick(const instrument::TrocarJoints& device, std::int32_t grasped = -1) {
    std::swap(contacts_, last_);
    contacts_.Clear();
    const ToolMotion motion{&tool_,         0,         X_proxy_before_, X_proxy_,
                            PoseAt(device), last_jaw_, device.jaw,      grasped};
    FindContacts(motion, GetContactCandidates(), settings_, last_, contacts_);
    before_ = state_.position;
    const auto solved = solver_->Solve({tissue::SolverKind::kChebyshevJacobi2015, 800, 1e-6, 0.0},
                                       {.contacts = contacts_.springs}, state_);
    EXPECT_TRUE(solved.is_finite);
    const ContactReaction reaction = CalcContactReaction(0, state_.position, contacts_);
    UpdateOrganSurface(organs_[0], state_.position);
    tubes_.tree.Update(state_.position);
    for (std::size_t i = 0; i < state_.position.size(); ++i) {
      double& motion_of = motion_[i < first_duct_node_ ? 0 : 1];
      if (i == 0 || i == first_duct_node_) motion_of = 0;
      motion_of = std::max(motion_of, math::Distance(before_[i], state_.position[i]));
    }
    ProxyLimits limits;
    AddContactLimits(0, contacts_, state_.position, limits);
    X_proxy_before_ = X_proxy_;
    for (int round = 0; round < 4; ++round) {
      const auto proxy = FindProxy({kPort, device}, offset_, limits.limits);
      X_proxy_ = PoseAt(proxy);
      overlap_ = AddOverlapLimits(tool_, X_proxy_, PoseAt(device), device.jaw, GetContactCandidates(),
                                  grasped, limits);
      proxy_ = proxy;
      if (overlap_ == 0.0) break;
    }
    offset_ = {proxy_.pan - device.pan, proxy_.tilt - device.tilt, 0, proxy_.depth - device.depth, 0};
    last_jaw_ = device.jaw;
    return reaction;
  }
  /// Puts the tool somewhere, touching nothing.
  void Place(const instrument::TrocarJoints& joints) {
    X_proxy_ = X_proxy_before_ = PoseAt(joints);
    offset_ = {};
    last_jaw_ = joints.jaw;
    contacts_.Clear();
    last_.Clear();
  }

  ContactCandidates GetContactCandidates() const {
    return {organs_, &tubes_, state_.position, before_, motion_};
  }
  math::Vec3 DuctMiddle() const { return state_.position[first_duct_node_ + kDuctNodes / 2]; }

  static constexpr math::Vec3 kPort{0, 0, 0.15};
  geometry::TriangleMesh mesh_;
  std::uint32_t first_duct_node_ = 0;
  tissue::TissueModel model_;
  tissue::TissueState state_;
  std::vector<OrganSurface> organs_;
  TubeSet tubes_;
  std::vector<math::Vec3> before_;
  std::vector<double> motion_ = std::vector<double>(2, 0.0);
  std::optional<tissue::EquilibriumSolver> solver_;
  instrument::Tool tool_;
  ContactSettings settings_;
  ContactSet contacts_, last_;
  math::Pose X_proxy_, X_proxy_before_;
  instrument::TrocarJoints offset_, proxy_;
  double last_jaw_ = 0, overlap_ = 0;
};

}  // namespace trocar::surgery
