// SPDX-License-Identifier: Apache-2.0
/// \file physics_checks.h  Comparisons of the report card: measured against analytic, or against what was
/// promised.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/bench/svg_plot.h"

namespace trocar::bench {

/// One figure and the bounds that it must keep.
struct CheckFigure {
  std::string name;
  double value = 0;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  std::string unit;
  /// A limit that is known and stated: shown, not counted as a failure.
  bool is_known_limit = false;

  /// NaN passes nothing.
  bool Passes() const { return value >= low && value <= high; }
};

/// One experiment.
struct PhysicsCheck {
  std::string title;
  std::string method;  ///< what is compared with what
  std::vector<CheckFigure> figures;
  PlotSettings plot;
  std::vector<PlotLine> lines;  ///< empty: no plot
};

/// Membrane, chain, foundation, weight, energy, refinement: seconds.
PhysicsCheck CheckPatch();
PhysicsCheck CheckHangingChain();
PhysicsCheck CheckIndentation();
PhysicsCheck CheckSelfWeight();
PhysicsCheck CheckEnergy();
PhysicsCheck CheckMeshRefinement();
PhysicsCheck CheckFreedOrgan();

/// Rods against the elastica, Euler's load, Zajac's twist and the catenary: a second.
PhysicsCheck CheckRodCantilever();
PhysicsCheck CheckRodBuckling();
PhysicsCheck CheckRodRing();
PhysicsCheck CheckRodCatenary();

/// Volume, pressure and time per tick of every organ of a scene while its script plays.
/// \return the scene's error
base::Result<PhysicsCheck> CheckVolume(const std::filesystem::path& scene);
/// Plays a scene's script until `time` [s] at three tick rates, lets the tissue come to rest, and compares the results.
base::Result<PhysicsCheck> CheckTickRate(const std::filesystem::path& scene, double time);

/// HTML that needs nothing else.
std::string FormatReportCard(const std::vector<PhysicsCheck>& checks, const std::string& machine);

/// How many figures fail that are no known limits.
int CountFailures(const std::vector<PhysicsCheck>& checks);

}  // namespace trocar::bench
