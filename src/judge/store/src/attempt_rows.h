// SPDX-License-Identifier: Apache-2.0
// Rows of attempts that more than one source needs.
#pragma once

#include <string_view>
#include <vector>

#include "database.h"
#include "trocar/store/attempts.h"
#include "trocar/training/metric_value.h"

namespace trocar::store {

/// Which attempts count: as VerificationMark::Counts, and completed.
#define TROCAR_COUNTS \
  "attempt.completed = 1 AND attempt.verification IN ('verified', 'recorded_here', 'accepted')"

/// Checks an attempt as AddAttempt does. \return kStoreInvalid
base::Status CheckAttempt(const Attempt& attempt);
/// Checks that an outcome is not nested too deep or too long for the store's readers. A text that is no JSON is kept as it is.
/// \return kStoreInvalid
base::Status CheckOutcome(std::string_view outcome);
/// Whether the store has it as somebody else's, or as nobody's where it is somebody's.
base::Result<bool> IsAnothers(Database& database, const Attempt& attempt);
/// The metrics in the order of their key, with the score and the length.
std::vector<training::MetricValue> ListMetrics(const Attempt& attempt);

/// In the order of their key.
base::Result<std::vector<training::MetricValue>> ReadMetrics(Database& database, std::int64_t attempt);

/// A person's standings from their attempts, as AddAttempt would have made them one by one.
base::Status RecalcStandings(Database& database, std::int64_t person);

}  // namespace trocar::store
