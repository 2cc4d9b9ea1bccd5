// SPDX-License-Identifier: Apache-2.0
/// \file spring_slices.h  Any model in single-precision displacements, its nodes in slices.
#pragma once

#include <span>
#include <vector>

#include "linearisation.h"

namespace trocar::tissue {

/// The iteration on an irregular mesh. Displacements are stored, as in SpringGrid.
class SpringSlices {
 public:
  /// Takes a model over, without displacements.
  /// \param model  must outlive this
  /// \note Allocates nothing where Reserve() was enough.
  void SetModel(const OrderedModel& model);
  /// Capacity for `share` times more links than `like` has.
  void Reserve(const OrderedModel& like, double share);

  /// \param springs  of the model
  /// \param load     in the solvers' order, without contacts
  void SetLoad(const OrderedModel& model, const OrderedSprings& springs, const OrderedLoad& load,
               std::span<const std::uint8_t> strand_is_intact) noexcept;
  void SetDisplacement(std::uint32_t node, const math::Vec3& u) noexcept;
  math::Vec3 GetDisplacement(std::uint32_t node) const noexcept {
    const float* const u = is_by_slice_ ? u_by_slice_.data() + BySlice(node) : &u_[node].x;
    const std::size_t apart = is_by_slice_ ? kSliceNodes : 1;
    return {static_cast<double>(u[0]), static_cast<double>(u[apart]), static_cast<double>(u[2 * apart])};
  }
  /// Adds to the load on a node, until the next SetLoad [N].
  void AddForce(std::uint32_t node, const math::Vec3& force) noexcept;
  /// One iteration.
  /// \return largest residual before it [N], NaN where one is; 0 unless measured
  double Step(const Kernels& kernels, Workers& workers, float omega, float damping, bool is_first,
              bool is_measured) noexcept;
  /// Iterations one after the other, to the same bits as by Step(); several follow each other closely through the mesh,
  /// so that a spring that has come from memory serves them all (Wellein, Hager, Zeiser, Wittmann, Fehske, "Efficient
  /// temporal blocking for stencil computations by multicore-aware wavefront parallelization", COMPSAC 2009).
  ///
  /// \param omegas       of each iteration
  /// \param is_first     the first of them, of its cycle
  /// \param is_measured  the last of them
  double Iterate(const Kernels& kernels, Workers& workers, std::span<const float> omegas, float damping,
                 bool is_first, bool is_measured) noexcept;
  /// Whether kernels that can look most neighbours up, several at a time.
  bool HasLookups() const { return has_lookups_; }
  /// Ranges of the mesh that threads work on side by side where iterations follow each other; 0 where none do, because
  /// neighbours lie too far apart for so small a mesh.
  std::uint32_t CountRanges(int threads) const;
  double LowestEigenvalue() const { return lowest_; }
  double SmallestShape() const { return smallest_shape_; }
  double LargestDisplacement() const noexcept;

 private:
  /// Place of a node's displacement along x by slice; y and z lie kSliceNodes apart.
  static std::size_t BySlice(std::uint32_t node) {
    return std::size_t{node / kSliceNodes} * 3 * kSliceNodes + node % kSliceNodes;
  }
  void SetLookups();
  SliceStep MakeStep(const Kernels& kernels, float omega, float damping, bool is_first,
                     bool is_measured) noexcept;
  void SwapDisplacements() noexcept;
  double FollowEachOther(const Kernels& kernels, Workers& workers, std::span<const SliceStep> steps,
                         std::uint32_t ranges) noexcept;

  const SliceLayout* layout_ = nullptr;
  std::uint32_t reach_ = 0;                 // slices to the farthest neighbour
  std::vector<SliceLookup> lookups_;        // as in SliceStep
  std::vector<std::uint8_t> is_scattered_;  // as in SliceStep
  bool has_lookups_ = false;                // for most steps
  bool is_by_slice_ = false;                // where the last step left the displacements
  math::AlignedVector<float> springs_, nodes_, u_by_slice_, previous_by_slice_;
  math::AlignedVector<Float4> u_, previous_;
  double lowest_ = 0, smallest_shape_ = 0;
};

}  // namespace trocar::tissue
