// SPDX-License-Identifier: Apache-2.0
#include "trocar/rehearsal/rehearsal_view.h"

#include <algorithm>
#include <string>
#include <utility>

#include "trocar/gui/columns.h"
#include "trocar/gui/labels.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/log.h"
#include "trocar/patient/patient.h"
#include "trocar/roles/roles.h"
#include "trocar/scene/scene.h"

namespace trocar::rehearsal {
namespace {

constexpr int kPanelWidth = 380;  // [pixels]
constexpr unsigned kPulse = 150;  // between two looks at what is under way [ms]
constexpr double kStepMm = 1, kLongStepMm = 5;

/// Commands of the contour window that have a button here: files, the build and the window are the way's own.
std::span<const editor::ContourCommand> PaneCommands() {
  static const std::vector<editor::ContourCommand> commands = [] {
    std::vector<editor::ContourCommand> kept;
    for (const editor::ContourCommand& command : editor::ContourCommands()) {
      const bool is_ours =
          command.action == editor::ContourAction::kOpen || command.action == editor::ContourAction::kSave ||
          command.action == editor::ContourAction::kSaveAs ||
          command.action == editor::ContourAction::kBuild || command.action == editor::ContourAction::kQuit ||
          command.action == editor::ContourAction::kToggleFullscreen;
      if (!is_ours) kept.push_back(command);
    }
    return kept;
  }();
  return commands;
}

bool IsPaneCommand(guint key, Gdk::ModifierType state) {
  const auto has = [state](Gdk::ModifierType mask) { return (state & mask) != Gdk::ModifierType{}; };
  const editor::ContourAction action = editor::FindContourAction(key, has(Gdk::ModifierType::CONTROL_MASK),
                                                                 has(Gdk::ModifierType::SHIFT_MASK));
  const auto commands = PaneCommands();
  return key == GDK_KEY_space ||
         std::any_of(commands.begin(), commands.end(),
                     [action](const editor::ContourCommand& one) { return one.action == action; });
}

view::PatientColours ReadColours() {
  const auto data = host::FindDataFolder();
  if (!data.ok()) return {};
  const auto colours = view::ReadPatientColours(*data / view::kPatientColoursFile);
  if (colours.ok()) return *colours;
  host::Log(host::LogLevel::kWarning, colours.error().Text());
  return {};
}

}  // namespace

RehearsalView::RehearsalView(const std::filesystem::path& folder, const std::filesystem::path& patients)
    : Gtk::Box(Gtk::Orientation::VERTICAL),
      colours_(ReadColours()),
      presenter_(folder, patients, static_cast<RehearsalScreen&>(*this), [this] { news_.emit(); }) {
  add_css_class("rehearsal");
  MakeSteps();
  MakeMiddle();
  MakeFoot();
  MakePorts();
  news_.connect([this] {
    presenter_.FinishWork();
    FollowWork();
  });
  figure_.SignalFailed().connect(
      [this](const base::Error& error) { gui::SetTextOrHide(problem_, host::ShownText(error)); });
}

RehearsalView::~RehearsalView() {
  pulse_.disconnect();
  ClosePane();
}

void RehearsalView::MakeSteps() {
  auto* row = Gtk::make_managed<gui::Columns>(6);
  row->add_css_class("status");
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    steps_[i].set_hexpand(true);
    steps_[i].signal_clicked().connect([this, i] { presenter_.GoTo(static_cast<RehearsalStep>(i)); });
    row->Append(steps_[i]);
  }
  auto* close = Gtk::make_managed<Gtk::Button>(host::Translate("Close"));
  close->set_tooltip_text(host::Translate("Back to the patients; it goes on here where it was left"));
  close->signal_clicked().connect([this] {
    presenter_.Leave();
    signal_closed_.emit();
  });
  row->Append(*close);
  append(*row);
}

void RehearsalView::MakeMiddle() {
  nothing_.set_text(host::Translate("No images are open yet"));
  nothing_.add_css_class("name");
  slices_.set_vexpand(true);
  left_.set_hexpand(true);
  left_.set_vexpand(true);
  left_.add(nothing_, "nothing");
  left_.add(slices_, "slices");
  left_.add(figure_, "figure");
  auto* cards = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  cards->set_spacing(7);
  cards->set_margin(8);
  build_.signal_clicked().connect([this] { presenter_.Build(); });
  for (Gtk::Widget* card :
       {static_cast<Gtk::Widget*>(&images_card_), static_cast<Gtk::Widget*>(&organs_card_),
        static_cast<Gtk::Widget*>(&check_card_), static_cast<Gtk::Widget*>(&build_),
        static_cast<Gtk::Widget*>(&ports_card_), static_cast<Gtk::Widget*>(&origin_card_)})
    cards->append(*card);
  scroller_.set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scroller_.set_size_request(kPanelWidth, -1);
  scroller_.set_child(*cards);
  auto* middle = Gtk::make_managed<Gtk::Box>();
  middle->append(left_);
  middle->append(scroller_);
  // steps above and buttons below stay where they are, however much a step shows
  auto* around = Gtk::make_managed<Gtk::ScrolledWindow>();
  around->set_policy(Gtk::PolicyType::AUTOMATIC, Gtk::PolicyType::AUTOMATIC);
  around->set_vexpand(true);
  around->set_child(*middle);
  append(*around);
}

void RehearsalView::MakeFoot() {
  auto* texts = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  texts->set_hexpand(true);
  texts->set_valign(Gtk::Align::CENTER);
  for (Gtk::Label* label : {&problem_, &hint_}) {
    label->set_xalign(0);
    label->set_wrap(true);
    label->set_natural_wrap_mode(Gtk::NaturalWrapMode::NONE);
    texts->append(*label);
  }
  problem_.add_css_class("bad");
  problem_.set_visible(false);
  hint_.add_css_class("meaning");
  doing_.set_xalign(0);
  doing_.add_css_class("name");
  progress_.set_valign(Gtk::Align::CENTER);
  gui::SetAccessibleName(progress_, host::Translate("How far it is"));
  cancel_.signal_clicked().connect([this] { presenter_.Cancel(); });
  under_way_.set_spacing(8);
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&doing_), static_cast<Gtk::Widget*>(&progress_),
                              static_cast<Gtk::Widget*>(&cancel_)})
    under_way_.append(*widget);
  under_way_.set_visible(false);
  map_.signal_clicked().connect([this] {
    wants_map_ = true;
    Show(presenter_.Page());
  });
  forget_.set_tooltip_text(host::Translate(
      "Forget these images and this patient; patients that were operated on stay in the list"));
  forget_.signal_clicked().connect([this] { presenter_.Forget(); });
  back_.signal_clicked().connect([this] { presenter_.GoBack(); });
  next_.add_css_class("primary");
  next_.signal_clicked().connect([this] {
    presenter_.GoOn();
    FollowWork();
  });
  auto* foot = Gtk::make_managed<gui::Columns>(10);
  foot->add_css_class("actions");
  foot->Append(*texts);
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&under_way_), static_cast<Gtk::Widget*>(&map_),
                              static_cast<Gtk::Widget*>(&forget_), static_cast<Gtk::Widget*>(&back_),
                              static_cast<Gtk::Widget*>(&next_)}) {
    widget->set_valign(Gtk::Align::CENTER);
    foot->Append(*widget);
  }
  append(*foot);
}

void RehearsalView::MakePorts() {
  figure_.on_press = [this](const editor::MeshPick& pick) {
    is_dragging_ = shown_step_ == RehearsalStep::kPorts && pick.point && *pick.point < ports_.size();
    if (is_dragging_) presenter_.GrabPort(*pick.point);
    return is_dragging_;
  };
  figure_.on_drag = [this](const editor::MeshPick& pick) {
    const std::size_t port = presenter_.Page().ports.chosen;
    if (is_dragging_ && port < ports_.size())
      presenter_.DragPort(figure_.PointAtDepth(ports_[port], pick.x, pick.y));
  };
  figure_.on_release = [this](const editor::MeshPick&) {
    is_dragging_ = false;
    presenter_.ReleasePort();
  };
}

void RehearsalView::Open() {
  presenter_.Start();
  FollowWork();
  FocusStep();
}

/// The bar moves while something is under way.
void RehearsalView::FollowWork() {
  if (!presenter_.IsBusy() || pulse_.connected()) return;
  pulse_ = Glib::signal_timeout().connect(
      [this] {
        presenter_.ShowProgress();
        return presenter_.IsBusy();
      },
      kPulse);
}

// keys

bool RehearsalView::IsDrawing() const {
  const RehearsalPage& page = presenter_.Page();
  return page.step == RehearsalStep::kOrgans && page.source == OrganSource::kContours && !wants_map_;
}

/// Lists and fields of the pane keep their keys.
bool RehearsalView::IsOnSlice() const {
  const auto* window = dynamic_cast<const Gtk::Window*>(get_root());
  return pane_ != nullptr && window != nullptr && window->get_focus() == &pane_->Canvas();
}

bool RehearsalView::OnKey(guint key, Gdk::ModifierType state) {
  const RehearsalStep step = presenter_.Page().step;
  if (step <= RehearsalStep::kOrgans)
    return IsOnSlice() && IsPaneCommand(key, state) && pane_->OnKey(key, state);
  if (step != RehearsalStep::kPorts) return false;
  const auto* window = dynamic_cast<const Gtk::Window*>(get_root());
  if (window != nullptr && dynamic_cast<const Gtk::Text*>(window->get_focus()) != nullptr) return false;
  const auto has = [state](Gdk::ModifierType mask) { return (state & mask) != Gdk::ModifierType{}; };
  const double length = has(Gdk::ModifierType::SHIFT_MASK) ? kLongStepMm : kStepMm;
  switch (key) {
    case GDK_KEY_Left:
      presenter_.MovePort(-length, 0);
      return true;
    case GDK_KEY_Right:
      presenter_.MovePort(length, 0);
      return true;
    case GDK_KEY_Up:
      presenter_.MovePort(0, length);
      return true;
    case GDK_KEY_Down:
      presenter_.MovePort(0, -length);
      return true;
    case GDK_KEY_z:
    case GDK_KEY_Z:
      if (!has(Gdk::ModifierType::CONTROL_MASK)) return false;
      has(Gdk::ModifierType::SHIFT_MASK) ? presenter_.Redo() : presenter_.Undo();
      return true;
    default:
      return false;
  }
}

void RehearsalView::OnKeyReleased(guint key) {
  if (pane_ != nullptr) pane_->OnKeyReleased(key);
}

// what is shown

void RehearsalView::Show(const RehearsalPage& page) {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const std::string label = page.steps[i].title + (page.steps[i].is_done ? " \u2713" : "");
    if (steps_[i].get_label().raw() != label) steps_[i].set_label(label);
    steps_[i].set_sensitive(page.steps[i].is_open);
    gui::SetClass(steps_[i], "primary", static_cast<std::size_t>(page.step) == i);
  }
  if (page.source != OrganSource::kContours) wants_map_ = false;
  const bool is_drawing = IsDrawing();
  const bool has_slices = page.step <= RehearsalStep::kOrgans;
  left_.set_visible_child(!has_slices ? "figure" : pane_ != nullptr ? "slices" : "nothing");
  if (!has_slices && !page.is_built) left_.set_visible_child("nothing");
  nothing_.set_text(has_slices ? host::Translate("No images are open yet")
                               : host::Translate("No patient is built yet"));
  if (pane_ != nullptr) pane_->SetReadOnly(!is_drawing);
  if (pane_bar_ != nullptr) pane_bar_->set_visible(is_drawing);
  images_card_.set_visible(page.step == RehearsalStep::kImages);
  organs_card_.set_visible(page.step == RehearsalStep::kOrgans);
  check_card_.set_visible(page.step == RehearsalStep::kPatient && page.is_built);
  build_.set_visible(page.step == RehearsalStep::kPatient && page.source != OrganSource::kNone);
  build_.set_label(page.is_built ? host::Translate("Build again") : host::Translate("Build the patient"));
  build_.set_sensitive(page.doing.empty());
  ports_card_.set_visible(page.step == RehearsalStep::kPorts);
  origin_card_.set_visible(page.step == RehearsalStep::kOperate);
  // the question for sizes needs the whole width
  scroller_.set_visible(!is_drawing && (pane_ == nullptr || !pane_->Sizes().get_visible()));
  images_card_.Show(page);
  organs_card_.Show(page);
  check_card_.Show(page.check);
  ports_card_.Show(page);
  origin_card_.Show(page.origin);
  gui::SetTextOrHide(problem_, page.problem ? "\u26a0 " + host::ShownText(*page.problem) : "");
  gui::SetTextOrHide(hint_, page.hint);
  under_way_.set_visible(!page.doing.empty());
  gui::SetText(doing_, page.doing);
  if (!page.doing.empty()) page.fraction < 0 ? progress_.pulse() : progress_.set_fraction(page.fraction);
  map_.set_visible(is_drawing);
  forget_.set_visible(page.step == RehearsalStep::kImages && !page.images.empty());
  back_.set_visible(page.step != RehearsalStep::kImages);
  back_.set_sensitive(page.can_go_back);
  next_.set_label(page.step == RehearsalStep::kOperate ? host::Translate("Operate")
                                                       : host::Translate("Next"));
  next_.set_sensitive(page.can_go_on);
  FollowWork();
  if (page.step == shown_step_) return;
  shown_step_ = page.step;
  FocusStep();
}

/// Whoever has only a keyboard goes on without looking for the place.
void RehearsalView::FocusStep() {
  Glib::signal_timeout().connect_once(
      [this] {
        if (!get_mapped()) return;
        if (shown_step_ == RehearsalStep::kImages && pane_ == nullptr) return images_card_.Focus();
        if (shown_step_ == RehearsalStep::kPorts) return ports_card_.Focus();
        if (IsDrawing() && pane_ != nullptr) {
          pane_->Canvas().grab_focus();
        } else if (next_.get_sensitive()) {
          next_.grab_focus();
        } else if (shown_step_ == RehearsalStep::kOrgans) {
          organs_card_.child_focus(Gtk::DirectionType::TAB_FORWARD);
        }
      },
      0);
}

void RehearsalView::ShowSlices(const std::optional<editor::ContourOptions>& slices) {
  ClosePane();
  if (slices) MakePane(*slices);
}

void RehearsalView::ClosePane() {
  while (Gtk::Widget* child = slices_.get_first_child()) slices_.remove(*child);
  pane_.reset();
  pane_bar_.reset();
  pane_tips_.reset();
}

void RehearsalView::MakePane(const editor::ContourOptions& slices) {
  editor::ContourPaneHost host;
  host.show = [this](const editor::ContourPage&) {
    if (pane_bar_ != nullptr)
      pane_bar_->Show(
          [this](const editor::ContourCommand& command) { return pane_->Presenter().FindButton(command); });
    CountContours();
  };
  host.do_in_window = [](editor::ContourAction) {};  // the window's own keys do that
  host.opened = [this] {
    if (pane_ == nullptr || pane_->Presenter().Workspace() == nullptr) return;
    const contours::ContourWorkspace& workspace = *pane_->Presenter().Workspace();
    presenter_.SlicesOpened(workspace.Series(), workspace.Options().series);
    CountContours();
  };
  pane_tips_ = std::make_unique<gui::Tips>();
  pane_ = std::make_unique<editor::ContourPane>(slices, *pane_tips_, std::move(host));
  pane_bar_ = std::make_unique<gui::CommandBar<editor::ContourAction, editor::ContourNeeds>>(
      PaneCommands(), *pane_tips_,
      [this](const editor::ContourCommand& command) { pane_->Presenter().Do(command.action); });
  pane_bar_->SetShowTitleButtons(false);
  pane_->Sizes().property_visible().signal_changed().connect([this] { Show(presenter_.Page()); });
  pane_->SetReadOnly(!IsDrawing());
  pane_bar_->set_visible(IsDrawing());
  slices_.append(*pane_bar_);
  slices_.append(*pane_);
  pane_->Start();
}

void RehearsalView::ShowOverlay(std::optional<images::LabelVolume> labels) {
  if (pane_ != nullptr) pane_->ShowOverlay(std::move(labels));
}

/// How many slices of both organs have contours.
void RehearsalView::CountContours() {
  if (pane_ == nullptr || pane_->Presenter().Workspace() == nullptr) return;
  const contours::ContourDocument& document = pane_->Presenter().Workspace()->Document();
  std::size_t liver = 0, gallbladder = 0;
  const auto& structures = document.Points().structures;
  for (std::size_t s = 0; s < structures.size(); ++s) {
    const std::size_t slices = document.ContouredSlices(static_cast<int>(s)).size();
    if (structures[s].name == NameOf(roles::OrganRole::kLiver)) liver = slices;
    if (structures[s].name == NameOf(roles::OrganRole::kGallbladder)) gallbladder = slices;
  }
  presenter_.SetContoured(liver, gallbladder);
}

base::Status RehearsalView::SaveContours() {
  if (pane_ == nullptr || pane_->Presenter().Workspace() == nullptr) return {};
  contours::ContourWorkspace& workspace = *pane_->Presenter().Workspace();
  if (!workspace.Document().IsDirty()) return {};
  const base::Status saved = workspace.Save(workspace.Options().points);
  if (saved.ok()) pane_->Presenter().Do(editor::ContourAction::kSave);  // which lets go of the side file
  return saved;
}

void RehearsalView::ShowFigure(const patient::Patient& patient) {
  figure_.SetSurfaces(MakeRehearsalFigure(patient, colours_));
}

void RehearsalView::ShowPorts(const patient::Patient& patient, std::optional<std::size_t> chosen) {
  ports_.clear();
  if (!chosen) return figure_.SetMarks({});
  for (const patient::Port& port : patient.ports) ports_.push_back(port.position);
  figure_.SetMarks(MakePortMarks(patient, *chosen));
}

}  // namespace trocar::rehearsal
