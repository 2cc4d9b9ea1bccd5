// SPDX-License-Identifier: Apache-2.0
#include "trocar/procedures/operation_end.h"

#include <algorithm>

namespace trocar::procedures {

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

OperationEnd JudgeEnd(const simulation::OperationResult& result, bool has_bailed_out) noexcept {
  if (result.is_completed) return OperationEnd::kCompleted;
  const auto& findings = result.procedure.findings;
  const bool is_harmless = result.procedure.errors.Count(surgery::Severity::kCritical) == 0 &&
                           std::none_of(findings.begin(), findings.end(),
                                        [](const scene::Finding& finding) { return finding.is_harm; });
  return has_bailed_out && is_harmless ? OperationEnd::kConversion : OperationEnd::kUnfinished;
}

}  // namespace trocar::procedures
