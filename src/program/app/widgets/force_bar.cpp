// SPDX-License-Identifier: Apache-2.0
#include "force_bar.h"

#include <algorithm>
#include <cmath>

namespace trocar::app {

ForceBar::ForceBar() {
  set_content_height(10);
  set_hexpand(true);
  set_draw_func(sigc::mem_fun(*this, &ForceBar::Draw));
}

void ForceBar::Show(double force, const presenter::ForceThresholds& thresholds) {
  // a pixel is about 0.05 N: less than that is not worth a redraw
  if (std::fabs(force - force_) < 0.02 && thresholds.warning == thresholds_.warning) return;
  force_ = force;
  thresholds_ = thresholds;
  queue_draw();
}

void ForceBar::Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height) const {
  const auto column = [width](double force) {
    return width * std::clamp(force / presenter::kForceBarEnd, 0.0, 1.0);
  };
  cairo->set_source_rgb(0.17, 0.195, 0.225);
  cairo->rectangle(0, 0, width, height);
  cairo->fill();
  switch (presenter::JudgeForce(force_, thresholds_)) {
    case presenter::ForceLevel::kCalm:
      cairo->set_source_rgb(0.36, 0.76, 0.50);
      break;
    case presenter::ForceLevel::kWarning:
      cairo->set_source_rgb(1.00, 0.74, 0.25);
      break;
    case presenter::ForceLevel::kDanger:
      cairo->set_source_rgb(0.95, 0.35, 0.30);
      break;
  }
  cairo->rectangle(0, 0, std::isfinite(force_) ? column(force_) : width, height);
  cairo->fill();
  cairo->set_line_width(2);
  cairo->set_source_rgb(1.00, 0.76, 0.30);
  cairo->move_to(column(thresholds_.warning), 0);
  cairo->line_to(column(thresholds_.warning), height);
  cairo->stroke();
  cairo->set_source_rgb(1.00, 0.42, 0.37);
  cairo->move_to(column(thresholds_.danger), 0);
  cairo->line_to(column(thresholds_.danger), height);
  cairo->stroke();
}

}  // namespace trocar::app
