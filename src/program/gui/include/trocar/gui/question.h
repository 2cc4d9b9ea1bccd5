// SPDX-License-Identifier: Apache-2.0
/// \file question.h  Question of a window to a person, and the effect of each answer.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace trocar::gui {

struct Answer {
  std::string label;
  std::function<void()> act;
  bool is_suggested = false;
};

struct Question {
  std::string text;
  std::vector<Answer> answers;
  std::string detail{};  ///< said smaller below the text
};

}  // namespace trocar::gui
