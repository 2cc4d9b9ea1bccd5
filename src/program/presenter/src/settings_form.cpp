// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/settings_form.h"

#include <cmath>
#include <cstdio>

#include "trocar/math/rotation_angle.h"

namespace trocar::presenter {
namespace {

using scene::LiveSettings;

constexpr double kMaxTiltDeg = 0.6 / math::kDegree;

constexpr SettingRow kRows[] = {
    {"Tissue",
     "Stiffness",
     "×",
     "Multiplies every structural and attachment spring. 1 is the patient's own tissue; right is stiffer.",
     {ScaleKind::kLogarithmic, 0.05, 20},
     2,
     1.0,
     [](const LiveSettings& s) { return s.stiffness_scale; },
     [](LiveSettings& s, double v) { s.stiffness_scale = v; }},
    {"Tissue",
     "Virtual springs",
     "×",
     "Multiplies the springs that pull each point back to its rest place (what lies behind the surface). "
     "At the very left they are off.",
     {ScaleKind::kLogarithmicOrZero, 0, 20, 0.01},
     2,
     1.0,
     [](const LiveSettings& s) { return s.shape_scale; },
     [](LiveSettings& s, double v) { s.shape_scale = v; }},
    {"Gravity and table",
     "Gravity",
     "m/s²",
     "Strength of gravity; 9.81 on earth.",
     {ScaleKind::kLinear, 0, 30},
     2,
     1.0,
     [](const LiveSettings& s) { return s.gravity; },
     [](LiveSettings& s, double v) { s.gravity = v; }},
    {"Gravity and table",
     "Head up",
     "°",
     "Reverse Trendelenburg: the head end of the table up. Surgeons take 10° to 15°.",
     {ScaleKind::kLinear, -kMaxTiltDeg, kMaxTiltDeg},
     0,
     math::kDegree,
     [](const LiveSettings& s) { return s.head_up; },
     [](LiveSettings& s, double v) { s.head_up = v; }},
    {"Gravity and table",
     "Right side up",
     "°",
     "The patient's right side up, so that bowel falls away from the gallbladder.",
     {ScaleKind::kLinear, -kMaxTiltDeg, kMaxTiltDeg},
     0,
     math::kDegree,
     [](const LiveSettings& s) { return s.right_up; },
     [](LiveSettings& s, double v) { s.right_up = v; }},
    {"Solver",
     "Iterations",
     "",
     "At most this many in one tick. More is closer to equilibrium and takes longer.",
     {ScaleKind::kLogarithmic, 1, 2000, 0, true},
     0,
     1.0,
     [](const LiveSettings& s) { return double(s.solver.max_iterations); },
     [](LiveSettings& s, double v) { s.solver.max_iterations = static_cast<int>(std::lround(v)); }},
    {"Solver",
     "Tolerance",
     "",
     "The solver stops when the largest force out of balance is below this part of the largest force at "
     "work.",
     {ScaleKind::kLogarithmic, 1e-8, 1e-1},
     -2,
     1.0,
     [](const LiveSettings& s) { return s.solver.tolerance; },
     [](LiveSettings& s, double v) { s.solver.tolerance = v; }},
};

constexpr SolverChoice kSolvers[] = {
    {tissue::SolverKind::kAdaptive, "Adaptive", "Newton with multigrid, as many steps as the error asks for"},
    {tissue::SolverKind::kChebyshevJacobi2015, "Chebyshev",
     "Jacobi iteration accelerated by Chebyshev's recurrence (Wang 2015)"},
    {tissue::SolverKind::kRelaxationPaper, "Relaxation (reference)",
     "Node after node along its residual, as the paper prints it; slow to converge"},
};

}  // namespace

std::span<const SettingRow> SettingRows() noexcept {
  return kRows;
}

std::span<const SolverChoice> SolverChoices() noexcept {
  return kSolvers;
}

double PositionInForm(const SettingRow& row, const LiveSettings& settings) {
  return PositionOf(row.scale, row.get(settings) / row.si_per_unit);
}

void SetFromForm(const SettingRow& row, double position, LiveSettings& settings) {
  row.set(settings, ValueAt(row.scale, position) * row.si_per_unit);
}

std::string FormatSetting(const SettingRow& row, const LiveSettings& settings) {
  const double value = row.get(settings) / row.si_per_unit;
  char text[64];
  if (row.decimals < 0) {
    std::snprintf(text, sizeof text, std::fabs(value) < 0.01 ? "%.*e" : "%.*g", -row.decimals - 1, value);
  } else {
    // no "-0"
    const double least = 0.5 * std::pow(10.0, -row.decimals);
    std::snprintf(text, sizeof text, "%.*f", row.decimals, std::fabs(value) < least ? 0.0 : value);
  }
  const std::string unit = row.unit;
  return text + (unit.empty() ? "" : unit == "°" ? unit : " " + unit);
}

}  // namespace trocar::presenter
