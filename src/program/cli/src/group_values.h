// SPDX-License-Identifier: Apache-2.0
/// \file group_values.h  Comparison of a report's metrics with the values of a group's people.
#pragma once

#include <string>

#include "store_console.h"
#include "trocar/report/attempt_report.h"

namespace trocar::cli {

/// Gives each metric of the whole attempt the group's values, where enough people have completed the task at this level; else the
/// report says why not. Nobody's name or pseudonym goes into it.
/// \return kStoreUnknown of the group, or what the store answers
base::Status CompareWithGroup(report::AttemptReport& report, StoreSession& session, const std::string& group);

}  // namespace trocar::cli
