// SPDX-License-Identifier: Apache-2.0
#include "exam_view.h"

#include "trocar/gui/card.h"
#include "trocar/gui/columns.h"
#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"
#include "view_parts.h"

namespace trocar::centre {
namespace {

constexpr int kPassphraseWidth = 300;  // [pixels]

}  // namespace

ExamView::ExamView() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  passphrase_.property_placeholder_text() = host::Translate("Passphrase");
  passphrase_.set_show_peek_icon(true);
  passphrase_.set_size_request(kPassphraseWidth, -1);
  passphrase_.set_valign(Gtk::Align::CENTER);
}

void ExamView::Show(const CentrePage& shown) {
  // it outlives the row that it stood in
  if (auto* row = dynamic_cast<Gtk::Box*>(passphrase_.get_parent())) row->remove(passphrase_);
  Clear(*this);
  const ExamPage& page = shown.exam;
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->add_css_class("page");
  all->set_spacing(14);
  all->append(MakeText(page.name.empty() ? host::Translate("Exam") : page.name, "page-title"));
  if (page.file.empty()) {
    auto* columns = Gtk::make_managed<gui::Columns>(14);
    columns->Append(MakeInvitation());
    columns->Append(MakeSealing(page));
    columns->Append(MakeKeys());
    all->append(*columns);
  } else {
    all->append(MakeFacts(page));
    all->append(MakeSitting(page));
    all->append(MakeCertificate(page));
  }
  append(MakePage(*all));
}

Gtk::Box& ExamView::MakeInvitation() {
  Gtk::Box& card = MakeCard(host::Translate("No exam is open"));
  card.append(MakeText(
      host::Translate("An examiner seals the settings of an exam. Open that file here; what is sat under it "
                      "is recorded, and the certificate says what it came to and nothing of anybody's "
                      "competence."),
      "value"));
  card.set_hexpand(true);
  card.set_valign(Gtk::Align::START);
  Gtk::Button& button = MakeButton(
      host::Translate("Open an exam…"), [this] { ChooseExam(); }, "primary");
  button.set_halign(Gtk::Align::START);
  card.append(button);
  return card;
}

/// For the examiner: what nobody can change or know beforehand.
Gtk::Box& ExamView::MakeSealing(const ExamPage& page) {
  Gtk::Box& card = MakeCard(host::Translate("Seal a new exam"));
  card.set_hexpand(true);
  card.set_valign(Gtk::Align::START);
  card.append(
      MakeText(host::Translate("What is left open is drawn by chance and kept secret. The file beside the "
                               "exam is published before, so that everybody can check afterwards."),
               "value"));
  auto* name = Gtk::make_managed<Gtk::Entry>();
  name->set_placeholder_text(host::Translate("Name of the exam"));
  gui::SetAccessibleName(*name, host::Translate("Name of the exam"));
  auto* tasks = Gtk::make_managed<Gtk::DropDown>();
  auto* levels = Gtk::make_managed<Gtk::DropDown>();
  std::vector<Glib::ustring> names;
  for (const ExamChoice& choice : page.choices) names.push_back(choice.name);
  tasks->set_model(Gtk::StringList::create(names));
  gui::SetAccessibleName(*tasks, host::Translate("Task"));
  gui::SetAccessibleName(*levels, host::Translate("Level"));
  const auto fill = [tasks, levels, choices = page.choices] {
    std::vector<Glib::ustring> shown;
    if (tasks->get_selected() < choices.size()) {
      for (const std::string& level : choices[tasks->get_selected()].levels)
        shown.push_back(host::Translate(level));
    }
    levels->set_model(Gtk::StringList::create(shown));
    levels->set_visible(!shown.empty());
  };
  tasks->property_selected().signal_changed().connect(fill);
  fill();
  Gtk::Button& seal = MakeButton(
      host::Translate("Seal…"),
      [this, name, tasks, levels, choices = page.choices] {
        if (tasks->get_selected() >= choices.size()) return;
        const ExamChoice& choice = choices[tasks->get_selected()];
        const std::string level = levels->get_selected() < choice.levels.size()
                                      ? choice.levels[levels->get_selected()]
                                      : std::string();
        ChooseSealed(name->get_text().raw(), choice.key, level);
      },
      "primary");
  card.append(*name);
  card.append(*tasks);
  card.append(*levels);
  seal.set_halign(Gtk::Align::START);
  card.append(seal);
  return card;
}

/// For the centre, once.
Gtk::Box& ExamView::MakeKeys() {
  Gtk::Box& card = MakeCard(host::Translate("The centre's keys"));
  card.set_hexpand(true);
  card.set_valign(Gtk::Align::START);
  card.append(MakeText(
      host::Translate(
          "Made once. The private key signs certificates and stays secret; the public one "
          "is published, and anybody checks certificates with it. A passphrase protects the private key."),
      "value"));
  auto* passphrase = Gtk::make_managed<Gtk::PasswordEntry>();
  passphrase->property_placeholder_text() = host::Translate("Passphrase");
  passphrase->set_show_peek_icon(true);
  Gtk::Button& make = MakeButton(
      host::Translate("Make keys…"), [this, passphrase] { ChooseNewKeys(passphrase->get_text().raw()); },
      "primary");
  make.set_halign(Gtk::Align::START);
  card.append(*passphrase);
  card.append(make);
  return card;
}

void ExamView::ChooseSealed(const std::string& name, const std::string& task, const std::string& level) {
  gui::FileRequest request;
  request.title = host::Translate("Save the sealed exam");
  request.new_name = "exam.json";
  file_dialog_.Ask(*this, request, [this, name, task, level](const std::filesystem::path& file) {
    presenter_->SealExam(name, task, level, file);
  });
}

void ExamView::ChooseNewKeys(const std::string& passphrase) {
  gui::FileRequest request;
  request.title = host::Translate("Save the centre's keys");
  request.new_name = "centre.key";
  file_dialog_.Ask(*this, request, [this, passphrase](const std::filesystem::path& file) {
    presenter_->MakeKeys(file, passphrase);
  });
}

Gtk::Box& ExamView::MakeFacts(const ExamPage& page) {
  Gtk::Box& card = MakeCard(host::Translate("What is sealed"));
  auto* table = Gtk::make_managed<Table>(std::vector<std::string>{});
  for (const auto& [name, value] : page.facts) {
    table->AddText(name, "name");
    table->AddText(value, "value", true);
    table->EndRow();
  }
  card.append(*table);
  card.append(MakeLine(host::Translate("What passes, besides completing"), "card-title"));
  if (page.thresholds.empty()) card.append(MakeText(host::Translate("Nothing more."), "value"));
  for (const std::string& threshold : page.thresholds) card.append(MakeText("•  " + threshold, "value"));
  return card;
}

Gtk::Box& ExamView::MakeSitting(const ExamPage& page) {
  Gtk::Box& card = MakeCard(host::Translate("1. Sit the exam"));
  const std::string who =
      page.examinee_name + (page.examinee_name == page.examinee ? "" : " (" + page.examinee + ")");
  card.append(MakeText(
      host::TranslateWith(
          "Examinee: {1}",
          {(page.examinee.empty() ? host::Translate("nobody yet; say at \"Who are you?\" who you are")
                                  : who)}),
      page.examinee.empty() ? "caution" : "value"));
  card.append(MakeText(host::Translate("There is no demonstration, no camera holder, no force arrows and no "
                                       "second try. It ends with the task, or with Finish."),
                       "value"));
  Gtk::Box& row = gui::MakeRow(8, {});
  Gtk::Button& start = MakeButton(
      host::Translate("Start the exam"), [this] { presenter_->StartExam(); }, "primary");
  start.set_sensitive(!page.examinee.empty() && page.recording.empty());
  row.append(start);
  row.append(MakeButton(host::Translate("Another exam…"), [this] { ChooseExam(); }));
  card.append(row);
  if (!page.recording.empty())
    card.append(MakeText(host::TranslateWith("Sat: {1}", {page.recording.filename().string()}), "value"));
  return card;
}

Gtk::Box& ExamView::MakeCertificate(const ExamPage& page) {
  Gtk::Box& card = MakeCard(host::Translate("2. Issue the certificate"));
  card.append(
      MakeText(host::Translate(
                   "The exam is computed again from its recording and signed with the centre's private key."),
               "value"));
  if (page.certificate.empty()) {
    const bool is_sat = !page.recording.empty();
    passphrase_.set_sensitive(is_sat);
    Gtk::Button& issue = MakeButton(
        host::Translate("Issue…"),
        [this, name = page.recording.stem().string() + ".json"] { ChooseKey(name); }, "primary");
    issue.set_sensitive(is_sat);
    card.append(gui::MakeRow(8, {&passphrase_, &issue}));
  } else {
    card.append(MakeText(page.finding, page.is_passed ? "good" : "caution"));
    card.append(
        MakeText(host::TranslateWith("Check it anywhere: trocar certificate verify {1} {2} --key PUBLIC.pub",
                                     {page.certificate.string(), page.recording.string()}),
                 "fine"));
  }
  return card;
}

void ExamView::ChooseExam() {
  gui::FileRequest request;
  request.title = host::Translate("Open a sealed exam");
  file_dialog_.Ask(*this, request,
                   [this](const std::filesystem::path& file) { presenter_->OpenExamFile(file); });
}

void ExamView::ChooseKey(const std::string& certificate_name) {
  gui::FileRequest request;
  request.title = host::Translate("The centre's private key");
  file_dialog_.Ask(*this, request, [this, certificate_name](const std::filesystem::path& key) {
    ChooseCertificate(key, certificate_name);
  });
}

void ExamView::ChooseCertificate(const std::filesystem::path& key, const std::string& name) {
  gui::FileRequest request;
  request.title = host::Translate("Save the certificate");
  request.new_name = name;
  file_dialog_.Ask(*this, request, [this, key](const std::filesystem::path& file) {
    presenter_->IssueCertificate({key, passphrase_.get_text().raw()}, file);
    passphrase_.set_text("");
  });
}

}  // namespace trocar::centre
