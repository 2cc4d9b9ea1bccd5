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
/// Coarser levels are computed again when a node may have gone so far, in mean spring lengths [-]: they follow
/// the springs' directions, which have hardly turned before.
constexpr double kStaleMove = 0.2;
constexpr std::uint8_t kNoConstraint = 255;

Float4 ToFloat(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0.0f};
}
Vec3 ToDouble(const Float4& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

}  // namespace

NewtonMultigrid::NewtonMultigrid(const TissueModel& model)
    : model_(MakeOrderedModel(model)),
      hierarchy_(model_.graph, model_.graph_stiffness),
      linearisation_(model_) {
  const std::size_t n = model_.Size(), padded = model_.layout.PaddedNodes();
  load_.constant.resize(n);
  load_.is_free.resize(n);
  load_.contacts.reserve(kMaxContacts);
  position_.resize(padded), start_.resize(padded);
  balance_.residual.resize(padded);
  balance_.is_pressing.resize(kMaxContacts);
  for (auto* vector : {&step_, &r_, &z_, &p_, &q_}) vector->resize(padded);
  constraint_of_node_.assign(n, kNoConstraint);
  gradient_.resize(padded);
  for (auto& answer : answers_) answer.resize(padded);
  double sum = 0;
  std::size_t count = 0;
  for (const double rest : model_.rest_length) sum += rest, count += rest > 0.0;
  edge_length_ = count > 0 ? sum / static_cast<double>(count) : 0.0;
}

void NewtonMultigrid::Multiply(const Kernels& kernels, Workers& workers, const Float4* x,
                               Float4* out) noexcept {
  RunPass(kernels, workers, hierarchy_.Finest(), LinkPass::kProduct, x, nullptr, 0.0f, out);
  // a contact's ground stands for each corner alone; what it does to the corners together makes up the rest
  for (std::size_t c = 0; c < load_.contacts.size(); ++c) {
    if (!balance_.is_pressing[c]) continue;
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
        z_[i].x -= m * answer[i].x, z_[i].y -= m * answer[i].y, z_[i].z -= m * answer[i].z,
            z_[i].w -= m * answer[i].w;
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
  double rz = CalcDot(kernels, workers, r_, z_);
  const double rounding = kLinearRounding * rz;
  while (report.iterations < max_iterations && rz > rounding) {
    Multiply(kernels, workers, p_.data(), q_.data());
    const double pq = CalcDot(kernels, workers, p_, q_);
    report.met_negative_curvature = !(pq > 0.0);
    const double longest = FindLongest(kernels, workers, p_);
    // along a direction of negative curvature the energy only falls: as far as the range reaches
    double length = report.met_negative_curvature ? INFINITY : rz / pq;
    const bool is_leaving = reached + length * longest > radius;
    report.reached_radius = is_leaving;
    if (is_leaving) length = std::fmax(0.0, radius - reached) / longest;
    reached += length * longest;
    const auto alpha = static_cast<float>(length);
    ForEachNodeChunk(workers, n, [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
      kernels.vectors.advance(alpha, p_.data(), q_.data(), step_.data(), r_.data(), first, last);
    });
    ++report.iterations;
    if (is_leaving && constraint_count_ == 0) break;
    Precondition(kernels, workers);
    if (is_leaving) break;
    if (FindLongest(kernels, workers, z_) <= tolerance) break;
    const double next = CalcDot(kernels, workers, r_, z_);
    const auto beta = static_cast<float>(next / rz);
    rz = next;
    ForEachNodeChunk(workers, n, [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
      kernels.vectors.scale_and_add(beta, z_.data(), p_.data(), first, last);
    });
  }
  return report;
}

SolveReport NewtonMultigrid::Solve(const Kernels& kernels, Workers& workers, const SolverSettings& settings,
                                   const TissueLoad& load, TissueState& state,
                                   const SolveHook* hook) noexcept {
  const std::uint32_t n = model_.Size();
  const auto set_load = [&] {
    SetOrderedLoad(model_, load, state, load_);
    linearisation_.SetLoad(load_, state.strand_is_intact, hierarchy_.Finest());
  };
  const auto read_positions = [&] {
    for (std::uint32_t i = 0; i < n; ++i) {
      const Vec3& p = state.position[model_.old_of_new[i]];
      position_[i] = {p.x, p.y, p.z, 0.0};
    }
  };
  const auto write_back = [&] {
    for (std::uint32_t i = 0; i < n; ++i) {
      if (load_.is_free[i])
        state.position[model_.old_of_new[i]] = {position_[i].x, position_[i].y, position_[i].z};
    }
  };
  set_load();
  read_positions();

  SolveReport report;
  const auto linearise = [&] {
    linearisation_.Linearise(kernels, workers, position_, hierarchy_.Finest(), balance_);
  };
  const auto call_hook = [&] {
    if (hook == nullptr) return;
    write_back();
    for (std::size_t c = 0; c < constraint_count_; ++c)
      hook->add_multiplier(hook->self, constraint_index_[c], -multipliers_[c]);
    hook->act(hook->self, state, {});
    read_positions();
    set_load();
  };
  double scale = 0;  // largest distance from rest [m]
  // estimate of the distance to the equilibrium; leaves the preconditioned residual in z_
  const auto estimate = [&] {
    std::copy(balance_.residual.begin(), balance_.residual.end(), r_.begin());
    SetConstraints(kernels, workers, hook);
    Precondition(kernels, workers);
    scale = balance_.largest_distance;
    const double largest = FindLongest(kernels, workers, z_);
    report.error = scale > 0.0 ? largest / (kEstimateShare * scale) : largest > 0.0 ? INFINITY : 0.0;
    report.residual = balance_.force_scale > 0.0 ? balance_.largest_residual / balance_.force_scale : 0.0;
    report.force_scale = balance_.force_scale;
    report.converged = report.error <= settings.max_error;
  };

  double moved = 0;  // bound of how far any node went since the coarser levels were computed [m]
  const auto update_coarse = [&] {
    hierarchy_.UpdateCoarse(kernels, workers, linearisation_.Slack());
    moved = 0;
  };
  double radius = edge_length_ > 0.0 ? kFirstRadius * edge_length_ : INFINITY;
  linearise();
  update_coarse();
  estimate();
  while (!report.converged && report.iterations < settings.max_newton_steps && balance_.is_finite) {
    const double before = balance_.energy;
    const double tolerance = kLinearShare * kEstimateShare * settings.max_error * scale;
    const auto first_multipliers = multipliers_;
    const LinearReport linear =
        SolveLinear(kernels, workers, settings.max_linear_iterations, tolerance, radius);
    report.linear_iterations += linear.iterations;
    report.negative_curvatures += linear.met_negative_curvature;
    const double length = FindLongest(kernels, workers, step_);
    if (!(length > 0.0 && length < INFINITY)) break;
    const double slope = -CalcDot(kernels, workers, balance_.residual, step_);
    double share = 1.0;
    std::copy(position_.begin(), position_.end(), start_.begin());
    bool is_lower = false;
    for (int halving = 0; halving <= kMaxHalvings && !is_lower; ++halving, share *= 0.5) {
      ForEachNodeChunk(workers, n, [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
        for (std::uint32_t i = first; i < last; ++i) {
          position_[i] = {start_[i].x + share * static_cast<double>(step_[i].x),
                          start_[i].y + share * static_cast<double>(step_[i].y),
                          start_[i].z + share * static_cast<double>(step_[i].z), 0.0};
        }
      });
      // a hook will change the balance again
      if (hook == nullptr) {
        linearise();
      } else {
        linearisation_.CalcBalance(kernels, workers, position_, balance_);
      }
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
      estimate();
      break;
    }
    // what the constraints carry of the residual after this part of the step
    for (std::size_t c = 0; c < constraint_count_; ++c)
      multipliers_[c] = share * multipliers_[c] + (1.0 - share) * first_multipliers[c];
    // a constraint is kept after every step, whatever the hook's interval: a step here is worth many
    // iterations
    if (hook != nullptr) {
      call_hook();
      linearise();
    }
    moved += share * length;
    if (moved > kStaleMove * edge_length_) update_coarse();
    estimate();
  }
  write_back();
  return report;
}

}  // namespace trocar::tissue
