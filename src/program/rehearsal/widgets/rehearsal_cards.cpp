// SPDX-License-Identifier: Apache-2.0
#include "trocar/rehearsal/rehearsal_cards.h"

#include <algorithm>
#include <utility>

#include "trocar/gui/labels.h"

namespace trocar::rehearsal {
namespace {

constexpr int kSpacing = 6;
constexpr int kPreviewPixels = 72;
constexpr double kStepMm = 1;

Gtk::Label* MakeWrapped(const std::string& text, const char* style) {
  auto* label = Gtk::make_managed<Gtk::Label>(text);
  label->add_css_class(style);
  label->set_xalign(0);
  label->set_wrap(true);
  label->set_wrap_mode(Pango::WrapMode::WORD_CHAR);
  label->set_max_width_chars(42);
  return label;
}

Glib::RefPtr<Gdk::Texture> MakeTexture(const images::ColorImage& image) {
  const auto pixels = Gdk::Pixbuf::create_from_data(image.samples.data(), Gdk::Colorspace::RGB, false, 8,
                                                    image.width, image.height, 3 * image.width);
  return Gdk::Texture::create_for_pixbuf(pixels->copy());
}

void Clear(Gtk::Box& box) {
  while (Gtk::Widget* child = box.get_first_child()) box.remove(*child);
}

}  // namespace

// a path

PathRow::PathRow(std::string title, std::vector<gui::FileRequest::Kind> kinds, bool has_folder)
    : Gtk::Box(Gtk::Orientation::VERTICAL), title_(std::move(title)), kinds_(std::move(kinds)) {
  set_spacing(kSpacing);
  gui::SetAccessibleName(path_, title_);
  path_.set_placeholder_text(host::Translate("Type a path and press Enter, or choose"));
  path_.signal_activate().connect([this] {
    const std::string text = path_.get_text().raw();
    if (!text.empty()) signal_chosen_.emit(text);
  });
  append(path_);
  Gtk::Box& row = gui::MakeRow(kSpacing, {});
  const auto add = [this, &row](const char* text, bool is_folder) {
    auto* button = Gtk::make_managed<Gtk::Button>(host::Translate(text));
    button->set_hexpand(true);
    button->signal_clicked().connect([this, is_folder] { Ask(is_folder); });
    row.append(*button);
  };
  if (has_folder) add(host::Mark("Choose a folder…"), true);
  add(host::Mark("Choose a file…"), false);
  append(row);
}

void PathRow::Ask(bool is_folder) {
  gui::FileRequest request;
  request.title = title_;
  request.is_folder = is_folder;
  if (!is_folder) request.kinds = kinds_;
  dialog_.Ask(static_cast<Gtk::Widget&>(*this), request,
              [this](const std::filesystem::path& file) { signal_chosen_.emit(file); });
}

void PathRow::Show(const std::string& path) {
  if (path == shown_) return;
  shown_ = path;
  path_.set_text(path);
  path_.set_position(-1);
}

// series

ImagesCard::ImagesCard(RehearsalPresenter& presenter)
    : gui::Card("Images", kSpacing),
      presenter_(presenter),
      path_(host::Translate("Folder or file of the images"),
            {{host::Translate("Images (DICOM, NIfTI, NRRD, MetaImage, PNG, JPEG, TIFF)"), "*"}}, true) {
  set_vexpand(true);
  append(path_);
  path_.SignalChosen().connect([this](const std::filesystem::path& path) { presenter_.ChooseImages(path); });
  series_.set_spacing(4);
  scroller_.set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scroller_.set_vexpand(true);
  scroller_.set_child(series_);
  append(scroller_);
}

Gtk::Widget& ImagesCard::MakeRow(const RehearsalSeries& series, std::size_t index, bool is_chosen) {
  auto* button = Gtk::make_managed<Gtk::Button>();
  button->add_css_class("step");
  gui::SetClass(*button, "primary", is_chosen);
  auto* picture = Gtk::make_managed<Gtk::Picture>();
  if (!series.preview.samples.empty()) picture->set_paintable(MakeTexture(series.preview));
  picture->set_alternative_text(series.title);
  picture->set_can_shrink(true);
  picture->set_size_request(kPreviewPixels, kPreviewPixels);
  picture->set_halign(Gtk::Align::START);
  picture->set_valign(Gtk::Align::CENTER);
  picture->add_css_class("thumbnail");
  auto* text = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  text->set_hexpand(true);
  text->set_valign(Gtk::Align::CENTER);
  text->append(*MakeWrapped(series.title, "key-text"));
  text->append(*MakeWrapped(series.about, "name"));
  if (!series.problem.empty()) text->append(*MakeWrapped("\u26a0 " + series.problem, "bad"));
  button->set_child(gui::MakeRow(10, {picture, text}));
  button->set_sensitive(series.problem.empty());
  gui::SetAccessibleName(*button, series.title + ", " + series.about);
  button->signal_clicked().connect([this, index] { presenter_.ChooseSeries(index); });
  return *button;
}

void ImagesCard::Show(const RehearsalPage& page) {
  path_.Show(page.images);
  std::vector<std::string> now;
  for (std::size_t i = 0; i < page.series.size(); ++i) {
    now.push_back(page.series[i].title + page.series[i].about + page.series[i].problem +
                  (page.chosen_series == i ? "+" : "-"));
  }
  if (now == shown_) return;
  shown_ = std::move(now);
  // not within the click of one of them
  Glib::signal_idle().connect_once([this, series = page.series, chosen = page.chosen_series] {
    Clear(series_);
    for (std::size_t i = 0; i < series.size(); ++i) series_.append(MakeRow(series[i], i, chosen == i));
  });
}

// organs

OrgansCard::OrgansCard(RehearsalPresenter& presenter)
    : gui::Card("Liver and gallbladder", kSpacing),
      presenter_(presenter),
      labels_(host::Translate("Label map of liver and gallbladder"),
              {{host::Translate("Label maps (NIfTI, NRRD)"), "*.nii"},
               {host::Translate("Compressed NIfTI"), "*.nii.gz"},
               {"NRRD", "*.nrrd"},
               {host::Translate("All files"), "*"}},
              true) {
  append(*MakeWrapped(host::Translate("A label map that was drawn or computed on this series"), "name"));
  append(labels_);
  labels_.SignalChosen().connect(
      [this](const std::filesystem::path& file) { presenter_.ChooseLabels(file); });
  constexpr const char* kNames[] = {host::Mark("Liver"), host::Mark("Gallbladder")};
  choices_.set_spacing(kSpacing);
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    auto* name = Gtk::make_managed<Gtk::Label>(host::Translate(kNames[i]));
    name->add_css_class("name");
    name->set_size_request(90, -1);
    name->set_xalign(0);
    organs_[i].set_hexpand(true);
    gui::SetAccessibleName(organs_[i], host::Translate(kNames[i]));
    organs_[i].property_selected().signal_changed().connect([this] { Choose(); });
    choices_.append(gui::MakeRow(kSpacing, {name, &organs_[i]}));
  }
  choices_.set_visible(false);
  append(choices_);
  auto* either = MakeWrapped(host::Translate("or"), "name");
  either->set_halign(Gtk::Align::CENTER);
  append(*either);
  draw_.signal_clicked().connect([this] { presenter_.DrawContours(); });
  append(draw_);
}

void OrgansCard::Choose() {
  if (is_showing_) return;
  const auto label = [this](const Gtk::DropDown& list) {
    const guint chosen = list.get_selected();
    return chosen >= 1 && chosen <= shown_.size() ? shown_[chosen - 1] : 0;
  };
  presenter_.NameLabels(label(organs_[0]), label(organs_[1]));
}

void OrgansCard::Show(const RehearsalPage& page) {
  labels_.Show(page.labels);
  choices_.set_visible(!page.label_choices.empty());
  if (page.label_choices.empty()) return;
  std::vector<int> now;
  for (const LabelChoice& choice : page.label_choices) now.push_back(choice.label);
  is_showing_ = true;
  if (now != shown_) {
    shown_ = now;
    std::vector<Glib::ustring> texts = {host::Translate("choose")};
    for (const LabelChoice& choice : page.label_choices) texts.emplace_back(choice.text);
    for (Gtk::DropDown& list : organs_) list.set_model(Gtk::StringList::create(texts));
  }
  const int chosen[] = {page.liver, page.gallbladder};
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    const auto found = std::find(shown_.begin(), shown_.end(), chosen[i]);
    organs_[i].set_selected(found == shown_.end() ? 0 : static_cast<guint>(found - shown_.begin()) + 1);
  }
  is_showing_ = false;
}

// lines

LinesCard::LinesCard(const char* title) : gui::Card(title, kSpacing) {
  lines_.set_spacing(4);
  append(lines_);
}

void LinesCard::Show(const std::vector<RehearsalLine>& lines) {
  if (lines == shown_) return;
  shown_ = lines;
  Clear(lines_);
  for (const RehearsalLine& line : lines) {
    const char* style = line.kind == RehearsalLine::Kind::kTitle  ? "card-title"
                        : line.kind == RehearsalLine::Kind::kGood ? "good"
                        : line.kind == RehearsalLine::Kind::kBad  ? "bad"
                                                                  : "name";
    Gtk::Label* label = MakeWrapped(line.text, style);
    if (line.kind == RehearsalLine::Kind::kTitle) label->set_margin_top(8);
    lines_.append(*label);
  }
}

// ports

PortsCard::PortsCard(RehearsalPresenter& presenter)
    : gui::Card("Ports and table", kSpacing), presenter_(presenter) {
  ports_.set_spacing(4);
  append(ports_);
  // where a mouse is all there is: the same as the arrow keys
  struct Move {
    const char *text, *tip;
    double left, up;
  };
  constexpr Move kMoves[] = {{"\u25c2", host::Mark("1 mm to the patient's right (Left arrow)"), -kStepMm, 0},
                             {"\u25b8", host::Mark("1 mm to the patient's left (Right arrow)"), kStepMm, 0},
                             {"\u25b4", host::Mark("1 mm towards the head (Up arrow)"), 0, kStepMm},
                             {"\u25be", host::Mark("1 mm towards the feet (Down arrow)"), 0, -kStepMm}};
  Gtk::Box& row = gui::MakeRow(kSpacing, {});
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    moves_[i].set_label(kMoves[i].text);
    moves_[i].set_hexpand(true);
    moves_[i].set_tooltip_text(host::Translate(kMoves[i].tip));
    gui::SetAccessibleName(moves_[i], host::Translate(kMoves[i].tip));
    moves_[i].signal_clicked().connect([this, move = kMoves[i]] { presenter_.MovePort(move.left, move.up); });
    row.append(moves_[i]);
  }
  append(row);
  Gtk::Box& table = gui::MakeRow(kSpacing, {});
  AddSpin(table, host::Mark("Head up [°]"), head_up_);
  AddSpin(table, host::Mark("right side up [°]"), right_up_);
  append(table);
  table_reason_.add_css_class("fine");
  table_reason_.set_xalign(0);
  table_reason_.set_wrap(true);
  table_reason_.set_max_width_chars(42);
  append(table_reason_);
  undo_.signal_clicked().connect([this] { presenter_.Undo(); });
  redo_.signal_clicked().connect([this] { presenter_.Redo(); });
  reset_.signal_clicked().connect([this] { presenter_.ResetPorts(); });
  for (Gtk::Button* button : {&undo_, &redo_, &reset_}) button->set_hexpand(true);
  append(gui::MakeRow(kSpacing, {&undo_, &redo_, &reset_}));
}

void PortsCard::AddSpin(Gtk::Box& row, const char* name, Gtk::SpinButton& spin) {
  auto* label = Gtk::make_managed<Gtk::Label>(host::Translate(name));
  label->add_css_class("name");
  spin.set_adjustment(Gtk::Adjustment::create(0, -kMostTiltDeg, kMostTiltDeg, 1, 5));
  spin.set_width_chars(3);
  spin.set_hexpand(true);
  gui::SetAccessibleName(spin, host::Translate(name));
  spin.signal_value_changed().connect([this] {
    if (!is_showing_) presenter_.TiltTable(head_up_.get_value(), right_up_.get_value());
  });
  row.append(*label);
  row.append(spin);
}

void PortsCard::MakePort(std::size_t index) {
  Row row{Gtk::make_managed<Gtk::ToggleButton>(), MakeWrapped("", "key-text"), MakeWrapped("", "value"),
          MakeWrapped("", "fine")};
  auto* text = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  for (Gtk::Label* label : {row.name, row.place, row.reason}) text->append(*label);
  row.button->set_child(*text);
  row.button->add_css_class("organ");
  row.button->signal_clicked().connect([this, index] { presenter_.ChoosePort(index); });
  ports_.append(*row.button);
  rows_.push_back(row);
}

void PortsCard::Show(const RehearsalPage& page) {
  while (rows_.size() < page.ports.list.size()) MakePort(rows_.size());
  chosen_ = page.ports.chosen;
  is_showing_ = true;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    rows_[i].button->set_visible(i < page.ports.list.size());
    if (i >= page.ports.list.size()) continue;
    rows_[i].button->set_active(i == page.ports.chosen);
    gui::SetText(*rows_[i].name, page.ports.list[i].name);
    gui::SetText(*rows_[i].place, page.ports.list[i].place);
    gui::SetText(*rows_[i].reason, page.ports.list[i].reason);
  }
  head_up_.set_value(page.ports.head_up_deg);
  right_up_.set_value(page.ports.right_up_deg);
  gui::SetTextOrHide(table_reason_, page.ports.table_reason);
  undo_.set_sensitive(page.ports.can_undo);
  redo_.set_sensitive(page.ports.can_redo);
  reset_.set_sensitive(!page.ports.is_proposal);
  is_showing_ = false;
}

void PortsCard::Focus() {
  if (chosen_ < rows_.size()) rows_[chosen_].button->grab_focus();
}

}  // namespace trocar::rehearsal
