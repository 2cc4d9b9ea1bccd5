// SPDX-License-Identifier: Apache-2.0
/// \file paper_arrays.h  From the tissue model to the arrays of the paper's four layouts.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/tissue/tissue_model.h"
#include "trocar/tissue_cuda/gpu_solver.h"

namespace trocar::tissue_cuda {

struct GridShape {
  std::uint32_t columns = 0, rows = 0;
};

/// The grid in whose row-by-row order the nodes lie, if every spring joins two of eight neighbours in it: the
/// paper's structured mesh. Of several, the one with the fewest rows.
std::optional<GridShape> FindGridShape(const tissue::TissueModel& model);

bool IsCoalesced(Layout layout) noexcept;
bool IsShared(Layout layout) noexcept;

/// Arrays of a model in one of the paper's layouts, which stay as long as the model does.
template <typename Real>
struct PaperArrays {
  Layout layout = Layout::kPaperGlobal;
  std::uint32_t points = 0, pitch = 0, max_neighbors = 0;
  GridShape grid;  ///< of the shared layouts
  Real mesh_stiffness = 0;
  std::vector<std::uint32_t> neighbors;  ///< of the layouts without shared memory
  std::vector<std::uint8_t> connected;   ///< of those with
  std::vector<Real> length_rest;
  std::vector<Real> link_stiffness;  ///< empty where all springs have the same
  std::vector<Real> rest_points;     ///< empty where there are no virtual springs
};

/// \return kGpuLayout when the layout cannot hold the model: strands, or a shared layout without a grid
template <typename Real>
base::Result<PaperArrays<Real>> MakePaperArrays(const tissue::TissueModel& model, Layout layout);

/// Positions with mass and condition, and external forces (left empty where there are none), as a solve
/// begins.
template <typename Real>
void FillPoints(const PaperArrays<Real>& arrays, const tissue::TissueModel& model,
                const tissue::TissueState& state, const tissue::TissueLoad& load,
                std::vector<Real>& positions, std::vector<Real>& external_force);

/// Takes the positions of nodes that are not prescribed back into the state.
template <typename Real>
void ReadPoints(const PaperArrays<Real>& arrays, const std::vector<Real>& positions,
                tissue::TissueState& state);

/// Blocks of one launch.
template <typename Real>
std::uint32_t CountPaperBlocks(const PaperArrays<Real>& arrays) noexcept;

}  // namespace trocar::tissue_cuda
