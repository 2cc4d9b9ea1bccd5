// SPDX-License-Identifier: Apache-2.0
#include "accelerated_descent.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "node_force.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"

namespace trocar::tissue {
namespace {

/// The smallest grid of the coarse-to-fine start has at least this many rows and columns.
constexpr std::uint32_t kSmallestGrid = 9;
/// Iterations on each coarser grid: its springs are few, and what is not solved here must be solved on a
/// finer one.
constexpr int kCoarseIterations = 400;
/// A start whose nodes are all nearer to rest than this part of a spring is cold [-].
constexpr double kColdShare = 1e-3;
/// Without a bound on the lowest eigenvalue, cycles of this length, then twice as long, and so on.
constexpr int kFirstCycle = 40;
constexpr int kLongestCycle = 640;
/// ln(2 / 1e-2): a cycle damps what it can reach a hundredfold.
constexpr double kCycleDamping = 5.3;
/// Iterations between two looks at the displacements, and at the caller's constraints.
constexpr int kCheckEvery = 160;
/// The residual is looked at this often.
constexpr int kMeasureEvery = 8;

/// Chebyshev's factors for eigenvalues of D^-1 K from `lowest` to 1 (Wang 2015, equation 9).
class Recurrence {
 public:
  explicit Recurrence(double lowest) noexcept
      : rho_((1.0 - lowest) / (1.0 + lowest)), damping_(2.0 / (1.0 + lowest)) {}
  /// omega of the next iteration.
  float Next() noexcept {
    ++count_;
    omega_ = count_ == 1 ? 1.0 : count_ == 2 ? 2.0 / (2.0 - rho_ * rho_) : 4.0 / (4.0 - rho_ * rho_ * omega_);
    return static_cast<float>(omega_);
  }
  float Damping() const { return static_cast<float>(damping_); }

 private:
  double rho_, damping_, omega_ = 1.0;
  int count_ = 0;
};

/// Lowest eigenvalue that a cycle of this length damps as kCycleDamping says.
double CalcLowest(int cycle) noexcept {
  const double root = kCycleDamping / (2.0 * cycle);
  return std::min(0.5, root * root);
}

/// Iterations that damp everything down to `lowest` to a ten-thousandth.
int CalcCycle(double lowest) noexcept {
  return base::CeilTo<int>(math::Log(2e4) / (2.0 * std::sqrt(lowest)));
}

/// Runs cycles until the residual is at most `force`, or for so many iterations.
/// \param refresh  called before every cycle
template <typename System, typename Refresh>
int RunCycles(System& system, const Kernels& kernels, Workers& workers, int max_iterations, double force,
              double& residual, const Refresh& refresh) noexcept {
  const double bound = system.LowestEigenvalue();
  int done = 0, cycle = kFirstCycle;
  while (done < max_iterations) {
    const bool is_bounded = bound > CalcLowest(kLongestCycle);
    const int length = std::min(max_iterations - done, is_bounded ? CalcCycle(bound) : cycle);
    Recurrence recurrence(is_bounded ? bound : CalcLowest(length));
    refresh();
    for (int i = 0; i < length; i += kMeasureEvery) {
      const int some = std::min(kMeasureEvery, length - i);
      const bool is_measured = some == kMeasureEvery;
      std::array<float, kMeasureEvery> omegas;
      for (int k = 0; k < some; ++k) omegas[k] = recurrence.Next();
      const double here =
          system.Iterate(kernels, workers, std::span(omegas).first(static_cast<std::size_t>(some)),
                         recurrence.Damping(), i == 0, is_measured);
      done += some;
      if (!is_measured) continue;
      residual = here;
      // not finite: ends here, and the guard finds it
      if (!(residual > force)) return done;
    }
    cycle = std::min(2 * cycle, kLongestCycle);
  }
  return done;
}

}  // namespace

void AcceleratedDescent::SetModel(const TissueModel& model, const OrderedModel& ordered,
                                  const std::optional<GridShape>& grid_shape) {
  model_ = &model;
  ordered_ = &ordered;
  edge_length_ = model.half_springs.empty() ? 0.0 : model.half_springs.front().rest_length;
  lowest_ratio_ = INFINITY;
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    const double sum = SumSpringStiffness(model, i);
    if (sum > 0.0 && !model.is_fixed[i])
      lowest_ratio_ = std::min(lowest_ratio_, model.shape_stiffness[i] / sum);
  }
  grids_.clear();
  loads_.clear();
  if (!grid_shape) {
    ordered_load_.constant.resize(model.Size());
    ordered_load_.is_free.resize(model.Size());
    ordered_load_.contacts.reserve(kMaxContacts);
    if (slices_ == nullptr) {
      slices_ = std::make_unique<SpringSlices>();
      slices_->Reserve(ordered, spare_share_);
    }
    slices_->SetModel(*ordered_);
    return;
  }
  GridModel grid = MakeGridModel(model, *grid_shape);
  while (true) {
    grids_.emplace_back(grid);
    loads_.push_back({std::vector<math::Vec3>(grid.Size()), std::vector<double>(grid.Size()),
                      std::vector<std::uint8_t>(grid.Size())});
    if (std::min(grid.shape.rows, grid.shape.columns) < 2 * kSmallestGrid) break;
    grid = MakeCoarseGrid(grid);
  }
}

bool AcceleratedDescent::IsCold(const TissueState& state) const noexcept {
  double largest = 0;
  for (std::size_t i = 0; i < model_->Size(); ++i) {
    if (state.condition[i] == NodeCondition::kPrescribed) continue;
    largest = std::max(largest, math::SquaredDistance(state.position[i], model_->rest[i]));
  }
  const double limit = kColdShare * edge_length_;
  return largest <= limit * limit;
}

bool AcceleratedDescent::IsWellConditioned(const TissueLoad& load) const noexcept {
  const double ratio = load.shape_scale * lowest_ratio_ / load.stiffness_scale;
  return ratio / (2.0 + ratio) > CalcLowest(kLongestCycle);
}

void AcceleratedDescent::SetGridLoads(const TissueLoad& load, const TissueState& state,
                                      std::size_t levels) noexcept {
  GridLoad& finest = loads_.front();
  for (std::uint32_t i = 0; i < finest.force.size(); ++i) {
    finest.force[i] = model_->mass[i] * load.gravity;
    if (!load.external_force.empty()) finest.force[i] += load.external_force[i];
    finest.shape[i] = load.shape_scale * model_->shape_stiffness[i];
    finest.is_free[i] = state.condition[i] != NodeCondition::kPrescribed;
  }
  for (const ContactSpring& contact : load.contacts) {
    const double depth = CalcContactDepth(contact, state.position);
    if (!(depth > 0.0)) continue;
    for (int corner = 0; corner < 3; ++corner)
      finest.force[contact.nodes[corner]] +=
          (contact.weights[corner] * contact.stiffness * depth) * contact.normal;
  }
  grids_.front().SetLoad(finest, load.stiffness_scale);
  for (std::size_t level = 1; level < levels; ++level) {
    const GridLoad& fine = loads_[level - 1];
    GridLoad& coarse = loads_[level];
    const GridShape from = grids_[level - 1].Shape(), to = grids_[level].Shape();
    std::fill(coarse.force.begin(), coarse.force.end(), math::Vec3{});
    std::fill(coarse.shape.begin(), coarse.shape.end(), 0.0);
    std::fill(coarse.is_free.begin(), coarse.is_free.end(), std::uint8_t{1});
    for (std::uint32_t i = 0; i < fine.force.size(); ++i) {
      const GridPlace r = FindGridPlace(i / from.columns, from.rows, to.rows);
      const GridPlace c = FindGridPlace(i % from.columns, from.columns, to.columns);
      const std::uint32_t corner = r.index * to.columns + c.index;
      for (const std::uint32_t down : {0u, 1u}) {
        for (const std::uint32_t right : {0u, 1u}) {
          const double row_share = static_cast<double>(r.share), column_share = static_cast<double>(c.share);
          const double share =
              (down == 1 ? row_share : 1.0 - row_share) * (right == 1 ? column_share : 1.0 - column_share);
          const std::uint32_t node = corner + down * to.columns + right;
          coarse.force[node] += share * fine.force[i];
          coarse.shape[node] += share * fine.shape[i];
          // the nearest coarse node stands for a held one
          if (fine.is_free[i] == 0 && share > 0.5) coarse.is_free[node] = 0;
        }
      }
    }
    grids_[level].SetLoad(coarse, load.stiffness_scale);
  }
}

SolveReport AcceleratedDescent::SolveGrid(const Kernels& kernels, Workers& workers,
                                          const AcceleratedSettings& settings, const TissueLoad& load,
                                          TissueState& state, ConstraintSet* constraints) noexcept {
  // well conditioned, the finest grid alone is as fast
  const std::size_t levels = IsCold(state) && !IsWellConditioned(load) ? grids_.size() : 1;
  SetGridLoads(load, state, levels);
  SolveReport report;
  SpringGrid& finest = grids_.front();
  const auto n = static_cast<std::uint32_t>(model_->Size());
  const auto read_state = [&] {
    for (std::uint32_t i = 0; i < n; ++i) finest.SetDisplacement(i, state.position[i] - model_->rest[i]);
  };
  const auto write_state = [&] {
    for (std::uint32_t i = 0; i < n; ++i) {
      if (state.condition[i] != NodeCondition::kPrescribed)
        state.position[i] = model_->rest[i] + finest.GetDisplacement(i);
    }
  };
  read_state();
  double residual = 0;
  for (std::size_t level = levels; level-- > 1;) {
    SpringGrid& grid = grids_[level];
    // nodes that are held here stay at rest, whatever an earlier solve left them at
    for (std::uint32_t i = 0; i < grid.Shape().rows * grid.Shape().columns; ++i) grid.SetDisplacement(i, {});
    if (level + 1 < levels) grid.Interpolate(grids_[level + 1]);
    (void)RunCycles(grid, kernels, workers, kCoarseIterations, 0.0, residual, [] {});
    ++report.coarse_levels;
  }
  if (levels > 1) finest.Interpolate(grids_[1]);
  const int check_every = IsWellConditioned(load) ? CalcCycle(finest.LowestEigenvalue()) : kCheckEvery;
  while (report.iterations < settings.max_iterations) {
    // the scale of the error is known only from the displacements
    const int some = std::min(settings.max_iterations - report.iterations, check_every);
    const double force = settings.max_error * finest.LargestDisplacement() * finest.SmallestShape();
    report.iterations += RunCycles(finest, kernels, workers, some, force, residual, [] {});
    const double bound = finest.SmallestShape() * finest.LargestDisplacement();
    report.error = bound > 0.0 ? residual / bound : NAN;
    if (report.error <= settings.max_error || !std::isfinite(residual)) break;
    if (constraints == nullptr) continue;
    write_state();
    constraints->Project(state, {});
    read_state();
    SetGridLoads(load, state, 1);
  }
  report.converged = report.error <= settings.max_error && load.contacts.empty();
  write_state();
  return report;
}

SolveReport AcceleratedDescent::SolveSlices(const Kernels& kernels, Workers& workers,
                                            const AcceleratedSettings& settings, const TissueLoad& load,
                                            TissueState& state, ConstraintSet* constraints) noexcept {
  SolveReport report;
  const std::uint32_t n = ordered_->Size();
  const auto read_state = [&] {
    SetOrderedLoad(*ordered_, load, state, ordered_load_);
    slices_->SetLoad(*ordered_, *springs_, ordered_load_, state.strand_is_intact);
    for (std::uint32_t i = 0; i < n; ++i) {
      slices_->SetDisplacement(i, state.position[ordered_->old_of_new[i]] - ordered_->rest[i]);
    }
  };
  const auto write_state = [&] {
    for (std::uint32_t i = 0; i < n; ++i) {
      if (ordered_load_.is_free[i])
        state.position[ordered_->old_of_new[i]] = ordered_->rest[i] + slices_->GetDisplacement(i);
    }
  };
  read_state();
  const auto refresh = [&] {
    if (ordered_load_.contacts.empty()) return;
    slices_->SetLoad(*ordered_, *springs_, ordered_load_, state.strand_is_intact);
    for (const ContactSpring& contact : ordered_load_.contacts) {
      double along = 0;
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t node = contact.nodes[corner];
        along += contact.weights[corner] *
                 math::Dot(contact.normal, ordered_->rest[node] + slices_->GetDisplacement(node));
      }
      const double depth = contact.offset - along;
      if (!(depth > 0.0)) continue;
      for (int corner = 0; corner < 3; ++corner) {
        slices_->AddForce(contact.nodes[corner],
                          (contact.weights[corner] * contact.stiffness * depth) * contact.normal);
      }
    }
  };
  double residual = 0;
  const int check_every = IsWellConditioned(load) ? CalcCycle(slices_->LowestEigenvalue()) : kCheckEvery;
  while (report.iterations < settings.max_iterations) {
    const int some = std::min(settings.max_iterations - report.iterations, check_every);
    const double scale = slices_->LargestDisplacement();
    report.iterations += RunCycles(*slices_, kernels, workers, some,
                                   settings.max_error * scale * slices_->SmallestShape(), residual, refresh);
    const double reached = slices_->SmallestShape() * slices_->LargestDisplacement();
    report.error = reached > 0.0 ? residual / reached : NAN;
    if (report.error <= settings.max_error || !std::isfinite(residual)) break;
    if (constraints == nullptr) continue;
    write_state();
    constraints->Project(state, {});
    read_state();
  }
  report.converged = report.error <= settings.max_error && load.contacts.empty();
  write_state();
  return report;
}

SolveReport AcceleratedDescent::Solve(const Kernels& kernels, Workers& workers,
                                      const AcceleratedSettings& settings, const TissueLoad& load,
                                      TissueState& state, ConstraintSet* constraints) noexcept {
  return IsStructured() ? SolveGrid(kernels, workers, settings, load, state, constraints)
                        : SolveSlices(kernels, workers, settings, load, state, constraints);
}

}  // namespace trocar::tissue
