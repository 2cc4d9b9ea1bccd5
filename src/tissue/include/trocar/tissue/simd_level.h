// SPDX-License-Identifier: Apache-2.0
/// \file simd_level.h  Which vector instructions the solvers' inner loops use.
#pragma once

#include "trocar/core/simd_level.h"

namespace trocar::tissue {

/// The inner loops exist once for each level. None reorders or approximates, and each rounds a product and a
/// sum together only where it says so: one level's bits do not depend on compiler or optimisation. AVX2 and
/// AVX-512 give the same bits; the baseline has no fused multiply-add and differs in the last place.
using core::SimdLevel;

using core::FindSimdLevel;
using core::HasSimdLevel;
using core::SimdLevelName;

}  // namespace trocar::tissue
