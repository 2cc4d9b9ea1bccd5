// SPDX-License-Identifier: Apache-2.0
#include "patient_list_card.h"

#include <string>

#include "trocar/gui/card.h"
#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::app {
namespace {

constexpr int kListWidth = 700;   // [pixels]
constexpr unsigned kPulse = 150;  // between two looks at what is under way [ms]
constexpr double kMostSeed = 2147483647;

}  // namespace

PatientListCard::PatientListCard()
    : gui::ListCard(kListWidth), desk_(presenter::FindPatientsFolder(), [this] { news_.emit(); }) {
  news_.connect(sigc::mem_fun(*this, &PatientListCard::OnNews));
  gui::SetStyle(problem_, "bad");
  gui::Wrap(problem_);
  problem_.set_visible(false);
  append(problem_);
  gui::SetStyle(doing_, "name");
  doing_.set_hexpand(true);
  doing_.set_wrap(true);
  doing_.set_xalign(0);
  progress_.set_valign(Gtk::Align::CENTER);
  gui::SetAccessibleName(progress_, host::Translate("How far it is"));
  cancel_.signal_clicked().connect([this] {
    desk_.Cancel();
    ShowProgress();
  });
  under_way_.set_spacing(8);
  under_way_.append(doing_);
  under_way_.append(progress_);
  under_way_.append(cancel_);
  under_way_.set_visible(false);
  append(under_way_);
  MakeFoot();
}

PatientListCard::~PatientListCard() {
  pulse_.disconnect();
}

void PatientListCard::MakeFoot() {
  auto* label = Gtk::make_managed<Gtk::Label>(host::Translate("New patient: number"));
  label->add_css_class("name");
  seed_.set_adjustment(Gtk::Adjustment::create(1, 0, kMostSeed, 1, 10));
  seed_.set_tooltip_text(host::Translate("The same number gives the same patient"));
  gui::SetAccessibleName(seed_, host::Translate("Number of a new patient"));
  generate_.add_css_class("primary");
  generate_.set_tooltip_text(
      host::Translate("A plausible patient without any pictures, with varied anatomy"));
  import_.set_tooltip_text(
      host::Translate("Liver and gallbladder that somebody drew or computed (NIfTI, NRRD)"));
  generate_.signal_clicked().connect([this] {
    desk_.Generate(static_cast<std::uint64_t>(seed_.get_value_as_int()));
    Begin();
  });
  import_.signal_clicked().connect(sigc::mem_fun(*this, &PatientListCard::AskForLabels));
  images_.set_tooltip_text(host::Translate(
      "Step by step from a CT or other images: choose a series, mark liver and gallbladder, check, place "
      "ports, operate"));
  images_.signal_clicked().connect([this] { signal_images_.emit(); });
  AddFoot({label, &seed_, &generate_, &import_, &images_});
}

void PatientListCard::AskForLabels() {
  gui::FileRequest request;
  request.title = host::Translate("Label map of liver and gallbladder");
  request.kinds = {{host::Translate("Label maps (NIfTI, NRRD)"), "*.nii"},
                   {host::Translate("Compressed NIfTI"), "*.nii.gz"},
                   {"NRRD", "*.nrrd"},
                   {host::Translate("All files"), "*"}};
  file_dialog_.Ask(*this, request, [this](const std::filesystem::path& file) {
    desk_.Import(file);
    Begin();
  });
}

void PatientListCard::Load(const std::filesystem::path& chosen) {
  desk_.Choose(chosen);
  desk_.List();
  Begin();
}

void PatientListCard::Begin() {
  ShowProgress();
  if (!desk_.IsBusy() || pulse_.connected()) return;
  pulse_ = Glib::signal_timeout().connect(
      [this] {
        ShowProgress();
        return desk_.IsBusy();
      },
      kPulse);
}

void PatientListCard::OnNews() {
  const auto made = desk_.Finish();
  if (made) {
    desk_.Choose(*made);
    signal_chosen_.emit(*made);
  }
  Show();
  ShowProgress();
}

void PatientListCard::ShowProgress() {
  const presenter::PatientPage& page = desk_.Look();
  const bool is_busy = !page.doing.empty();
  under_way_.set_visible(is_busy);
  generate_.set_sensitive(!is_busy);
  import_.set_sensitive(!is_busy);
  images_.set_sensitive(!is_busy);
  cancel_.set_visible(page.can_cancel);
  gui::SetText(doing_, page.doing);
  page.fraction < 0 ? progress_.pulse() : progress_.set_fraction(page.fraction);
}

void PatientListCard::Show() {
  const presenter::PatientPage& page = desk_.Look();
  gui::SetTextOrHide(problem_, page.problem ? host::ShownText(*page.problem) : "");
  ClearRows();
  AddTitle(host::Translate("Who is operated on"));
  for (const presenter::PatientEntry& patient : page.patients) AddPatient(patient);
}

void PatientListCard::AddPatient(const presenter::PatientEntry& patient) {
  const bool is_chosen = patient.folder == desk_.Look().chosen;
  Gtk::Label* about = gui::MakeLabel(patient.about, "fine");
  about->set_tooltip_text(patient.about);
  Gtk::Label* state = gui::MakeLabel("", "name");
  if (patient.problem) {
    gui::SetClass(*state, "bad", true);
    state->set_text("\u26a0 " + host::ShownText(*patient.problem));
    state->set_tooltip_text(host::ShownText(*patient.problem));
  } else if (is_chosen) {
    state->set_text(host::Translate("\u2713 Chosen"));
  }
  auto* choose = Gtk::make_managed<Gtk::Button>(host::Translate("Choose"));
  choose->set_tooltip_text(patient.name);
  gui::SetAccessibleName(*choose, host::TranslateWith("Choose {1}", {patient.name}));
  choose->set_sensitive(!patient.problem);
  choose->signal_clicked().connect([this, folder = patient.folder] {
    desk_.Choose(folder);
    Show();
    signal_chosen_.emit(folder);
  });
  AddPictureRow(patient.picture, patient.name, {about, state}, {choose});
}

}  // namespace trocar::app
