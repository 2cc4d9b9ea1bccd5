// SPDX-License-Identifier: Apache-2.0
#include "scene_source.h"

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "forks.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/files/find_scene.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/task_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"

namespace trocar::python {
namespace {

namespace fs = std::filesystem;

base::Error Unusable(const std::string& what) {
  return base::Error{base::ErrorCode::kUsage, what};
}

/// A text or what os.fspath makes one of; nothing for anything else.
std::optional<std::string> FindPath(const py::object& given) {
  if (!py::isinstance<py::str>(given) && !py::hasattr(given, "__fspath__")) return std::nullopt;
  return py::str(py::module_::import("os").attr("fspath")(given));
}

/// As on a command line, where truth values are yes and no.
std::string FormatSetting(const std::string& where, const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "yes" : "no";
  if (!py::isinstance<py::str>(value) && !py::isinstance<py::int_>(value) &&
      !py::isinstance<py::float_>(value))
    throw Failure(Unusable(where + " is " + std::string(py::repr(value)) +
                           "; it is set to a number, a truth value or a text"));
  return py::str(value);
}

/// A new folder, which goes with its name.
std::shared_ptr<const fs::path> MakeFolder() {
  std::string name = (fs::temp_directory_path() / "trocar-patient-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    throw Failure({base::ErrorCode::kFileUnwritable, name + ": a folder for the patient cannot be made"});
  // not by children of fork: it is still the parent's
  return {new fs::path(name), [process = ::getpid()](const fs::path* folder) {
            std::error_code ignored;
            if (::getpid() == process) fs::remove_all(*folder, ignored);
            delete folder;
          }};
}

}  // namespace

py::dict ToPlain(const py::dict& given, const char* name) {
  return py::module_::import("trocar.plain").attr("plain")(given, name);
}

SceneSource ReadSceneSource(const py::object& scene, const std::filesystem::path& folder) {
  if (auto path = FindPath(scene)) return {std::move(*path), {}};
  if (!py::isinstance<py::dict>(scene))
    throw Failure(Unusable("a scene is a task's key, \"cholecystectomy\", a file, or a dictionary"));
  const py::object text =
      py::module_::import("json").attr("dumps")(ToPlain(scene, ""), py::arg("allow_nan") = false);
  return {(folder / "the dictionary").string(), py::str(text)};
}

base::Result<scene::Scene> FindScene(const SceneSource& source, const files::TaskChoice& choice) {
  if (!source.document.empty()) return files::ParseScene(source.document, source.name, choice);
  std::error_code ignored;
  if (!fs::is_regular_file(source.name, ignored)) return files::FindScene(source.name, choice);
  const auto text = host::ReadFile(source.name);
  return text.ok() ? files::ParseScene(*text, source.name, choice) : text.error();
}

PatientSource::PatientSource(const py::object& patient) {
  if (const auto path = FindPath(patient)) {
    folder_ = *path;
    return;
  }
  if (!py::isinstance<py::dict>(patient))
    throw Failure(Unusable("a patient is a folder, or a dictionary with seed and what to set"));
  std::uint64_t seed = 1;
  std::vector<anatomy::ParameterSetting> settings;
  for (const auto& [key, value] : ToPlain(patient, "patient")) {
    const std::string name = py::str(key);
    if (name == "seed" && py::isinstance<py::int_>(value) && !py::isinstance<py::bool_>(value)) {
      seed = PyLong_AsUnsignedLongLong(value.ptr());
      if (PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        throw Failure(Unusable("patient.seed is " + std::string(py::repr(value)) +
                               "; a seed is a whole number from 0 to 2^64 - 1"));
      }
    } else if (name == "set" && py::isinstance<py::dict>(value)) {
      for (const auto& [parameter, wanted] : py::cast<py::dict>(value)) {
        const std::string where = "patient.set." + std::string(py::str(parameter));
        settings.emplace_back(py::str(parameter), FormatSetting(where, wanted));
      }
    } else {
      throw Failure(
          Unusable("a patient's dictionary has a whole number \"seed\" and a dictionary \"set\"; \"" + name +
                   "\" is something else"));
    }
  }
  ExpectThreadsOfLibraries();
  made_ = MakeFolder();
  folder_ = *made_;
  const py::gil_scoped_release release;
  Check(files::WritePatient(folder_, Take(anatomy::GeneratePatient(seed, settings))));
}

}  // namespace trocar::python
