// SPDX-License-Identifier: Apache-2.0
#include "recording_chooser.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "trocar/host/translate.h"
#include "trocar/presenter/replay_presenter.h"

namespace trocar::app {
namespace {

constexpr int kListWidth = 700;         // [pixels]
constexpr std::size_t kMostRows = 200;  // of the newest: a list that nobody scrolls through

std::string NameOf(const record::Description& d) {
  std::string name = std::filesystem::path(d.name).stem().string();
  std::replace(name.begin(), name.end(), '_', ' ');
  name = host::Translate(name);
  if (!d.level.empty()) name += ", " + host::Translate(d.level);
  return host::TranslateWith("{1}, variant {2}", {name, std::to_string(d.seed)});
}

std::string DescribeRow(const record::RecordingSummary& recording) {
  const record::Description& d = recording.description;
  std::string text;
  if (d.started.size() >= 16) text = d.started.substr(0, 10) + " " + d.started.substr(11, 5) + "  ·  ";
  text += presenter::FormatClock(recording.seconds);
  const std::string outcome = host::TranslateComposed(record::DescribeOutcome(recording.outcome));
  if (!recording.is_finished) {
    text += host::Translate("  ·  not finished");
  } else if (!outcome.empty()) {
    // nobody has replayed it: it is what its file says
    text += "  ·  " + host::TranslateWith("{1} (not verified)", {outcome});
  }
  if (!recording.is_whole) text += host::Translate("  ·  damaged");
  if (recording.errors > 0)
    text +=
        "  ·  " + host::TranslateCount("{1} error", "{1} errors", static_cast<std::size_t>(recording.errors));
  text += "  ·  " + host::TranslateComposed(d.player);
  if (!d.branched_from.empty()) text += host::TranslateWith(", from {1}", {d.branched_from});
  return text;
}

}  // namespace

RecordingChooser::RecordingChooser(const char* verb) : gui::ListCard(kListWidth), verb_(verb) {
  auto* file = Gtk::make_managed<Gtk::Button>(host::Translate("Another file…"));
  file->signal_clicked().connect(sigc::mem_fun(*this, &RecordingChooser::OpenFile));
  AddFoot({file});
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
  ClearRows();
  AddTitle(list.empty() ? host::TranslateWith("There is no recording in {1}", {folder_.string()})
                        : host::Translate("Recordings, the newest first"));
  for (std::size_t i = 0; i < std::min(list.size(), kMostRows); ++i) AddRecording(list[i]);
  if (list.size() > kMostRows)
    AddTitle(host::TranslateWith("and {1} older ones in {2}",
                                 {std::to_string(list.size() - kMostRows), folder_.string()}));
  if (next_folder_) Load(*std::exchange(next_folder_, std::nullopt));
}

void RecordingChooser::AddRecording(const record::RecordingSummary& recording) {
  auto* open = Gtk::make_managed<Gtk::Button>(host::Translate(verb_));
  open->set_tooltip_text(recording.path.filename().string());
  open->signal_clicked().connect([this, path = recording.path] { signal_chosen_.emit(path); });
  AddRow(NameOf(recording.description), DescribeRow(recording), {open});
}

void RecordingChooser::OpenFile() {
  gui::FileRequest request;
  request.title = host::Translate("Open a recording");
  request.kinds = {{host::Translate("Recordings"), "*.trocar"}};
  file_dialog_.Ask(*this, request, [this](const std::filesystem::path& file) { signal_chosen_.emit(file); });
}

}  // namespace trocar::app
