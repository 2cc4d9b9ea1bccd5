// SPDX-License-Identifier: Apache-2.0
#include "exam_view.h"

#include "trocar/gui/card.h"
#include "view_parts.h"

namespace trocar::centre {

ExamView::ExamView() : Gtk::Box(Gtk::Orientation::VERTICAL) {}

void ExamView::Show(const CentrePage& shown) {
  Clear(*this);
  const ExamPage& page = shown.exam;
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->add_css_class("page");
  all->set_spacing(14);
  all->append(MakeText(page.name.empty() ? "Exam" : page.name, "page-title"));
  const auto open = [this] {
    ChooseFile("Open a sealed exam", Gtk::FileChooser::Action::OPEN, "",
               [this](const std::string& file) { presenter_->OpenExamFile(file); });
  };
  if (page.file.empty()) {
    Gtk::Box& card = MakeCard("No exam is open");
    card.append(MakeText(
        "An examiner seals the settings of an exam with `trocar exam seal`. Open that file here; what is "
        "sat under it is recorded, and the certificate says what it came to and nothing of anybody's "
        "competence.",
        "value"));
    Gtk::Button& button = MakeButton("Open an exam…", open, "primary");
    button.set_halign(Gtk::Align::START);
    card.append(button);
    all->append(card);
    append(MakePage(*all));
    return;
  }
  Gtk::Box& facts = MakeCard("What is sealed");
  auto* table = Gtk::make_managed<Table>(std::vector<std::string>{});
  for (const auto& [name, value] : page.facts) {
    table->AddText(name, "name");
    table->AddText(value, "value", true);
    table->EndRow();
  }
  facts.append(*table);
  facts.append(MakeLine("What passes, besides completing", "card-title"));
  if (page.thresholds.empty()) facts.append(MakeText("Nothing more.", "value"));
  for (const std::string& threshold : page.thresholds) facts.append(MakeText("•  " + threshold, "value"));
  all->append(facts);

  Gtk::Box& sit = MakeCard("1. Sit the exam");
  sit.append(MakeText(
      "Examinee: " + (page.examinee.empty()
                          ? std::string("nobody yet; say at \"Who are you?\" who you are")
                          : shown.who + (shown.who == page.examinee ? "" : " (" + page.examinee + ")")),
      page.examinee.empty() ? "caution" : "value"));
  sit.append(
      MakeText("There is no demonstration, no camera holder, no force arrows and no second try. It ends with "
               "the task, or "
               "with Finish.",
               "value"));
  Gtk::Box& row = gui::MakeRow(8, {});
  Gtk::Button& start = MakeButton(
      "Start the exam", [this] { presenter_->StartExam(); }, "primary");
  start.set_sensitive(!page.examinee.empty() && page.recording.empty());
  row.append(start);
  row.append(MakeButton("Another exam…", open));
  sit.append(row);
  if (!page.recording.empty()) sit.append(MakeText("Sat: " + page.recording.filename().string(), "value"));
  all->append(sit);

  Gtk::Box& sign = MakeCard("2. Issue the certificate");
  sign.append(MakeText(
      "The exam is computed again from its recording and signed with the centre's private key.", "value"));
  Gtk::Button& issue = MakeButton(
      "Issue…", [this, page] { ChooseKey(page); }, "primary");
  issue.set_halign(Gtk::Align::START);
  issue.set_sensitive(!page.recording.empty() && page.certificate.empty());
  sign.append(issue);
  if (!page.certificate.empty()) {
    sign.append(MakeText(page.finding, page.is_passed ? "good" : "caution"));
    sign.append(MakeText("Check it anywhere: trocar certificate verify " + page.certificate.string() + " " +
                             page.recording.string() + " --key PUBLIC.pub",
                         "fine"));
  }
  all->append(sign);
  append(MakePage(*all));
}

void ExamView::ChooseKey(const ExamPage& page) {
  ChooseFile("The centre's private key", Gtk::FileChooser::Action::OPEN, "",
             [this, page](const std::string& key) {
               ChooseFile("Save the certificate", Gtk::FileChooser::Action::SAVE,
                          page.recording.stem().string() + ".json",
                          [this, key](const std::string& file) { presenter_->IssueCertificate(key, file); });
             });
}

void ExamView::ChooseFile(const char* title, Gtk::FileChooser::Action action, const std::string& name,
                          std::function<void(std::string)> chosen) {
  auto* window = dynamic_cast<Gtk::Window*>(get_root());
  if (window == nullptr) return;
  auto dialog = Gtk::FileChooserNative::create(
      title, *window, action, action == Gtk::FileChooser::Action::SAVE ? "Save" : "Open", "Cancel");
  if (!name.empty()) dialog->set_current_name(name);
  dialog->signal_response().connect([dialog, chosen = std::move(chosen)](int response) {
    if (response == Gtk::ResponseType::ACCEPT) chosen(dialog->get_file()->get_path());
  });
  dialog->show();
}

}  // namespace trocar::centre
