// SPDX-License-Identifier: Apache-2.0
/// \file validity.h  Validity of each metric of each task, by a study with scripted people of known skill.
///
/// It says whether a number tells novices from experts *here*, with people made by a program. It is no study of residents and
/// sets no standard of competence.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::training {

/// One number of one task.
struct MeasureValidity {
  std::string metric;      ///< id of a definition, or "coach:NAME" of a coach's measure
  std::string hand;        ///< as MetricValue::hand
  bool separates = false;  ///< the values of novices and of experts do not overlap
  double auc = 0.5;        ///< that a novice's value is worse than an expert's, area under the ROC curve [-]
  double expert_mean = 0, expert_sd = 0;  ///< in the metric's unit
  int experts = 0;
};

struct TaskValidity {
  std::string task;  ///< key: "peg_transfer"
  std::string level;
  std::vector<MeasureValidity> measures;

  const MeasureValidity* Find(std::string_view metric, std::string_view hand = "") const noexcept;
};

/// The delivered file, see FindDataFolder.
inline constexpr const char* kValidityFile = "validity.json";

struct Validity {
  std::vector<TaskValidity> tasks;

  const TaskValidity* FindTask(std::string_view task) const noexcept;
};

/// \param name  for messages
/// \return kJsonSyntax, kJsonField with the path of the field
base::Result<Validity> ParseValidity(std::string_view text, const std::string& name);

/// The words that a report puts beside a number.
/// \return "separates", "does not separate", or "not studied"
std::string_view ValidityWords(const TaskValidity* task, std::string_view metric,
                               std::string_view hand) noexcept;

}  // namespace trocar::training
