// SPDX-License-Identifier: Apache-2.0
/// \file sound_card.h  Volume, mute and speech, in the panel.
#pragma once

#include <gtkmm.h>

#include <string>

#include "trocar/gui/card.h"
#include "trocar/presenter/window_sound.h"

namespace trocar::app {

class SoundCard : public gui::Card {
 public:
  SoundCard();
  void Show(const sound::SoundSettings& settings, const std::string& state);
  /// A person has moved something.
  sigc::signal<void(const sound::SoundSettings&)>& SignalChanged() { return signal_changed_; }

 private:
  void Change();

  Gtk::Scale volume_;
  Gtk::CheckButton is_on_, has_speech_;
  Gtk::Label state_;
  bool is_showing_ = false;
  sigc::signal<void(const sound::SoundSettings&)> signal_changed_;
};

}  // namespace trocar::app
