// SPDX-License-Identifier: Apache-2.0
/// \file hints.h  The one thing that a person should know right now.
#pragma once

#include <string>

#include "trocar/presenter/key_bindings.h"

namespace trocar::presenter {

/// State of the window that the texts depend on.
struct Situation {
  bool is_loaded = false;
  bool is_loading = false;  ///< otherwise nothing has been chosen yet
  bool is_paused = true;
  bool is_demonstration = false;
  bool is_demonstration_over = false;
  bool is_pointer_taken = false;
  bool is_laparoscope_held = false;
  bool is_camera_task = false;  ///< the mouse has the laparoscope without holding a key
  bool has_camera_holder = false;
  bool is_right_hand = true;
  bool is_fulcrum_mirrored = false;
  bool is_slow = false;
  bool has_tools = false;                 ///< a tray of several, so pedals and exchanges matter
  std::string left_jaws, right_jaws;      ///< as DescribeJaws
  std::string device;                     ///< that holds hands in place of the mouse; empty: none
  const KeyBindings* bindings = nullptr;  ///< names of keys and buttons; null: as they are at first
};

/// Text at the lower edge of the picture; empty when the person is at work and needs none.
std::string HintText(const Situation& situation);
/// Name of what the mouse and keys move: "Right hand", "Laparoscope", "Demonstration"; empty while loading.
std::string BadgeText(const Situation& situation);
/// Current functions of mouse and keys, in one line; no longer than kLongestMode characters while the keys are the default ones.
std::string ModeText(const Situation& situation);
inline constexpr std::size_t kLongestMode = 170;
/// "Running", "Paused", "Demonstration", "Loading"
std::string StateText(const Situation& situation);

}  // namespace trocar::presenter
