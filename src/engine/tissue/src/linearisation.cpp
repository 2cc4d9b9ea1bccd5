// SPDX-License-Identifier: Apache-2.0
#include "linearisation.h"

#include <algorithm>
#include <cmath>

#include "node_force.h"
#include "node_vectors.h"
#include "trocar/base/assert.h"
#include "trocar/base/spare_capacity.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

/// Slices a thread takes at a time; fixed, so that sums do not depend on the number of threads.
constexpr std::uint32_t kChunkSlices = 28;

/// Springs, then strands, of each node, in the model's order.
void SetGraph(const TissueModel& model, NodeGraph& graph, std::vector<double>& stiffness) {
  graph.Clear();
  stiffness.clear();
  for (std::size_t i = 0; i < model.Size(); ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      graph.others.push_back(model.half_springs[h].other);
      stiffness.push_back(model.half_springs[h].stiffness);
    }
    for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
      graph.others.push_back(model.half_strands[h].other);
      stiffness.push_back(model.half_strands[h].stiffness);
    }
    graph.starts.push_back(static_cast<std::uint32_t>(graph.others.size()));
  }
}

/// Place of the first of a node's six values.
std::size_t DiagonalAt(std::uint32_t i) {
  return std::size_t{i / kSliceNodes} * 6 * kSliceNodes + i % kSliceNodes;
}

Vec3 ToVec3(const Double4& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

void SetOrderedModel(const TissueModel& model, OrderedModelWorkspace& workspace, OrderedModel& made) {
  const auto n = static_cast<std::uint32_t>(model.Size());
  NodeGraph& old_graph = workspace.graph;
  SetGraph(model, old_graph, workspace.stiffness);
  FindNodeOrder(old_graph, workspace.order, made.old_of_new);
  made.new_of_old.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) made.new_of_old[made.old_of_new[i]] = i;
  made.graph.Clear();
  made.graph_stiffness.clear();
  made.rest.clear(), made.mass.clear(), made.shape.clear(), made.strands.clear();
  for (const std::uint32_t old : made.old_of_new) {
    for (auto h = old_graph.starts[old]; h < old_graph.starts[old + 1]; ++h) {
      made.graph.others.push_back(made.new_of_old[old_graph.others[h]]);
      made.graph_stiffness.push_back(workspace.stiffness[h]);
    }
    made.graph.starts.push_back(static_cast<std::uint32_t>(made.graph.others.size()));
    made.rest.push_back(model.rest[old]);
    made.mass.push_back(model.mass[old]);
    made.shape.push_back(model.shape_stiffness[old]);
  }
  SetSliceLayout(made.graph, made.layout);
  made.spring_entries.resize(model.half_springs.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t old = made.old_of_new[i];
    std::uint32_t place = 0;
    for (auto h = model.spring_starts[old]; h < model.spring_starts[old + 1]; ++h, ++place)
      made.spring_entries[h] = static_cast<std::uint32_t>(made.layout.Entry(i, place));
    for (auto h = model.strand_starts[old]; h < model.strand_starts[old + 1]; ++h, ++place) {
      const auto& half = model.half_strands[h];
      made.strands.push_back(
          {i, made.new_of_old[half.other], half.strand, made.layout.Entry(i, place), half.stiffness});
    }
  }
}

OrderedModel MakeOrderedModel(const TissueModel& model) {
  OrderedModel made;
  OrderedModelWorkspace workspace;
  SetOrderedModel(model, workspace, made);
  return made;
}

void OrderedModel::Reserve(const OrderedModel& like, double share) {
  const std::size_t n = like.Size();
  for (auto* list : {&old_of_new, &new_of_old}) list->reserve(n);
  graph.starts.reserve(n + 1), layout.starts.reserve(like.layout.starts.size());
  rest.reserve(n), mass.reserve(n), shape.reserve(n);
  base::ReserveWithSpare(like.graph.others.size(), share, graph.others, graph_stiffness);
  base::ReserveWithSpare(like.layout.others.size(), share, layout.others);
  base::ReserveWithSpare(like.spring_entries.size(), share, spring_entries);
  base::ReserveWithSpare(like.strands.size(), share, strands);
}

void OrderedModelWorkspace::Reserve(const OrderedModel& like, double share) {
  const std::size_t n = like.Size();
  graph.starts.reserve(n + 1);
  order.roots.reserve(n), order.is_placed.reserve(n);
  base::ReserveWithSpare(like.graph.others.size(), share, graph.others, stiffness);
  order.places.reserve(base::AddSpare(n, share));  // by degree: a node has fewer links than there are nodes
}

void SetOrderedSprings(const TissueModel& model, const OrderedModel& ordered, OrderedSprings& springs) {
  const std::size_t entries = ordered.layout.Steps() * kSliceNodes;
  springs.stiffness.assign(entries, 0.0), springs.rest_length.assign(entries, 0.0);
  for (std::size_t h = 0; h < model.half_springs.size(); ++h) {
    springs.stiffness[ordered.spring_entries[h]] = model.half_springs[h].stiffness;
    springs.rest_length[ordered.spring_entries[h]] = model.half_springs[h].rest_length;
  }
  double sum = 0;
  std::size_t count = 0;
  for (const double rest : springs.rest_length) sum += rest, count += rest > 0.0;
  springs.mean_length = count > 0 ? sum / static_cast<double>(count) : 0.0;
}

OrderedSprings MakeOrderedSprings(const TissueModel& model, const OrderedModel& ordered) {
  OrderedSprings springs;
  SetOrderedSprings(model, ordered, springs);
  return springs;
}

void SetOrderedLoad(const OrderedModel& model, const TissueLoad& load, const TissueState& state,
                    OrderedLoad& ordered) noexcept {
  ordered.stiffness_scale = load.stiffness_scale;
  ordered.shape_scale = load.shape_scale;
  SetOrderedForce(model, load, 0, model.Size(), ordered);
  for (std::uint32_t i = 0; i < model.Size(); ++i)
    ordered.is_free[i] = state.condition[model.old_of_new[i]] != NodeCondition::kPrescribed;
  ordered.contacts.assign(load.contacts.begin(), load.contacts.end());
  for (ContactSpring& contact : ordered.contacts) {
    for (std::uint32_t& node : contact.nodes) node = model.new_of_old[node];
  }
  ordered.elements.Clear();
  if (!HasElements(load)) return;
  ordered.elements = *load.elements;
  ordered.elements.ForEach([&](auto& element) {
    for (std::uint32_t& node : element.nodes) node = model.new_of_old[node];
  });
}

void SetOrderedForce(const OrderedModel& model, const TissueLoad& load, std::uint32_t first,
                     std::uint32_t last, OrderedLoad& ordered) noexcept {
  for (std::uint32_t i = first; i < last; ++i) {
    ordered.constant[i] = model.mass[i] * load.gravity;
    if (!load.external_force.empty()) ordered.constant[i] += load.external_force[model.old_of_new[i]];
  }
}

void AddContactLinks(const OrderedLoad& load, const Balance& balance, const Float4* x, Float4* out) noexcept {
  for (std::size_t c = 0; c < load.contacts.size(); ++c) {
    if (!balance.is_pressing[c]) continue;
    const ContactSpring& contact = load.contacts[c];
    double along[3], together = 0;
    for (int corner = 0; corner < 3; ++corner) {
      along[corner] = math::Dot(contact.normal, ToDouble(x[contact.nodes[corner]]));
      together += contact.weights[corner] * along[corner];
    }
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t node = contact.nodes[corner];
      if (!load.is_free[node]) continue;
      const double force = contact.weights[corner] * contact.stiffness * (together - along[corner]);
      out[node] = ToFloat(ToDouble(out[node]) + force * contact.normal);
    }
  }
}

void Linearisation::SetModel(const OrderedModel& model) {
  model_ = &model;
  nodes_.assign(model.layout.PaddedNodes() * kBalanceValues, 0.0);
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    for (int axis = 0; axis < 3; ++axis)
      At(i, static_cast<BalanceValue>(kRestX + axis)) = model.rest[i][axis];
  }
  strand_nodes_.clear();
  for (const auto& strand : model.strands) {
    if (strand_nodes_.empty() || strand_nodes_.back() != strand.node) strand_nodes_.push_back(strand.node);
  }
}

void Linearisation::Reserve(std::size_t nodes, std::size_t strand_ends) {
  nodes_.reserve(nodes * kBalanceValues);
  strand_nodes_.reserve(std::min(nodes, strand_ends));
  element_stiffness_.Reserve();
}

void Linearisation::SetLoad(const OrderedLoad& load, std::span<const std::uint8_t> strand_is_intact,
                            LinkLevel& level) noexcept {
  load_ = &load;
  strand_is_intact_ = strand_is_intact;
  element_stiffness_.Clear();
  level.elements.Clear();
  SetForce(0, model_->Size());
  for (std::uint32_t i = 0; i < model_->Size(); ++i) {
    const double shape = load.shape_scale * model_->shape[i];
    At(i, kShape) = shape;
    At(i, kFree) = load.is_free[i] != 0 ? 1.0 : 0.0;
    level.is_free[i] = load.is_free[i] != 0 ? 1.0f : 0.0f;
    float* const diagonal = level.diagonal_excess.data() + DiagonalAt(i);
    for (std::size_t v = 0; v < 6; ++v)
      diagonal[v * kSliceNodes] = v == 0 || v == 3 || v == 5 ? static_cast<float>(shape) : 0.0f;
  }
  for (const std::uint32_t node : strand_nodes_) At(node, kStrands) = 0.0;
  for (const auto& strand : model_->strands) {
    if (strand_is_intact[strand.strand]) At(strand.node, kStrands) += load.stiffness_scale * strand.stiffness;
  }
}

void Linearisation::SetForce(std::uint32_t first, std::uint32_t last) noexcept {
  for (std::uint32_t i = first; i < last; ++i) {
    for (int axis = 0; axis < 3; ++axis)
      At(i, static_cast<BalanceValue>(kOuterX + axis)) = load_->constant[i][axis];
    At(i, kOuterSize) = math::Norm(load_->constant[i]);
  }
}

void Linearisation::AddOuter(std::uint32_t node, const Vec3& force, double size) noexcept {
  for (int axis = 0; axis < 3; ++axis) At(node, static_cast<BalanceValue>(kOuterX + axis)) += force[axis];
  At(node, kOuterSize) = math::Max(At(node, kOuterSize), size);
}

/// Strands, contacts and elements are few, and each changes a few nodes: their force joins the constant one.
/// \return their energy, less that of a constant force of the same size [J]
double Linearisation::AddOuterForces(std::span<const Double4> position, Balance& balance) noexcept {
  const OrderedModel& model = *model_;
  const OrderedLoad& load = *load_;
  const auto set_outer = [&](std::uint32_t node, const Vec3& force, double size) {
    for (int axis = 0; axis < 3; ++axis) At(node, static_cast<BalanceValue>(kOuterX + axis)) = force[axis];
    At(node, kOuterSize) = size;
  };
  for (const ContactSpring& contact : load.contacts) {
    for (const std::uint32_t node : contact.nodes)
      set_outer(node, load.constant[node], math::Norm(load.constant[node]));
  }
  load.elements.ForEach([&](const auto& element) {
    for (const std::uint32_t node : element.nodes)
      set_outer(node, load.constant[node], math::Norm(load.constant[node]));
  });
  double energy = 0;
  for (std::size_t first = 0, last = 0; first < model.strands.size(); first = last) {
    // a node's strands lie side by side
    const std::uint32_t node = model.strands[first].node;
    const Vec3 here = ToVec3(position[node]), rest = model.rest[node];
    Vec3 force = load.constant[node];
    double size2 = math::SquaredNorm(force);
    for (last = first; last < model.strands.size() && model.strands[last].node == node; ++last) {
      const auto& strand = model.strands[last];
      if (!strand_is_intact_[strand.strand]) continue;
      const double k = load.stiffness_scale * strand.stiffness;
      const Vec3 offset = (ToVec3(position[strand.other]) - here) - (model.rest[strand.other] - rest);
      const double length2 = math::SquaredNorm(offset);
      force += k * offset;
      size2 = std::max(size2, k * k * length2);
      energy += 0.25 * k * length2 - k * math::Dot(offset, rest - here);
    }
    set_outer(node, force, std::sqrt(size2));
  }
  for (std::size_t c = 0; c < load.contacts.size(); ++c) {
    const ContactSpring& contact = load.contacts[c];
    double depth = contact.offset;
    for (int corner = 0; corner < 3; ++corner)
      depth -= contact.weights[corner] * math::Dot(contact.normal, ToVec3(position[contact.nodes[corner]]));
    balance.is_pressing[c] = depth > 0.0;
    if (!(depth > 0.0)) continue;
    energy += 0.5 * contact.stiffness * depth * depth;
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t node = contact.nodes[corner];
      const double force = contact.weights[corner] * contact.stiffness * depth;
      AddOuter(node, force * contact.normal, std::fabs(force));
      energy -= force * math::Dot(contact.normal, model.rest[node] - ToVec3(position[node]));
    }
  }
  return load.elements.IsEmpty() ? energy : energy + AddElementForces(position);
}

double Linearisation::AddElementForces(std::span<const Double4> position) noexcept {
  double energy = 0;
  load_->elements.ForEach([&](const auto& element) {
    const auto here = GatherPositions(element, [&](std::uint32_t node) { return ToVec3(position[node]); });
    energy += CalcElementEnergy(element, here);
    const auto forces = CalcElementForce(element, here);
    for (std::size_t i = 0; i < forces.size(); ++i) {
      AddOuter(element.nodes[i], forces[i], math::Norm(forces[i]));
      energy -= math::Dot(forces[i], model_->rest[element.nodes[i]] - here[i]);
    }
  });
  return energy;
}

/// The elements' stiffness at a position: the whole of it for products, what is firm of it for the level.
void Linearisation::SetElements(std::span<const Double4> position, LinkLevel& level) noexcept {
  if (load_->elements.IsEmpty()) return;
  const auto position_at = [&](std::uint32_t node) { return ToVec3(position[node]); };
  const auto is_free = [&](std::uint32_t node) { return load_->is_free[node] != 0; };
  SetElementMatrix(load_->elements, position_at, StiffnessPart::kWhole, is_free, element_stiffness_);
  SetElementMatrix(load_->elements, position_at, StiffnessPart::kFirm, is_free, level.elements.Firm());
  level.elements.AddDiagonal(level.diagonal_excess);
}

void Linearisation::AddContactDiagonal(LinkLevel& level, const Balance& balance) noexcept {
  for (const ContactSpring& contact : load_->contacts) {
    for (const std::uint32_t node : contact.nodes) {
      const auto shape = static_cast<float>(At(node, kShape));
      for (std::size_t v = 0; v < 6; ++v)
        level.diagonal_excess[DiagonalAt(node) + v * kSliceNodes] = v == 0 || v == 3 || v == 5 ? shape : 0.0f;
    }
  }
  for (std::size_t c = 0; c < load_->contacts.size(); ++c) {
    if (!balance.is_pressing[c]) continue;
    const ContactSpring& contact = load_->contacts[c];
    for (int corner = 0; corner < 3; ++corner) {
      math::Symmetric3 m{};
      AddDirection(m, contact.normal, contact.weights[corner] * contact.stiffness);
      for (std::size_t v = 0; v < 6; ++v)
        level.diagonal_excess[DiagonalAt(contact.nodes[corner]) + v * kSliceNodes] +=
            static_cast<float>(m[v]);
    }
  }
}

void Linearisation::Run(const Kernels& kernels, Workers& workers, BalancePass pass, double energy,
                        Balance& balance) noexcept {
  pass.table = model_->layout.Table();
  pass.stiffness = springs_->stiffness.data(), pass.rest_length = springs_->rest_length.data();
  pass.stiffness_scale = load_->stiffness_scale;
  pass.nodes = nodes_.data();
  pass.residual = balance.residual.data();
  const std::uint32_t slices = model_->layout.Slices();
  const std::uint32_t chunk_slices = std::max(kChunkSlices, slices / Workers::kMaxChunks + 1);
  const std::uint32_t chunks = (slices + chunk_slices - 1) / chunk_slices;
  std::array<BalanceSums, Workers::kMaxChunks> sums;
  workers.Run(chunks, [&](std::uint32_t chunk) {
    sums[chunk] = kernels.balance(pass, chunk * chunk_slices, std::min(slices, (chunk + 1) * chunk_slices));
  });
  BalanceSums all;
  all.energy = energy;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
    all.energy += sums[chunk].energy;
    all.residual2 = math::Max(all.residual2, sums[chunk].residual2);
    all.force = math::Max(all.force, sums[chunk].force);
    all.distance2 = math::Max(all.distance2, sums[chunk].distance2);
    all.is_finite = all.is_finite && sums[chunk].is_finite;
  }
  balance.energy = all.energy;
  balance.largest_residual = std::sqrt(all.residual2);
  balance.force_scale = all.force;
  balance.largest_distance = std::sqrt(all.distance2);
  balance.is_finite = all.is_finite;
}

void Linearisation::CalcBalance(const Kernels& kernels, Workers& workers, std::span<const Double4> position,
                                Balance& balance) noexcept {
  const double energy = AddOuterForces(position, balance);
  Run(kernels, workers, {.position = position.data(), .has_stiffness = false}, energy, balance);
}

void Linearisation::Linearise(const Kernels& kernels, Workers& workers, std::span<const Double4> position,
                              LinkLevel& level, Balance& balance) noexcept {
  TROCAR_ASSERT(level.link_floats == kSpringLinkFloats);
  const double energy = AddOuterForces(position, balance);
  level.elements.RemoveDiagonal(level.diagonal_excess);
  AddContactDiagonal(level, balance);
  SetElements(position, level);
  Run(kernels, workers,
      {.position = position.data(),
       .has_stiffness = true,
       .links = level.links.data(),
       .diagonal_excess = level.diagonal_excess.data(),
       .inverse = level.inverse.data()},
      energy, balance);
  for (const auto& strand : model_->strands) {
    const double k = strand_is_intact_[strand.strand] ? load_->stiffness_scale * strand.stiffness : 0.0;
    float* const link = level.links.data() + strand.entry / kSliceNodes * kSpringLinkFloats * kSliceNodes +
                        strand.entry % kSliceNodes;
    for (std::size_t v = 0; v < kSpringLinkFloats; ++v)
      link[v * kSliceNodes] = v == 0 ? static_cast<float>(k) : 0.0f;
  }
}

}  // namespace trocar::tissue
