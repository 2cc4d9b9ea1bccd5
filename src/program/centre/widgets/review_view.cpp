// SPDX-License-Identifier: Apache-2.0
#include "review_view.h"

#include "trocar/gui/card.h"
#include "trocar/host/translate.h"
#include "view_parts.h"

namespace trocar::centre {
namespace {

constexpr int kLeastPoints = 1, kMostPoints = 5;
constexpr double kMostSeconds = 86400;  // that a moment may lie after the beginning

}  // namespace

ReviewView::ReviewView(const ReviewPage& review, CentrePresenter& presenter)
    : Gtk::Box(Gtk::Orientation::VERTICAL), presenter_(presenter), forms_(review.forms) {
  set_spacing(14);
  AddRemarks(review);
  if (!review.may_review) return;
  for (std::size_t i = 0; i < forms_.size(); ++i) {
    Gtk::Box& card = MakeCard(host::TranslateWith("Rate by {1}", {forms_[i].name}));
    card.append(MakeText(forms_[i].about, "fine"));
    AddForm(i, card);
    append(card);
  }
}

void ReviewView::AddRemarks(const ReviewPage& review) {
  Gtk::Box& card = MakeCard(host::Translate("Remarks"));
  if (review.remarks.empty())
    card.append(MakeText(host::Translate("Nobody has remarked anything."), "value"));
  for (const ReviewPage::Remark& remark : review.remarks) {
    Gtk::Box& row = gui::MakeRow(10, {});
    row.append(MakeButton(
        remark.clock + "  ▸", [this, time = remark.time] { presenter_.Jump(time); }, "small"));
    Gtk::Label& text = MakeText(remark.text, "value");
    text.set_hexpand(true);
    row.append(text);
    row.append(MakeLine(remark.author, "fine"));
    card.append(row);
  }
  if (review.may_review) {
    remark_.set_placeholder_text(host::Translate("A remark for the trainee"));
    remark_.set_hexpand(true);
    seconds_.set_adjustment(Gtk::Adjustment::create(0, 0, kMostSeconds, 1, 10));
    seconds_.set_tooltip_text(host::Translate("Second of the attempt to which it belongs"));
    const auto keep = [this] { presenter_.AddRemark(seconds_.get_value(), remark_.get_text().raw()); };
    remark_.signal_activate().connect(keep);
    Gtk::Box& line = gui::MakeRow(8, {});
    line.append(MakeLine(host::Translate("at second"), "name"));
    line.append(seconds_);
    line.append(remark_);
    line.append(MakeButton(host::Translate("Remark"), keep));
    card.append(line);
  }
  append(card);
}

void ReviewView::AddForm(std::size_t index, Gtk::Box& into) {
  auto* table = Gtk::make_managed<Table>(std::vector<std::string>{
      "", host::Translate("least"), host::Translate("points"), host::Translate("most")});
  ReviewPage::Form& form = forms_[index];
  for (std::size_t i = 0; i < form.items.size(); ++i) {
    const ReviewPage::Item& item = form.items[i];
    table->AddText(item.name, "value", true);
    table->AddText(item.lowest, "fine", true);
    auto* points = Gtk::make_managed<Gtk::DropDown>();
    std::vector<Glib::ustring> words = {"–"};
    for (int p = kLeastPoints; p <= kMostPoints; ++p) words.push_back(std::to_string(p));
    points->set_model(Gtk::StringList::create(words));
    points->set_selected(static_cast<guint>(item.points));
    points->set_valign(Gtk::Align::CENTER);
    points->property_selected().signal_changed().connect([this, points, index, i] {
      forms_[index].items[i].points = static_cast<int>(points->get_selected());
    });
    table->Add(*points);
    table->AddText(item.highest, "fine", true);
    table->EndRow();
  }
  into.append(*table);
  Gtk::Button& keep =
      MakeButton(host::Translate("Keep the rating"), [this, index] { presenter_.Rate(forms_[index]); });
  keep.set_halign(Gtk::Align::START);
  into.append(keep);
}

}  // namespace trocar::centre
