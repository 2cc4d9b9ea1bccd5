// SPDX-License-Identifier: Apache-2.0
/// \file hand.h  The surgeon's hands, one instrument in each.
#pragma once

namespace trocar::instrument {

/// Index of a hand in every per-hand array.
enum Hand { kLeft = 0, kRight = 1 };
inline constexpr int kHandCount = 2;

}  // namespace trocar::instrument
