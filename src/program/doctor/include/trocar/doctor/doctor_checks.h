// SPDX-License-Identifier: Apache-2.0
/// \file doctor_checks.h  Checks of this computer: what it can do for Trocar, what that means, and how to mend it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace trocar::doctor {

enum class Health {
  kGood,
  kLimited,  ///< Trocar runs, and something about it is slower or absent
  kMissing   ///< a command does not work
};
/// "good", "limited", "missing"
std::string_view HealthName(Health health) noexcept;

/// One finding. `remedy` is empty where there is nothing to mend.
struct Finding {
  std::string name;  ///< "opengl"
  Health health = Health::kGood;
  std::string found, meaning, remedy;
};

/// Each check asks the system afresh; none changes anything that outlives it.
Finding CheckOpenGl();
Finding CheckVideoEncoder();
Finding CheckGpu();
Finding CheckDisplay();
Finding CheckWindow(const std::filesystem::path& program_folder);
Finding CheckImageReader(const std::filesystem::path& program_folder);
/// Can the process be started that takes the force away when the simulator dies?
Finding CheckSupervisor(const std::filesystem::path& program_folder);
/// Which vector instructions the inner loops use, and whether that was asked for.
Finding CheckProcessor();
Finding CheckRealTime();
/// \param root  "/", or a folder that stands for it in a test; reads dev/ and sys/class/ below it
Finding CheckInputDevices(const std::filesystem::path& root);
Finding CheckSerialDevices(const std::filesystem::path& root);
Finding CheckThreeDMouse(const std::filesystem::path& root);
/// \param root     of the file system, as sound::FindSoundOutput
/// \param speaker  program that speaks, or nothing
Finding CheckSound(const std::filesystem::path& root, const std::string& speaker);
Finding CheckDataFolder();

/// All of them, in the order in which a person reads them.
std::vector<Finding> CheckAll();

}  // namespace trocar::doctor
