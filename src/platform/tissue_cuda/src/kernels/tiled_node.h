// SPDX-License-Identifier: Apache-2.0
/// \file tiled_node.h  Computation of one node in our own layout: its forces, its 3 x 3 block, its step. Both
/// kernels of tiled_chebyshev.h share it; they differ in where they read.
/// Source of the mathematics: tissue/chebyshev_jacobi_wang2015.cpp.
#pragma once

#include "tiled_args.h"

namespace trocar::tissue_cuda {

/// Below this squared length a spring counts as having no direction [m^2].
template <typename Real>
TROCAR_HD Real NoLength2() {
  return sizeof(Real) == 4 ? Real(1e-30) : Real(1e-200);
}

/// Symmetric 3 x 3 matrix.
template <typename Real>
struct Symmetric {
  Real xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  TROCAR_HD void AddDirection(Triple<Real> u, Real k) {
    xx += k * u.x * u.x, xy += k * u.x * u.y, xz += k * u.x * u.z;
    yy += k * u.y * u.y, yz += k * u.y * u.z, zz += k * u.z * u.z;
  }
  TROCAR_HD void AddIsotropic(Real k) { xx += k, yy += k, zz += k; }
  TROCAR_HD Triple<Real> Times(Triple<Real> v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  /// Inverse of a positive definite matrix, else zero. Scaled first: three stiffnesses multiplied may leave
  /// single precision.
  TROCAR_HD Symmetric Inverse() const {
    const Real size = xx + yy + zz;
    if (!(size > Real(0))) return {};
    const Real s = Real(1) / size;
    const Symmetric m{s * xx, s * xy, s * xz, s * yy, s * yz, s * zz};
    const Real c00 = m.yy * m.zz - m.yz * m.yz, c01 = m.xz * m.yz - m.xy * m.zz,
               c02 = m.xy * m.yz - m.xz * m.yy;
    const Real determinant = m.xx * c00 + m.xy * c01 + m.xz * c02;
    if (!(determinant > Real(0))) return {};
    const Real t = s / determinant;
    return {t * c00,
            t * c01,
            t * c02,
            t * (m.xx * m.zz - m.xz * m.xz),
            t * (m.xy * m.xz - m.xx * m.yz),
            t * (m.xx * m.yy - m.xy * m.xy)};
  }
};

/// A node's share of what stays for a solve, and its inverse block, which stays for a cycle.
template <typename Real>
struct NodeConstants {
  Symmetric<Real> inverse;
  Real shape_stiffness = 0;     ///< scaled [N/m]
  Triple<Real> force{0, 0, 0};  ///< weight and external force [N]
  bool is_free = false, is_touched = false, has_strands = false;
};

/// One spring at displacement difference d = u_other - u_here.
template <typename Real>
struct Stretch {
  Triple<Real> along;  ///< r + d [m]
  Real length2 = 0, length = 0;
  Real strain = 0;  ///< (L - l) / L; 0 without direction [-]
  bool has_direction = false;

  TROCAR_HD Stretch(const RestLink<Real>& link, Triple<Real> d) {
    const Triple<Real> r = First3(link.vector_stiffness);
    along = r + d;
    length2 = Dot(along, along);
    has_direction = length2 > NoLength2<Real>();
    if (!has_direction) return;
    length = SquareRoot(length2);
    // L^2 - l^2 without the cancellation of L - l
    const Real difference = link.excess + (Real(2) * Dot(r, d) + Dot(d, d));
    strain = difference / ((length + link.length) * length);
  }
};

template <typename Real, typename Memory>
TROCAR_HD Triple<Real> LoadDisplacement(const TiledArgs<Real, Memory>& args, std::uint32_t parity,
                                        std::uint32_t node) {
  return First3(
      Load(args.displacements, static_cast<std::size_t>(parity) * args.mesh.tiles * kTileNodes + node));
}

/// Place of a node among the touched ones; the node is there.
template <typename Real, typename Memory>
TROCAR_HD std::uint32_t FindTouched(const TiledArgs<Real, Memory>& args, std::uint32_t node) {
  std::uint32_t low = 0, high = args.touched;
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (Load(args.touched_nodes, middle) < node) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}
template <typename Real, typename Memory>
TROCAR_HD bool IsTouched(const TiledArgs<Real, Memory>& args, std::uint32_t node) {
  const std::uint32_t at = FindTouched(args, node);
  return at < args.touched && Load(args.touched_nodes, at) == node;
}

/// Calls visit(contact, corner) for every contact at a touched node, in the order of the load.
template <typename Real, typename Memory, typename Visit>
TROCAR_HD void ForEachContact(const TiledArgs<Real, Memory>& args, std::uint32_t node, const Visit& visit) {
  const std::uint32_t at = FindTouched(args, node);
  for (std::uint32_t e = Load(args.touch_starts, at); e < Load(args.touch_starts, at + 1); ++e) {
    const std::uint32_t entry = Load(args.touch_entries, e);
    const ContactEntry contact = Load(args.contacts, entry / 4);
    visit(contact, entry % 4);
  }
}

/// Weight of a corner; chosen by comparisons, because an index would move the entry from registers to memory.
TROCAR_HD double CornerWeight(const ContactEntry& contact, std::uint32_t corner) {
  return corner == 0 ? contact.weights[0] : corner == 1 ? contact.weights[1] : contact.weights[2];
}

/// Strands and pressing contacts at a node, which few nodes have [N]; strands unscaled in the sum, as
/// springs.
template <typename Real, typename Memory>
TROCAR_HD Triple<Real> CalcOtherForce(const TiledArgs<Real, Memory>& args,
                                      const NodeConstants<Real>& constants, std::uint32_t parity,
                                      std::uint32_t node, Triple<Real> here) {
  Triple<Real> force = constants.force;
  if (constants.has_strands) {
    Triple<Real> pull{0, 0, 0};
    for (std::uint32_t e = Load(args.mesh.strand_starts, node); e < Load(args.mesh.strand_starts, node + 1);
         ++e) {
      const HalfStrandEntry strand = Load(args.mesh.strands, e);
      if (Load(args.intact, strand.strand) == 0) continue;
      pull = pull + Real(strand.stiffness) * (LoadDisplacement(args, parity, strand.other) - here);
    }
    force = force + args.stiffness_scale * pull;
  }
  if (constants.is_touched) {
    ForEachContact(args, node, [&](const ContactEntry& contact, std::uint32_t corner) {
      const Triple<Real> normal{Real(contact.normal[0]), Real(contact.normal[1]), Real(contact.normal[2])};
      Real depth = Real(contact.rest_depth);
      for (int c = 0; c < 3; ++c) {
        depth -= Real(contact.weights[c]) * Dot(normal, LoadDisplacement(args, parity, contact.nodes[c]));
      }
      if (depth > Real(0))
        force = force + (Real(CornerWeight(contact, corner)) * Real(contact.stiffness) * depth) * normal;
    });
  }
  return force;
}

/// Inverse of the stiffness that a node itself feels.
///
/// \param for_each_link  calls its argument with (link, displacement of the other node) for each spring
template <typename Real, typename Memory, typename ForEachLink>
TROCAR_HD Symmetric<Real> CalcInverseBlock(const TiledArgs<Real, Memory>& args,
                                           const NodeConstants<Real>& constants, Real transverse_share,
                                           std::uint32_t node, Triple<Real> here,
                                           const ForEachLink& for_each_link) {
  Symmetric<Real> block;
  if (!constants.is_free) return block;
  for_each_link([&](const RestLink<Real>& link, Triple<Real> there) {
    const Real stiffness = args.stiffness_scale * link.vector_stiffness.w;
    const Stretch<Real> stretch(link, there - here);
    if (!stretch.has_direction) {
      block.AddIsotropic(stiffness);
      return;
    }
    const Real across = Larger(transverse_share, stretch.strain);
    block.AddDirection((Real(1) / stretch.length) * stretch.along, stiffness * (Real(1) - across));
    block.AddIsotropic(stiffness * across);
  });
  if (constants.has_strands) {
    for (std::uint32_t e = Load(args.mesh.strand_starts, node); e < Load(args.mesh.strand_starts, node + 1);
         ++e) {
      const HalfStrandEntry strand = Load(args.mesh.strands, e);
      if (Load(args.intact, strand.strand) != 0)
        block.AddIsotropic(args.stiffness_scale * Real(strand.stiffness));
    }
  }
  block.AddIsotropic(constants.shape_stiffness);
  // a touched node counts as pressed, so that a contact that opens and closes cannot make it jump
  if (constants.is_touched) {
    ForEachContact(args, node, [&](const ContactEntry& contact, std::uint32_t corner) {
      block.AddDirection({Real(contact.normal[0]), Real(contact.normal[1]), Real(contact.normal[2])},
                         Real(CornerWeight(contact, corner)) * Real(contact.stiffness));
    });
  }
  return block.Inverse();
}

/// One step of the recurrence.
///
/// \param[in,out] maxima  raised by what this node finds
/// \return the node's next displacement; `here` where it is prescribed
template <typename Real, typename Memory, typename ForEachLink>
TROCAR_HD Triple<Real> CalcNextDisplacement(const TiledArgs<Real, Memory>& args,
                                            const NodeConstants<Real>& constants,
                                            const ChebyshevControl<Real>& control, std::uint32_t node,
                                            Triple<Real> here, Triple<Real> before,
                                            const ForEachLink& for_each_link, IterationMaxima<Real>& maxima) {
  if (!constants.is_free) return here;
  Triple<Real> springs{0, 0, 0};
  Real largest2 = 0;
  for_each_link([&](const RestLink<Real>& link, Triple<Real> there) {
    const Stretch<Real> stretch(link, there - here);
    const Real secant = link.vector_stiffness.w * stretch.strain;
    springs = springs + secant * stretch.along;
    largest2 = Larger(largest2, secant * secant * stretch.length2);
  });
  const Triple<Real> shape = (-constants.shape_stiffness) * here;
  const Triple<Real> other = CalcOtherForce(args, constants, control.Parity(), node, here);
  const Triple<Real> force = args.stiffness_scale * springs + shape + other;
  const Real residual2 = Dot(force, force);
  // NaN stays once it is there
  const bool is_kept = maxima.residual2 != maxima.residual2 || residual2 <= maxima.residual2;
  maxima.residual2 = is_kept ? maxima.residual2 : residual2;
  largest2 = args.stiffness_scale * args.stiffness_scale * largest2;
  maxima.force2 = Larger(maxima.force2, Larger(largest2, Larger(Dot(shape, shape), Dot(other, other))));

  Triple<Real> step = control.damping * constants.inverse.Times(force);
  const Real step2 = Dot(step, step), limit = args.settings.max_step;
  if (step2 > limit * limit) {
    step = (limit / SquareRoot(step2)) * step;
    maxima.is_cut_short = true;
  }
  return control.omega * ((here + step) - before) + before;
}

}  // namespace trocar::tissue_cuda
