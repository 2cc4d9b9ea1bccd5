// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/message_bars.h"

#include <algorithm>

#include "trocar/host/translate.h"

namespace trocar::gui {
namespace {

constexpr int kMostHeight = 180;  // then the bars scroll [pixels]

}  // namespace

MessageBars::MessageBars() {
  set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  set_propagate_natural_height(true);
  set_max_content_height(kMostHeight);
  set_child(bars_);
  set_visible(false);
}

Gtk::Box& MessageBars::AddBar(const std::string& style, const std::string& code, const std::string& text) {
  auto* bar = Gtk::make_managed<Gtk::Box>();
  bar->add_css_class("bar");
  bar->add_css_class(style);
  bar->set_spacing(12);
  if (!code.empty()) {
    auto* label = Gtk::make_managed<Gtk::Label>(code);
    label->add_css_class("code");
    label->set_valign(Gtk::Align::START);
    bar->append(*label);
  }
  auto* label = Gtk::make_managed<Gtk::Label>(text);
  label->set_wrap(true);
  label->set_selectable(true);
  label->set_focusable(false);
  label->set_xalign(0);
  label->set_hexpand(true);
  bar->append(*label);
  auto* count = Gtk::make_managed<Gtk::Label>();
  count->add_css_class("code");
  bar->append(*count);
  bars_.append(*bar);
  shown_.push_back({bar, text, count, 1, {}});
  set_visible(true);
  return *bar;
}

void MessageBars::Remove(Gtk::Widget& bar) {
  std::erase_if(shown_, [&](const Shown& s) { return s.bar == &bar; });
  bars_.remove(bar);
  set_visible(!shown_.empty());
}

void MessageBars::ShowError(const base::Error& error) {
  const std::string message = host::TranslateComposed(error.message);
  for (Shown& shown : shown_) {
    if (shown.text != message) continue;
    shown.count->set_text(host::TranslateWith("{1} times", {std::to_string(++shown.times)}));
    return;
  }
  Gtk::Box& bar = AddBar("error", std::string(base::CodeText(error.code)), message);
  auto* close = Gtk::make_managed<Gtk::Button>(host::Translate("Read"));
  close->add_css_class("small");
  close->set_valign(Gtk::Align::CENTER);
  close->signal_clicked().connect(
      [this, &bar] { Glib::signal_idle().connect_once([this, &bar] { Remove(bar); }); });
  bar.append(*close);
}

void MessageBars::ShowNotice(const std::string& text) {
  Gtk::Box& bar = AddBar("notice", "", text);
  auto* close = Gtk::make_managed<Gtk::Button>(host::Translate("Read"));
  close->add_css_class("small");
  close->set_valign(Gtk::Align::CENTER);
  close->signal_clicked().connect(
      [this, &bar] { Glib::signal_idle().connect_once([this, &bar] { Remove(bar); }); });
  bar.append(*close);
}

void MessageBars::Ask(Question question) {
  const auto old = std::find_if(shown_.begin(), shown_.end(),
                                [&](const Shown& shown) { return shown.text.starts_with(question.text); });
  if (old != shown_.end()) Remove(*old->bar);
  const std::string between = question.detail.empty() ? "" : " ";
  Gtk::Box& bar = AddBar("question", "", question.text + between + question.detail);
  for (const Answer& answer : question.answers) {
    auto* button = Gtk::make_managed<Gtk::Button>(host::Translate(answer.label));
    button->set_valign(Gtk::Align::CENTER);
    if (answer.is_suggested) button->add_css_class("primary");
    // the bar goes after the click is over: it holds the button
    button->signal_clicked().connect([this, &bar, act = answer.act] {
      Glib::signal_idle().connect_once([this, &bar, act] {
        Remove(bar);
        act();
      });
    });
    bar.append(*button);
  }
  shown_.back().answers = std::move(question.answers);
}

bool MessageBars::Press(const std::string& label) {
  for (const Shown& shown : shown_) {
    for (const Answer& answer : shown.answers) {
      if (answer.label != label) continue;
      const auto act = answer.act;
      Remove(*shown.bar);
      act();
      return true;
    }
  }
  return false;
}

std::vector<std::string> MessageBars::Texts() const {
  std::vector<std::string> texts;
  for (const Shown& shown : shown_) texts.push_back(shown.text);
  return texts;
}

}  // namespace trocar::gui
