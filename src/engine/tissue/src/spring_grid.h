// SPDX-License-Identifier: Apache-2.0
/// \file spring_grid.h  A structured mesh in single-precision displacements, taken as a stencil.
///
/// Displacements, not positions, are stored: near equilibrium they are small where positions are large, and
/// what a float loses it loses from the smaller number. A spring's extent is its rest offset, rounded once
/// from double precision, plus the difference of two displacements.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kernels.h"
#include "trocar/math/aligned_vector.h"
#include "trocar/tissue/tissue_model.h"
#include "workers.h"

namespace trocar::tissue {

/// Rows and columns of a model whose node (row, column) has the index row * columns + column and whose
/// springs go to at most its eight neighbours.
struct GridShape {
  std::uint32_t rows = 0, columns = 0;
};
/// Recognises a structured mesh in a general model; nothing for all others, and for models with strands.
std::optional<GridShape> FindGridShape(const TissueModel& model);

/// Springs from a node towards one of its own neighbours.
struct GridSprings {
  std::vector<math::Vec3> rest_offset;  // (nodes) [m]; something other than zero where there is no spring
  std::vector<double> stiffness;        // (nodes) k [N/m], 0 where there is none
  std::vector<double> rest_length;      // (nodes) [m]
};

/// A structured mesh's springs, by node and direction.
struct GridModel {
  GridShape shape;
  std::vector<math::Vec3> rest;  // (nodes) [m]
  std::array<GridSprings, kGridDirections> springs;

  std::size_t Size() const { return rest.size(); }
};
GridModel MakeGridModel(const TissueModel& model, const GridShape& shape);

/// About half as many rows and columns, over the same rectangle: rest positions interpolated, stiffness that
/// of the nearest springs (a membrane's springs keep theirs when all lengths double), the same strain at
/// rest.
GridModel MakeCoarseGrid(const GridModel& fine);

/// Where a row or column of one grid lies in another of the same extent.
struct GridPlace {
  std::uint32_t index;  // of the one before
  float share;          // of the one after [-]
};
GridPlace FindGridPlace(std::uint32_t at, std::uint32_t count, std::uint32_t other_count) noexcept;

/// Loads and supports of one solve.
struct GridLoad {
  std::vector<math::Vec3> force;      // (nodes) [N]
  std::vector<double> shape;          // (nodes) k_virtual, scaled [N/m]
  std::vector<std::uint8_t> is_free;  // (nodes)
};

/// The iteration on one grid.
class SpringGrid {
 public:
  explicit SpringGrid(const GridModel& model);

  const GridShape& Shape() const { return shape_; }
  /// \param scale  on every spring's stiffness [-]
  void SetLoad(const GridLoad& load, double scale) noexcept;
  void SetDisplacement(std::uint32_t node, const math::Vec3& u) noexcept;
  math::Vec3 GetDisplacement(std::uint32_t node) const noexcept;
  /// Sets the free nodes' displacements by interpolation from a coarser grid.
  void Interpolate(const SpringGrid& coarse) noexcept;
  /// One iteration.
  /// \return largest residual before it [N], NaN where one is; 0 unless measured
  double Step(const Kernels& kernels, Workers& workers, float omega, float damping, bool is_first,
              bool is_measured) noexcept;
  /// Iterations one after the other; `is_first` of the first of them, `is_measured` of the last.
  double Iterate(const Kernels& kernels, Workers& workers, std::span<const float> omegas, float damping,
                 bool is_first, bool is_measured) noexcept;
  /// Smallest k_virtual / (2 sum k + k_virtual) of a free node: no eigenvalue is lower where no spring is
  /// compressed [-].
  double LowestEigenvalue() const { return lowest_; }
  double SmallestShape() const { return smallest_shape_; }  ///< of a free node [N/m]
  double LargestDisplacement() const noexcept;              ///< [m]

 private:
  /// Place of the first of a node's numbers, kSliceNodes apart, where a node has so many.
  std::size_t At(std::uint32_t node, std::uint32_t values) const {
    const std::uint32_t row = node / shape_.columns, column = node % shape_.columns;
    return (std::size_t{row} * (stride_ / kSliceNodes) + column / kSliceNodes) * values * kSliceNodes +
           column % kSliceNodes;
  }
  /// Place of a node's displacement along x; y and z lie stride_ apart.
  std::size_t DisplacementAt(std::uint32_t node) const {
    return kMargin + std::size_t{node / shape_.columns} * 3 * stride_ + node % shape_.columns;
  }

  static constexpr std::size_t kMargin = kSliceNodes;  // floats before the first row and after the last

  GridShape shape_;
  std::uint32_t stride_;
  bool is_alike_ = false;  // one row of springs stands for all but the last
  bool has_south_west_ = false;
  bool is_aligned_ = true;  // rest offsets: x alone to the east, y alone to the south, no z
  math::AlignedVector<float> springs_, last_springs_;  // as in GridStep, scaled
  std::vector<double> unscaled_;                       // (nodes, directions, 2) k and k l
  std::vector<double> sum_stiffness_;                  // (nodes) of all springs at the node
  math::AlignedVector<float> nodes_, u_, previous_, reaction_;
  std::vector<std::uint32_t> node_rows_;  // as in GridStep
  double lowest_ = 0, smallest_shape_ = 0;
};

}  // namespace trocar::tissue
