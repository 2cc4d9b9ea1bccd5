// SPDX-License-Identifier: Apache-2.0
/// \file validity_note.h  Expert sets and the coach's rules; which of an attempt's numbers tell novices from experts, beside the numbers.
#pragma once

#include <string>

#include "trocar/base/result.h"
#include "trocar/training/coach.h"
#include "trocar/training/metric_value.h"
#include "trocar/training/validity.h"

namespace trocar::cli {

/// The delivered expert sets, or those of a file. \return the file's error
base::Result<training::Validity> ReadValidity(const std::string& path = {});

/// The delivered rules of the coach, or those of a file. \return the file's error
base::Result<training::CoachRules> ReadCoachRules(const std::string& path = {});

/// Key of the task that a recording is of: the name, or that of its file.
std::string TaskKey(const std::string& description_name);

/// For a person: which of these numbers do not separate scripted novices and experts, or that nobody asked.
std::string FormatValidityNote(const training::AttemptMetrics& metrics, const std::string& task,
                               const training::TaskValidity* validity);

}  // namespace trocar::cli
