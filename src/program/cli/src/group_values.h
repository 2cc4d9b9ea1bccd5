// SPDX-License-Identifier: Apache-2.0
/// \file group_values.h  What the people of a group came to, beside the metrics of a report.
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
