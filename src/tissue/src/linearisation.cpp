// SPDX-License-Identifier: Apache-2.0
#include "linearisation.h"

#include <algorithm>
#include <cmath>

#include "node_force.h"

namespace trocar::tissue {
namespace {

/// Slices a thread takes at a time; fixed, so that sums do not depend on the number of threads.
constexpr std::uint32_t kChunkSlices = 32;

/// Springs, then strands, of each node, in the model's order.
NodeGraph MakeGraph(const TissueModel& model, std::vector<double>& stiffness) {
  NodeGraph graph;
  graph.starts.push_back(0);
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
  return graph;
}

/// Partial sums of a chunk.
struct ChunkSums {
  double energy = 0, residual2 = 0, force = 0;
  bool is_finite = true;
};

/// Six floats of a symmetric matrix, kSliceNodes apart.
void Write(const Symmetric3& m, float* to) noexcept {
  for (std::size_t i = 0; i < 6; ++i) to[i * kSliceNodes] = static_cast<float>(m[i]);
}

/// Force, energy and stiffness of the springs of one node.
Vec3 LineariseSprings(const OrderedModel& model, double scale, std::span<const Vec3> position,
                      std::uint32_t i, LinkLevel& level, std::span<float> stiffness, double& largest,
                      double& energy) noexcept {
  const Vec3 here = position[i];
  Vec3 force;
  const std::size_t first = model.layout.Entry(i, 0),
                    last = first + std::size_t{model.layout.RowSteps(i)} * kSliceNodes;
  float* link = level.links.data() + first / kSliceNodes * 6 * kSliceNodes + first % kSliceNodes;
  double stored = 0, most = 0;
  for (std::size_t entry = first; entry < last; entry += kSliceNodes, link += 6 * kSliceNodes) {
    const std::uint32_t other = model.layout.others[entry];
    if (other == i) break;
    const double k = scale * model.stiffness[entry], rest = model.rest_length[entry];
    const Vec3 along = position[other] - here;
    const double length = std::sqrt(math::SquaredNorm(along));
    const double inverse = length > 0.0 ? 1.0 / length : 0.0, b = k * rest * inverse, across = k - b;
    const double bend = b * inverse * inverse;  // times the extent twice: b u u^T
    force += across * along;
    link[0] = static_cast<float>(across + bend * along.x * along.x);
    link[kSliceNodes] = static_cast<float>(bend * along.x * along.y);
    link[2 * kSliceNodes] = static_cast<float>(bend * along.x * along.z);
    link[3 * kSliceNodes] = static_cast<float>(across + bend * along.y * along.y);
    link[4 * kSliceNodes] = static_cast<float>(bend * along.y * along.z);
    link[5 * kSliceNodes] = static_cast<float>(across + bend * along.z * along.z);
    stiffness[entry] = static_cast<float>(k);
    const double tension = k * std::fabs(length - rest);
    most = tension > most ? tension : most;
    stored += tension * std::fabs(length - rest);
  }
  largest = most;
  energy += 0.25 * stored;
  return force;
}

}  // namespace

OrderedModel MakeOrderedModel(const TissueModel& model) {
  OrderedModel made;
  const auto n = static_cast<std::uint32_t>(model.Size());
  std::vector<double> old_stiffness;
  const NodeGraph old_graph = MakeGraph(model, old_stiffness);
  made.old_of_new = CalcNodeOrder(old_graph);
  made.new_of_old.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) made.new_of_old[made.old_of_new[i]] = i;
  made.graph.starts.push_back(0);
  for (const std::uint32_t old : made.old_of_new) {
    for (auto h = old_graph.starts[old]; h < old_graph.starts[old + 1]; ++h) {
      made.graph.others.push_back(made.new_of_old[old_graph.others[h]]);
      made.graph_stiffness.push_back(old_stiffness[h]);
    }
    made.graph.starts.push_back(static_cast<std::uint32_t>(made.graph.others.size()));
    made.rest.push_back(model.rest[old]);
    made.mass.push_back(model.mass[old]);
    made.shape.push_back(model.shape_stiffness[old]);
  }
  made.layout = MakeSliceLayout(made.graph);
  made.stiffness.assign(made.layout.Steps() * kSliceNodes, 0.0);
  made.rest_length.assign(made.layout.Steps() * kSliceNodes, 0.0);
  made.spring_entries.resize(model.half_springs.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t old = made.old_of_new[i];
    std::uint32_t place = 0;
    for (auto h = model.spring_starts[old]; h < model.spring_starts[old + 1]; ++h, ++place) {
      const std::size_t entry = made.spring_entries[h] = made.layout.Entry(i, place);
      made.stiffness[entry] = model.half_springs[h].stiffness;
      made.rest_length[entry] = model.half_springs[h].rest_length;
    }
    for (auto h = model.strand_starts[old]; h < model.strand_starts[old + 1]; ++h, ++place) {
      const auto& half = model.half_strands[h];
      made.strands.push_back(
          {i, made.new_of_old[half.other], half.strand, made.layout.Entry(i, place), half.stiffness});
    }
  }
  return made;
}

void SetOrderedLoad(const OrderedModel& model, const TissueLoad& load, const TissueState& state,
                    OrderedLoad& ordered) noexcept {
  ordered.stiffness_scale = load.stiffness_scale;
  ordered.shape_scale = load.shape_scale;
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    const std::uint32_t old = model.old_of_new[i];
    ordered.constant[i] = model.mass[i] * load.gravity;
    if (!load.external_force.empty()) ordered.constant[i] += load.external_force[old];
    ordered.is_free[i] = state.condition[old] != NodeCondition::kPrescribed;
  }
  ordered.contacts.assign(load.contacts.begin(), load.contacts.end());
  for (ContactSpring& contact : ordered.contacts) {
    for (std::uint32_t& node : contact.nodes) node = model.new_of_old[node];
  }
}

void Linearise(const OrderedModel& model, const OrderedLoad& load,
               std::span<const std::uint8_t> strand_is_intact, std::span<const Vec3> position,
               Workers& workers, LinkLevel& level, std::span<float> stiffness, Balance& balance) noexcept {
  const std::uint32_t slices = model.layout.Slices();
  const std::uint32_t chunk_slices = std::max(kChunkSlices, slices / Workers::kMaxChunks + 1);
  const std::uint32_t chunks = (slices + chunk_slices - 1) / chunk_slices;
  std::array<ChunkSums, Workers::kMaxChunks> sums;
  const auto nodes_of = [&](std::uint32_t chunk, const auto& work) {
    const std::uint32_t last = std::min(model.Size(), (chunk + 1) * chunk_slices * kSliceNodes);
    for (std::uint32_t i = chunk * chunk_slices * kSliceNodes; i < last; ++i) work(i);
  };
  workers.Run(chunks, [&](std::uint32_t chunk) {
    ChunkSums& sum = sums[chunk];
    nodes_of(chunk, [&](std::uint32_t i) {
      double largest = 0;
      Vec3 force =
          LineariseSprings(model, load.stiffness_scale, position, i, level, stiffness, largest, sum.energy);
      const double shape = load.shape_scale * model.shape[i];
      const Vec3 offset = model.rest[i] - position[i];
      force += shape * offset + load.constant[i];
      // from rest, so that the difference of two energies keeps its digits
      sum.energy += 0.5 * shape * math::SquaredNorm(offset) + math::Dot(load.constant[i], offset);
      largest = std::fmax(largest, shape * math::Norm(offset));
      balance.node_force[i] = std::fmax(largest, math::Norm(load.constant[i]));
      balance.residual[i] = force;
      Symmetric3 ground{};
      AddIsotropic(ground, shape);
      Write(ground, level.ground.data() + std::size_t{i / kSliceNodes} * 6 * kSliceNodes + i % kSliceNodes);
      level.is_free[i] = load.is_free[i] != 0 ? 1.0f : 0.0f;
    });
  });

  // strands and contacts: few, and each changes two or three nodes
  double energy = 0;
  for (const auto& strand : model.strands) {
    const double k = strand_is_intact[strand.strand] ? load.stiffness_scale * strand.stiffness : 0.0;
    const Vec3 offset = (position[strand.other] - position[strand.node]) -
                        (model.rest[strand.other] - model.rest[strand.node]);
    balance.residual[strand.node] += k * offset;
    balance.node_force[strand.node] = std::fmax(balance.node_force[strand.node], k * math::Norm(offset));
    energy += 0.25 * k * math::SquaredNorm(offset);
    Symmetric3 link{};
    AddIsotropic(link, k);
    Write(link,
          level.links.data() + strand.entry / kSliceNodes * 6 * kSliceNodes + strand.entry % kSliceNodes);
    stiffness[strand.entry] = static_cast<float>(k);
  }
  for (const ContactSpring& contact : load.contacts) {
    const double depth = CalcContactDepth(contact, position);
    if (!(depth > 0.0)) continue;
    energy += 0.5 * contact.stiffness * depth * depth;
    for (int corner = 0; corner < 3; ++corner) {
      const double force = contact.weights[corner] * contact.stiffness * depth;
      balance.residual[contact.nodes[corner]] += force * contact.normal;
      balance.node_force[contact.nodes[corner]] =
          std::fmax(balance.node_force[contact.nodes[corner]], std::fabs(force));
    }
  }

  workers.Run(chunks, [&](std::uint32_t chunk) {
    ChunkSums& sum = sums[chunk];
    nodes_of(chunk, [&](std::uint32_t i) {
      // what is not finite fails the comparison, a held node's force included
      sum.is_finite = sum.is_finite && math::SquaredNorm(balance.residual[i]) < INFINITY;
      if (!load.is_free[i]) {
        balance.residual[i] = {};
        return;
      }
      sum.residual2 = std::fmax(sum.residual2, math::SquaredNorm(balance.residual[i]));
      sum.force = std::fmax(sum.force, balance.node_force[i]);
    });
  });
  balance.largest_residual = balance.force_scale = 0;
  balance.is_finite = true;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
    energy += sums[chunk].energy;
    balance.largest_residual = std::fmax(balance.largest_residual, std::sqrt(sums[chunk].residual2));
    balance.force_scale = std::fmax(balance.force_scale, sums[chunk].force);
    balance.is_finite = balance.is_finite && sums[chunk].is_finite;
  }
  balance.energy = energy;
}

}  // namespace trocar::tissue
