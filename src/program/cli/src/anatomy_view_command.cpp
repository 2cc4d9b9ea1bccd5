// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "console.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/patient/patient.h"
#include "trocar/render/figure_picture.h"
#include "trocar/scene/scene.h"
#include "trocar/view/patient_figure.h"

namespace trocar::cli {
namespace {

struct ViewArguments {
  std::string patient, picture, from = "anterior", focus;
  bool has_regions = false, has_attachments = false, has_edges = false;
  double liver_opacity = 1;
  int width = 1000, height = 800;
};

/// What the camera must hold: everything but the landmarks, or the organ or tube of that name.
base::Result<geometry::Box> FindFocus(const patient::Patient& patient, const view::PatientFigure& figure,
                                      const std::string& name) {
  if (name.empty()) return render::CalcFigureBox(figure.surfaces);
  std::string known;
  for (std::size_t i = 0; i < figure.surfaces.size(); ++i) {
    const std::string& each =
        i < patient.organs.size() ? patient.organs[i].name : patient.tubes[i - patient.organs.size()].name;
    if (each == name) return render::CalcFigureBox({&figure.surfaces[i], 1});
    known += (known.empty() ? "" : ", ") + each;
  }
  return base::Error{base::ErrorCode::kUnknownName,
                     "the patient has no \"" + name + "\" to focus on; it has " + known};
}

void PrintLegend(const patient::Patient& patient, const view::PatientFigureOptions& options) {
  const auto row = [](const std::string& what, const render::SrgbColour& colour) {
    char text[8];
    std::snprintf(text, sizeof(text), "#%02x%02x%02x", static_cast<int>(255 * colour[0] + 0.5),
                  static_cast<int>(255 * colour[1] + 0.5), static_cast<int>(255 * colour[2] + 0.5));
    return std::vector<std::string>{what, text};
  };
  std::vector<std::vector<std::string>> rows = {{"in the picture", "colour"}};
  for (const patient::Organ& organ : patient.organs) {
    rows.push_back(row(ShownName(organ.name), options.colours.Of(organ.role)));
    if (!options.has_regions) continue;
    for (const patient::Region& region : organ.regions)
      rows.push_back(
          row(ShownName(organ.name) + "/" + ShownName(region.name), options.colours.Of(region.role)));
  }
  for (const patient::Tube& tube : patient.tubes)
    rows.push_back(row(ShownName(tube.name), options.colours.Of(tube)));
  host::PrintTable(rows);
}

base::Status View(const ViewArguments& arguments) {
  std::vector<render::Viewpoint> viewpoints;
  if (arguments.from == "all") {
    for (int i = 0; i < 6; ++i) viewpoints.push_back(static_cast<render::Viewpoint>(i));
  } else if (const auto viewpoint = render::FindViewpoint(arguments.from)) {
    viewpoints = {*viewpoint};
  } else {
    return base::Error{base::ErrorCode::kUsage,
                       "--from \"" + arguments.from +
                           "\" is not known; it is anterior, posterior, right, left, superior, inferior, "
                           "umbilicus or all"};
  }
  const auto patient = files::ReadPatient(arguments.patient);
  if (!patient) return patient.error();
  const auto data = host::FindDataFolder();
  if (!data) return data.error();
  const auto colours = view::ReadPatientColours(*data / view::kPatientColoursFile);
  if (!colours) return colours.error();
  view::PatientFigureOptions options;
  options.colours = *colours;
  options.has_regions = arguments.has_regions;
  options.has_attachments = arguments.has_attachments;
  options.has_edges = arguments.has_edges;
  options.has_landmarks = false;
  options.liver_opacity = arguments.liver_opacity;
  const view::PatientFigure figure = view::MakePatientFigure(*patient, options);
  const auto box = FindFocus(*patient, figure, arguments.focus);
  if (!box) return box.error();
  std::vector<render::OrbitCamera> cameras;
  for (const render::Viewpoint viewpoint : viewpoints) {
    cameras.push_back(
        render::LookFrom(viewpoint, *box, static_cast<double>(arguments.width) / arguments.height));
  }
  const auto pictures =
      render::DrawPictures(figure.surfaces, figure.marks, cameras, {}, arguments.width, arguments.height);
  if (!pictures) return pictures.error();
  constexpr int kColumns = 3;
  if (auto status = render::WritePng(arguments.picture, render::TilePictures(*pictures, kColumns)); !status)
    return status;
  PrintLegend(*patient, options);
  host::Say("\nWrote {1}\n", arguments.picture);
  return {};
}

}  // namespace

void AddAnatomyViewCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command = anatomy.add_subcommand("view", "Draw a patient from outside: organs, regions, ducts");
  auto arguments = std::make_shared<ViewArguments>();
  command->add_option("patient", arguments->patient, "Patient folder")->required()->type_name("PATIENT");
  command->add_option("--png", arguments->picture, "Picture to write")->required()->type_name("FILE");
  command
      ->add_option(
          "--from", arguments->from,
          "anterior, posterior, right, left, superior, inferior, umbilicus (as the laparoscope looks), "
          "or all: six in one picture")
      ->type_name("SIDE")
      ->capture_default_str();
  command->add_flag("--regions", arguments->has_regions, "The organs' regions in colour");
  command->add_flag("--attachments", arguments->has_attachments,
                    "The springs between gallbladder and liver, to see with --liver-opacity");
  command->add_flag("--edges", arguments->has_edges, "The triangles' edges");
  command
      ->add_option("--liver-opacity", arguments->liver_opacity,
                   "0 hides the liver, 1 hides what lies behind it")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--focus", arguments->focus, "Fill the picture with this organ, duct or artery")
      ->type_name("NAME");
  command->add_option("--width", arguments->width, "Of one view [pixels]")
      ->check(CLI::Range(64, 2700))
      ->capture_default_str();
  command->add_option("--height", arguments->height, "Of one view [pixels]")
      ->check(CLI::Range(64, 2700))
      ->capture_default_str();
  command->footer(
      "Needs no display. Letters in the corner: L left, S superior, A anterior.\n"
      "Examples: trocar anatomy view assets/patients/visible-human-male/patient --png liver.png --regions "
      "--from all\n"
      "          trocar anatomy view out/seven --png ducts.png --focus cystic_duct --liver-opacity 0.3 "
      "--from umbilicus");
  command->callback([arguments, &outcome] { outcome.status = View(*arguments); });
}

}  // namespace trocar::cli
