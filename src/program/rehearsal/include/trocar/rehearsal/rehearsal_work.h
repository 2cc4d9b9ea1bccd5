// SPDX-License-Identifier: Apache-2.0
/// \file rehearsal_work.h  Computations from images to an operation, beside the window: a label map is read, a patient is built,
/// and what is to be said and shown of it.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "trocar/anatomy/patient_lint.h"
#include "trocar/base/result.h"
#include "trocar/images/image_stack.h"
#include "trocar/patient/patient.h"
#include "trocar/rehearsal/rehearsal_state.h"
#include "trocar/view/patient_figure.h"

namespace trocar::rehearsal {

/// A label of a map, as a person chooses it.
struct LabelChoice {
  int label = 0;
  std::string text;  ///< "5: liver, 1,498 mL"
};

/// Findings in a label map before anything is built.
struct LabelMap {
  images::LabelVolume aligned;  ///< a voxel a pixel of the series
  std::vector<LabelChoice> choices;
  int liver = 0, gallbladder = 0;      ///< 0: not found
  std::optional<base::Error> problem;  ///< why the organs are not found; they may be chosen among `choices`
};

/// Reads a map and lays it over the series.
/// \param liver, gallbladder  labels; 0: found as anatomy::FindLabels does
/// \param slices, opening     where the series lies, for the labels' densities, and how it is opened; empty: they are not looked at
/// \return the error of reading, or kLabelsMismatch where it was drawn on other images
base::Result<LabelMap> ReadLabelMap(const std::filesystem::path& file, int liver, int gallbladder,
                                    const images::ImageSeriesInfo& series,
                                    const std::filesystem::path& slices = {},
                                    const images::ImageSeriesOptions& opening = {});

/// Identifies what a patient is built from: it changes with the files. Empty where one cannot be read.
std::string Fingerprint(const RehearsalState& state, const std::filesystem::path& contours);

struct RehearsedPatient {
  patient::Patient patient;
  anatomy::LintReport check;
  std::vector<std::string> notes;  ///< sentences: what was left out, what sank under the gas
};

/// Builds the patient that the state describes and writes it in place of `folder`; that is as it was where something fails or is
/// stopped.
/// \param contours  file of control points, with OrganSource::kContours
base::Result<RehearsedPatient> BuildRehearsed(const RehearsalState& state,
                                              const std::filesystem::path& contours,
                                              const std::filesystem::path& folder,
                                              const images::Progress& progress, const std::stop_token& stop);
/// One that was built before.
base::Result<RehearsedPatient> ReadRehearsed(const std::filesystem::path& folder,
                                             std::vector<std::string> notes);

/// A line that a person reads.
struct RehearsalLine {
  enum class Kind { kPlain, kTitle, kGood, kBad };
  Kind kind = Kind::kPlain;
  std::string text;

  friend bool operator==(const RehearsalLine&, const RehearsalLine&) = default;
};

/// The check's findings as sentences, volumes, neighbours, notes.
std::vector<RehearsalLine> DescribeCheck(const RehearsedPatient& built);
/// Origin of a patient's parts: fitted to the images, a template, or taken from distributions.
std::vector<RehearsalLine> DescribeOrigin(const patient::Patient& patient);
/// Why a port is there or the table tilts so, in the chosen language.
std::string SpokenReason(const std::string& reason);
/// "Laparoscope", "Left hand", ...
std::string SpokenUse(patient::PortUse use);

/// The patient from outside with its neighbours; those from the template are paler.
std::vector<render::FigureSurface> MakeRehearsalFigure(const patient::Patient& patient,
                                                       const view::PatientColours& colours);
/// Its ports in their order, each with a line to the gallbladder's neck; the chosen one is highlighted.
render::FigureMarks MakePortMarks(const patient::Patient& patient, std::size_t chosen);

}  // namespace trocar::rehearsal
