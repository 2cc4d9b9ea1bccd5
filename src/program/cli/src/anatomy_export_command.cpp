// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>

#include "command.h"
#include "console.h"
#include "trocar/anatomy/patient_export.h"
#include "trocar/files/patient_file.h"

namespace trocar::cli {
namespace {

struct ExportArguments {
  std::string patient, format, output;
  bool is_ascii = false;
};

base::Status Export(const ExportArguments& arguments) {
  const auto format = anatomy::FindMeshFormat(arguments.format);
  if (!format) return base::Error{base::ErrorCode::kUsage, format.error().message};
  if (arguments.is_ascii && *format != anatomy::MeshFormat::kVtk) {
    return base::Error{base::ErrorCode::kUsage,
                       "--ascii goes with --format vtk only; OBJ is always text, the others never"};
  }
  const auto patient = files::ReadPatient(arguments.patient);
  if (!patient) return patient.error();
  const auto paths = anatomy::ExportPatient(*patient, arguments.output, {*format, arguments.is_ascii});
  if (!paths) return paths.error();
  for (const auto& path : *paths) host::Say("Wrote {1}\n", path);
  return {};
}

}  // namespace

void AddAnatomyExportCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* command =
      anatomy.add_subcommand("export", "Write organs, ducts and vessels as meshes for other programs");
  auto arguments = std::make_shared<ExportArguments>();
  command->add_option("patient", arguments->patient, "Patient folder")->required()->type_name("PATIENT");
  command->add_option("--format", arguments->format, "obj, ply, stl, gltf or vtk")
      ->required()
      ->type_name("FORMAT");
  command->add_option("-o,--output", arguments->output, "Folder to make; it must not exist, or be empty")
      ->required()
      ->type_name("DIR");
  command->add_flag("--ascii", arguments->is_ascii, "VTK as text");
  command->footer(
      "LPS millimetres; glTF in metres with y up. OBJ and glTF are one file, the others one a mesh. Nothing "
      "is "
      "written when\n"
      "any step fails. docs/formats.md says more.\n"
      "Example: trocar anatomy export assets/patients/visible-human-male/patient --format gltf -o out/gltf");
  command->callback([arguments, &outcome] { outcome.status = Export(*arguments); });
}

}  // namespace trocar::cli
