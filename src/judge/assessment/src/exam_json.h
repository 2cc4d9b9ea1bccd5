// SPDX-License-Identifier: Apache-2.0
/// \file exam_json.h  An exam's settings as canonical JSON: keys in their order, no spaces, only texts, whole numbers and lists.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "trocar/assessment/exam.h"
#include "trocar/host/json.h"

namespace trocar::assessment {

enum class ExamPart {
  kPublished,  ///< without seed and nonce
  kSealed,     ///< what is committed to: without the commitment
  kAll
};
nlohmann::json ExamJson(const ExamSettings& settings, ExamPart part);

/// The reverse of kAll, wherever it stands in a document; complains there.
ExamSettings ReadExamFields(const host::JsonView& view, ExamPart part);

/// One line, ending with a newline.
std::string DumpCanonical(const nlohmann::json& json);

/// "2026-11-25T03:10:00Z"
std::string NowText();

}  // namespace trocar::assessment
