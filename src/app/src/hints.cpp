// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/hints.h"

namespace trocar::app {

std::string HintText(const Situation& situation) {
  if (!situation.is_loaded) return "Loading the patient …";
  if (situation.is_paused) return "Paused. Space starts.";
  if (situation.is_demonstration_over) return "The demonstration is over. P takes over, R plays it again.";
  if (situation.is_demonstration) return "Demonstration: the script holds both instruments. P takes over.";
  if (situation.is_laparoscope_held)
    return "Laparoscope: move the mouse to look around, wheel to go in and out.";
  if (!situation.is_pointer_taken) return "Click into the picture to take the instruments. H shows all keys.";
  return "";
}

std::string BadgeText(const Situation& situation) {
  if (!situation.is_loaded) return "";
  if (situation.is_laparoscope_held) return "Laparoscope";
  if (situation.is_demonstration) return "Demonstration";
  std::string text = situation.is_right_hand ? "Right hand" : "Left hand";
  if (situation.is_fulcrum_mirrored) text += "  ·  real trocar";
  if (situation.has_camera_holder) text += "  ·  automatic camera";
  if (situation.is_pointer_taken) text += "  ·  Esc gives the mouse back";
  return text;
}

std::string StateText(const Situation& situation) {
  if (!situation.is_loaded) return "Loading the patient";
  if (situation.is_paused) return "Paused";
  return situation.is_demonstration ? "Demonstration" : "Running";
}

}  // namespace trocar::app
