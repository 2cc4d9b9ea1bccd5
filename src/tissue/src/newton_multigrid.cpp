// SPDX-License-Identifier: Apache-2.0
#include "newton_multigrid.h"

#include <algorithm>
#include <cmath>

#include "node_vectors.h"

namespace trocar::tissue {
namespace {

/// The part of the tolerated error that the linear solution may leave [-].
constexpr double kLinearShare = 0.3;
/// The preconditioned residual sees at least this part of the error [-]; measured, see docs/tissue.md.
constexpr double kEstimateShare = 0.2;
/// Longest move of a node in the first Newton step, in mean spring lengths [-]: the stiffness is that of
/// springs that have not turned far. Conjugate gradients stop where they leave this range (Steihaug, "The
/// conjugate gradient method and trust regions in large scale optimization", SIAM J. Numer. Anal. 20, 1983):
/// by then the stiff part of the step is solved, and the soft one goes on in the next step.
constexpr double kFirstRadius = 0.1;
/// The range grows by this where a step used all of it and lowered the energy as predicted, and shrinks to as
/// many times what was left of a step that did not [-].
constexpr double kRadiusGrowth = 2.0;
/// Halvings of a step that does not lower the energy.
constexpr int kMaxHalvings = 6;
/// Part of the predicted loss of energy that a step must bring (Armijo) [-].
constexpr double kLeastDecrease = 1e-4;
/// Rounding of the energy, as a part of it [-].
constexpr double kEnergyRounding = 1e-12;
/// Conjugate gradients end where r . z, of single precision, has fallen to this part of its start [-]: from a state
/// at rest the tolerance is zero, and what follows is rounding.
constexpr double kLinearRounding = 1e-12;
constexpr std::uint8_t kNoConstraint = 255;

Float4 ToFloat(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0.0f};
}
Vec3 ToDouble(const Float4& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

double FindLongest(Workers& workers, const std::vector<Float4>& vectors) noexcept {
  return std::sqrt(FindLargestOfNodes(workers, vectors.size(),
                                      [&](std::uint32_t i) { return Dot(vectors[i], vectors[i]); }));
}

}  // namespace

NewtonMultigrid::NewtonMultigrid(const TissueModel& model)
    : model_(MakeOrderedModel(model)), hierarchy_(model_.graph, model_.graph_stiffness) {
  const std::size_t n = model_.Size(), padded = model_.layout.PaddedNodes();
  load_.constant.resize(n);
  load_.is_free.resize(n);
  load_.contacts.reserve(kMaxContacts);
  stiffness_.resize(model_.layout.Steps() * kSliceNodes);
  position_.resize(n), start_.resize(n);
  balance_.residual.resize(n), balance_.node_force.resize(n);
  is_pressing_.resize(kMaxContacts);
  for (auto* vector : {&step_, &r_, &z_, &p_, &q_}) vector->resize(padded);
  constraint_of_node_.assign(n, kNoConstraint);
  gradient_.resize(padded);
  for (auto& answer : answers_) answer.resize(padded);
  double sum = 0;
  std::size_t count = 0;
  for (const double rest : model_.rest_length) sum += rest, count += rest > 0.0;
  edge_length_ = count > 0 ? sum / static_cast<double>(count) : 0.0;
}

void NewtonMultigrid::AddContactGround() noexcept {
  auto& ground = hierarchy_.Finest().ground;
  for (std::size_t c = 0; c < load_.contacts.size(); ++c) {
    const ContactSpring& contact = load_.contacts[c];
    is_pressing_[c] = CalcContactDepth(contact, position_) > 0.0;
    if (!is_pressing_[c]) continue;
    for (int corner = 0; corner < 3; ++corner) {
      Symmetric3 m{};
      AddDirection(m, contact.normal, contact.weights[corner] * contact.stiffness);
      const std::uint32_t i = contact.nodes[corner];
      for (std::size_t v = 0; v < 6; ++v) {
        ground[(std::size_t{i / kSliceNodes} * 6 + v) * kSliceNodes + i % kSliceNodes] +=
            static_cast<float>(m[v]);
      }
    }
  }
}

void NewtonMultigrid::Multiply(const Kernels& kernels, Workers& workers, const Float4* x,
                               Float4* out) noexcept {
  RunPass(kernels, workers, hierarchy_.Finest(), LinkPass::kProduct, x, nullptr, 0.0f, out);
  // a contact's ground stands for each corner alone; what it does to the corners together makes up the rest
  for (std::size_t c = 0; c < load_.contacts.size(); ++c) {
    if (!is_pressing_[c]) continue;
    const ContactSpring& contact = load_.contacts[c];
    double along[3], together = 0;
    for (int corner = 0; corner < 3; ++corner) {
      along[corner] = math::Dot(contact.normal, ToDouble(x[contact.nodes[corner]]));
      together += contact.weights[corner] * along[corner];
    }
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t node = contact.nodes[corner];
      if (!load_.is_free[node]) continue;
      const double force = contact.weights[corner] * contact.stiffness * (together - along[corner]);
      out[node] = ToFloat(ToDouble(out[node]) + force * contact.normal);
    }
  }
}

void NewtonMultigrid::SetConstraints(const Kernels& kernels, Workers& workers,
                                     const SolveHook* hook) noexcept {
  constraint_count_ = 0;
  if (hook == nullptr || hook->constraints.empty()) return;
  std::fill(constraint_of_node_.begin(), constraint_of_node_.end(), kNoConstraint);
  std::fill(gradient_.begin(), gradient_.end(), Float4{});
  for (std::size_t index = 0; index < hook->constraints.size(); ++index) {
    if (!hook->is_active(hook->self, index)) continue;
    const auto place = static_cast<std::uint8_t>(constraint_count_);
    const SolveHook::Constraint& constraint = hook->constraints[index];
    std::fill(q_.begin(), q_.end(), Float4{});
    for (std::uint32_t k = 0; k < constraint.node_count; ++k) {
      const std::uint32_t i = model_.new_of_old[constraint.first_node + k];
      if (!load_.is_free[i]) continue;
      constraint_of_node_[i] = place;
      q_[i] = gradient_[i] = ToFloat(hook->gradient[constraint.first_node + k]);
    }
    hierarchy_.Apply(kernels, workers, q_.data(), answers_[place].data());
    constraint_index_[place] = index;
    ++constraint_count_;
  }
  for (auto& row : gram_) row.fill(0.0);
  for (std::uint32_t i = 0; i < model_.Size(); ++i) {
    if (constraint_of_node_[i] == kNoConstraint) continue;
    for (std::size_t b = 0; b < constraint_count_; ++b)
      gram_[constraint_of_node_[i]][b] += Dot(gradient_[i], answers_[b][i]);
  }
}

void NewtonMultigrid::Precondition(const Kernels& kernels, Workers& workers) noexcept {
  hierarchy_.Apply(kernels, workers, r_.data(), z_.data());
  multipliers_.fill(0.0);
  if (constraint_count_ == 0) return;
  std::array<double, kMaxHookConstraints> along{};
  for (std::uint32_t i = 0; i < model_.Size(); ++i) {
    if (constraint_of_node_[i] != kNoConstraint) along[constraint_of_node_[i]] += Dot(gradient_[i], z_[i]);
  }
  // few and well apart: elimination without pivots; the matrix is positive definite
  auto matrix = gram_;
  for (std::size_t c = 0; c < constraint_count_; ++c) {
    for (std::size_t row = c + 1; row < constraint_count_; ++row) {
      const double factor = matrix[c][c] > 0.0 ? matrix[row][c] / matrix[c][c] : 0.0;
      for (std::size_t k = c; k < constraint_count_; ++k) matrix[row][k] -= factor * matrix[c][k];
      along[row] -= factor * along[c];
    }
  }
  for (std::size_t c = constraint_count_; c-- > 0;) {
    double sum = along[c];
    for (std::size_t k = c + 1; k < constraint_count_; ++k) sum -= matrix[c][k] * multipliers_[k];
    multipliers_[c] = matrix[c][c] > 0.0 ? sum / matrix[c][c] : 0.0;
  }
  for (std::size_t c = 0; c < constraint_count_; ++c) {
    const auto m = static_cast<float>(multipliers_[c]);
    const std::vector<Float4>& answer = answers_[c];
    ForEachNodeChunk(workers, z_.size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
      for (std::uint32_t i = first; i < last; ++i) {
        z_[i].x -= m * answer[i].x, z_[i].y -= m * answer[i].y, z_[i].z -= m * answer[i].z;
      }
    });
  }
}

NewtonMultigrid::LinearReport NewtonMultigrid::SolveLinear(const Kernels& kernels, Workers& workers,
                                                           int max_iterations, double tolerance,
                                                           double radius) noexcept {
  LinearReport report;
  const std::size_t n = step_.size();
  std::fill(step_.begin(), step_.end(), Float4{});
  // z_ is the preconditioned residual already
  std::copy(z_.begin(), z_.end(), p_.begin());
  double reached = 0;  // bound of the longest move so far
  double rz = SumOverNodes(workers, n, [&](std::uint32_t i) { return Dot(r_[i], z_[i]); });
  const double rounding = kLinearRounding * rz;
  while (report.iterations < max_iterations && rz > rounding) {
    Multiply(kernels, workers, p_.data(), q_.data());
    const double pq = SumOverNodes(workers, n, [&](std::uint32_t i) { return Dot(p_[i], q_[i]); });
    report.met_negative_curvature = !(pq > 0.0);
    const double longest = FindLongest(workers, p_);
    // along a direction of negative curvature the energy only falls: as far as the range reaches
    double length = report.met_negative_curvature ? INFINITY : rz / pq;
    const bool is_leaving = reached + length * longest > radius;
    report.reached_radius = is_leaving;
    if (is_leaving) length = std::fmax(0.0, radius - reached) / longest;
    reached += length * longest;
    const auto alpha = static_cast<float>(length);
    ForEachNodeChunk(workers, n, [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
      for (std::uint32_t i = first; i < last; ++i) {
        step_[i].x += alpha * p_[i].x, step_[i].y += alpha * p_[i].y, step_[i].z += alpha * p_[i].z;
        r_[i].x -= alpha * q_[i].x, r_[i].y -= alpha * q_[i].y, r_[i].z -= alpha * q_[i].z;
      }
    });
    ++report.iterations;
    if (is_leaving && constraint_count_ == 0) break;
    Precondition(kernels, workers);
    if (is_leaving) break;
    if (FindLongest(workers, z_) <= tolerance) break;
    const double next = SumOverNodes(workers, n, [&](std::uint32_t i) { return Dot(r_[i], z_[i]); });
    const auto beta = static_cast<float>(next / rz);
    rz = next;
    ForEachNodeChunk(workers, n, [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
      for (std::uint32_t i = first; i < last; ++i) {
        p_[i] = {z_[i].x + beta * p_[i].x, z_[i].y + beta * p_[i].y, z_[i].z + beta * p_[i].z, 0.0f};
      }
    });
  }
  return report;
}

SolveReport NewtonMultigrid::Solve(const Kernels& kernels, Workers& workers, const SolverSettings& settings,
                                   const TissueLoad& load, TissueState& state,
                                   const SolveHook* hook) noexcept {
  const std::uint32_t n = model_.Size();
  SetOrderedLoad(model_, load, state, load_);
  for (std::uint32_t i = 0; i < n; ++i) position_[i] = state.position[model_.old_of_new[i]];

  SolveReport report;
  const auto linearise = [&] {
    Linearise(model_, load_, state.strand_is_intact, position_, workers, hierarchy_.Finest(), stiffness_,
              balance_);
    AddContactGround();
  };
  const auto write_back = [&] {
    for (std::uint32_t i = 0; i < n; ++i) {
      if (load_.is_free[i]) state.position[model_.old_of_new[i]] = position_[i];
    }
  };
  const auto call_hook = [&] {
    if (hook == nullptr) return;
    write_back();
    for (std::size_t c = 0; c < constraint_count_; ++c)
      hook->add_multiplier(hook->self, constraint_index_[c], -multipliers_[c]);
    hook->act(hook->self, state, {});
    for (std::uint32_t i = 0; i < n; ++i) position_[i] = state.position[model_.old_of_new[i]];
    SetOrderedLoad(model_, load, state, load_);
    linearise();
  };
  double scale = 0;  // largest distance from rest [m]
  // estimate of the distance to the equilibrium; leaves the preconditioned residual in z_
  const auto estimate = [&] {
    ForEachNodeChunk(workers, n, [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
      for (std::uint32_t i = first; i < last; ++i) r_[i] = ToFloat(balance_.residual[i]);
    });
    SetConstraints(kernels, workers, hook);
    Precondition(kernels, workers);
    scale = std::sqrt(FindLargestOfNodes(
        workers, n, [&](std::uint32_t i) { return math::SquaredDistance(position_[i], model_.rest[i]); }));
    const double largest = FindLongest(workers, z_);
    report.error = scale > 0.0 ? largest / (kEstimateShare * scale) : largest > 0.0 ? INFINITY : 0.0;
    report.residual = balance_.force_scale > 0.0 ? balance_.largest_residual / balance_.force_scale : 0.0;
    report.force_scale = balance_.force_scale;
    report.converged = report.error <= settings.max_error;
  };

  double radius = edge_length_ > 0.0 ? kFirstRadius * edge_length_ : INFINITY;
  linearise();
  hierarchy_.Update(stiffness_);
  estimate();
  while (!report.converged && report.iterations < settings.max_newton_steps && balance_.is_finite) {
    const double before = balance_.energy;
    const double tolerance = kLinearShare * kEstimateShare * settings.max_error * scale;
    const auto first_multipliers = multipliers_;
    const LinearReport linear =
        SolveLinear(kernels, workers, settings.max_linear_iterations, tolerance, radius);
    report.linear_iterations += linear.iterations;
    report.negative_curvatures += linear.met_negative_curvature;
    const double length = FindLongest(workers, step_);
    if (!(length > 0.0 && length < INFINITY)) break;
    const double slope = -SumOverNodes(
        workers, n, [&](std::uint32_t i) { return math::Dot(balance_.residual[i], ToDouble(step_[i])); });
    double share = 1.0;
    std::copy(position_.begin(), position_.end(), start_.begin());
    bool is_lower = false;
    for (int halving = 0; halving <= kMaxHalvings && !is_lower; ++halving, share *= 0.5) {
      for (std::uint32_t i = 0; i < n; ++i) position_[i] = start_[i] + share * ToDouble(step_[i]);
      linearise();
      is_lower = balance_.is_finite && balance_.energy <= before + kLeastDecrease * share * slope +
                                                              kEnergyRounding * std::fabs(before);
      report.restarts += !is_lower;
    }
    ++report.iterations;
    share *= 2.0;  // the one that was tried last
    if (share < 1.0) {
      radius = kRadiusGrowth * share * length;
    } else if (linear.reached_radius) {
      radius *= kRadiusGrowth;
    }
    if (!is_lower) {
      std::copy(start_.begin(), start_.end(), position_.begin());
      linearise();
      hierarchy_.Update(stiffness_);
      estimate();
      break;
    }
    // what the constraints carry of the residual after this part of the step
    for (std::size_t c = 0; c < constraint_count_; ++c)
      multipliers_[c] =
          std::fmin(share, 1.0) * multipliers_[c] + (1.0 - std::fmin(share, 1.0)) * first_multipliers[c];
    // a constraint is kept after every step, whatever the hook's interval: a step here is worth many
    // iterations
    call_hook();
    hierarchy_.Update(stiffness_);
    estimate();
  }
  write_back();
  return report;
}

}  // namespace trocar::tissue
