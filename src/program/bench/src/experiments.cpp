// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "trocar/bench/experiment.h"

namespace trocar::bench {
namespace {

constexpr std::array<ExperimentEntry, 7> kExperiments = {{
    {"table1", "Table 1: points, edges and triangles of the four meshes", ReproduceTable1},
    {"table2", "Table 2: shape conservation by virtual springs, on the liver and on a grid", ReproduceTable2},
    {"fig6", "Figure 6: collision search over mesh size, greedy and exact", ReproduceFigure6},
    {"fig7", "Figure 7: update of the collision hierarchy over mesh size", ReproduceFigure7},
    {"fig8", "Figure 8: time of an iteration of every solver and GPU layout", ReproduceFigure8},
    {"fig9", "Figure 9: speed-up over the paper's relaxation", ReproduceFigure9},
    {"equilibrium", "Section V: an error below 0.0005 in a frame", ReproduceEquilibrium},
}};

}  // namespace

std::span<const ExperimentEntry> Experiments() noexcept {
  return kExperiments;
}

}  // namespace trocar::bench
