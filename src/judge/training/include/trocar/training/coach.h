// SPDX-License-Identifier: Apache-2.0
/// \file coach.h  Says in plain words which two or three habits cost most, when they showed, why they matter, and what to practise.
///
/// Every sentence comes from a rule of assets/coach/rules.json and the numbers that it was given; none is a judgement of
/// competence.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/training/attempt_trace.h"
#include "trocar/training/metric_value.h"
#include "trocar/training/validity.h"

namespace trocar::training {

/// One thing that the coach can say.
struct CoachRule {
  std::string id;
  std::string topic;    ///< rules of one topic say the same thing: the one that costs most speaks
  std::string measure;  ///< "coach:tremor", "event:dropped", "metric:path_length", "metric:path_length/left"
  bool is_high_bad = true;
  /// Said when the value lies so many standard deviations of the expert set on the bad side [-], and passes `least`.
  double threshold_sd = 3;
  double sd_floor = 0;  ///< an expert set that varies less counts as varying so much, in the measure's unit
  double least = 0;     ///< on the bad side of it, whatever the expert set says, in the measure's unit
  /// Said without an expert set when the value passes this, in the measure's unit.
  std::optional<double> absolute;
  double weight = 1;       ///< of a standard deviation beyond the mean, or of a multiple of `absolute` [-]
  double shown_scale = 1;  ///< from the measure's unit to what the sentence shows
  int decimals = 1;        ///< of what it shows
  std::string sentence;    ///< with {value}, {times}, {expert}, {hand}
  std::string sentence_alone;  ///< the same without {expert}; empty: nothing is said without an expert set
  std::string why;
  std::string exercise;  ///< key of a delivered task
  std::string practise;  ///< what to do there
  std::string source;    ///< of why and threshold
};

struct CoachRules {
  int most = 3;  ///< pieces of advice
  std::vector<CoachRule> rules;
};

/// assets/coach/rules.json, see FindDataFolder.
inline constexpr const char* kCoachRulesFile = "coach/rules.json";

/// \param name  for messages
/// \return kJsonSyntax; kJsonField with the path of the field: unknown measures and placeholders, rules given twice, a sentence
///         that shows {expert} where there may be none
base::Result<CoachRules> ParseCoachRules(std::string_view text, const std::string& name);

/// Numbers that a rule was decided by.
struct AdviceNumbers {
  double value = 0;                              ///< in the measure's unit
  std::optional<double> most;                    ///< the single greatest one, where `value` is not that
  std::optional<double> expert_mean, expert_sd;  ///< of the expert set; nothing where there is none
  double deviation = 0;  ///< standard deviations beyond the mean, or multiples of the absolute threshold [-]
  double threshold = 0;  ///< that it has passed, of the same [-]
  double cost = 0;       ///< weight * deviation: by it advice is ordered [-]
};

struct Advice {
  std::string rule, topic;
  std::string sentence;  ///< what was seen
  std::string look;      ///< where to look: "Look at 0:41, the left hand."; empty where no moment stands out
  std::string why;       ///< why it matters
  std::string exercise;  ///< key of a delivered task
  std::string practise;  ///< what to do there
  std::string source;
  std::optional<double> time;  ///< of the moment, since the attempt's first tick [s]
  int hand = -1;               ///< instrument::Hand, or -1
  AdviceNumbers numbers;
};

/// \param reference  the expert set of the same task, or nullptr: then only rules with an absolute threshold speak
/// \return most costly first, at most CoachRules::most, one for each topic; empty where nothing stands out
/// \note The same attempt gives the same words. Not real-time safe: allocates.
std::vector<Advice> CoachAttempt(const AttemptTrace& trace, const AttemptMetrics& metrics,
                                 const CoachRules& rules, const TaskValidity* reference);

/// "1:07"
std::string FormatMoment(double seconds);

}  // namespace trocar::training
