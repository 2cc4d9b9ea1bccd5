// SPDX-License-Identifier: Apache-2.0
/// \file chebyshev_jacobi_wang2015.cpp  Jacobi iteration with 3 x 3 blocks, accelerated by Chebyshev's recurrence.
///
/// Each node moves by D_i^-1 R_i, where D_i is the stiffness that the node itself feels. Blocks instead of scalars
/// matter on surfaces: along the surface a node is held by its edges, across it only by its virtual spring, often a
/// thousand times weaker. Every link's stiffness [K -K; -K K] is at most 2 diag(K, K), so the eigenvalues of D^-1 K
/// lie in (0, 2] and the recurrence is stable near equilibrium. Far from it the springs turn, and the blocks no longer
/// bound them: a residual that grows starts the recurrence again with blocks that assume more stiffness across the
/// springs, up to the whole, which bounds every position (Liu et al., "Fast simulation of mass-spring systems", 2013).
/// Source: Wang, "A Chebyshev semi-iterative approach for accelerating projective and position-based dynamics",
/// ACM TOG 34(6), 2015, equations 7 to 9.
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "solver_content.h"

namespace trocar::tissue {
namespace {

/// Share of a spring's stiffness that its node feels across the spring even where the spring is slack: stands for the
/// stiffness that arises as soon as the spring turns, and bounds the step of an unsupported node [-].
constexpr double kTransverseShare = 0.02;
/// Growth of that share at each restart [-].
constexpr double kShareGrowth = 4.0;
/// No node moves farther in one Jacobi step [m]: half a triangle's edge of the built-in organs. While a step is cut
/// short the recurrence waits, because it presumes whole steps.
constexpr double kMaxStep = 0.002;
/// The recurrence starts again after this many iterations at the latest.
constexpr int kMaxCycle = 200;
/// ln(100) / 2: a cycle is tuned to damp what it can reach a hundredfold.
constexpr double kCycleDamping = 2.302585;
/// The residual may grow this much over its smallest value before the acceleration is taken back [-].
constexpr double kGrowthLimit = 4.0;

void AddDirection(Symmetric3& block, const Vec3& u, double stiffness) noexcept {
  block[0] += stiffness * u.x * u.x, block[1] += stiffness * u.x * u.y, block[2] += stiffness * u.x * u.z;
  block[3] += stiffness * u.y * u.y, block[4] += stiffness * u.y * u.z, block[5] += stiffness * u.z * u.z;
}

void AddIsotropic(Symmetric3& block, double stiffness) noexcept {
  block[0] += stiffness, block[3] += stiffness, block[5] += stiffness;
}

/// Inverse of a positive definite block; zero for a node that nothing holds.
Symmetric3 Invert(const Symmetric3& m) noexcept {
  const double c00 = m[3] * m[5] - m[4] * m[4], c01 = m[2] * m[4] - m[1] * m[5], c02 = m[1] * m[4] - m[2] * m[3];
  const double determinant = m[0] * c00 + m[1] * c01 + m[2] * c02;
  if (!(determinant > 0.0)) return {};
  const double s = 1.0 / determinant;
  return {s * c00, s * c01, s * c02, s * (m[0] * m[5] - m[2] * m[2]), s * (m[1] * m[2] - m[0] * m[4]),
          s * (m[0] * m[3] - m[1] * m[1])};
}

Vec3 Multiply(const Symmetric3& m, const Vec3& v) noexcept {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[1] * v.x + m[3] * v.y + m[4] * v.z,
          m[2] * v.x + m[4] * v.y + m[5] * v.z};
}

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
    const double across = std::fmax(transverse_share, 1.0 - half.rest_length / length);
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

/// Force on one node and the square of its largest part.
struct NodeForce {
  Vec3 sum;
  double largest2 = 0;
};

/// std::fmax without its care for NaN, which the state guard finds; a call in the hot loop otherwise.
double Larger(double a, double b) noexcept { return a > b ? a : b; }

/// Adds what acts on a node beside its springs, and notes the largest part.
NodeForce AddOtherForces(const TissueModel& model, const TissueLoad& load, const TissueState& state,
                         const Vec3& springs, double largest_spring, const Vec3& contact_force,
                         std::uint32_t i) noexcept {
  const Vec3 here = state.position[i];
  Vec3 links = springs;
  double largest2 = largest_spring;
  for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
    const auto& strand = model.half_strands[h];
    if (!state.strand_is_intact[strand.strand]) continue;
    const Vec3 pull = strand.stiffness * ((state.position[strand.other] - here) - (model.rest[strand.other] - model.rest[i]));
    links += pull;
    largest2 = Larger(largest2, math::SquaredNorm(pull));
  }
  const Vec3 shape = (load.shape_scale * model.shape_stiffness[i]) * (model.rest[i] - here);
  const Vec3 weight = model.mass[i] * load.gravity;
  NodeForce force{load.stiffness_scale * links + shape + weight + contact_force,
                  load.stiffness_scale * load.stiffness_scale * largest2};
  for (const Vec3& part : {shape, weight, contact_force}) {
    force.largest2 = Larger(force.largest2, math::SquaredNorm(part));
  }
  if (!load.external_force.empty()) {
    force.sum += load.external_force[i];
    force.largest2 = Larger(force.largest2, math::SquaredNorm(load.external_force[i]));
  }
  return force;
}

static_assert(kChunk % kLanes == 0);

/// Runs work(chunk, first, last) over all nodes in chunks of fixed size, on one thread or several.
template <typename Work>
void ForEachChunk(EquilibriumSolver::Content& content, std::uint32_t n, const Work& work) noexcept {
  const std::uint32_t chunks = (n + kChunk - 1) / kChunk;
  const auto run = [&](std::uint32_t chunk) { work(chunk, chunk * kChunk, std::min(n, (chunk + 1) * kChunk)); };
  if (content.threads == 1) {
    for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) run(chunk);
    return;
  }
  content.arena.execute([&] { tbb::parallel_for(std::uint32_t{0}, chunks, run, tbb::static_partitioner()); });
}

void SetContactForce(EquilibriumSolver::Content& content, const TissueLoad& load, const TissueState& state) noexcept {
  for (const ContactSpring& contact : load.contacts) {
    for (const auto node : contact.nodes) content.contact_force[node] = {};
  }
  for (const ContactSpring& contact : load.contacts) {
    const double depth = CalcContactDepth(contact, state.position);
    if (!(depth > 0.0)) continue;
    for (int i = 0; i < 3; ++i) {
      content.contact_force[contact.nodes[i]] += (contact.weights[i] * contact.stiffness * depth) * contact.normal;
    }
  }
}

/// Inverse of each node's own stiffness. A touched node counts as pressed, so that a contact that opens and closes
/// cannot make it jump.
void SetBlocks(EquilibriumSolver::Content& content, const TissueLoad& load, const TissueState& state,
               double transverse_share) noexcept {
  const TissueModel& model = *content.model;
  const auto n = static_cast<std::uint32_t>(model.Size());
  auto& blocks = content.inverse_blocks;
  ForEachChunk(content, n, [&](std::uint32_t, std::uint32_t first, std::uint32_t last) {
    for (auto i = first; i < last; ++i) blocks[i] = CalcBlock(model, load, state, transverse_share, i);
  });
  for (const ContactSpring& contact : load.contacts) {
    for (int i = 0; i < 3; ++i) {
      AddDirection(blocks[contact.nodes[i]], contact.normal, contact.weights[i] * contact.stiffness);
    }
  }
  ForEachChunk(content, n, [&](std::uint32_t, std::uint32_t first, std::uint32_t last) {
    for (auto i = first; i < last; ++i) blocks[i] = Invert(blocks[i]);
  });
}

}  // namespace

SolveReport SolveChebyshevJacobiWang2015(EquilibriumSolver::Content& content, const SolverSettings& settings,
                                         const TissueLoad& load, TissueState& state) noexcept {
  const TissueModel& model = *content.model;
  const auto n = static_cast<std::uint32_t>(model.Size());
  const auto& blocks = content.inverse_blocks;

  const int cycle_length = std::clamp(settings.max_iterations, 1, kMaxCycle);
  // modes whose eigenvalue is below this are out of reach of one cycle
  const double lowest = std::clamp(std::pow(kCycleDamping / cycle_length, 2), 1e-4, 0.5);
  const double rho = (2.0 - lowest) / (2.0 + lowest);
  const double damping = 2.0 / (2.0 + lowest);

  SolveReport report;
  double omega = 1.0, smallest = INFINITY, transverse_share = kTransverseShare;
  int in_cycle = 0;
  SetBlocks(content, load, state, transverse_share);
  while (report.iterations < settings.max_iterations) {
    omega = in_cycle == 0 ? 1.0 : in_cycle == 1 ? 2.0 / (2.0 - rho * rho) : 4.0 / (4.0 - rho * rho * omega);
    SetContactForce(content, load, state);
    ForEachChunk(content, n, [&](std::uint32_t chunk, std::uint32_t first, std::uint32_t last) {
      double largest_residual = 0, largest_force = 0;
      bool is_cut_short = false;
      SliceForce springs;
      for (auto i = first; i < last; ++i) {
        const std::uint32_t lane = i % kLanes;
        if (lane == 0) GatherSlice(content.springs, state.position.data(), n, i / kLanes, springs);
        const Vec3 here = state.position[i];
        if (state.condition[i] == NodeCondition::kPrescribed) {
          content.previous[i] = here;
          continue;
        }
        const NodeForce force = AddOtherForces(model, load, state, {springs.x[lane], springs.y[lane], springs.z[lane]},
                                               springs.largest_squared[lane], content.contact_force[i], i);
        largest_residual = Larger(largest_residual, math::SquaredNorm(force.sum));
        largest_force = Larger(largest_force, force.largest2);
        Vec3 step = damping * Multiply(blocks[i], force.sum);
        const double length2 = math::SquaredNorm(step);
        if (length2 > kMaxStep * kMaxStep) {
          step *= kMaxStep / std::sqrt(length2);
          is_cut_short = true;
        }
        const Vec3 before = in_cycle == 0 ? here : content.previous[i];
        content.previous[i] = omega * ((here + step) - before) + before;  // becomes the current one below
      }
      content.chunk_residual[chunk] = std::sqrt(largest_residual);
      content.chunk_scale[chunk] = std::sqrt(largest_force);
      content.chunk_is_cut_short[chunk] = is_cut_short;
    });
    double residual = 0, scale = 0;
    bool is_cut_short = false;
    for (std::uint32_t chunk = 0; chunk * kChunk < n; ++chunk) {
      residual = Larger(residual, content.chunk_residual[chunk]);
      scale = Larger(scale, content.chunk_scale[chunk]);
      is_cut_short = is_cut_short || content.chunk_is_cut_short[chunk] != 0;
    }
    report.force_scale = scale;
    report.residual = scale > 0.0 ? residual / scale : 0.0;
    report.converged = report.residual <= settings.tolerance;
    if (report.converged) break;  // the state's positions are those the residual belongs to

    ++report.iterations;
    std::swap(state.position, content.previous);
    ++in_cycle;
    smallest = std::fmin(smallest, residual);
    if (residual > kGrowthLimit * smallest) {
      transverse_share = std::fmin(kShareGrowth * transverse_share, 1.0);
      smallest = residual;
      in_cycle = 0;
      ++report.restarts;
    } else if (in_cycle == cycle_length || is_cut_short) {
      in_cycle = 0;
    }
    if (in_cycle == 0 && report.iterations < settings.max_iterations) SetBlocks(content, load, state, transverse_share);
  }
  for (const ContactSpring& contact : load.contacts) {
    for (const auto node : contact.nodes) content.contact_force[node] = {};
  }
  return report;
}

}  // namespace trocar::tissue
