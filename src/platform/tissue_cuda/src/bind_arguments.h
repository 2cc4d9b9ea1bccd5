// SPDX-License-Identifier: Apache-2.0
/// \file bind_arguments.h  Gives a model's arrays to whoever holds memory for kernels (the GPU, or the host
/// executor) and names them in the kernels' arguments.
///
/// A memory has Filled(name, vector), which copies, or names nothing for an empty vector, and
/// Array<T>(name, count), which leaves the contents open.
#pragma once

#include "kernels/paper_layouts.h"
#include "kernels/tiled_args.h"
#include "paper_arrays.h"
#include "tiled_arrays.h"
#include "trocar/tissue_cuda/gpu_solver.h"

namespace trocar::tissue_cuda {

/// Binds the arrays that stay as long as the model does. Positions, forces and factors come with each solve.
template <typename Real, typename Heap>
PaperArgs<Real, typename Heap::Memory> BindPaperArrays(const PaperArrays<Real>& arrays, Heap& heap) {
  PaperArgs<Real, typename Heap::Memory> args;
  args.points = arrays.points;
  args.pitch = arrays.pitch;
  args.max_neighbors = arrays.max_neighbors;
  args.columns = arrays.grid.columns;
  args.rows = arrays.grid.rows;
  args.mesh_stiffness = arrays.mesh_stiffness;
  args.neighbors = heap.Filled("neighbors", arrays.neighbors);
  args.connected = heap.Filled("connected", arrays.connected);
  args.length_rest = heap.Filled("length_rest", arrays.length_rest);
  args.link_stiffness = heap.Filled("link_stiffness", arrays.link_stiffness);
  args.rest_points = heap.Filled("rest_points", arrays.rest_points);
  return args;
}

/// Factors of one solve.
template <typename Real, typename Memory>
void SetPaperLoad(const tissue::TissueLoad& load, double alpha, PaperArgs<Real, Memory>& args) {
  args.alpha = static_cast<Real>(alpha);
  args.stiffness_scale = static_cast<Real>(load.stiffness_scale);
  args.shape_scale = static_cast<Real>(load.shape_scale);
  args.gravity = {static_cast<Real>(load.gravity.x), static_cast<Real>(load.gravity.y),
                  static_cast<Real>(load.gravity.z)};
}

/// Binds the arrays that stay as long as the model does, and working memory.
template <typename Real, typename Heap>
TiledArgs<Real, typename Heap::Memory> BindTiledArrays(const TiledArrays<Real>& arrays, Heap& heap) {
  TiledArgs<Real, typename Heap::Memory> args;
  args.mesh.nodes = arrays.nodes;
  args.mesh.tiles = arrays.tiles;
  args.mesh.max_border = arrays.max_border;
  args.mesh.max_links = arrays.max_links;
  args.mesh.model_index = heap.Filled("model_index", arrays.model_index);
  args.mesh.rest = heap.Filled("rest", arrays.rest);
  args.mesh.mass = heap.Filled("mass", arrays.mass);
  args.mesh.shape_stiffness = heap.Filled("shape_stiffness", arrays.shape_stiffness);
  args.mesh.slice_starts = heap.Filled("slice_starts", arrays.slice_starts);
  args.mesh.link_vectors = heap.Filled("link_vectors", arrays.link_vectors);
  args.mesh.link_rests = heap.Filled("link_rests", arrays.link_rests);
  args.mesh.link_others = heap.Filled("link_others", arrays.link_others);
  args.mesh.link_locals = heap.Filled("link_locals", arrays.link_locals);
  args.mesh.border_starts = heap.Filled("border_starts", arrays.border_starts);
  args.mesh.borders = heap.Filled("borders", arrays.borders);
  args.mesh.strand_starts = heap.Filled("strand_starts", arrays.strand_starts);
  args.mesh.strands = heap.Filled("strands", arrays.strands);
  const std::size_t all = arrays.model_index.size();
  args.displacements = heap.template Array<Quad<Real>>("displacements", 2 * all);
  args.node_constants = heap.template Array<Quad<Real>>("node_constants", 3 * all);
  args.maxima = heap.template Array<Key>("maxima", kMaximaSets * kMaxima);
  args.control = heap.template Array<ChebyshevControl<Real>>("control", 1);
  args.report = heap.template Array<TiledReport>("report", 1);
  return args;
}

/// Factors of one solve.
template <typename Real, typename Memory>
void SetTiledLoad(const GpuSettings& settings, const tissue::TissueLoad& load,
                  TiledArgs<Real, Memory>& args) {
  args.settings = {};
  args.settings.max_iterations = static_cast<std::uint32_t>(settings.max_iterations);
  args.settings.tolerance = static_cast<Real>(settings.tolerance);
  args.stiffness_scale = static_cast<Real>(load.stiffness_scale);
  args.shape_scale = static_cast<Real>(load.shape_scale);
  args.gravity = {load.gravity.x, load.gravity.y, load.gravity.z};
}

}  // namespace trocar::tissue_cuda
