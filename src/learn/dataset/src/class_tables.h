// SPDX-License-Identifier: Apache-2.0
/// \file class_tables.h  Classes of the public data sets, and which of them our labels become.
/// Sources: W.-Y. Hong et al., "CholecSeg8k", arXiv 2012.12453, values as its loaders use them; A. Murali et al., "The
/// Endoscapes dataset", arXiv 2312.12429; C. I. Nwoye et al., "Rendezvous", Med. Image Anal. 78, 2022 (CholecT50);
/// A. P. Twinanda et al., "EndoNet", IEEE TMI 36, 2017 (Cholec80).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "trocar/cholecystectomy/triplet.h"
#include "trocar/scene/procedure_snapshot.h"
#include "trocar/view/labels.h"

namespace trocar::dataset {

struct SegmentationClass {
  int id;
  std::string_view name;
  std::uint8_t watershed;  ///< grey value of the mask; 0 where the data set has none
  std::array<std::uint8_t, 3> colour;
};
/// 13 classes.
std::span<const SegmentationClass> CholecSeg8kClasses() noexcept;
/// 0 for the background, then 6 classes.
std::span<const SegmentationClass> EndoscapesClasses() noexcept;

/// Index in the table. What has no class of its own becomes what stands nearest, or the background.
int ToCholecSeg8k(view::LabelClass label) noexcept;
int ToEndoscapes(view::LabelClass label) noexcept;

/// Criteria of the critical view as Endoscapes orders them: two structures, hepatocystic triangle, cystic plate; 0 not, 0.5 in part, 1
/// whole. Source: "Endoscapes, a critical view of safety and surgical scene segmentation dataset", Sci Data 2025, s41597-025-04642-4,
/// Fig. 5.
std::array<double, 3> EndoscapesCriteria(const scene::ViewScore& view) noexcept;

/// Place of a triplet in CholecT50's list of 100, or -1.
int FindCholecT50Triplet(const cholecystectomy::Triplet& triplet) noexcept;
/// All 100.
std::span<const cholecystectomy::Triplet> CholecT50Triplets() noexcept;
/// "preparation", "carlot-triangle-dissection", ...: as that data set spells them.
std::string_view CholecT50Name(cholecystectomy::Phase phase) noexcept;

}  // namespace trocar::dataset
