// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/hints.h"

#include <string_view>

namespace trocar::presenter {
namespace {

std::string Fill(const Situation& situation, std::string_view text) {
  static const KeyBindings first;
  return (situation.bindings != nullptr ? *situation.bindings : first).Fill(text);
}

std::string ModeTemplate(const Situation& situation) {
  if (!situation.is_loaded) return "Choose above what to train  ·  {help} all keys";
  if (situation.is_paused) return "Paused: mouse and keys move nothing  ·  {run} goes on  ·  {help} all keys";
  if (situation.is_demonstration)
    return "The script holds both hands  ·  {demonstration} takes over  ·  {run} pauses  ·  {help} all keys";
  if (situation.is_laparoscope_held)
    return "Laparoscope: mouse looks round  ·  wheel in and out  ·  let {hold-laparoscope} or the "
           "{button:look} "
           "button go: hands again";
  const std::string hand = situation.is_right_hand ? "Right hand" : "Left hand";
  if (!situation.device.empty())
    return situation.device + " holds the hands  ·  {run} pauses  ·  {help} all keys";
  if (!situation.is_pointer_taken)
    return hand +
           ": click into the picture to take it with the mouse, or use the arrow keys  ·  {help} all keys";
  std::string text = hand +
                     ": mouse moves  ·  wheel in, out  ·  {button:close} button closes, {button:open} "
                     "opens";
  text += situation.is_right_hand ? "  ·  {left-hand} left hand" : "  ·  {right-hand} right hand";
  if (situation.has_tools) text += "  ·  {next-tool} tool";
  return text + "  ·  hold {hold-laparoscope}: look  ·  Esc frees the mouse  ·  {help} all keys";
}

}  // namespace

std::string HintText(const Situation& situation) {
  if (!situation.is_loaded) return situation.is_loading ? "Loading the patient …" : "";
  if (situation.is_paused) return Fill(situation, "Paused. {run} goes on.");
  if (situation.is_demonstration_over)
    return Fill(situation, "The demonstration is over. {demonstration} takes over, {reset} plays it again.");
  if (situation.is_demonstration)
    return Fill(situation, "Demonstration: the script holds both instruments. {demonstration} takes over.");
  if (situation.is_laparoscope_held) return "";
  if (!situation.is_pointer_taken)
    return Fill(situation, "Click into the picture to take the instruments. {help} shows all keys.");
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
  return Fill(situation, ModeTemplate(situation));
}

std::string StateText(const Situation& situation) {
  if (!situation.is_loaded) return situation.is_loading ? "Loading the patient" : "";
  if (situation.is_paused) return "Paused";
  return situation.is_demonstration ? "Demonstration" : "Running";
}

}  // namespace trocar::presenter
