// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/hints.h"

namespace trocar::app {

std::string HintText(const Situation& situation) {
  if (!situation.is_loaded) return situation.is_loading ? "Loading the patient …" : "";
  if (situation.is_paused) return "Paused. Space goes on.";
  if (situation.is_demonstration_over) return "The demonstration is over. P takes over, R plays it again.";
  if (situation.is_demonstration) return "Demonstration: the script holds both instruments. P takes over.";
  if (situation.is_laparoscope_held) return "";
  if (!situation.is_pointer_taken) return "Click into the picture to take the instruments. H shows all keys.";
  return "";
}

std::string BadgeText(const Situation& situation) {
  if (!situation.is_loaded) return "";
  if (situation.is_laparoscope_held) return "Laparoscope";
  if (situation.is_demonstration) return "Demonstration";
  const auto hand = [](const char* name, const std::string& jaws, bool is_chosen) {
    return std::string(is_chosen ? "▶ " : "") + name + (jaws.empty() ? "" : " " + jaws);
  };
  std::string text;
  if (situation.left_jaws.empty() && situation.right_jaws.empty()) {
    text = situation.is_right_hand ? "Right hand" : "Left hand";
  } else {
    text = hand("Left hand", situation.left_jaws, !situation.is_right_hand) + "  ·  " +
           hand("Right hand", situation.right_jaws, situation.is_right_hand);
  }
  if (situation.is_slow) text += "  ·  slow motion";
  if (situation.is_fulcrum_mirrored) text += "  ·  real trocar";
  if (situation.has_camera_holder) text += "  ·  automatic camera";
  return text;
}

std::string ModeText(const Situation& situation) {
  if (!situation.is_loaded) return "Choose above what to train  ·  H all keys";
  const bool is_mirrored = situation.is_left_handed;
  const std::string help = is_mirrored ? "F1 all keys" : "H all keys";
  if (situation.is_paused) return "Paused: mouse and keys move nothing  ·  Space goes on  ·  " + help;
  if (situation.is_demonstration)
    return std::string("The script holds both hands  ·  ") + (is_mirrored ? "Q" : "P") +
           " takes over  ·  Space pauses  ·  " + help;
  if (situation.is_laparoscope_held)
    return std::string("Laparoscope: mouse looks round  ·  wheel in and out  ·  let ") +
           (is_mirrored ? "Comma" : "C") + " or the middle button go: hands again";
  const std::string hand = situation.is_right_hand ? "Right hand" : "Left hand";
  if (!situation.device.empty()) return situation.device + " holds the hands  ·  Space pauses  ·  " + help;
  if (!situation.is_pointer_taken)
    return hand + ": click into the picture to take it with the mouse, or use the arrow keys  ·  " + help;
  std::string text = hand + ": mouse moves  ·  wheel in, out  ·  ";
  text += is_mirrored ? "right button closes, left opens" : "left button closes, right opens";
  text += situation.is_right_hand ? "  ·  1 left hand" : "  ·  2 right hand";
  if (situation.has_tools) text += is_mirrored ? "  ·  . tool" : "  ·  X tool";
  text += is_mirrored ? "  ·  hold Comma: look" : "  ·  hold C: look";
  return text + "  ·  Esc frees the mouse  ·  " + help;
}

std::string StateText(const Situation& situation) {
  if (!situation.is_loaded) return situation.is_loading ? "Loading the patient" : "";
  if (situation.is_paused) return "Paused";
  return situation.is_demonstration ? "Demonstration" : "Running";
}

}  // namespace trocar::app
