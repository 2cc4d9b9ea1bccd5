// SPDX-License-Identifier: Apache-2.0
/// \file patient_from_labels.h  A label map that somebody else drew or computed becomes a patient.
#pragma once

#include <filesystem>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "trocar/anatomy/build_patient.h"
#include "trocar/anatomy/structure.h"
#include "trocar/base/result.h"
#include "trocar/images/image_series.h"
#include "trocar/images/image_stack.h"

namespace trocar::anatomy {

struct LabelOptions {
  std::filesystem::path labels;  ///< label map or folder of masks, as ReadLabelVolume reads
  std::filesystem::path output;  ///< patient folder to write; empty: nothing is written
  std::filesystem::path names;   ///< table of labels, in place of the file's own names; empty: none
  std::filesystem::path
      images;  ///< the series that the labels were drawn on, for their densities; empty: none
  images::ImageSeriesOptions opening;  ///< of `images`
  int liver = 0;                       ///< label, 1 to kLargestLabel; 0: found by FindLabels
  int gallbladder = 0;                 ///< as `liver`
  double spacing_mm = 1.0;             ///< of the volume's lattice, 0.4 to 4
  double gap_mm = 0.7;                 ///< left free around the gallbladder
  bool is_mirrored = false;            ///< left and right of the map are swapped: take it the other way round
  bool takes_largest_part = false;     ///< also where a large part does not hang together with it
  std::stop_token stop;                ///< gives up before anything is written: kCancelled
};

/// Which labels of a map are what, and how that was found.
struct OrganLabels {
  int liver = 0, gallbladder = 0;
  int spleen = 0;  ///< 0: not known; it tells left from right
  std::string
      convention;  ///< how they were found: "named on request", "the map's names", "the numbers of ..."
  std::map<int, Structure>
      structures;  ///< of the labels that occur and are understood, the two organs among them
  std::map<int, int>
      joined;  ///< labels that are part of an organ, as lobes, tumours and stones are, to that organ's label
  std::vector<patient::SourceLabel>
      taken;  ///< liver and gallbladder, then the others that are used, each with its reason
};

/// Median of the grey values in which each label lies [HU], of labels with voxels enough to tell.
using LabelDensities = std::map<int, double>;

/// Whether a series is a CT in Hounsfield units: grey values that go down to air. Those of magnetic resonance and photographs do not.
bool HoldsHounsfieldUnits(const images::ImageSeriesInfo& series);

/// Lays the labels over a CT and measures them, 3 mm from slice to slice.
/// \return empty where the series holds no Hounsfield units; kLabelsMismatch where the labels were drawn on other images; or why slices
///         cannot be read
base::Result<LabelDensities> MeasureDensities(const images::LabelVolume& volume,
                                              const images::ImageSeries& series);

/// Which labels are the organs and their neighbours, the one decision for every reader of a label map:
/// what `options` names; else the map's names, where it has any (an unknown name is asked for, never replaced by a number); else the
/// numbers, where all labels fit one scheme of label_schemes.cpp and sizes, places and densities agree (label_evidence.h). Where several schemes
/// fit so, they must agree on both organs.
/// \return kLabelsMismatch where that is not certain: it says what is seen, and asks for --names, --liver or --gallbladder
base::Result<OrganLabels> FindLabels(const images::LabelVolume& volume, const LabelOptions& options,
                                     const LabelDensities& densities = {});

/// Gives the parts of an organ (`joined`) the organ's label.
void JoinParts(const OrganLabels& organs, images::LabelVolume& volume);

/// Fills, meshes and assembles liver and gallbladder as BuildPatient does. The header's directions (LPS or
/// RAS, turned or mirrored axes) are obeyed. Ducts and arteries are the generator's usual ones, placed by
/// landmarks (is_seen = false); the neck of the gallbladder is its more cranial and posterior end. Of each organ
/// the largest part that hangs together is taken; `notes` of the report say what was lost.
/// \return the first error of any step, and kLabelsMismatch with the likely reason for what cannot be a person's
///         organs (docs/patients.md); then nothing has been written
base::Result<BuildReport> BuildPatientFromLabels(const LabelOptions& options,
                                                 const images::Progress& progress = {});

}  // namespace trocar::anatomy
