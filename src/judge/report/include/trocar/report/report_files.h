// SPDX-License-Identifier: Apache-2.0
/// \file report_files.h  Reports for other programs: CSV and JSON, with a dictionary of every field.
/// Files: schemas/report.schema.json.
#pragma once

#include <string>
#include <vector>

#include "trocar/report/attempt_report.h"

namespace trocar::report {

/// Meaning of a column or field.
struct FieldMeaning {
  std::string field;  ///< "attempt.started", "path_length"
  std::string meaning, unit, source;
};
/// Of both files: the fields first, then every metric as its definition says.
std::vector<FieldMeaning> MakeDataDictionary();

/// Long form, one number in a row: attempt, person, task, level, patient, seed, started, measure, hand, phase, tool, value, unit. Values are
/// in the definitions' SI units. RFC 4180, UTF-8. A text that a spreadsheet would take for a formula begins with an apostrophe.
std::string FormatCsv(const AttemptReport& report);
/// The dictionary as CSV.
std::string FormatDictionaryCsv();
/// Everything but pictures and plots; "dictionary" explains each field that is there.
std::string FormatJson(const AttemptReport& report);

}  // namespace trocar::report
