// SPDX-License-Identifier: Apache-2.0
/// \file disclaimer.h  Disclaimer and footer of every report.
#pragma once

#include <string>

#include "trocar/host/translate.h"
#include "trocar/training/metric_definition.h"

namespace trocar::report {

inline std::string DisclaimerSentence() {
  return host::Translate("This is training feedback, not certified assessment.");
}

/// For the foot of every page.
inline std::string FooterText(const std::string& person, const std::string& program) {
  std::string text = "Trocar" + (program.empty() ? "" : " " + program);
  if (!person.empty()) text += " · " + person;
  return text + " · " + host::Translate(training::MetricsDisclaimer());
}

}  // namespace trocar::report
