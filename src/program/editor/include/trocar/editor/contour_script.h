// SPDX-License-Identifier: Apache-2.0
/// \file contour_script.h  The contour window's commands as text, one a line: for samples, tests and
/// pictures.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/editor/contour_editor.h"

namespace trocar::editor {

struct ScriptStep {
  int line = 0;  ///< in the file, from 1
  std::string verb;
  std::vector<std::string> words;  ///< what follows it
};

/// Reads a script. Empty lines and what follows # are skipped.
///
/// \return kScriptInvalid with the line, for an unknown verb or a wrong number of words
base::Result<std::vector<ScriptStep>> ParseContourScript(std::string_view text, std::string_view source);

/// Does one step. Coordinates are pixels of the picture.
/// \return false when the step is the window's affair; the refusal of a command, or kScriptInvalid for a word
/// that is no number, both with the line
base::Result<bool> RunScriptStep(const ScriptStep& step, ContourEditor& editor);

/// All verbs with their words and meaning, for --help and the docs.
std::string DescribeContourScript();

}  // namespace trocar::editor
