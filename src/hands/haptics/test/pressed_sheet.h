// SPDX-License-Identifier: Apache-2.0
/// \file pressed_sheet.h  A sheet of tissue on a soft foundation, a tool that presses it from above, and the whole
/// system's equilibrium for any place of the tool: what a segment is compared with.
#pragma once

#include <vector>

#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/local_patch.h"

namespace trocar::haptics {

class PressedSheet {
 public:
  static constexpr int kSide = 31;         // nodes
  static constexpr double kStep = 0.004;   // [m]
  static constexpr double kSpring = 440;   // [N/m], gallbladder wall (domain facts 3.2)
  static constexpr double kContact = 300;  // [N/m]

  explicit PressedSheet(double foundation = 20.0, int pressed_rings = 1) {
    tissue::TissueDefinition definition;
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        definition.rest.push_back({kStep * (column - kSide / 2), kStep * (row - kSide / 2), 0.0});
        const bool is_edge = row == 0 || column == 0 || row == kSide - 1 || column == kSide - 1;
        if (is_edge) definition.fixed.push_back(Node(row, column));
      }
    }
    definition.mass.assign(definition.rest.size(), 0.0);
    definition.shape_stiffness.assign(definition.rest.size(), foundation);
    const auto link = [&](std::uint32_t a, std::uint32_t b) {
      definition.springs.push_back({a, b, kSpring, math::Distance(definition.rest[a], definition.rest[b])});
    };
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        if (column + 1 < kSide) link(Node(row, column), Node(row, column + 1));
        if (row + 1 < kSide) link(Node(row, column), Node(row + 1, column));
        if (column + 1 < kSide && row + 1 < kSide) link(Node(row, column), Node(row + 1, column + 1));
      }
    }
    model = tissue::MakeTissueModel(definition);
    state = tissue::MakeRestState(model);
    const int middle = kSide / 2;
    for (int row = middle - pressed_rings; row <= middle + pressed_rings; ++row) {
      for (int column = middle - pressed_rings; column <= middle + pressed_rings; ++column) {
        tissue::ContactSpring contact;
        contact.nodes = {Node(row, column), Node(row, column + 1), Node(row + 1, column + 1)};
        contact.weights = {0.6, 0.3, 0.1};
        contact.normal = {0, 0, -1};
        contact.stiffness = kContact;
        contacts.push_back(contact);
      }
    }
    tools.assign(contacts.size(), 0);
  }

  static std::uint32_t Node(int row, int column) { return static_cast<std::uint32_t>(row * kSide + column); }

  /// Equilibrium with the tool's origin at `tool`; its pressing points lie in the plane of the origin.
  void Solve(const math::Vec3& tool) {
    p_world_tool = tool;
    for (tissue::ContactSpring& contact : contacts) contact.offset = -tool.z;
    for (std::size_t i = 0; i < held.size(); ++i) state.position[held[i]] = model.rest[held[i]] + tool;
    load.contacts = contacts;
    tissue::SolverSettings exact;
    exact.kind = tissue::SolverKind::kNewtonMultigrid;
    exact.max_error = 1e-10;
    exact.newton.max_steps = 200;
    exact.newton.max_linear_iterations = 300;
    tissue::EquilibriumSolver solver(model);
    solver.Solve(exact, load, state);
    force = solver.CalcReaction(load, state, held);
    for (const tissue::ContactSpring& contact : contacts) {
      const double depth = tissue::CalcContactDepth(contact, state.position);
      if (depth > 0.0) force -= (contact.stiffness * depth) * contact.normal;
    }
  }

  /// Lets jaws hold some nodes around the middle instead of pressing.
  void Hold() {
    contacts.clear();
    tools.clear();
    for (const int offset : {0, 1}) held.push_back(Node(kSide / 2 + offset, kSide / 2));
    for (const std::uint32_t node : held) state.condition[node] = tissue::NodeCondition::kPrescribed;
  }

  tissue::PatchSource Source() const {
    return {model, state, load, contacts, tools, 0, held, {{}, p_world_tool}, force, true, 1};
  }
  tissue::LocalPatch Cut(int rings = tissue::PatchCutter::kMaxRings) const {
    tissue::LocalPatch patch;
    tissue::PatchCutter(model.Size()).Cut(Source(), patch, rings);
    return patch;
  }

  tissue::TissueModel model;
  tissue::TissueState state;
  tissue::TissueLoad load;
  std::vector<tissue::ContactSpring> contacts;
  std::vector<std::uint8_t> tools;
  std::vector<std::uint32_t> held;
  math::Vec3 p_world_tool;  // [m]
  math::Vec3 force;         // on the tool [N]
};

}  // namespace trocar::haptics
