// SPDX-License-Identifier: Apache-2.0
/// \file data_card.h  Data card of a data set: what it holds, how it was made, its licence, seeds, hash and gaps.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "layout_set.h"

namespace trocar::dataset {

struct CardSummary {
  std::string hash;       ///< SHA-256 of SHA256SUMS
  std::size_t files = 0;  ///< that it names
};
/// Writes SHA256SUMS, as `sha256sum -c` reads it, then README.md, which says it to people, and card.json.
/// \return kFileUnwritable, kFileUnreadable
base::Result<CardSummary> WriteCard(const std::filesystem::path& folder, const Plan& plan,
                                    const LayoutSet& layout, std::span<const VideoResult> videos);

}  // namespace trocar::dataset
