// SPDX-License-Identifier: Apache-2.0
#include "trocar/rehearsal/rehearsal_work.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <system_error>

#include "trocar/anatomy/build_patient.h"
#include "trocar/anatomy/patient_from_labels.h"
#include "trocar/base/state_archive.h"
#include "trocar/base/state_hash.h"
#include "trocar/files/patient_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/images/label_alignment.h"
#include "trocar/patient/patient.h"
#include "trocar/roles/roles.h"

namespace trocar::rehearsal {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;
using Kind = RehearsalLine::Kind;
using roles::NeighbourRole;

constexpr std::size_t kMostChoices = 150;
constexpr double kNeighbourOpacity = 0.55, kTemplateOpacity = 0.25, kLiverOpacity = 0.6;

Error GivenUp() {
  return {ErrorCode::kCancelled, "the patient was given up; nothing was written"};
}

std::string Millilitres(double ml) {
  return host::LocalCount(static_cast<std::uint64_t>(std::llround(std::max(0.0, ml)))) + " mL";
}

std::vector<LabelChoice> ListChoices(const images::LabelVolume& volume) {
  double voxel_ml = 1e-3;
  for (const auto& axis : volume.direction) voxel_ml *= std::hypot(axis[0], axis[1], axis[2]);
  std::map<std::int32_t, std::size_t> counts;
  for (const std::int32_t label : volume.labels) {
    if (label != 0) ++counts[label];
  }
  std::vector<LabelChoice> choices;
  for (const auto& [label, count] : counts) {
    if (choices.size() == kMostChoices) break;
    std::string text = std::to_string(label);
    for (const auto& [name, number] : volume.names) {
      if (number == label) text += ": " + host::TranslateComposed(roles::SpokenName(name));
    }
    choices.push_back({label, text + ", " + Millilitres(voxel_ml * static_cast<double>(count))});
  }
  return choices;
}

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Names of the neighbours that the images show, or of those that they do not.
std::string ListNeighbours(const patient::Patient& patient, bool is_seen) {
  std::vector<std::string> names;
  for (const patient::Neighbour& neighbour : patient.neighbours) {
    if (neighbour.is_seen == is_seen)
      names.push_back(host::TranslateComposed(roles::SpokenName(neighbour.name)));
  }
  return Join(names);
}

std::string ListTubes(const patient::Patient& patient, bool is_seen) {
  std::vector<std::string> names;
  for (const patient::Tube& tube : patient.tubes) {
    if (tube.is_seen == is_seen) names.push_back(host::TranslateComposed(roles::SpokenName(tube.name)));
  }
  return Join(names);
}

render::SrgbColour NeighbourColour(NeighbourRole role) {
  switch (role) {
    case NeighbourRole::kRibs:
    case NeighbourRole::kSpine:
      return {0.86, 0.82, 0.70};
    case NeighbourRole::kVenaCava:
    case NeighbourRole::kPortalVein:
      return {0.35, 0.48, 0.78};
    case NeighbourRole::kAorta:
      return {0.78, 0.30, 0.28};
    case NeighbourRole::kPancreas:
    case NeighbourRole::kRightKidney:
      return {0.82, 0.68, 0.42};
    default:
      return {0.82, 0.58, 0.56};
  }
}

base::Result<RehearsedPatient> BuildFrom(const RehearsalState& state, const fs::path& contours,
                                         const images::Progress& progress, const std::stop_token& stop) {
  base::Result<anatomy::BuildReport> report = GivenUp();
  if (state.source == OrganSource::kLabels) {
    anatomy::LabelOptions options;
    options.labels = state.labels;
    options.liver = state.liver, options.gallbladder = state.gallbladder;
    options.images = state.series, options.opening = state.options;
    options.stop = stop;
    report = anatomy::BuildPatientFromLabels(options, progress);
  } else {
    anatomy::BuildOptions options;
    options.control_points = contours;
    options.images = state.series;
    options.dicom_series = state.options.series;
    options.stop = stop;
    report = anatomy::BuildPatient(options, progress);
  }
  if (!report.ok()) return report.error();
  RehearsedPatient built;
  built.patient = std::move(report->patient);
  built.notes = std::move(report->notes);
  for (std::string& sentence : report->sinking) built.notes.push_back(std::move(sentence));
  return built;
}

}  // namespace

base::Result<LabelMap> ReadLabelMap(const fs::path& file, int liver, int gallbladder,
                                    const images::ImageSeriesInfo& series, const fs::path& slices,
                                    const images::ImageSeriesOptions& opening) {
  auto volume = images::ReadLabelVolume(file);
  if (!volume.ok()) return volume.error();
  LabelMap map;
  map.choices = ListChoices(*volume);
  anatomy::LabelOptions options;
  options.liver = liver, options.gallbladder = gallbladder;
  anatomy::LabelDensities densities;
  if (!slices.empty() && anatomy::HoldsHounsfieldUnits(series)) {
    // what cannot be measured speaks neither for nor against a label; that the map is of other images is said below
    if (const auto opened = images::ImageSeries::Open(slices, opening); opened.ok()) {
      if (auto measured = anatomy::MeasureDensities(*volume, *opened); measured.ok())
        densities = std::move(*measured);
    }
  }
  const auto found = anatomy::FindLabels(*volume, options, densities);
  if (found.ok()) {
    map.liver = found->liver, map.gallbladder = found->gallbladder;
    anatomy::JoinParts(*found, *volume);
  } else {
    // what FindLabels says names options of the command line
    map.problem = Error{
        found.error().code,
        "which labels of this map are liver and gallbladder is not certain by their names, "
        "their numbers, sizes, "
        "places and densities; say which label is which. A map without a gallbladder, as after its removal "
        "or of the chest, is of no use here: take another one"};
    map.liver = liver, map.gallbladder = gallbladder;
  }
  auto aligned = images::AlignLabels(std::move(*volume), series);
  if (!aligned.ok()) return aligned.error();
  map.aligned = std::move(*aligned);
  return map;
}

std::string Fingerprint(const RehearsalState& state, const fs::path& contours) {
  base::StateHash hash;
  std::error_code failure;
  if (state.source == OrganSource::kLabels) {
    const auto time = fs::last_write_time(state.labels, failure);
    if (failure) return {};
    const auto size = fs::is_directory(state.labels, failure) ? 0 : fs::file_size(state.labels, failure);
    base::AddStateTo(hash, state.labels.string() + " " + std::to_string(state.liver) + " " +
                               std::to_string(state.gallbladder) + " " + std::to_string(size) + " " +
                               std::to_string(time.time_since_epoch().count()));
  } else if (state.source == OrganSource::kContours) {
    const auto text = host::ReadFile(contours);
    if (!text.ok()) return {};
    base::AddStateTo(hash, state.series.string() + " " + std::to_string(state.options.series) + *text);
  } else {
    return {};
  }
  return hash.Text();
}

base::Result<RehearsedPatient> BuildRehearsed(const RehearsalState& state, const fs::path& contours,
                                              const fs::path& folder, const images::Progress& progress,
                                              const std::stop_token& stop) {
  auto built = BuildFrom(state, contours, progress, stop);
  if (!built.ok()) return built;
  if (progress) progress(host::Mark("checking the patient"), 0.95);
  built->check = anatomy::LintPatient(built->patient);
  std::error_code failure;
  fs::create_directories(folder.parent_path(), failure);
  const host::PartialPath part(folder);
  if (auto status = files::WritePatient(part.Path(), built->patient); !status.ok()) return status.error();
  if (stop.stop_requested()) return GivenUp();
  fs::remove_all(folder, failure);
  fs::rename(part.Path(), folder, failure);
  if (failure)
    return Error{ErrorCode::kFileUnwritable, folder.string() + " cannot be written: " + failure.message()};
  return built;
}

base::Result<RehearsedPatient> ReadRehearsed(const fs::path& folder, std::vector<std::string> notes) {
  auto patient = files::ReadPatient(folder);
  if (!patient.ok()) return patient.error();
  RehearsedPatient built;
  built.check = anatomy::LintPatient(*patient);
  built.patient = std::move(*patient);
  built.notes = std::move(notes);
  return built;
}

std::vector<RehearsalLine> DescribeCheck(const RehearsedPatient& built) {
  std::vector<RehearsalLine> lines;
  const auto& findings = built.check.findings;
  if (findings.empty()) {
    lines.push_back(
        {Kind::kGood, host::Translate("The check finds nothing wrong: this patient can be operated on.")});
  } else {
    lines.push_back({Kind::kBad, host::TranslateCount("The check finds {1} thing that is to be looked at:",
                                                      "The check finds {1} things that are to be looked at:",
                                                      findings.size())});
    for (const anatomy::LintFinding& finding : findings)
      lines.push_back({Kind::kPlain, host::TranslateComposed(finding.text)});
  }
  lines.push_back({Kind::kTitle, host::Translate("Volumes")});
  for (const anatomy::MeshSummary& mesh : built.check.meshes) {
    lines.push_back(
        {Kind::kPlain, host::TranslateWith("{1}: {2}, {3} triangles",
                                           {host::TranslateComposed(roles::SpokenName(mesh.name)),
                                            Millilitres(mesh.volume_ml), host::LocalCount(mesh.triangles)})});
  }
  lines.push_back({Kind::kTitle, host::Translate("Neighbours")});
  const std::string seen = ListNeighbours(built.patient, true), placed = ListNeighbours(built.patient, false);
  if (!seen.empty()) lines.push_back({Kind::kPlain, host::TranslateWith("From the images: {1}", {seen})});
  if (!placed.empty())
    lines.push_back({Kind::kPlain,
                     host::TranslateWith("From the template, because nothing outlines them: {1}", {placed})});
  if (!built.patient.labels.empty()) lines.push_back({Kind::kTitle, host::Translate("Labels")});
  for (const patient::SourceLabel& label : built.patient.labels) {
    if (!roles::FindRole<roles::OrganRole>(label.meaning)) continue;
    lines.push_back(
        {Kind::kPlain, host::TranslateWith("Label {1} was taken for the {2}: {3}.",
                                           {std::to_string(label.label), host::Translate(label.meaning),
                                            host::TranslateComposed(label.reason)})});
  }
  if (built.notes.empty()) return lines;
  lines.push_back({Kind::kTitle, host::Translate("Notes")});
  for (const std::string& note : built.notes) lines.push_back({Kind::kPlain, host::TranslateComposed(note)});
  return lines;
}

std::vector<RehearsalLine> DescribeOrigin(const patient::Patient& patient) {
  std::vector<RehearsalLine> lines;
  lines.push_back({Kind::kTitle, host::Translate("Fitted to the images")});
  std::string seen = host::Translate(roles::NameOf(roles::OrganRole::kLiver)) + ", " +
                     host::Translate(roles::NameOf(roles::OrganRole::kGallbladder));
  if (const std::string more = ListNeighbours(patient, true); !more.empty()) seen += ", " + more;
  if (const std::string tubes = ListTubes(patient, true); !tubes.empty()) seen += ", " + tubes;
  lines.push_back({Kind::kPlain, seen});
  lines.push_back({Kind::kTitle, host::Translate("Template")});
  const std::string placed = ListNeighbours(patient, false);
  lines.push_back(
      {Kind::kPlain, !placed.empty() ? placed
                     : patient.neighbours.empty()
                         ? host::Translate("The abdomen round liver and gallbladder is the usual one.")
                         : host::Translate("No neighbour is from the template.")});
  lines.push_back({Kind::kTitle, host::Translate("Not in the images")});
  if (const std::string tubes = ListTubes(patient, false); !tubes.empty())
    lines.push_back(
        {Kind::kPlain,
         host::TranslateWith("Placed by landmarks, with the middle of every distribution: {1}", {tubes})});
  lines.push_back(
      {Kind::kPlain, host::Translate("Thickness of the wall, adhesions and stones are the usual ones.")});
  lines.push_back({Kind::kTitle, host::Translate("What is known of the accuracy")});
  lines.push_back(
      {Kind::kPlain,
       host::Translate("How closely surfaces follow known bodies is measured on phantoms and on the Visible "
                       "Human (docs/measurements.md). Nothing is measured on patients: this is for "
                       "training, not for planning treatment.")});
  return lines;
}

std::string SpokenReason(const std::string& reason) {
  return host::TranslatePieces(reason);
}

std::string SpokenUse(patient::PortUse use) {
  switch (use) {
    case patient::PortUse::kLaparoscope:
      return host::Translate("Laparoscope");
    case patient::PortUse::kLeftHand:
      return host::Translate("Left hand");
    case patient::PortUse::kRightHand:
      return host::Translate("Right hand");
    case patient::PortUse::kAssistant:
      break;
  }
  return host::Translate("Assistant");
}

std::vector<render::FigureSurface> MakeRehearsalFigure(const patient::Patient& patient,
                                                       const view::PatientColours& colours) {
  view::PatientFigureOptions options;
  options.colours = colours;
  options.has_regions = options.has_landmarks = false;
  options.liver_opacity = kLiverOpacity;
  std::vector<render::FigureSurface> surfaces = view::MakePatientFigure(patient, options).surfaces;
  for (const patient::Neighbour& neighbour : patient.neighbours) {
    render::FigureSurface surface{
        neighbour.mesh.triangles, neighbour.mesh.positions, {NeighbourColour(neighbour.role)}};
    surface.opacity = neighbour.is_seen ? kNeighbourOpacity : kTemplateOpacity;
    surface.is_pickable = false;
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

render::FigureMarks MakePortMarks(const patient::Patient& patient, std::size_t chosen) {
  constexpr render::SrgbColour kChosen{1.0, 0.76, 0.30}, kOther{0.50, 0.82, 0.87};
  render::FigureMarks marks;
  const patient::Landmark* neck = patient.LandmarkOf(roles::LandmarkRole::kInfundibulum);
  for (std::size_t i = 0; i < patient.ports.size(); ++i) {
    const bool is_chosen = i == chosen;
    const render::SrgbColour& colour = is_chosen ? kChosen : kOther;
    marks.points.push_back({patient.ports[i].position, colour, is_chosen ? 18.0 : 13.0, true});
    if (neck != nullptr)
      marks.lines.push_back(
          {{patient.ports[i].position, neck->position}, colour, is_chosen ? 3.0 : 1.5, true});
  }
  return marks;
}

}  // namespace trocar::rehearsal
