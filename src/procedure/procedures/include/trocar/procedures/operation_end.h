// SPDX-License-Identifier: Apache-2.0
/// \file operation_end.h  How an operation ended: finished, ended early for safety, or neither.
/// Source: domain facts, section 1.2: where the view that has to be reached cannot be had, stopping, asking for help and converting
/// are the right answers, not failures.
#pragma once

#include <string_view>

#include "trocar/simulation/operation_result.h"

namespace trocar::procedures {

enum class OperationEnd {
  kCompleted,   ///< what was to be taken out has left the abdomen in its bag
  kConversion,  ///< a bail-out: said to be one, and nothing that must stay was harmed
  kUnfinished   ///< neither; also a bail-out that came after the harm was done
};
/// "completed", "conversion", "unfinished"
std::string_view NameOf(OperationEnd end) noexcept;

/// \param has_bailed_out  the operator ended it and said why
OperationEnd JudgeEnd(const simulation::OperationResult& result, bool has_bailed_out) noexcept;

}  // namespace trocar::procedures
