// SPDX-License-Identifier: Apache-2.0
#include "result_view.h"

#include "review_view.h"
#include "trocar/gui/card.h"
#include "trocar/host/translate.h"
#include "trocar/report/attempt_report.h"
#include "view_parts.h"

namespace trocar::centre {
namespace {

constexpr int kMomentWidth = 320, kMomentHeight = 200;        // [pixels]
constexpr int kTextWidth = 420, kPlotWidth = 640, kGap = 14;  // [pixels]
constexpr double kWidePlot = 600;  // a drawing that stands alone in its row [pixels]

}  // namespace

ResultView::ResultView() : Gtk::Box(Gtk::Orientation::VERTICAL) {}

void ResultView::Show(const CentrePage& shown) {
  Clear(*this);
  if (!shown.result) {
    auto* wait = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    wait->set_valign(Gtk::Align::CENTER);
    wait->set_halign(Gtk::Align::CENTER);
    wait->set_vexpand(true);
    wait->set_spacing(10);
    Gtk::Label& title = MakeLine(host::Translate("Measuring the attempt"), "page-title");
    title.set_halign(Gtk::Align::CENTER);
    wait->append(title);
    Gtk::Label& what =
        MakeText(host::Translate("It is measured while it is played. What was not, is played again from its "
                                 "recording, to the bit. It is kept whatever you do meanwhile."),
                 "name");
    what.set_max_width_chars(60);
    wait->append(what);
    append(*wait);
    return;
  }
  const ResultPage& page = *shown.result;
  file_name_ = page.report.facts.task_key.empty() ? "result" : page.report.facts.task_key;

  auto* left = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  auto* right = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  for (Gtk::Box* column : {left, right}) column->set_spacing(kGap);
  left->set_size_request(kTextWidth, -1);
  left->set_hexpand(true);
  ShowHead(page, *left);
  ShowAdvice(page, *left);
  ShowErrors(page, *left);

  Gtk::Box& plots = MakeCard(host::Translate("What happened when"));
  if (!page.drawings.empty()) plots.append(MakePlot(page.drawings[0], kPlotWidth));
  right->append(plots);
  Gtk::Box& ways = MakeCard(host::Translate("Where both tips went, and how that compares"));
  Gtk::Box* row = nullptr;  // of two narrow plots
  for (std::size_t i = 1; i < page.drawings.size(); ++i) {
    const report::Drawing& drawing = page.drawings[i];
    if (drawing.width > kWidePlot) {
      ways.append(MakePlot(drawing, kPlotWidth));
      row = nullptr;
      continue;
    }
    const bool begins = row == nullptr;
    if (begins) row = &gui::MakeRow(kGap, {});
    row->append(MakePlot(drawing, (kPlotWidth - kGap) / 2));
    if (begins) {
      ways.append(*row);
    } else {
      row = nullptr;
    }
  }
  right->append(ways);
  ShowNumbers(page, *right);
  if (shown.review.attempt != 0) right->append(*Gtk::make_managed<ReviewView>(shown.review, *presenter_));

  auto* columns = Gtk::make_managed<gui::Columns>(kGap);
  columns->add_css_class("page");
  columns->Append(*left);
  columns->Append(*right);
  append(MakePage(*columns));
  append(MakeActions(page));
}

void ResultView::ShowHead(const ResultPage& page, Gtk::Box& into) {
  into.append(MakeText(page.title, "page-title"));
  into.append(MakeText(page.subtitle, "name"));
  auto* banner = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  banner->add_css_class("verdict");
  banner->add_css_class(StyleOf(page.tone));
  banner->append(MakeText(page.verdict, "verdict-text"));
  banner->append(MakeText(page.outcome, "value"));
  if (!page.debriefing.empty()) banner->append(MakeText(page.debriefing, "value"));
  if (!page.first.empty())
    banner->append(MakeText(host::TranslateWith("Better first: {1}", {page.first}), "key-text"));
  if (!page.moment.empty()) {
    auto* moment = Gtk::make_managed<Gtk::Picture>();
    moment->set_filename(page.moment.string());
    moment->set_alternative_text(page.first);
    moment->set_can_shrink(true);
    moment->set_size_request(kMomentWidth, kMomentHeight);
    moment->set_halign(Gtk::Align::START);
    moment->set_margin_top(6);
    moment->add_css_class("thumbnail");
    banner->append(*moment);
  }
  into.append(*banner);
  auto* tiles = Gtk::make_managed<Gtk::FlowBox>();
  tiles->set_selection_mode(Gtk::SelectionMode::NONE);
  tiles->set_max_children_per_line(static_cast<guint>(page.tiles.size()));
  tiles->set_homogeneous(true);
  tiles->set_column_spacing(8);
  for (const ResultPage::Tile& tile : page.tiles) {
    auto* box = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    box->add_css_class("tile");
    box->append(MakeLine(tile.label, "fine"));
    box->append(MakeLine(tile.value, "tile-value"));
    box->append(MakeText(tile.note, "fine"));
    tiles->append(*box);
  }
  into.append(*tiles);
}

void ResultView::ShowAdvice(const ResultPage& page, Gtk::Box& into) {
  Gtk::Box& card = MakeCard(host::Translate("What cost most"));
  if (page.advice.empty())
    card.append(
        MakeText(host::Translate("Nothing stands out against what the coach knows of this task."), "value"));
  int number = 0;
  for (const ResultPage::AdviceRow& advice : page.advice) {
    auto* row = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    row->set_spacing(2);
    row->set_margin_top(number == 0 ? 0 : 8);
    row->append(MakeText(std::to_string(++number) + ". " + advice.sentence, "key-text"));
    row->append(MakeText(advice.why, "value"));
    row->append(MakeText(host::TranslateWith("Practise: {1}", {advice.practise}), "value"));
    if (advice.time) {
      Gtk::Button& look = MakeButton(
          host::TranslateWith("Look at {1}", {report::FormatClock(*advice.time)}),
          [this, time = *advice.time] { presenter_->Jump(time); }, "small");
      look.set_halign(Gtk::Align::START);
      look.set_tooltip_text(host::Translate("Opens the replay a little before this moment"));
      row->append(look);
    }
    card.append(*row);
  }
  card.append(MakeText(host::Translate("Training feedback, not certified assessment."), "fine"));
  into.append(card);
}

void ResultView::ShowErrors(const ResultPage& page, Gtk::Box& into) {
  Gtk::Box& card = MakeCard(host::Translate("Errors"));
  if (page.errors.empty()) {
    card.append(MakeText(page.tone == Tone::kCaution
                             ? host::Translate("None was noted, but the attempt is not complete.")
                             : host::Translate("None was noted."),
                         "value"));
  }
  for (const ResultPage::ErrorRow& error : page.errors) {
    Gtk::Box& row = gui::MakeRow(10, {});
    Gtk::Button& jump = MakeButton(
        error.clock + "  ▸", [this, time = error.time] { presenter_->Jump(time); }, "small");
    jump.set_tooltip_text(host::Translate("Opens the replay a little before this error"));
    row.append(jump);
    Gtk::Label& what = MakeText(error.what, "value");
    what.set_hexpand(true);
    row.append(what);
    row.append(MakeLine(error.severity, StyleOf(error.tone)));
    card.append(row);
  }
  into.append(card);
}

void ResultView::ShowNumbers(const ResultPage& page, Gtk::Box& into) {
  if (!page.thresholds.empty()) {
    Gtk::Box& card = MakeCard(host::Translate("What passes"));
    auto* table = Gtk::make_managed<Table>(
        std::vector<std::string>{"", "", host::Translate("reached"), host::Translate("needed")});
    for (const ResultPage::ThresholdRow& row : page.thresholds) {
      table->AddText(row.is_met    ? host::Translate("✓ met")
                     : row.is_open ? host::Translate("– not finished")
                                   : host::Translate("✗ missed"),
                     row.is_met    ? "good"
                     : row.is_open ? "name"
                                   : "caution");
      table->AddText(row.name, "value", true);
      table->AddText(row.value);
      table->AddText(row.limit);
      table->EndRow();
    }
    card.append(*table);
    into.append(card);
  }
  Gtk::Box& card = MakeCard(host::Translate("All metrics"));
  auto* table = Gtk::make_managed<Table>(std::vector<std::string>{
      "", host::Translate("this attempt"), host::Translate("range of experts"), host::Translate("own best")});
  for (const ResultPage::MetricRow& row : page.metrics) {
    Gtk::Label& name = MakeText(row.name, "name");
    name.set_hexpand(true);
    name.set_tooltip_text(row.about);
    table->Add(name);
    table->AddText(row.value + (row.is_outside ? host::Translate("  outside") : ""),
                   row.is_outside ? "caution" : "value");
    table->AddText(row.expert);
    table->AddText(row.best);
    table->EndRow();
  }
  card.append(*table);
  into.append(card);
}

gui::Columns& ResultView::MakeActions(const ResultPage& page) {
  auto* line = Gtk::make_managed<gui::Columns>(8);
  line->add_css_class("actions");
  line->Append(MakeButton(
      host::Translate("Again"), [this] { presenter_->PlayAgain(); }, "primary"));
  const bool is_course = page.step.IsSet() || page.advice.empty();
  line->Append(
      MakeButton(is_course ? host::Translate("Next exercise") : host::Translate("Exercise that helps"),
                 [this] { presenter_->PlayNext(); }));
  line->Append(MakeButton(host::Translate("See the replay"), [this] { presenter_->Jump(0); }));
  line->Append(MakeButton(host::Translate("Save the report…"), [this] { ChooseReport(); }));
  return *line;
}

void ResultView::ChooseReport() {
  gui::FileRequest request;
  request.title = host::Translate("Save the report");
  request.new_name = file_name_ + ".html";
  request.kinds = {{host::Translate("Page (HTML)"), "*.html"},
                   {host::Translate("For print (PDF)"), "*.pdf"},
                   {host::Translate("Table (CSV)"), "*.csv"},
                   {host::Translate("Data (JSON)"), "*.json"}};
  file_dialog_.Ask(*this, request,
                   [this](const std::filesystem::path& file) { presenter_->SaveReport(file); });
}

}  // namespace trocar::centre
