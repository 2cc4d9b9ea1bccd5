// SPDX-License-Identifier: Apache-2.0
#include "sound_card.h"

#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::app {

SoundCard::SoundCard() : gui::Card("Sound") {
  is_on_.set_label(host::Translate("Sound"));
  has_speech_.set_label(host::Translate("Speech"));
  volume_.set_adjustment(Gtk::Adjustment::create(0.5, 0, 1, 0.01, 0.1));
  volume_.set_draw_value(false);
  volume_.set_hexpand(true);
  volume_.set_focus_on_click(false);
  volume_.set_tooltip_text(host::Translate("Volume (- quieter, = louder)"));
  is_on_.set_tooltip_text(
      host::Translate("Tones of the electrosurgical unit, clips, and the patient's pulse (0)"));
  has_speech_.set_tooltip_text(
      host::Translate("What the tutorial asks for is said aloud (9); needs the program espeak-ng"));
  volume_.signal_value_changed().connect([this] { Change(); });
  is_on_.signal_toggled().connect([this] { Change(); });
  has_speech_.signal_toggled().connect([this] { Change(); });
  gui::SetStyle(state_, "fine");
  gui::Wrap(state_);
  append(gui::MakeRow(8, {&is_on_, &has_speech_, &volume_}));
  append(state_);
}

void SoundCard::Show(const sound::SoundSettings& settings, const std::string& state) {
  is_showing_ = true;
  volume_.set_value(settings.volume);
  is_on_.set_active(!settings.is_muted);
  has_speech_.set_active(settings.has_speech);
  gui::SetText(state_, state);
  is_showing_ = false;
}

void SoundCard::Change() {
  if (!is_showing_)
    signal_changed_.emit({volume_.get_value(), !is_on_.get_active(), has_speech_.get_active()});
}

}  // namespace trocar::app
