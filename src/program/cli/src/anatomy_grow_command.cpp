// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "console.h"
#include "image_options.h"
#include "trocar/contours/contour_workspace.h"
#include "trocar/host/printable.h"

namespace trocar::cli {
namespace {

struct GrowArguments {
  contours::WorkspaceOptions options;
  std::string organ, output;
  std::vector<double> at;  // column, row, slice number
};

base::Status Grow(const GrowArguments& arguments) {
  host::ProgressBar bar("opening", 1.0);
  auto workspace = contours::ContourWorkspace::Open(arguments.options, bar.Follow());
  if (!workspace) return workspace.error();
  auto& document = workspace->Document();
  const auto& structures = document.Points().structures;
  const auto organ = std::find_if(structures.begin(), structures.end(),
                                  [&](const contours::Structure& s) { return s.name == arguments.organ; });
  if (organ == structures.end()) {
    return base::Error{base::ErrorCode::kUsage, "the contours have no organ \"" +
                                                    host::Printable(arguments.organ) +
                                                    "\"; --organ liver or gallbladder"};
  }
  const auto request = workspace->MakeGrowthRequest(static_cast<int>(organ - structures.begin()),
                                                    static_cast<int>(std::lround(arguments.at[2])),
                                                    {arguments.at[0], arguments.at[1]});
  const auto grown = contours::GrowOrgan(request, {}, bar.Follow());
  bar.Finish();
  if (!grown) return grown.error();
  if (auto status = contours::ApplyGrowth(document, *grown); !status) return status;
  if (auto status = workspace->Save(arguments.output); !status) return status;
  host::Say("{1}: {2} mL, {3} points on {4} slices, {5} to {6}\nWrote {7}\n", host::Translate(grown->name),
            host::ShownFixed(grown->volume_ml, 0), grown->points, grown->slices.size(),
            grown->slices.front().slice, grown->slices.back().slice, arguments.output);
  return {};
}

}  // namespace

void AddAnatomyGrowCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command = anatomy.add_subcommand(
      "grow", "Draw contours of liver or gallbladder on CT or MR, from one place in it");
  auto arguments = std::make_shared<GrowArguments>();
  command
      ->add_option("images", arguments->options.images,
                   "DICOM series or volume, as trocar anatomy images reads")
      ->required()
      ->type_name("PATH");
  command
      ->add_option("--at", arguments->at,
                   "A place in the middle of the organ: column and row [pixels], slice number")
      ->required()
      ->expected(3)
      ->delimiter(',')
      ->type_name("X,Y,SLICE");
  command->add_option("--organ", arguments->organ, "liver or gallbladder")->required()->type_name("NAME");
  command->add_option("-o,--output", arguments->output, "File of contours to write")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--points", arguments->options.points, "Contours of other organs, which stay as they are")
      ->type_name("FILE");
  AddSeriesOption(*command, arguments->options.series.series);
  command->footer(
      "Correct what grew in the window: trocar anatomy contours. How it grows: docs/contours.md.\n"
      "Example: trocar anatomy phantom --ct portal --seed 1 -o out/ct\n"
      "         trocar anatomy grow out/ct/slices --organ liver --at 120,150,40 -o out/liver.json");
  command->callback([arguments, &outcome] { outcome.status = Grow(*arguments); });
}

}  // namespace trocar::cli
