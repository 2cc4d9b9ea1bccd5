// SPDX-License-Identifier: Apache-2.0
/// \file linearisation.h  Residual, energy and stiffness of a model in double precision, in the order in
/// which the solvers hold its nodes.
#pragma once

#include <span>
#include <vector>

#include "link_hierarchy.h"
#include "trocar/tissue/element_kinds.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// A model with its nodes in the solvers' order, and where its springs and strands lie in slices. Constant.
struct OrderedModel {
  std::vector<std::uint32_t> old_of_new;  // (n)
  std::vector<std::uint32_t> new_of_old;  // (n)
  NodeGraph graph;                        // springs, then strands, of each node
  std::vector<double> graph_stiffness;    // (graph.others) k [N/m]
  SliceLayout layout;
  std::vector<std::uint32_t> spring_entries;  // (half-springs of the model) place of each
  std::vector<math::Vec3> rest;               // (n) [m]
  std::vector<double> mass;                   // (n) [kg]
  std::vector<double> shape;                  // (n) k_virtual [N/m]

  struct StrandEntry {
    std::uint32_t node, other, strand;
    std::size_t entry;
    double stiffness;  // [N/m]
  };
  std::vector<StrandEntry> strands;  // from both ends

  std::uint32_t Size() const { return layout.node_count; }
  /// Capacity for as many links as `like` has, and `share` times more.
  void Reserve(const OrderedModel& like, double share);
};
/// Memory of SetOrderedModel: the graph in the caller's order.
struct OrderedModelWorkspace {
  NodeGraph graph;
  std::vector<double> stiffness;
  NodeOrderWorkspace order;

  void Reserve(const OrderedModel& like, double share);
};
/// Takes a model over.
/// \note Allocates nothing where the vectors have the capacity.
void SetOrderedModel(const TissueModel& model, OrderedModelWorkspace& workspace, OrderedModel& made);
OrderedModel MakeOrderedModel(const TissueModel& model);

/// The springs of an ordered model as they are linearised now.
struct OrderedSprings {
  math::AlignedVector<double> stiffness;    // (entries) k [N/m]; 0 for strands and padding
  math::AlignedVector<double> rest_length;  // (entries) [m]
  double mean_length = 0;                   // mean rest length of the model's own springs [m]
};
/// Takes the model's own springs.
/// \note Allocates nothing where the vectors have the capacity.
void SetOrderedSprings(const TissueModel& model, const OrderedModel& ordered, OrderedSprings& springs);
OrderedSprings MakeOrderedSprings(const TissueModel& model, const OrderedModel& ordered);

/// Load of one solve, in the solvers' order.
struct OrderedLoad {
  std::vector<math::Vec3> constant;  // (n) weight and external force [N]
  std::vector<std::uint8_t> is_free;
  std::vector<ContactSpring> contacts;
  ElementArrays elements;
  double stiffness_scale = 1, shape_scale = 1;
};
/// Fills `ordered`, whose vectors have the capacity, from the caller's order.
/// \note Real-time safe.
void SetOrderedLoad(const OrderedModel& model, const TissueLoad& load, const TissueState& state,
                    OrderedLoad& ordered) noexcept;
/// Fills in `constant` alone, where only the external force has changed since, of nodes `first` to before `last`.
/// \note Real-time safe.
void SetOrderedForce(const OrderedModel& model, const TissueLoad& load, std::uint32_t first,
                     std::uint32_t last, OrderedLoad& ordered) noexcept;

/// Balance of forces at one set of positions.
struct Balance {
  math::AlignedVector<Float4> residual;   // (padded) R_i [N]; zero where the node is held
  std::vector<std::uint8_t> is_pressing;  // (contacts)
  double energy = 0;                      // [J]
  double largest_residual = 0;            // [N]
  double force_scale = 0;                 // largest force of one spring, load or element on a free node [N]
  double largest_distance = 0;            // of a node from rest [m]
  bool is_finite = true;
};

/// Adds to out = K x what the pressing contacts of a balance do to their corners together; what each does to its corners
/// alone is in the diagonal excess.
/// \note Real-time safe.
void AddContactLinks(const OrderedLoad& load, const Balance& balance, const Float4* x, Float4* out) noexcept;

/// Evaluates the balance of a model and its stiffness -dR/dx.
class Linearisation {
 public:
  /// \param springs  of the model; must outlive this
  explicit Linearisation(const OrderedSprings& springs) : springs_(&springs) {}

  /// Capacity for a model of so many nodes and ends of strands.
  void Reserve(std::size_t nodes, std::size_t strand_ends);
  /// Takes a model, or a change of it.
  /// \param model  must outlive this
  /// \note Allocates nothing where Reserve() was enough.
  void SetModel(const OrderedModel& model);

  /// Takes what acts in one solve; sets is_free and diagonal_excess of `level`.
  /// \note Real-time safe.
  void SetLoad(const OrderedLoad& load, std::span<const std::uint8_t> strand_is_intact,
               LinkLevel& level) noexcept;
  /// Takes the constant forces of that load anew, and nothing else, of nodes `first` to before `last`.
  /// \note Real-time safe.
  void SetForce(std::uint32_t first, std::uint32_t last) noexcept;

  /// Forces and energy.
  ///
  /// \param position  (padded nodes) [m], in the solvers' order
  /// \note Real-time safe.
  void CalcBalance(const Kernels& kernels, Workers& workers, std::span<const Double4> position,
                   Balance& balance) noexcept;
  /// Forces, energy and stiffness: the last fills links, diagonal_excess and inverse of `level`. Of the contacts' stiffness the
  /// diagonal excess has only what each contact does to its corners alone.
  /// \note Real-time safe.
  void Linearise(const Kernels& kernels, Workers& workers, std::span<const Double4> position,
                 LinkLevel& level, Balance& balance) noexcept;
  /// Adds to out = K x of a pass over the level what the elements of the last Linearise() do beyond the level's diagonal.
  /// \note Real-time safe.
  void CompleteProduct(const LinkLevel& level, const Float4* x, Float4* out) const noexcept {
    level.elements.CompleteProduct(element_stiffness_, x, out);
  }

 private:
  double& At(std::uint32_t node, BalanceValue value) {
    return nodes_[(std::size_t{node / kSliceNodes} * kBalanceValues + value) * kSliceNodes +
                  node % kSliceNodes];
  }
  void AddOuter(std::uint32_t node, const math::Vec3& force, double size) noexcept;
  double AddOuterForces(std::span<const Double4> position, Balance& balance) noexcept;
  double AddElementForces(std::span<const Double4> position) noexcept;
  void AddContactDiagonal(LinkLevel& level, const Balance& balance) noexcept;
  void SetElements(std::span<const Double4> position, LinkLevel& level) noexcept;
  void Run(const Kernels& kernels, Workers& workers, BalancePass pass, double energy,
           Balance& balance) noexcept;

  const OrderedModel* model_ = nullptr;
  const OrderedSprings* springs_;
  const OrderedLoad* load_ = nullptr;
  std::span<const std::uint8_t> strand_is_intact_;
  math::AlignedVector<double> nodes_;        // (slices, kBalanceValues, kSliceNodes)
  std::vector<std::uint32_t> strand_nodes_;  // those with strands, each once
  ElementMatrix element_stiffness_;          // of all elements, what softens them included
};

}  // namespace trocar::tissue
