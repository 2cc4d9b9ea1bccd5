// SPDX-License-Identifier: Apache-2.0
/// \file simd_level.h  Which vector instructions the solvers' inner loops use.
#pragma once

#include "trocar/core/simd_level.h"

namespace trocar::tissue {

/// The inner loops exist once for each level, of one body. None reorders, approximates or fuses: all give the same bits, with
/// every compiler and optimisation.
using core::SimdLevel;

using core::FindSimdLevel;
using core::HasSimdLevel;
using core::SimdLevelName;

}  // namespace trocar::tissue
