// SPDX-License-Identifier: Apache-2.0
/// \file report.h  The page that shows a played scene: pictures, video, metrics, force and path.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/math/vector.h"
#include "trocar/training/metric_value.h"

namespace trocar::cli {

struct ReportPicture {
  std::string caption;
  std::string png;  ///< the file's bytes, put into the page
};

/// One hand, sample by sample.
struct ReportHand {
  std::string name;                     ///< "left"
  std::vector<double> force;            ///< (samples) on the instrument [N]
  std::vector<math::Vec3> p_world_tip;  ///< (samples) [m]
};

struct ReportContent {
  std::string scene, patient;  ///< names
  std::string provenance;      ///< of the patient, with credit
  std::uint64_t seed = 0;
  std::string hash;  ///< of the state after the last tick
  std::uint64_t ticks = 0;
  double tick_seconds = 0;  ///< [s]
  std::string version;      ///< of the program
  std::string video;        ///< file name beside the page; empty: none
  std::vector<ReportPicture> pictures;
  training::AttemptMetrics metrics;
  std::vector<std::array<std::string, 2>> haptics;  ///< of session::DescribeSummary; empty: none took part
  std::vector<double> times;                        ///< (samples) [s]
  std::vector<ReportHand> hands;
};

/// HTML that needs no network and no other file but the video.
std::string FormatReportPage(const ReportContent& content);

/// RFC 4648, with padding.
std::string EncodeBase64(std::string_view bytes);

}  // namespace trocar::cli
