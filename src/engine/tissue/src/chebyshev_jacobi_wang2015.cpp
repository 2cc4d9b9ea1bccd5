// SPDX-License-Identifier: Apache-2.0
/// \file chebyshev_jacobi_wang2015.cpp  Jacobi iteration with 3 x 3 blocks, accelerated by Chebyshev's
/// recurrence.
///
/// Each node moves by D_i^-1 R_i, where D_i is the stiffness that the node itself feels. Blocks instead of
/// scalars matter on surfaces: along the surface a node is held by its edges, across it only by its virtual
/// spring, often a thousand times weaker. Every link's stiffness [K -K; -K K] is at most 2 diag(K, K), so the
/// eigenvalues of D^-1 K lie in (0, 2] and the recurrence is stable near equilibrium. Far from it the springs
/// turn, and the blocks no longer bound them: a residual that grows starts the recurrence again with blocks
/// that assume more stiffness across the springs, up to the whole, which bounds every position (Liu et al.,
/// "Fast simulation of mass-spring systems", 2013).
/// Source: Wang, "A Chebyshev semi-iterative approach for accelerating projective and position-based
/// dynamics", ACM TOG 34(6), 2015, equations 7 to 9.
#include <algorithm>
#include <cmath>

#include "solver_content.h"
#include "trocar/base/spare_capacity.h"
#include "trocar/tissue/element_kinds.h"

namespace trocar::tissue {

using math::Symmetric3;
using math::Vec3;

namespace {

using math::AddIsotropic;
using math::Invert;

/// Share of a spring's stiffness that its node feels across the spring even where the spring is slack: stands
/// for the stiffness that arises as soon as the spring turns, and bounds the step of an unsupported node [-].
constexpr double kTransverseShare = 0.2;
/// Growth of that share at each restart [-].
constexpr double kShareGrowth = 4.0;
/// No node moves farther in one Jacobi step [m]: half a triangle's edge of the built-in organs. While a step
/// is cut short the recurrence waits, because it presumes whole steps.
constexpr double kMaxStep = 0.002;
/// The recurrence starts again after this many iterations, then after twice as many, and so on: how weak the
/// weakest mode is need not be known, and what a short cycle can reach is not kept waiting by a long one.
constexpr int kFirstCycle = 40;
constexpr int kLongestCycle = 1280;
/// ln(100) / 2: a cycle is tuned to damp what it can reach a hundredfold.
constexpr double kCycleDamping = 2.302585;
/// The residual may grow this much over its smallest value before the acceleration is taken back [-].
constexpr double kGrowthLimit = 4.0;

Symmetric3 CalcBlock(const TissueModel& model, const TissueLoad& load, const TissueState& state,
                     double transverse_share, std::uint32_t i) noexcept {
  Symmetric3 block{};
  const Vec3 here = state.position[i];
  for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
    const auto& half = model.half_springs[h];
    const Vec3 along = state.position[half.other] - here;
    const double length = math::Norm(along);
    const double stiffness = load.stiffness_scale * half.stiffness;
    if (!(length > 0.0)) {
      AddIsotropic(block, stiffness);
      continue;
    }
    const double across = math::Max(transverse_share, 1.0 - half.rest_length / length);
    AddDirection(block, along / length, stiffness * (1.0 - across));
    AddIsotropic(block, stiffness * across);
  }
  for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
    const auto& half = model.half_strands[h];
    if (state.strand_is_intact[half.strand]) AddIsotropic(block, load.stiffness_scale * half.stiffness);
  }
  AddIsotropic(block, load.shape_scale * model.shape_stiffness[i]);
  return block;
}

/// math::Max without its care for NaN, which the state guard finds: one comparison in the hot loop.
double Larger(double a, double b) noexcept {
  return a > b ? a : b;
}

/// Runs work(chunk, first, last) over all nodes in chunks of fixed size, on one thread or several.
template <typename Work>
void ForEachChunk(Workers& workers, std::uint32_t n, const Work& work) noexcept {
  const std::uint32_t size = CalcChunk(n);
  workers.Run((n + size - 1) / size,
              [&](std::uint32_t chunk) { work(chunk, chunk * size, std::min(n, (chunk + 1) * size)); });
}

/// Refills the forces that change with the positions of few nodes: strands, contacts and elements.
void SetOtherForces(const TissueModel& model, const TissueLoad& load, const TissueState& state,
                    ChebyshevScratch& scratch) noexcept {
  const auto set = [&](std::uint32_t i, const Vec3& force) {
    for (int axis = 0; axis < 3; ++axis)
      scratch.slices[i / kLanes].other_force[axis][i % kLanes] = force[axis];
  };
  const auto add = [&](std::uint32_t i, const Vec3& force) {
    for (int axis = 0; axis < 3; ++axis)
      scratch.slices[i / kLanes].other_force[axis][i % kLanes] += force[axis];
  };
  for (const std::uint32_t i : scratch.touched_nodes) set(i, scratch.constant_force[i]);
  for (const std::uint32_t i : scratch.strand_nodes) {
    Vec3 pull;
    for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
      const auto& strand = model.half_strands[h];
      if (!state.strand_is_intact[strand.strand]) continue;
      pull += strand.stiffness * ((state.position[strand.other] - state.position[i]) -
                                  (model.rest[strand.other] - model.rest[i]));
    }
    set(i, scratch.constant_force[i] + load.stiffness_scale * pull);
  }
  for (const ContactSpring& contact : load.contacts) {
    const double depth = CalcContactDepth(contact, state.position);
    if (!(depth > 0.0)) continue;
    for (int i = 0; i < 3; ++i)
      add(contact.nodes[i], (contact.weights[i] * contact.stiffness * depth) * contact.normal);
  }
  if (!HasElements(load)) return;
  load.elements->ForEach([&](const auto& element) {
    const auto forces = CalcElementForce(
        element, GatherPositions(element, [&](std::uint32_t node) { return state.position[node]; }));
    for (std::size_t i = 0; i < forces.size(); ++i) add(element.nodes[i], forces[i]);
  });
}

/// Weight and external force of every node; strands and contacts are added in every iteration.
void SetConstantForces(const TissueModel& model, const TissueLoad& load, ChebyshevScratch& scratch) noexcept {
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    Vec3 force = model.mass[i] * load.gravity;
    if (!load.external_force.empty()) force += load.external_force[i];
    scratch.constant_force[i] = force;
    for (int axis = 0; axis < 3; ++axis)
      scratch.slices[i / kLanes].other_force[axis][i % kLanes] = force[axis];
  }
}

/// Sets what stays for the whole solve.
void SetSlices(const TissueModel& model, const TissueLoad& load, const TissueState& state,
               ChebyshevScratch& scratch) noexcept {
  const auto n = static_cast<std::uint32_t>(model.Size());
  for (std::uint32_t i = 0; i < n; ++i) {
    SliceData& data = scratch.slices[i / kLanes];
    const std::uint32_t lane = i % kLanes;
    data.shape_stiffness[lane] = load.shape_scale * model.shape_stiffness[i];
    data.is_free[lane] = state.condition[i] == NodeCondition::kPrescribed ? 0.0 : 1.0;
    for (int axis = 0; axis < 3; ++axis) data.rest[axis][lane] = model.rest[i][axis];
  }
  SetConstantForces(model, load, scratch);
  scratch.touched_nodes.clear();
  for (const ContactSpring& contact : load.contacts) {
    if (scratch.touched_nodes.size() + 3 > scratch.touched_nodes.capacity()) break;
    scratch.touched_nodes.insert(scratch.touched_nodes.end(), contact.nodes.begin(), contact.nodes.end());
  }
  if (!HasElements(load)) return;
  load.elements->ForEach([&](const auto& element) {
    scratch.touched_nodes.insert(scratch.touched_nodes.end(), element.nodes.begin(), element.nodes.end());
  });
}

/// Inverse of each node's own stiffness. A touched node counts as pressed, so that a contact that opens and
/// closes cannot make it jump.
void SetBlocks(const TissueModel& model, Workers& workers, const TissueLoad& load, const TissueState& state,
               double transverse_share, ChebyshevScratch& scratch) noexcept {
  const auto n = static_cast<std::uint32_t>(model.Size());
  auto& blocks = scratch.blocks;
  ForEachChunk(workers, n, [&](std::uint32_t, std::uint32_t first, std::uint32_t last) {
    for (auto i = first; i < last; ++i) blocks[i] = CalcBlock(model, load, state, transverse_share, i);
  });
  for (const ContactSpring& contact : load.contacts) {
    for (int i = 0; i < 3; ++i) {
      AddDirection(blocks[contact.nodes[i]], contact.normal, contact.weights[i] * contact.stiffness);
    }
  }
  if (HasElements(load)) {
    const auto position_at = [&](std::uint32_t node) { return state.position[node]; };
    const auto is_free = [&](std::uint32_t node) {
      return state.condition[node] != NodeCondition::kPrescribed;
    };
    SetElementMatrix(*load.elements, position_at, StiffnessPart::kBound, is_free, scratch.element_bound);
    scratch.element_bound.ForEachBound([&](std::uint32_t node, const Symmetric3& own) {
      for (std::size_t v = 0; v < own.size(); ++v) blocks[node][v] += own[v];
    });
  }
  ForEachChunk(workers, n, [&](std::uint32_t, std::uint32_t first, std::uint32_t last) {
    for (auto i = first; i < last; ++i) {
      const bool is_free = state.condition[i] != NodeCondition::kPrescribed;
      const Symmetric3 inverse = is_free ? Invert(blocks[i]) : Symmetric3{};
      for (int entry = 0; entry < 6; ++entry)
        scratch.slices[i / kLanes].inverse_block[entry][i % kLanes] = inverse[entry];
    }
  });
}

}  // namespace

ChebyshevScratch::ChebyshevScratch(const TissueModel& model, double spare_share) {
  const std::size_t n = model.Size();
  previous.resize(n);
  blocks.resize(n);
  slices.resize((n + kLanes - 1) / kLanes, SliceData{});
  constant_force.resize(n);
  touched_nodes.reserve(3 * kMaxContacts + ElementArrays::kNodeCapacity);
  element_bound.Reserve();
  chunk_reports.resize(n / CalcChunk(n) + 1);
  base::ReserveWithSpare(model.half_strands.size(), spare_share, strand_nodes);
  SetModel(model);
}

void ChebyshevScratch::SetModel(const TissueModel& model) {
  strand_nodes.clear();
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    if (model.strand_starts[i] < model.strand_starts[i + 1]) strand_nodes.push_back(i);
  }
}

SolveReport SolveChebyshevJacobiWang2015(const LinearisedModel& springs, ChebyshevScratch& scratch,
                                         Workers& workers, const IterationSettings& settings,
                                         const TissueLoad& load, TissueState& state,
                                         ConstraintSet* constraints) noexcept {
  const TissueModel& model = springs.model;
  const auto n = static_cast<std::uint32_t>(model.Size());
  SetSlices(model, load, state, scratch);
  double transverse_share = kTransverseShare;
  SetBlocks(model, workers, load, state, transverse_share, scratch);
  SolveReport report;
  int cycle_length = std::min(settings.max_iterations, kFirstCycle);
  StepFactors factors{load.stiffness_scale, 1.0, 1.0, kMaxStep, true};
  double smallest = INFINITY, rho = 0.0;
  int in_cycle = 0;
  while (report.iterations < settings.max_iterations) {
    factors.is_first = in_cycle == 0;
    if (in_cycle == 0) {
      // modes whose eigenvalue is below `lowest` are out of reach of this cycle
      const double root = kCycleDamping / cycle_length;
      const double lowest = std::min(root * root, 0.5);
      factors.damping = 2.0 / (2.0 + lowest);
      rho = (2.0 - lowest) / (2.0 + lowest);
    }
    factors.omega = in_cycle == 0   ? 1.0
                    : in_cycle == 1 ? 2.0 / (2.0 - rho * rho)
                                    : 4.0 / (4.0 - rho * rho * factors.omega);
    SetOtherForces(model, load, state, scratch);
    ForEachChunk(workers, n, [&](std::uint32_t chunk, std::uint32_t first, std::uint32_t last) {
      SliceReport slice_report;
      for (std::uint32_t slice = first / kLanes; slice * kLanes < last; ++slice) {
        UpdateSlice(springs.sliced, scratch.slices[slice], factors, state.position.data(),
                    scratch.previous.data(), n, slice, slice_report);
      }
      scratch.chunk_reports[chunk] = slice_report;
    });
    SliceReport all;
    for (std::uint32_t chunk = 0; chunk * CalcChunk(n) < n; ++chunk) {
      const SliceReport& part = scratch.chunk_reports[chunk];
      all.residual2 = Larger(all.residual2, part.residual2);
      all.force2 = Larger(all.force2, part.force2);
      all.is_cut_short = all.is_cut_short || part.is_cut_short;
    }
    const double residual = std::sqrt(all.residual2);
    report.force_scale = std::sqrt(all.force2);
    report.residual = report.force_scale > 0.0 ? residual / report.force_scale : 0.0;
    report.converged = report.residual <= settings.tolerance;
    if (report.converged) break;  // the state's positions are those the residual belongs to

    ++report.iterations;
    std::swap(state.position, scratch.previous);
    ++in_cycle;
    if (constraints != nullptr && report.iterations % constraints->Interval() == 0) {
      constraints->Project(state, scratch.previous);
      SetConstantForces(model, load, scratch);
    }
    smallest = math::Min(smallest, residual);
    if (residual > kGrowthLimit * smallest) {
      transverse_share = math::Min(kShareGrowth * transverse_share, 1.0);
      smallest = residual;
      in_cycle = 0;
      ++report.restarts;
    } else if (in_cycle == cycle_length || all.is_cut_short) {
      if (in_cycle == cycle_length) cycle_length = std::min(2 * cycle_length, kLongestCycle);
      in_cycle = 0;
    }
    if (in_cycle == 0 && report.iterations < settings.max_iterations)
      SetBlocks(model, workers, load, state, transverse_share, scratch);
  }
  return report;
}

}  // namespace trocar::tissue
