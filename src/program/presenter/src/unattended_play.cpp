// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/unattended_play.h"

#include <cstdio>

#include "trocar/host/json_text.h"

namespace trocar::presenter {

UnattendedPlay::Step UnattendedPlay::Advance(double simulated, double elapsed) {
  if (!is_on_ || is_over_) return Step::kGoOn;
  is_over_ = elapsed > Limit() || simulated >= after_;
  if (!is_over_) return Step::kGoOn;
  return elapsed > Limit() ? Step::kGiveUp : Step::kSave;
}

base::Error UnattendedPlay::Complaint() const {
  return {base::ErrorCode::kUsage, "--after was not reached in " + std::to_string(static_cast<int>(Limit())) +
                                       " s: the simulation is slower than real time here; ask for less"};
}

std::string FormatPlayReport(const PlayReport& report) {
  char text[640];
  std::snprintf(text, sizeof text,
                ", \"width\": %d, \"height\": %d, \"first_picture_s\": %.3f, \"ticks\": %llu, "
                "\"late_ticks\": %llu, \"tick_median_ms\": %.3f, \"tick_p99_ms\": %.3f, \"real_time\": %s, "
                "\"pictures\": %llu, \"pictures_per_second\": %.1f, \"has_task_list\": %s",
                report.width, report.height, report.first_picture,
                static_cast<unsigned long long>(report.statistics.ticks),
                static_cast<unsigned long long>(report.statistics.late_ticks),
                1e3 * report.statistics.tick_median, 1e3 * report.statistics.tick_p99,
                report.statistics.is_real_time ? "true" : "false",
                static_cast<unsigned long long>(report.pictures), report.pictures_per_second,
                report.has_task_list ? "true" : "false");
  return "{\"screenshot\": " + host::QuoteJson(report.screenshot) + text +
         ", \"result\": " + host::QuoteJson(report.result) +
         (report.haptics.empty() ? std::string() : ", \"haptics\": " + report.haptics) + "}";
}

}  // namespace trocar::presenter
