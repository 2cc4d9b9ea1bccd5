// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "solver_content.h"

// Several versions of one function need the loader's help (ifunc), which sanitizers run before they are
// ready.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && (!defined(__clang__) || __clang_major__ >= 14)
#define TROCAR_VERSIONS __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define TROCAR_VERSIONS
#endif

namespace trocar::tissue {

using math::Vec3;

void SetSlicedSprings(const TissueModel& model, SlicedSprings& sliced) {
  const auto n = static_cast<std::uint32_t>(model.Size());
  sliced.starts.assign(1, 0);
  sliced.others.clear(), sliced.stiffness.clear(), sliced.stiffness_times_rest.clear();
  for (std::uint32_t first = 0; first < n; first += kLanes) {
    std::uint32_t longest = 0;
    for (std::uint32_t i = first; i < std::min(n, first + kLanes); ++i) {
      longest = std::max(longest, model.spring_starts[i + 1] - model.spring_starts[i]);
    }
    for (std::uint32_t step = 0; step < longest; ++step) {
      for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
        const std::uint32_t i = std::min(first + lane, n - 1);
        const std::uint32_t h = model.spring_starts[i] + step;
        const bool is_padding = first + lane >= n || h >= model.spring_starts[i + 1];
        const auto half = is_padding ? TissueModel::HalfSpring{i, 0, 0.0, 0.0} : model.half_springs[h];
        sliced.others.push_back(half.other);
        sliced.stiffness.push_back(half.stiffness);
        sliced.stiffness_times_rest.push_back(half.stiffness * half.rest_length);
      }
    }
    sliced.starts.push_back(sliced.starts.back() + longest);
  }
}

TROCAR_VERSIONS
void UpdateSlice(const SlicedSprings& springs, const SliceData& data, const StepFactors& factors,
                 const Vec3* position, Vec3* previous, std::uint32_t node_count, std::uint32_t slice,
                 SliceReport& report) noexcept {
  // below this a spring counts as having no direction [m^2]; its force is then zero because its extent is
  constexpr double kNoLength2 = 1e-200;
  const double* const coordinates = &position->x;
  double here_x[kLanes], here_y[kLanes], here_z[kLanes];
  double before_x[kLanes], before_y[kLanes], before_z[kLanes];
  double x[kLanes] = {}, y[kLanes] = {}, z[kLanes] = {}, largest[kLanes] = {};
  const std::uint32_t first = slice * kLanes, count = std::min(kLanes, node_count - first);
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    const std::uint32_t i = first + std::min(lane, count - 1);
    here_x[lane] = position[i].x, here_y[lane] = position[i].y, here_z[lane] = position[i].z;
    const Vec3& before = factors.is_first ? position[i] : previous[i];
    before_x[lane] = before.x, before_y[lane] = before.y, before_z[lane] = before.z;
  }

  // springs
  for (std::uint32_t step = springs.starts[slice]; step < springs.starts[slice + 1]; ++step) {
    const std::uint32_t* const others = springs.others.data() + step * kLanes;
    const double* const stiffness = springs.stiffness.data() + step * kLanes;
    const double* const rest = springs.stiffness_times_rest.data() + step * kLanes;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      const std::uint32_t at = 3 * others[lane];
      const double along_x = coordinates[at] - here_x[lane];
      const double along_y = coordinates[at + 1] - here_y[lane];
      const double along_z = coordinates[at + 2] - here_z[lane];
      const double length2 = along_x * along_x + along_y * along_y + along_z * along_z;
      const double secant =
          stiffness[lane] - rest[lane] / std::sqrt(length2 > kNoLength2 ? length2 : kNoLength2);
      x[lane] += secant * along_x;
      y[lane] += secant * along_y;
      z[lane] += secant * along_z;
      const double tension2 = secant * secant * length2;
      largest[lane] = tension2 > largest[lane] ? tension2 : largest[lane];
    }
  }

  // the other forces, the step through the node's own stiffness, and the recurrence
  const double scale = factors.stiffness_scale;
  double residual2[kLanes], force2[kLanes], is_long[kLanes];
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    const double k = data.shape_stiffness[lane];
    const double shape_x = k * (data.rest[0][lane] - here_x[lane]);
    const double shape_y = k * (data.rest[1][lane] - here_y[lane]);
    const double shape_z = k * (data.rest[2][lane] - here_z[lane]);
    const double other_x = data.other_force[0][lane], other_y = data.other_force[1][lane],
                 other_z = data.other_force[2][lane];
    const double force_x = scale * x[lane] + shape_x + other_x;
    const double force_y = scale * y[lane] + shape_y + other_y;
    const double force_z = scale * z[lane] + shape_z + other_z;
    residual2[lane] = data.is_free[lane] * (force_x * force_x + force_y * force_y + force_z * force_z);
    const double shape2 = shape_x * shape_x + shape_y * shape_y + shape_z * shape_z;
    const double other2 = other_x * other_x + other_y * other_y + other_z * other_z;
    const double tension2 = scale * scale * largest[lane];
    const double greater2 = shape2 > other2 ? shape2 : other2;
    force2[lane] = data.is_free[lane] * (tension2 > greater2 ? tension2 : greater2);

    const auto& b = data.inverse_block;
    double step_x = factors.damping * (b[0][lane] * force_x + b[1][lane] * force_y + b[2][lane] * force_z);
    double step_y = factors.damping * (b[1][lane] * force_x + b[3][lane] * force_y + b[4][lane] * force_z);
    double step_z = factors.damping * (b[2][lane] * force_x + b[4][lane] * force_y + b[5][lane] * force_z);
    const double step2 = step_x * step_x + step_y * step_y + step_z * step_z;
    const double limit2 = factors.max_step * factors.max_step;
    is_long[lane] = step2 > limit2 ? 1.0 : 0.0;
    const double shorten = step2 > limit2 ? factors.max_step / std::sqrt(step2) : 1.0;
    x[lane] = factors.omega * ((here_x[lane] + shorten * step_x) - before_x[lane]) + before_x[lane];
    y[lane] = factors.omega * ((here_y[lane] + shorten * step_y) - before_y[lane]) + before_y[lane];
    z[lane] = factors.omega * ((here_z[lane] + shorten * step_z) - before_z[lane]) + before_z[lane];
  }
  for (std::uint32_t lane = 0; lane < count; ++lane) {
    previous[first + lane] = {x[lane], y[lane], z[lane]};
    report.residual2 = residual2[lane] > report.residual2 ? residual2[lane] : report.residual2;
    report.force2 = force2[lane] > report.force2 ? force2[lane] : report.force2;
    report.is_cut_short = report.is_cut_short || is_long[lane] != 0.0;
  }
}

}  // namespace trocar::tissue
