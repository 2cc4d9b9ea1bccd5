// SPDX-License-Identifier: Apache-2.0
/// \file linearisation.h  Residual, energy and stiffness of a model in double precision, in the order in
/// which the solvers hold its nodes.
#pragma once

#include <span>
#include <vector>

#include "link_hierarchy.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// A model with its nodes in the solvers' order and its springs and strands in slices. Constant.
struct OrderedModel {
  std::vector<std::uint32_t> old_of_new;  // (n)
  std::vector<std::uint32_t> new_of_old;  // (n)
  NodeGraph graph;                        // springs, then strands, of each node
  std::vector<double> graph_stiffness;    // (graph.others) k [N/m]
  SliceLayout layout;
  std::vector<double> stiffness;    // (entries) k of springs [N/m]; 0 for strands and padding
  std::vector<double> rest_length;  // (entries) [m]
  std::vector<std::size_t> spring_entries;  // (half-springs of the model) place of each
  std::vector<Vec3> rest;           // (n) [m]
  std::vector<double> mass;         // (n) [kg]
  std::vector<double> shape;        // (n) k_virtual [N/m]

  struct StrandEntry {
    std::uint32_t node, other, strand;
    std::size_t entry;
    double stiffness;  // [N/m]
  };
  std::vector<StrandEntry> strands;  // from both ends

  std::uint32_t Size() const { return layout.node_count; }
};
OrderedModel MakeOrderedModel(const TissueModel& model);

/// What acts in one solve, in the solvers' order.
struct OrderedLoad {
  std::vector<Vec3> constant;  // (n) weight and external force [N]
  std::vector<std::uint8_t> is_free;
  std::vector<ContactSpring> contacts;
  double stiffness_scale = 1, shape_scale = 1;
};
/// Fills `ordered`, whose vectors have room, from the caller's order.
/// \note Real-time safe.
void SetOrderedLoad(const OrderedModel& model, const TissueLoad& load, const TissueState& state,
                    OrderedLoad& ordered) noexcept;

/// Balance of forces at one set of positions.
struct Balance {
  std::vector<Vec3> residual;      // (n) R_i [N]; zero where the node is held
  std::vector<double> node_force;  // (n) largest force of one spring or load on the node [N]
  double energy = 0;               // [J]
  double largest_residual = 0;     // [N]
  double force_scale = 0;          // largest force of one spring, load or contact on a free node [N]
  bool is_finite = true;
};

/// Evaluates the balance, and with it the stiffness -dR/dx: links and ground of `level`, and k of each entry
/// for LinkHierarchy::Update. Contacts are left out of the stiffness; see ContactMatrix.
///
/// \param position  (n) [m], in the solvers' order
/// \note Real-time safe.
/// Source: Hooke's law; stiffness of a spring of extent d u: (k - b) I + b u u^T with
/// b = k l / d.
void Linearise(const OrderedModel& model, const OrderedLoad& load,
               std::span<const std::uint8_t> strand_is_intact, std::span<const Vec3> position,
               Workers& workers, LinkLevel& level, std::span<float> stiffness, Balance& balance) noexcept;

}  // namespace trocar::tissue
