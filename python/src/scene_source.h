// SPDX-License-Identifier: Apache-2.0
/// \file scene_source.h  Scene or patient as Python gives it: a name, a path, or a dictionary.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "binding.h"
#include "trocar/files/find_scene.h"
#include "trocar/files/task_file.h"

namespace trocar::python {

/// A copy of plain Python values, as files hold them: numpy's numbers, truth values and arrays become Python's.
/// \param name  of the whole, in messages
/// \throw trocar.Error that names the field, where something else is in it
py::dict ToPlain(const py::dict& given, const char* name);

/// A scene's text, or where it stands.
struct SceneSource {
  std::string
      name;  ///< of a task or an operation, or a file; of a dictionary what messages call it, in its folder
  std::string document;  ///< JSON of a dictionary, else empty
};
/// \param folder  that relative paths of a dictionary start from; the working folder where it is empty
/// \throw Failure kUsage for something else, and for a dictionary that is no JSON
SceneSource ReadSceneSource(const py::object& scene, const std::filesystem::path& folder);

/// An operation, a task, or a scene to look at.
base::Result<scene::Scene> FindScene(const SceneSource& source, const files::TaskChoice& choice);

/// A folder with a patient. One that was made of a dictionary is removed with the last copy of this.
class PatientSource {
 public:
  /// \param patient  a folder, "" for the scene's own, or a dictionary: "seed" and what to "set" (`trocar anatomy generate`)
  /// \throw Failure kUsage for something else; the generator's or the file's error
  explicit PatientSource(const py::object& patient);

  const std::filesystem::path& Folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::shared_ptr<const std::filesystem::path> made_;  // removed with its last owner
};

}  // namespace trocar::python
