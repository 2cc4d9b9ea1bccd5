// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/input.h"

#include <algorithm>
#include <cmath>

namespace trocar::scene {
namespace {

double ClampOr(double value, double low, double high, double fallback) noexcept {
  return std::isnan(value) ? fallback : std::clamp(value, low, high);
}

}  // namespace

LiveSettings ClampSettings(const LiveSettings& settings) noexcept {
  const LiveSettings normal;
  LiveSettings clamped = settings;
  clamped.stiffness_scale = ClampOr(settings.stiffness_scale, 0.05, 20.0, normal.stiffness_scale);
  clamped.shape_scale = ClampOr(settings.shape_scale, 0.0, 20.0, normal.shape_scale);
  clamped.gravity = ClampOr(settings.gravity, 0.0, 30.0, normal.gravity);
  clamped.head_up = ClampOr(settings.head_up, -0.6, 0.6, normal.head_up);
  clamped.right_up = ClampOr(settings.right_up, -0.6, 0.6, normal.right_up);
  clamped.solver.max_iterations = std::clamp(settings.solver.max_iterations, 1, 100'000);
  clamped.solver.tolerance = ClampOr(settings.solver.tolerance, 0.0, 1.0, normal.solver.tolerance);
  clamped.solver.max_error = ClampOr(settings.solver.max_error, 1e-9, 1.0, normal.solver.max_error);
  clamped.solver.newton.max_steps = std::clamp(settings.solver.newton.max_steps, 1, 1000);
  clamped.solver.newton.max_linear_total = std::clamp(settings.solver.newton.max_linear_total, 1, 100'000);
  clamped.solver.newton.max_linear_iterations =
      std::clamp(settings.solver.newton.max_linear_iterations, 1, 10'000);
  clamped.solver.relaxation.alpha =
      ClampOr(settings.solver.relaxation.alpha, 0.0, 1e6, normal.solver.relaxation.alpha);
  return clamped;
}

}  // namespace trocar::scene
