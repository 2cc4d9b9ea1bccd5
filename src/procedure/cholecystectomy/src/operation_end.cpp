// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/operation_end.h"

namespace trocar::cholecystectomy {

std::string_view NameOf(OperationEnd end) noexcept {
  switch (end) {
    case OperationEnd::kCompleted:
      return "completed";
    case OperationEnd::kConversion:
      return "conversion";
    case OperationEnd::kUnfinished:
      break;
  }
  return "unfinished";
}

OperationEnd JudgeEnd(bool is_completed, bool has_bailed_out, const ErrorLog& errors,
                      const InjuryReport& injuries) noexcept {
  if (is_completed) return OperationEnd::kCompleted;
  const bool is_harmless = errors.Count(Severity::kCritical) == 0 && injuries.strasberg < Strasberg::kB &&
                           !injuries.is_right_liver_without_blood;
  return has_bailed_out && is_harmless ? OperationEnd::kConversion : OperationEnd::kUnfinished;
}

}  // namespace trocar::cholecystectomy
