// SPDX-License-Identifier: Apache-2.0
/// \file settings_form.h  Which settings the panel offers, in words, units and ranges; no widget knows a
/// setting.
#pragma once

#include <span>
#include <string>

#include "trocar/presenter/slider_scale.h"
#include "trocar/scene/input.h"

namespace trocar::presenter {

/// One slider of the panel.
struct SettingRow {
  const char* group;    ///< "Tissue"
  const char* label;    ///< "Stiffness"
  const char* unit;     ///< as shown, "" for a pure number
  const char* tooltip;  ///< what it means and what to expect
  SliderScale scale;    ///< in the unit shown
  int decimals;  ///< digits after the point; negative: that many significant digits, scientific below 0.01
  double si_per_unit;                               ///< SI value of one unit shown
  double (*get)(const scene::LiveSettings&);        ///< SI
  void (*set)(scene::LiveSettings&, double value);  ///< SI
};

/// All rows, group after group.
std::span<const SettingRow> SettingRows() noexcept;

/// Slider position of the row's value in `settings`, 0 to 1.
double PositionInForm(const SettingRow& row, const scene::LiveSettings& settings);
/// Writes the value at a slider position into `settings`.
void SetFromForm(const SettingRow& row, double position, scene::LiveSettings& settings);
/// "1.50 x", "9.81 m/s²", "12°"
std::string FormatSetting(const SettingRow& row, const scene::LiveSettings& settings);

/// A solver as the panel names it.
struct SolverChoice {
  tissue::SolverKind kind;
  const char* label;
  const char* tooltip;
};
std::span<const SolverChoice> SolverChoices() noexcept;

}  // namespace trocar::presenter
