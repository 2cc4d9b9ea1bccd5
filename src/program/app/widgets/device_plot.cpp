// SPDX-License-Identifier: Apache-2.0
#include "device_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "trocar/host/translate.h"

namespace trocar::app {
namespace {

using device::HandSample;

constexpr double kDegree = 57.29577951308232;
constexpr double kLeft = 118;  // of the lanes: room for names and numbers [pixels]

struct Lane {
  const char* name;
  const char* unit;
  double lowest, highest;  // of the lane, in `unit`
  double red, green, blue;
  double (*value)(const HandSample&);  // in `unit`; null: the force
};

constexpr Lane kLanes[] = {{host::Mark("pan"), "°", -80, 80, 0.50, 0.82, 0.87,
                            [](const HandSample& hand) { return kDegree * hand.pan; }},
                           {host::Mark("tilt"), "°", -80, 80, 0.56, 0.88, 0.66,
                            [](const HandSample& hand) { return kDegree * hand.tilt; }},
                           {host::Mark("turn"), "°", -180, 180, 0.80, 0.68, 0.95,
                            [](const HandSample& hand) { return kDegree * hand.spin; }},
                           {host::Mark("depth"), "mm", 0, 300, 1.00, 0.76, 0.30,
                            [](const HandSample& hand) { return 1e3 * hand.depth; }},
                           {host::Mark("jaw"), "°", 0, 70, 0.98, 0.56, 0.48,
                            [](const HandSample& hand) { return kDegree * hand.jaw; }},
                           {host::Mark("force"), "N", 0, 5, 0.92, 0.95, 0.97, nullptr}};
constexpr int kLaneCount = static_cast<int>(std::size(kLanes));

}  // namespace

DevicePlot::DevicePlot() {
  set_hexpand(true);
  set_vexpand(true);
  set_content_width(620);
  set_content_height(560);
  set_draw_func(sigc::mem_fun(*this, &DevicePlot::Draw));
}

void DevicePlot::Show(const std::deque<presenter::DeviceBench::Point>& points,
                      const std::deque<presenter::ForcePoint>& forces, device::Channel hand, double now) {
  points_ = &points, forces_ = &forces, hand_ = hand, now_ = now;
  queue_draw();
}

void DevicePlot::Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height) const {
  cairo->set_source_rgb(0.09, 0.105, 0.12);
  cairo->rectangle(0, 0, width, height);
  cairo->fill();
  if (points_ == nullptr) return;
  const double lane_height = static_cast<double>(height) / kLaneCount;
  const auto column = [&](double time) {
    return kLeft + (width - kLeft - 8) * (1.0 - (now_ - time) / presenter::DeviceBench::kHistory);
  };
  for (int i = 0; i < kLaneCount; ++i) {
    const Lane& lane = kLanes[i];
    const double top = i * lane_height;
    const auto row = [&](double value) {
      const double share = std::clamp((value - lane.lowest) / (lane.highest - lane.lowest), 0.0, 1.0);
      return top + 6 + (lane_height - 12) * (1.0 - share);
    };
    cairo->set_source_rgb(0.17, 0.195, 0.225);
    cairo->set_line_width(1);
    cairo->move_to(kLeft, row(std::max(0.0, lane.lowest)));
    cairo->line_to(width - 8, row(std::max(0.0, lane.lowest)));
    cairo->move_to(0, top + lane_height);
    cairo->line_to(width, top + lane_height);
    cairo->stroke();

    // a gap where the hand is not seen
    cairo->set_source_rgb(lane.red, lane.green, lane.blue);
    cairo->set_line_width(1.6);
    bool is_down = false;
    double newest = NAN;
    const auto add = [&](double time, double value, bool is_seen) {
      if (!is_seen || !std::isfinite(value) || column(time) < kLeft) {
        is_down = false;
        newest = NAN;
        return;
      }
      is_down ? cairo->line_to(column(time), row(value)) : cairo->move_to(column(time), row(value));
      is_down = true;
      newest = value;
    };
    if (lane.value != nullptr) {
      for (const presenter::DeviceBench::Point& point : *points_) {
        const HandSample& hand = point.hands[static_cast<std::size_t>(hand_)];
        add(point.time, lane.value(hand), hand.is_valid);
      }
    } else {
      for (const presenter::ForcePoint& point : *forces_) add(point.time, point.force, true);
    }
    cairo->stroke();
    cairo->select_font_face("sans-serif", Cairo::ToyFontFace::Slant::NORMAL,
                            Cairo::ToyFontFace::Weight::NORMAL);
    cairo->set_font_size(13);
    cairo->move_to(10, top + 0.5 * lane_height - 3);
    cairo->show_text(host::Translate(lane.name));
    char text[32] = "–";
    if (std::isfinite(newest)) std::snprintf(text, sizeof text, "%.1f %s", newest, lane.unit);
    cairo->move_to(10, top + 0.5 * lane_height + 15);
    cairo->show_text(host::LocalNumber(text));
  }
}

}  // namespace trocar::app
