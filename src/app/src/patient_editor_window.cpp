// SPDX-License-Identifier: Apache-2.0
#include "patient_editor_window.h"

#include <cstdio>

#include "trocar/scene/scene.h"
#include "window_screenshot.h"

namespace trocar::app {
namespace {

constexpr int kWidth = 1280, kHeight = 800;
constexpr unsigned kAutosaveSeconds = 5;
constexpr unsigned kCheckDelay = 400;  // after the last change [ms]
constexpr double kFindingSpan = 0.09;  // of what is shown around a finding [m]

const char* HintOf(EditorTool tool) {
  switch (tool) {
    case EditorTool::kLook:
      return "Drag turns · right button moves · wheel zooms · 1 to 4 choose a tool";
    case EditorTool::kPaint:
      return "Drag over the organ paints · Shift erases · Ctrl+wheel: radius · beside the organ the drag "
             "turns";
    case EditorTool::kTubes:
      return "Click a duct, drag its points · wheel over a point: radius · Shift+click inserts · Delete "
             "removes";
    case EditorTool::kLandmarks:
      return "Drag a landmark's disc in the plane of the view";
  }
  return "";
}

/// Whether the folder belongs to what was delivered: it is never overwritten without a question.
bool IsDelivered(const std::filesystem::path& folder) {
  const auto data = scene::FindDataFolder();
  if (!data) return false;
  std::error_code failure;
  const auto inside = std::filesystem::relative(folder, *data / "assets", failure);
  return !failure && !inside.empty() && *inside.begin() != "..";
}

}  // namespace

PatientEditorWindow::PatientEditorWindow(const Options& options) : options_(options) {
  set_title("Trocar: patient");
  add_css_class("trocar");
  set_default_size(kWidth, kHeight);
  MakeHeader();
  MakeContent();
  ConnectView();
  const auto keys = Gtk::EventControllerKey::create();
  keys->set_propagation_phase(Gtk::PropagationPhase::CAPTURE);
  keys->signal_key_pressed().connect(
      [this](guint key, guint, Gdk::ModifierType state) { return OnKey(key, state); }, false);
  add_controller(keys);
  checked_.connect(sigc::mem_fun(*this, &PatientEditorWindow::FinishCheck));
  Glib::signal_timeout().connect_once(sigc::mem_fun(*this, &PatientEditorWindow::Open), 0);
}

PatientEditorWindow::~PatientEditorWindow() {
  check_delay_.disconnect();
  autosave_.disconnect();
  if (checker_.joinable()) checker_.join();
  panel_.SetEditor(nullptr);
}

void PatientEditorWindow::MakeHeader() {
  const auto add = [this](Gtk::Button& button, const char* tooltip, bool is_at_end, auto act) {
    button.set_tooltip_text(tooltip);
    button.set_focus_on_click(false);
    button.signal_clicked().connect(act);
    is_at_end ? header_.pack_end(button) : header_.pack_start(button);
  };
  add(undo_, "Take the last change back (Ctrl+Z)", false, [this] {
    if (editor_) editor_->Undo(), Refresh();
  });
  add(redo_, "Do it again (Shift+Ctrl+Z)", false, [this] {
    if (editor_) editor_->Redo(), Refresh();
  });
  add(save_, "Write the patient's folder (Ctrl+S)", true, [this] { Save(); });
  add(save_as_, "Write another folder (Shift+Ctrl+S)", true, [this] { SaveAs(); });
  save_.add_css_class("primary");
  set_titlebar(header_);
}

void PatientEditorWindow::MakeContent() {
  auto* middle = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
  auto* overlay = Gtk::make_managed<Gtk::Overlay>();
  overlay->set_child(view_);
  hint_.add_css_class("hint");
  hint_.set_halign(Gtk::Align::CENTER);
  hint_.set_valign(Gtk::Align::END);
  hint_.set_can_target(false);
  hint_.set_ellipsize(Pango::EllipsizeMode::END);
  overlay->add_overlay(hint_);
  overlay->set_hexpand(true);
  middle->append(*overlay);
  auto* scrolled = Gtk::make_managed<Gtk::ScrolledWindow>();
  scrolled->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scrolled->set_child(panel_);
  scrolled->set_hexpand(false);
  middle->append(*scrolled);
  middle->set_vexpand(true);
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->append(*middle);
  auto* bar = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL);
  bar->add_css_class("status");
  status_.set_xalign(0);
  status_.set_hexpand(true);
  status_.set_ellipsize(Pango::EllipsizeMode::END);
  bar->append(status_);
  all->append(*bar);
  set_child(*all);
  panel_.SignalChanged().connect(sigc::mem_fun(*this, &PatientEditorWindow::Refresh));
  panel_.SignalRefused().connect(sigc::mem_fun(*this, &PatientEditorWindow::Refuse));
  panel_.SignalLookAt().connect([this](const Glib::ustring& where) { LookAt(where); });
}

void PatientEditorWindow::ConnectView() {
  const auto has = [](Gdk::ModifierType state, Gdk::ModifierType wanted) {
    return (state & wanted) != Gdk::ModifierType{};
  };
  view_.on_press = [this, has](const MeshPick& pick) {
    if (!editor_) return false;
    const auto revision = editor_->Document().Revision();
    const bool is_taken =
        editor_->Press(pick.surface, pick.point, has(pick.keys, Gdk::ModifierType::SHIFT_MASK));
    hover_ = pick.surface;
    if (is_taken || editor_->Document().Revision() != revision) Refresh();
    return is_taken;
  };
  view_.on_drag = [this](const MeshPick& pick) {
    if (!editor_) return;
    hover_ = pick.surface;
    if (const auto status =
            editor_->Drag(pick.surface, view_.PointAtDepth(editor_->Grabbed(), pick.x, pick.y));
        !status)
      Refuse(status.error());
    ShowFigure();
  };
  view_.on_release = [this](const MeshPick&) {
    if (!editor_) return;
    editor_->Release();
    Refresh();
  };
  view_.on_hover = [this](const MeshPick& pick) {
    if (!editor_ || editor_->tool != EditorTool::kPaint) return;
    hover_ = pick.surface;
    view_.SetMarks(editor_->MakeFigure(hover_).marks);
  };
  view_.on_leave = [this] {
    hover_.reset();
    if (editor_ && editor_->tool == EditorTool::kPaint) ShowFigure();
  };
  view_.on_wheel = [this, has](const MeshPick& pick, double steps) {
    const bool is_meant =
        editor_ && editor_->Wheel(pick.point, has(pick.keys, Gdk::ModifierType::CONTROL_MASK), steps);
    if (is_meant) Refresh();
    return is_meant;
  };
  view_.SignalFailed().connect([this](const core::Error& error) {
    failure_ = error;
    Refuse(error);
    if (!options_.screenshot.empty()) may_close_ = true, close();
  });
}

bool PatientEditorWindow::OnKey(guint key, Gdk::ModifierType state) {
  if (!editor_ || is_question_open_) return false;
  const bool has_ctrl = (state & Gdk::ModifierType::CONTROL_MASK) != Gdk::ModifierType{};
  const bool has_shift = (state & Gdk::ModifierType::SHIFT_MASK) != Gdk::ModifierType{};
  const auto try_to = [this](const core::Status& status) {
    if (!status) Refuse(status.error());
  };
  if (has_ctrl) {
    switch (gdk_keyval_to_lower(key)) {
      case GDK_KEY_z:
        has_shift ? editor_->Redo() : editor_->Undo();
        break;
      case GDK_KEY_y:
        editor_->Redo();
        break;
      case GDK_KEY_s:
        has_shift ? SaveAs() : Save();
        break;
      case GDK_KEY_q:
      case GDK_KEY_w:
        close();
        return true;
      default:
        return false;
    }
  } else if (key >= GDK_KEY_1 && key <= GDK_KEY_4) {
    editor_->tool = static_cast<EditorTool>(key - GDK_KEY_1);
  } else if (key == GDK_KEY_Delete || key == GDK_KEY_BackSpace) {
    try_to(editor_->DeletePoint());
  } else if (key == GDK_KEY_Insert) {
    try_to(editor_->InsertPoint());
  } else if (key == GDK_KEY_e || key == GDK_KEY_E) {
    editor_->is_erasing = !editor_->is_erasing;
  } else {
    return false;
  }
  Refresh();
  return true;
}

void PatientEditorWindow::Open() {
  if (anatomy::PatientDocument::HasAutosave(options_.patient) && options_.screenshot.empty()) {
    Ask("Unsaved changes were found", "The editor ended before these changes were saved. Go on with them?",
        {"Leave them", "Go on with them"}, [this](int answer) { Load(answer == 1); });
    return;
  }
  Load(false);
}

void PatientEditorWindow::Load(bool is_recovered) {
  auto document = anatomy::PatientDocument::Open(options_.patient, is_recovered);
  if (!document) {
    failure_ = document.error();
    Refuse(document.error());
    if (!options_.screenshot.empty()) {
      std::fprintf(stderr, "%s\n", document.error().Text().c_str());
      may_close_ = true;
      close();
    }
    return;
  }
  editor_ = std::make_unique<PatientEditor>(std::move(document).value());
  if (const auto tool = FindEditorTool(options_.editor_tool)) editor_->tool = *tool;
  const auto& tubes = editor_->GetPatient().tubes;
  for (std::uint32_t i = 0; i < tubes.size(); ++i) {
    if (tubes[i].role == anatomy::TubeRole::kCysticDuct) editor_->ChooseTube(i);
  }
  if (editor_->tool == EditorTool::kTubes) editor_->look.liver_opacity = 0.35;
  panel_.SetEditor(editor_.get());
  Refresh();
  Say("Opened " + options_.patient.string() + (is_recovered ? " with the changes that were not saved" : ""));
  autosave_ = Glib::signal_timeout().connect_seconds(
      [this] {
        const auto wrote = editor_->Document().Autosave();
        if (!wrote) Refuse(wrote.error());
        return true;
      },
      kAutosaveSeconds);
  if (!options_.screenshot.empty()) {
    if (editor_->tool == EditorTool::kTubes || editor_->tool == EditorTool::kLandmarks) {
      view_.LookFrom(render::Viewpoint::kUmbilicus);
      LookAt(editor_->tool == EditorTool::kTubes ? NameOf(anatomy::TubeRole::kCysticDuct)
                                                 : NameOf(anatomy::OrganRole::kGallbladder));
    }
    Glib::signal_timeout().connect_once(sigc::mem_fun(*this, &PatientEditorWindow::TakeScreenshot),
                                        static_cast<unsigned>(1000 * options_.screenshot_after));
  }
}

void PatientEditorWindow::Refresh() {
  if (!editor_) return;
  auto& document = editor_->Document();
  undo_.set_sensitive(document.CanUndo());
  redo_.set_sensitive(document.CanRedo());
  undo_.set_tooltip_text(document.CanUndo() ? "Undo: " + document.UndoName() + " (Ctrl+Z)"
                                            : "Nothing to undo");
  redo_.set_tooltip_text(document.CanRedo() ? "Redo: " + document.RedoName() + " (Shift+Ctrl+Z)"
                                            : "Nothing to redo");
  save_.set_sensitive(document.IsDirty());
  set_title((document.IsDirty() ? "• " : "") + editor_->GetPatient().name + " – " +
            document.Folder().string());
  hint_.set_text(HintOf(editor_->tool));
  panel_.Refresh();
  ShowFigure();
  const bool is_first = shown_revision_ == 0 && !is_checking_;
  if (document.Revision() + 1 == shown_revision_ && !is_first) return;
  shown_revision_ = document.Revision() + 1;
  check_delay_.disconnect();
  check_delay_ = Glib::signal_timeout().connect(
      [this] {
        Check();
        return false;
      },
      kCheckDelay);
}

void PatientEditorWindow::ShowFigure() {
  if (!editor_) return;
  auto figure = editor_->MakeFigure(hover_);
  view_.SetSurfaces(std::move(figure.surfaces));
  view_.SetMarks(std::move(figure.marks));
}

void PatientEditorWindow::Check() {
  if (is_checking_) {
    is_check_due_ = true;
    return;
  }
  if (checker_.joinable()) checker_.join();
  is_checking_ = true;
  is_check_due_ = false;
  checker_ = std::thread([this, patient = editor_->GetPatient()] {
    auto report = anatomy::LintPatient(patient);
    {
      const std::lock_guard lock(mutex_);
      report_ = std::move(report);
    }
    checked_.emit();
  });
}

void PatientEditorWindow::FinishCheck() {
  {
    const std::lock_guard lock(mutex_);
    if (report_) panel_.ShowFindings(*report_);
    report_.reset();
  }
  is_checking_ = false;
  if (is_check_due_) Check();
}

void PatientEditorWindow::LookAt(const std::string& where) {
  if (!editor_) return;
  if (const auto place = anatomy::FindWhere(editor_->GetPatient(), where)) view_.LookAt(*place, kFindingSpan);
}

void PatientEditorWindow::Save() {
  if (!editor_) return;
  const auto folder = editor_->Document().Folder();
  if (may_overwrite_ || !IsDelivered(folder)) return SaveTo(folder);
  Ask("Change the patient that came with Trocar?",
      "Scenes, samples and other people's results use it as it was delivered.",
      {"Cancel", "Change it", "Save as…"}, [this, folder](int answer) {
        if (answer == 1) may_overwrite_ = true, SaveTo(folder);
        if (answer == 2) SaveAs();
      });
}

void PatientEditorWindow::SaveTo(const std::filesystem::path& folder) {
  if (const auto status = editor_->Document().Save(folder); !status) return Refuse(status.error());
  Say("Saved " + folder.string());
  Refresh();
}

void PatientEditorWindow::SaveAs() {
  if (!editor_) return;
  auto dialog = Gtk::FileChooserNative::create("Save the patient's folder", *this,
                                               Gtk::FileChooser::Action::SAVE, "Save", "Cancel");
  dialog->set_current_name(editor_->Document().Folder().filename().string() + "-edited");
  dialog->signal_response().connect([this, dialog](int response) {
    if (response == Gtk::ResponseType::ACCEPT) {
      may_overwrite_ = false;
      SaveTo(dialog->get_file()->get_path());
    }
  });
  dialog->show();
}

void PatientEditorWindow::Ask(const Glib::ustring& title, const Glib::ustring& text,
                              const std::vector<Glib::ustring>& answers, std::function<void(int)> act) {
  auto* dialog =
      new Gtk::MessageDialog(*this, title, false, Gtk::MessageType::QUESTION, Gtk::ButtonsType::NONE, true);
  dialog->set_secondary_text(text);
  dialog->add_css_class("trocar");
  for (std::size_t i = 0; i < answers.size(); ++i) dialog->add_button(answers[i], static_cast<int>(i));
  is_question_open_ = true;
  dialog->signal_response().connect([this, dialog, act = std::move(act)](int answer) {
    is_question_open_ = false;
    dialog->hide();
    act(answer);
    // not within its own signal
    Glib::signal_timeout().connect_once([dialog] { delete dialog; }, 0);
  });
  dialog->show();
}

bool PatientEditorWindow::on_close_request() {
  if (may_close_ || !editor_ || !editor_->Document().IsDirty())
    return Gtk::ApplicationWindow::on_close_request();
  if (is_question_open_) return true;
  Ask("Save the changes?", "Without saving they are lost.", {"Cancel", "Do not save", "Save"},
      [this](int answer) {
        if (answer == 1) {
          editor_->Document().DiscardAutosave();
          may_close_ = true;
          close();
        }
        if (answer == 2) {
          Save();
          if (!editor_->Document().IsDirty()) close();
        }
      });
  return true;
}

void PatientEditorWindow::Say(const Glib::ustring& text, bool is_warning) {
  status_.set_text(text);
  is_warning ? status_.add_css_class("warning") : status_.remove_css_class("warning");
}

void PatientEditorWindow::Refuse(const core::Error& error) {
  Say(error.Text(), true);
}

void PatientEditorWindow::TakeScreenshot() {
  if (const auto status = SaveScreenshot(*this, options_.screenshot); !status) {
    failure_ = status.error();
    std::fprintf(stderr, "%s\n", status.error().Text().c_str());
  } else {
    std::printf("{\"screenshot\": \"%s\", \"width\": %d, \"height\": %d, \"tubes\": %zu}\n",
                options_.screenshot.filename().c_str(), get_width(), get_height(),
                editor_->GetPatient().tubes.size());
  }
  may_close_ = true;
  close();
}

}  // namespace trocar::app
