// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_editor_run.h"

#include <cstdio>

#include "trocar/gui/window_screenshot.h"
#include "trocar/host/json_text.h"

namespace trocar::editor {
namespace {

constexpr unsigned kPeriod = 50;  // between looks whether the patient is there [ms]

}  // namespace

PatientEditorRun::PatientEditorRun(const Parts& parts) : at_(parts) {
  timer_ = Glib::signal_timeout().connect([this] { return OnTime(); }, kPeriod);
}

PatientEditorRun::~PatientEditorRun() {
  timer_.disconnect();
}

/// \return whether it is called again
bool PatientEditorRun::OnTime() {
  if (at_.presenter.Editor() == nullptr) return !at_.presenter.GetFailure();
  Look();
  timer_ = Glib::signal_timeout().connect(
      [this] {
        SaveScreenshot();
        return false;
      },
      static_cast<unsigned>(1000 * at_.presenter.GetOptions().run.screenshot_after));
  return false;
}

void PatientEditorRun::Look() {
  const EditorTool tool = at_.presenter.Editor()->tool;
  if (tool != EditorTool::kTubes && tool != EditorTool::kLandmarks) return;
  at_.view.LookFrom(render::Viewpoint::kUmbilicus);
  at_.presenter.LookAt(tool == EditorTool::kTubes ? NameOf(roles::TubeRole::kCysticDuct)
                                                  : NameOf(roles::OrganRole::kGallbladder));
}

void PatientEditorRun::SaveScreenshot() {
  const auto& file = at_.presenter.GetOptions().run.screenshot;
  if (const auto status = gui::SaveScreenshot(at_.window, file); !status)
    return at_.presenter.Fail(status.error());
  std::printf("{\"screenshot\": %s, \"width\": %d, \"height\": %d, \"tubes\": %zu}\n",
              host::QuoteJson(file.filename().string()).c_str(), at_.window.get_width(),
              at_.window.get_height(), at_.presenter.Editor()->GetPatient().tubes.size());
  at_.window.close();
}

}  // namespace trocar::editor
