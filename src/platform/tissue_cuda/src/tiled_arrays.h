// SPDX-License-Identifier: Apache-2.0
/// \file tiled_arrays.h  From the tissue model to the arrays of our own layout (kernels/tiled_args.h).
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/tiled_args.h"
#include "trocar/base/result.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue_cuda {

/// Arrays of a model in our layout, which stay as long as the model does; names and shapes as in TiledArgs.
template <typename Real>
struct TiledArrays {
  std::uint32_t nodes = 0, tiles = 0, max_border = 0, max_links = 0;
  std::vector<std::uint32_t> renumbered;  ///< (nodes) model -> place
  std::vector<std::uint32_t> model_index;
  std::vector<Triple<double>> rest;
  std::vector<double> mass;
  std::vector<Real> shape_stiffness;
  std::vector<std::uint32_t> slice_starts;
  std::vector<Quad<Real>> link_vectors;
  std::vector<LengthExcess<Real>> link_rests;
  std::vector<std::uint32_t> link_others;
  std::vector<std::uint16_t> link_locals;
  std::vector<std::uint32_t> border_starts, borders;
  std::vector<std::uint32_t> strand_starts;  ///< empty where the model has no strands
  std::vector<HalfStrandEntry> strands;
};

/// \return kGpuLayout for a model without nodes, or with a node that has more neighbours outside its tile
/// than a tile can name
template <typename Real>
base::Result<TiledArrays<Real>> MakeTiledArrays(const tissue::TissueModel& model);

/// Contacts of one solve, by the nodes that they touch.
struct TiledContacts {
  std::vector<ContactEntry> contacts;
  std::vector<std::uint32_t> touched_nodes, touch_starts, touch_entries;
};

/// Refills `result` without allocating once it has grown.
void FillContacts(std::span<const std::uint32_t> renumbered, const tissue::TissueModel& model,
                  std::span<const tissue::ContactSpring> contacts, TiledContacts& result);

}  // namespace trocar::tissue_cuda
