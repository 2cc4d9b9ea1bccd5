// SPDX-License-Identifier: Apache-2.0
#include "accelerated_descent.h"

#include <algorithm>
#include <cmath>

namespace trocar::tissue {
namespace {

/// The smallest grid of the coarse-to-fine start has at least this many rows and columns.
constexpr std::uint32_t kSmallestGrid = 9;
/// Iterations on each coarser grid: its springs are few, and what is not solved here must be solved on a finer one.
constexpr int kCoarseIterations = 400;
/// A start whose nodes are all nearer to rest than this part of a spring is cold [-].
constexpr double kColdShare = 1e-3;
/// Without a bound on the lowest eigenvalue, cycles of this length, then twice as long, and so on.
constexpr int kFirstCycle = 40;
constexpr int kLongestCycle = 640;
/// ln(2 / 1e-2): a cycle damps what it can reach a hundredfold.
constexpr double kCycleDamping = 5.3;
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
  return std::min(0.5, std::pow(kCycleDamping / (2.0 * cycle), 2));
}

/// Iterations that damp everything down to `lowest` to a ten-thousandth.
int CalcCycle(double lowest) noexcept {
  return static_cast<int>(std::ceil(std::log(2e4) / (2.0 * std::sqrt(lowest))));
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
    for (int i = 0; i < length; ++i) {
      const bool is_measured = i % kMeasureEvery == kMeasureEvery - 1;
      const double here =
          system.Step(kernels, workers, recurrence.Next(), recurrence.Damping(), i == 0, is_measured);
      ++done;
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

AcceleratedDescent::AcceleratedDescent(const TissueModel& model, bool use_grid) : model_(&model) {
  const auto shape = use_grid ? FindGridShape(model) : std::nullopt;
  if (!shape) {
    ordered_ = MakeOrderedModel(model);
    ordered_load_.constant.resize(model.Size());
    ordered_load_.is_free.resize(model.Size());
    ordered_load_.contacts.reserve(kMaxContacts);
    slices_ = std::make_unique<SpringSlices>(ordered_);
    return;
  }
  GridModel grid = MakeGridModel(model, *shape);
  while (true) {
    grids_.emplace_back(grid);
    loads_.push_back({std::vector<Vec3>(grid.Size()), std::vector<double>(grid.Size()),
                      std::vector<std::uint8_t>(grid.Size())});
    if (std::min(grid.shape.rows, grid.shape.columns) < 2 * kSmallestGrid) break;
    grid = MakeCoarseGrid(grid);
  }
}

void AcceleratedDescent::SetGridLoads(const TissueLoad& load, const TissueState& state) noexcept {
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
      finest.force[contact.nodes[corner]] += (contact.weights[corner] * contact.stiffness * depth) * contact.normal;
  }
  grids_.front().SetLoad(finest, load.stiffness_scale);
  for (std::size_t level = 1; level < grids_.size(); ++level) {
    const GridLoad& fine = loads_[level - 1];
    GridLoad& coarse = loads_[level];
    const GridShape from = grids_[level - 1].Shape(), to = grids_[level].Shape();
    std::fill(coarse.force.begin(), coarse.force.end(), Vec3{});
    std::fill(coarse.shape.begin(), coarse.shape.end(), 0.0);
    std::fill(coarse.is_free.begin(), coarse.is_free.end(), std::uint8_t{1});
    for (std::uint32_t i = 0; i < fine.force.size(); ++i) {
      const GridPlace r = FindGridPlace(i / from.columns, from.rows, to.rows);
      const GridPlace c = FindGridPlace(i % from.columns, from.columns, to.columns);
      const std::uint32_t corner = r.index * to.columns + c.index;
      for (const std::uint32_t down : {0u, 1u}) {
        for (const std::uint32_t right : {0u, 1u}) {
          const double row_share = static_cast<double>(r.share), column_share = static_cast<double>(c.share);
          const double share = (down == 1 ? row_share : 1.0 - row_share) * (right == 1 ? column_share : 1.0 - column_share);
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

SolveReport AcceleratedDescent::SolveGrid(const Kernels& kernels, Workers& workers, const SolverSettings& settings,
                                          const TissueLoad& load, TissueState& state) noexcept {
  SetGridLoads(load, state);
  SolveReport report;
  SpringGrid& finest = grids_.front();
  const auto n = static_cast<std::uint32_t>(model_->Size());
  double largest = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3 u = state.position[i] - model_->rest[i];
    finest.SetDisplacement(i, u);
    if (state.condition[i] != NodeCondition::kPrescribed) largest = std::max(largest, math::SquaredNorm(u));
  }
  const auto force_for = [&](const SpringGrid& grid) {
    return settings.max_error * grid.LargestDisplacement() * grid.SmallestShape();
  };
  double residual = 0;
  const double edge = math::Distance(model_->rest[1], model_->rest[0]);
  if (largest <= kColdShare * kColdShare * edge * edge) {
    for (std::size_t level = grids_.size(); level-- > 1;) {
      SpringGrid& grid = grids_[level];
      if (level + 1 < grids_.size()) grid.Interpolate(grids_[level + 1]);
      if (level + 1 == grids_.size()) {
        for (std::uint32_t i = 0; i < grid.Shape().rows * grid.Shape().columns; ++i) grid.SetDisplacement(i, {});
      }
      (void)RunCycles(grid, kernels, workers, kCoarseIterations, 0.0, residual, [] {});
      ++report.coarse_levels;
    }
    if (grids_.size() > 1) finest.Interpolate(grids_[1]);
  }
  while (report.iterations < settings.max_iterations) {
    // the scale of the error is known only from the displacements
    const int some = std::min(settings.max_iterations - report.iterations, 4 * kFirstCycle);
    const double force = force_for(finest);
    report.iterations += RunCycles(finest, kernels, workers, some, force, residual, [] {});
    report.error = finest.SmallestShape() > 0.0 && finest.LargestDisplacement() > 0.0
                       ? residual / (finest.SmallestShape() * finest.LargestDisplacement())
                       : NAN;
    if (report.error <= settings.max_error || !std::isfinite(residual)) break;
  }
  report.converged = report.error <= settings.max_error;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (state.condition[i] != NodeCondition::kPrescribed)
      state.position[i] = model_->rest[i] + finest.GetDisplacement(i);
  }
  return report;
}

SolveReport AcceleratedDescent::SolveSlices(const Kernels& kernels, Workers& workers,
                                            const SolverSettings& settings, const TissueLoad& load,
                                            TissueState& state) noexcept {
  SolveReport report;
  SetOrderedLoad(ordered_, load, state, ordered_load_);
  const std::uint32_t n = ordered_.Size();
  for (std::uint32_t i = 0; i < n; ++i) {
    slices_->SetDisplacement(i, state.position[ordered_.old_of_new[i]] - ordered_.rest[i]);
  }
  slices_->SetLoad(ordered_, ordered_load_, state.strand_is_intact);
  const auto refresh = [&] {
    if (ordered_load_.contacts.empty()) return;
    slices_->SetLoad(ordered_, ordered_load_, state.strand_is_intact);
    for (const ContactSpring& contact : ordered_load_.contacts) {
      double along = 0;
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t node = contact.nodes[corner];
        along += contact.weights[corner] *
                 math::Dot(contact.normal, ordered_.rest[node] + slices_->GetDisplacement(node));
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
  while (report.iterations < settings.max_iterations) {
    const int some = std::min(settings.max_iterations - report.iterations, 4 * kFirstCycle);
    const double scale = slices_->LargestDisplacement();
    report.iterations += RunCycles(*slices_, kernels, workers, some,
                                   settings.max_error * scale * slices_->SmallestShape(), residual, refresh);
    const double reached = slices_->SmallestShape() * slices_->LargestDisplacement();
    report.error = reached > 0.0 ? residual / reached : NAN;
    if (report.error <= settings.max_error || !std::isfinite(residual)) break;
  }
  report.converged = report.error <= settings.max_error && load.contacts.empty();
  for (std::uint32_t i = 0; i < n; ++i) {
    if (ordered_load_.is_free[i])
      state.position[ordered_.old_of_new[i]] = ordered_.rest[i] + slices_->GetDisplacement(i);
  }
  return report;
}

SolveReport AcceleratedDescent::Solve(const Kernels& kernels, Workers& workers, const SolverSettings& settings,
                                      const TissueLoad& load, TissueState& state) noexcept {
  return IsStructured() ? SolveGrid(kernels, workers, settings, load, state)
                        : SolveSlices(kernels, workers, settings, load, state);
}

}  // namespace trocar::tissue
