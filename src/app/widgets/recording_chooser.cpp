// SPDX-License-Identifier: Apache-2.0
#include "recording_chooser.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "trocar/app/replay_presenter.h"
#include "trocar/gui/card.h"

namespace trocar::app {
namespace {

constexpr int kListWidth = 700, kListHeight = 520;  // [pixels]
constexpr std::size_t kMostRows = 200;              // of the newest: a list that nobody scrolls through

std::string NameOf(const record::Description& d) {
  std::string name = std::filesystem::path(d.name).stem().string();
  std::replace(name.begin(), name.end(), '_', ' ');
  return name + (d.level.empty() ? "" : ", " + d.level) + ", seed " + std::to_string(d.seed);
}

std::string DescribeRow(const record::RecordingSummary& recording) {
  const record::Description& d = recording.description;
  std::string text;
  if (d.started.size() >= 16) text = d.started.substr(0, 10) + " " + d.started.substr(11, 5) + "  ·  ";
  text += FormatClock(recording.seconds);
  const std::string outcome = record::DescribeOutcome(recording.outcome);
  if (!recording.is_finished) {
    text += "  ·  not finished";
  } else if (!outcome.empty()) {
    text += "  ·  " + outcome;
  }
  if (!recording.is_whole) text += "  ·  damaged";
  if (recording.errors > 0)
    text += "  ·  " + std::to_string(recording.errors) + (recording.errors == 1 ? " error" : " errors");
  text += "  ·  " + d.player;
  if (!d.branched_from.empty()) text += ", from " + d.branched_from;
  return text;
}

}  // namespace

RecordingChooser::RecordingChooser(const char* verb) : Gtk::Box(Gtk::Orientation::VERTICAL), verb_(verb) {
  add_css_class("help");
  set_halign(Gtk::Align::CENTER);
  set_valign(Gtk::Align::CENTER);
  set_spacing(8);
  rows_.set_spacing(4);
  auto* scroller = Gtk::make_managed<Gtk::ScrolledWindow>();
  scroller->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scroller->set_propagate_natural_height(true);
  scroller->set_max_content_height(kListHeight);
  scroller->set_size_request(kListWidth, -1);
  scroller->set_child(rows_);
  append(*scroller);
  auto* file = Gtk::make_managed<Gtk::Button>("Another file…");
  file->signal_clicked().connect(sigc::mem_fun(*this, &RecordingChooser::OpenFile));
  auto* close = Gtk::make_managed<Gtk::Button>("Close");
  close->set_hexpand(true);
  close->set_halign(Gtk::Align::END);
  close->signal_clicked().connect([this] { signal_closed_.emit(); });
  append(gui::MakeRow(8, {file, close}));
  loaded_.connect(sigc::mem_fun(*this, &RecordingChooser::Fill));
}

void RecordingChooser::Load(const std::filesystem::path& folder) {
  if (loading_.IsRunning()) {
    next_folder_ = folder;
    return;
  }
  folder_ = folder;
  loading_.Start([folder] { return record::ListRecordings(folder); });
}

void RecordingChooser::Fill() {
  const auto list = loading_.Take();
  while (Gtk::Widget* child = rows_.get_first_child()) rows_.remove(*child);
  AddLine(list.empty() ? "There is no recording in " + folder_.string() : "Recordings, the newest first");
  for (std::size_t i = 0; i < std::min(list.size(), kMostRows); ++i) AddRow(list[i]);
  if (list.size() > kMostRows)
    AddLine("and " + std::to_string(list.size() - kMostRows) + " older ones in " + folder_.string());
  if (next_folder_) Load(*std::exchange(next_folder_, std::nullopt));
}

void RecordingChooser::AddLine(const Glib::ustring& text) {
  auto* line = Gtk::make_managed<Gtk::Label>(text);
  line->add_css_class("card-title");
  line->set_xalign(0);
  rows_.append(*line);
}

void RecordingChooser::AddRow(const record::RecordingSummary& recording) {
  auto* text = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  text->set_hexpand(true);
  text->append(*gui::MakeLabel(NameOf(recording.description), "key"));
  text->append(*gui::MakeLabel(DescribeRow(recording), "fine"));
  auto* open = Gtk::make_managed<Gtk::Button>(verb_);
  open->set_valign(Gtk::Align::CENTER);
  open->set_tooltip_text(recording.path.filename().string());
  open->signal_clicked().connect([this, path = recording.path] { signal_chosen_.emit(path); });
  rows_.append(gui::MakeRow(8, {text, open}));
}

void RecordingChooser::OpenFile() {
  auto* window = dynamic_cast<Gtk::Window*>(get_root());
  if (window == nullptr) return;
  auto dialog = Gtk::FileChooserNative::create("Open a recording", *window, Gtk::FileChooser::Action::OPEN,
                                               "Open", "Cancel");
  auto filter = Gtk::FileFilter::create();
  filter->set_name("Recordings");
  filter->add_pattern("*.trocar");
  dialog->add_filter(filter);
  dialog->signal_response().connect([this, dialog](int response) {
    if (response == Gtk::ResponseType::ACCEPT) signal_chosen_.emit(dialog->get_file()->get_path());
  });
  dialog->show();
}

}  // namespace trocar::app
