// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "solver_content.h"

// Several versions of one function need the loader's help (ifunc), which sanitizers run before they are ready.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    (!defined(__clang__) || __clang_major__ >= 14)
#define TROCAR_VERSIONS __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define TROCAR_VERSIONS
#endif

namespace trocar::tissue {

SlicedSprings MakeSlicedSprings(const TissueModel& model) {
  const auto n = static_cast<std::uint32_t>(model.Size());
  SlicedSprings sliced;
  sliced.starts.push_back(0);
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
        const auto half = is_padding ? TissueModel::HalfSpring{i, 0.0, 0.0} : model.half_springs[h];
        sliced.others.push_back(half.other);
        sliced.stiffness.push_back(half.stiffness);
        sliced.stiffness_times_rest.push_back(half.stiffness * half.rest_length);
      }
    }
    sliced.starts.push_back(sliced.starts.back() + longest);
  }
  return sliced;
}

TROCAR_VERSIONS
void GatherSlice(const SlicedSprings& springs, const Vec3* position, std::uint32_t node_count, std::uint32_t slice,
                 SliceForce& force) noexcept {
  // below this a spring counts as having no direction [m^2]; its force is then zero because its extent is
  constexpr double kNoLength2 = 1e-200;
  const double* const coordinates = &position->x;
  double here_x[kLanes], here_y[kLanes], here_z[kLanes];
  double x[kLanes] = {}, y[kLanes] = {}, z[kLanes] = {}, largest[kLanes] = {};
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    const std::uint32_t i = std::min(slice * kLanes + lane, node_count - 1);
    here_x[lane] = coordinates[3 * i], here_y[lane] = coordinates[3 * i + 1], here_z[lane] = coordinates[3 * i + 2];
  }
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
      const double secant = stiffness[lane] - rest[lane] / std::sqrt(length2 > kNoLength2 ? length2 : kNoLength2);
      x[lane] += secant * along_x;
      y[lane] += secant * along_y;
      z[lane] += secant * along_z;
      const double tension2 = secant * secant * length2;
      largest[lane] = tension2 > largest[lane] ? tension2 : largest[lane];
    }
  }
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    force.x[lane] = x[lane], force.y[lane] = y[lane], force.z[lane] = z[lane];
    force.largest_squared[lane] = largest[lane];
  }
}

}  // namespace trocar::tissue
