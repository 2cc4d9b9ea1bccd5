// SPDX-License-Identifier: Apache-2.0
/// \file trace_file.h  Traces as text, for other programs: schemas/trace.schema.json describes the JSON.
#pragma once

#include <string>
#include <string_view>

#include "trocar/base/result.h"
#include "trocar/training/attempt_trace.h"

namespace trocar::training {

/// Everything in a trace; numbers with all their digits. Columns of a hand that keep their default are left out.
std::string FormatTraceJson(const AttemptTrace& trace);
/// \param name  for messages
/// \return kJsonSyntax; kJsonField for a field that is missing, of the wrong kind or out of range, with its path
base::Result<AttemptTrace> ParseTraceJson(std::string_view text, const std::string& name);
/// Hands and camera tick by tick, with a heading; without events, clips and all else that is not per tick.
std::string FormatTraceCsv(const AttemptTrace& trace);

}  // namespace trocar::training
