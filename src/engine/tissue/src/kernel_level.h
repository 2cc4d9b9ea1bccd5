// SPDX-License-Identifier: Apache-2.0
/// \file kernel_level.h  All inner loops of one level of vector instructions. Included by kernels_*.cpp only.
#pragma once

#include "kernel_balance.h"
#include "kernel_bodies.h"
#include "kernel_table.h"
#include "kernel_vectors.h"

namespace trocar::tissue {
namespace {

constexpr Kernels kKernels = {
    .multiply = MultiplyLinks,
    .step_slices = StepSlices,
    .looks_up = TROCAR_LANES == 16,
    .step_rows = StepRows,
    .calc_follower_stiffness = CalcFollowerStiffness,
    .balance = CalcBalance,
    .invert_blocks = InvertBlocks,
    .vectors = {CalcDot, FindLargest2, Advance, AddScaled, ScaleAndAdd},
};

}  // namespace
}  // namespace trocar::tissue
