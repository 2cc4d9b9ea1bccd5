// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>
#include <vector>

#include "anatomy_settings.h"
#include "command.h"
#include "console.h"
#include "trocar/anatomy/ct_phantom.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/anatomy/phantom.h"
#include "trocar/files/patient_file.h"
#include "trocar/patient/patient.h"

namespace trocar::cli {
namespace {

struct PhantomArguments {
  anatomy::PhantomOptions options;
  std::string output, patient, phase, labels;
  double noise_hu = 12.0;
  std::vector<std::string> settings;
};

base::Status MakeCt(const PhantomArguments& arguments, const base::Result<patient::Patient>& patient) {
  const auto phase = images::FindCtPhase(arguments.phase);
  if (!phase) return base::Error{base::ErrorCode::kUsage, "--ct none, arterial or portal"};
  host::ProgressBar bar("drawing", 1.0);
  const auto labels = arguments.labels.empty() ? anatomy::DrawLabels(*patient, bar.Follow())
                                               : images::ReadLabelVolume(arguments.labels);
  if (!labels) return labels.error();
  const anatomy::PhantomOptions& o = arguments.options;
  const auto phantom = anatomy::MakeCtPhantom(
      *labels, {*phase, o.pixel_mm, o.slice_mm, o.blur_px * o.pixel_mm, arguments.noise_hu, o.seed}, {},
      bar.Follow());
  if (!phantom) return phantom.error();
  if (auto status = anatomy::WriteCtPhantom(arguments.output, *phantom, bar.Follow()); !status) return status;
  bar.Finish();
  host::Say(
      "Wrote {1}: slices/ (a CT series), labels.nrrd (the truth)\nNext: trocar anatomy contours {1}/slices\n",
      arguments.output);
  return {};
}

base::Status MakePhantom(const PhantomArguments& arguments) {
  const auto settings = ParseSettings(arguments.settings);
  if (!settings) return settings.error();
  if (!arguments.patient.empty() && !settings->empty()) {
    return base::Error{base::ErrorCode::kUsage, "--set belongs to a generated patient; leave out --patient"};
  }
  const auto patient = arguments.patient.empty() ? anatomy::GeneratePatient(arguments.options.seed, *settings)
                                                 : files::ReadPatient(arguments.patient);
  if (!patient) return patient.error();
  if (!arguments.phase.empty()) return MakeCt(arguments, patient);
  if (!arguments.labels.empty()) return base::Error{base::ErrorCode::kUsage, "--labels belongs to --ct"};
  host::ProgressBar bar("drawing", 1.0);
  const auto status = anatomy::WritePhantom(arguments.output, *patient, arguments.options, bar.Follow());
  bar.Finish();
  if (!status) return status;
  const std::string& o = arguments.output;
  host::Say(
      "Wrote {1}: slices/ (the pictures), labels.nrrd (the truth), control_points.json, patient/ (the truth "
      "as "
      "meshes)\n"
      "Next: trocar anatomy build {1}/control_points.json --images {1}/slices --reference {1}/labels.nrrd -o "
      "{1}-built\n",
      o);
  return {};
}

}  // namespace

void AddAnatomyPhantomCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command = anatomy.add_subcommand(
      "phantom", "Draw cryosection pictures or a CT of a generated patient, with the truth");
  auto arguments = std::make_shared<PhantomArguments>();
  auto& options = arguments->options;
  command->add_option("--seed", options.seed, "Of the patient, the textures and the clicks")
      ->type_name("N")
      ->capture_default_str();
  command->add_option("-o,--output", arguments->output, "Folder to make; it must not exist, or be empty")
      ->required()
      ->type_name("DIR");
  command->add_option("--set", arguments->settings, "A parameter of the patient, as for generate: name=value")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command->add_option("--patient", arguments->patient, "Draw this patient instead of a generated one")
      ->type_name("PATIENT");
  command
      ->add_option("--ct", arguments->phase,
                   "Draw a CT: no contrast (none), arterial or portal venous (portal) phase")
      ->type_name("PHASE");
  command
      ->add_option("--labels", arguments->labels,
                   "With --ct: draw this label map's organs, not a generated patient's")
      ->type_name("FILE");
  command->add_option("--noise-hu", arguments->noise_hu, "Of a CT")->capture_default_str();
  command
      ->add_option("--noise", options.noise,
                   "Grain and uneven light: 0 none, 1 as a fair photograph, up to 5")
      ->capture_default_str();
  command->add_option("--blur", options.blur_px, "Of the lens [pixels]")->capture_default_str();
  command->add_option("--pixel-mm", options.pixel_mm, "Size of a pixel")->capture_default_str();
  const auto* slice =
      command->add_option("--slice-mm", options.slice_mm, "Distance of the slices; of a CT 3 by default")
          ->capture_default_str();
  command->add_option("--every", options.every, "Control points on every n-th slice")->capture_default_str();
  command->add_option("--points", options.points, "Control points on the largest contour of a slice")
      ->capture_default_str();
  command->add_option("--slip-mm", options.slip_mm, "How far each control point lies beside the true border")
      ->capture_default_str();
  command->footer(
      "The whole chain can be tried without any data. Axial slices, columns to the left, rows to posterior.\n"
      "Example: trocar anatomy phantom --seed 7 -o out/phantom\n"
      "         trocar anatomy build out/phantom/control_points.json --images out/phantom/slices \\\n"
      "           --reference out/phantom/labels.nrrd -o out/built\n"
      "         trocar anatomy phantom --ct portal --seed 1 -o out/ct");
  command->callback([arguments, slice, &outcome] {
    if (!arguments->phase.empty() && slice->count() == 0) arguments->options.slice_mm = 3.0;
    outcome.status = MakePhantom(*arguments);
  });
}

}  // namespace trocar::cli
