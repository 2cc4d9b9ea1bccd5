// SPDX-License-Identifier: Apache-2.0
// How numbers, times and keys are said to a person.
#include <cmath>
#include <cstdio>

#include "trocar/host/text_table.h"
#include "trocar/host/translate.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/report/attempt_report.h"

namespace trocar::report {
namespace {

constexpr const char* kMonths[] = {host::Mark("January"), host::Mark("February"), host::Mark("March"),
                                   host::Mark("April"),   host::Mark("May"),      host::Mark("June"),
                                   host::Mark("July"),    host::Mark("August"),   host::Mark("September"),
                                   host::Mark("October"), host::Mark("November"), host::Mark("December")};

}  // namespace

std::string FormatClock(double seconds) {
  // tenths only where an axis has marks between seconds
  const auto tenths = static_cast<long long>(std::llround(10 * std::fmax(seconds, 0)));
  const long long whole =
      tenths % 10 == 0 || seconds >= 10 ? static_cast<long long>(std::llround(seconds)) : tenths / 10;
  char text[48];
  if (tenths % 10 != 0 && seconds < 10) {
    std::snprintf(text, sizeof text, "0:%02lld.%lld", whole, tenths % 10);
  } else if (whole >= 3600) {
    std::snprintf(text, sizeof text, "%lld:%02lld:%02lld", whole / 3600, whole / 60 % 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%lld:%02lld", whole / 60, whole % 60);
  }
  return host::LocalNumber(text);
}

std::string FormatDigits(double value, int digits) {
  return host::LocalNumber(host::FormatNumber(value, digits));
}

std::string FormatDuration(double seconds) {
  if (seconds < 100) return FormatDigits(seconds, seconds < 10 ? 2 : 3) + " s";
  const auto whole = static_cast<long long>(std::llround(seconds));
  std::string text = std::to_string(whole / 60) + " min";
  if (whole % 60 != 0) text += " " + std::to_string(whole % 60) + " s";
  return text;
}

std::string FormatShown(double value) {
  const double size = std::fabs(value);
  char text[64];
  if (size >= 1e6 || (size > 0 && size < 1e-3)) return FormatDigits(value, 3);
  const int decimals = value == std::round(value) ? 0 : size >= 100 ? 0 : size >= 10 ? 1 : 2;
  std::snprintf(text, sizeof text, "%.*f", size < 0.1 && size > 0 ? 3 : decimals, value);
  return host::LocalNumber(text);
}

std::string FormatDate(const std::string& date) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0;
  if (std::sscanf(date.c_str(), "%4d-%2d-%2dT%2d:%2d", &year, &month, &day, &hour, &minute) != 5 ||
      month < 1 || month > 12)
    return date;
  char clock[16];
  std::snprintf(clock, sizeof clock, "%02d:%02d", hour, minute);
  return host::TranslateWith("{1} {2} {3}, {4}", {std::to_string(day), host::Translate(kMonths[month - 1]),
                                                  std::to_string(year), clock});
}

std::string PhaseName(const std::string& phase) {
  for (const scene::Procedure* procedure : procedures::ListProcedures()) {
    for (const scene::PhaseRow& row : procedure->phases) {
      if (phase == row.name) return host::Translate(row.about);
    }
  }
  return phase;
}

std::string HandName(const std::string& hand) {
  if (hand == "left") return host::Translate("left hand");
  if (hand == "right") return host::Translate("right hand");
  return hand == "camera" ? host::Translate("camera") : hand;
}

}  // namespace trocar::report
