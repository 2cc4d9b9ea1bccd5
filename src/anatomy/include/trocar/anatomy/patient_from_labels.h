// SPDX-License-Identifier: Apache-2.0
/// \file patient_from_labels.h  A label map that somebody else drew or computed becomes a patient.
/// Source of the numbers: TotalSegmentator (Wasserthal et al., Radiology: Artificial Intelligence 2023), its
/// totalsegmentator/map_to_binary.py: gallbladder 4, liver 5 in the tasks total (both versions) and total_mr.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>

#include "trocar/anatomy/build_patient.h"
#include "trocar/core/result.h"
#include "trocar/images/image_stack.h"

namespace trocar::anatomy {

struct LabelOptions {
  std::filesystem::path labels;     ///< label map or folder of masks, as ReadLabelVolume reads
  std::filesystem::path output;     ///< patient folder to write; empty: nothing is written
  std::filesystem::path names;      ///< table of labels, in place of the file's own names; empty: none
  int liver = 0;                    ///< label, 1 to kLargestLabel; 0: found by FindLabels
  int gallbladder = 0;              ///< likewise
  double spacing_mm = 1.0;          ///< of the volume's lattice, 0.4 to 4
  double gap_mm = 0.7;              ///< left free around the gallbladder
  bool is_mirrored = false;         ///< left and right of the map are swapped: take it the other way round
  bool takes_largest_part = false;  ///< also where a large part does not hang together with it
  std::stop_token stop;             ///< gives up before anything is written: kCancelled
};

struct OrganLabels {
  int liver = 0, gallbladder = 0;
  int spleen = 0;          ///< 0: not known; it tells left from right
  std::string convention;  ///< how they were found, in words
};

/// Which labels are the organs: those that are named in `options`, else segments called liver and
/// gallbladder, else TotalSegmentator's 5 and 4 where 5 occurs more often than 1 and 2, else 1 and 2.
/// \return kLabelsMismatch when a label does not occur (it names the label and those that do), or when the
///         file names one of the organs and not the other
core::Result<OrganLabels> FindLabels(const images::LabelVolume& volume, const LabelOptions& options);

/// Fills, meshes and assembles liver and gallbladder as BuildPatient does. The header's directions (LPS or
/// RAS, turned or mirrored axes) are obeyed. Ducts and arteries are the generator's usual ones, placed by
/// landmarks (is_seen = false); the neck of the gallbladder is its more cranial and posterior end. Of each organ
/// the largest part that hangs together is taken; `notes` of the report say what was lost.
/// \return the first error of any step, and kLabelsMismatch with the likely reason for what cannot be a person's
///         organs (docs/patients.md); then nothing has been written
core::Result<BuildReport> BuildPatientFromLabels(const LabelOptions& options,
                                                 const images::Progress& progress = {});

}  // namespace trocar::anatomy
