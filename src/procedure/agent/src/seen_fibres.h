// SPDX-License-Identifier: Apache-2.0
/// \file seen_fibres.h  Fibres of bed and hepatocystic triangle: which are left, what they cover, where the organ peels off.
#pragma once

#include <cstdint>
#include <vector>

#include "surgeon_view.h"
#include "trocar/collision/queries.h"

namespace trocar::agent {

/// Of the triangle that is to be clear: a little more than the critical view asks [-].
inline constexpr double kCleared = 0.91;

/// Share of the strands that is intact; 0 of none [-].
double ShareLeft(const SurgeonView& view, const std::vector<std::uint32_t>& strands);

/// Fibres that cover the ends of the tubes that enter the gallbladder, parted ones among them.
std::vector<std::uint32_t> FindCoveringStrands(const SurgeonView& view);
/// Whether each tube that still enters the gallbladder lies bare next to it, as far as the view asks and a little more.
bool AreTubesBare(const SurgeonView& view);
bool IsTriangleClear(const SurgeonView& view);
/// The lower third of the bed, as the critical view asks.
bool IsLowerThirdFree(const SurgeonView& view);
/// Hardly a fibre of the bed is left.
bool HangsFree(const SurgeonView& view);

/// The first fibres of those that are left, from the neck or from the fundus on: there the gallbladder peels off. At least one.
/// \pre one is left
std::vector<std::uint32_t> FindPeelStrands(const SurgeonView& view, const std::vector<std::uint32_t>& bed,
                                           bool is_from_fundus = false);

/// Fibres by which a duct or artery that is whole enters the gallbladder.
std::vector<collision::Segment> FindWholeEntries(const SurgeonView& view);

}  // namespace trocar::agent
