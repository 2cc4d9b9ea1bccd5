// SPDX-License-Identifier: Apache-2.0
/// \file patient_editor_options.h  Options of the patient editor.
#pragma once

#include <filesystem>

#include "trocar/editor/patient_editor.h"
#include "trocar/gui/run_options.h"

namespace trocar::editor {

struct PatientEditorOptions {
  std::filesystem::path patient;  ///< folder
  EditorTool tool = EditorTool::kLook;
  gui::RunOptions run;
};

}  // namespace trocar::editor
