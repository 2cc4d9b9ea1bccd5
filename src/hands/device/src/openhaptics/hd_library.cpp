// SPDX-License-Identifier: Apache-2.0
#include "hd_library.h"

#include <dlfcn.h>

namespace trocar::device::hd {

Library::~Library() {
  if (file != nullptr) ::dlclose(file);
}

base::Result<std::unique_ptr<Library>> Library::Load(const std::string& name) {
  auto library = std::make_unique<Library>();
  library->file = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library->file == nullptr) {
    return base::Error{
        base::ErrorCode::kDeviceUnsupported,
        "OpenHaptics is not installed (" + name +
            " is not found): install it and the device's driver from its maker, and set the device up "
            "there"};
  }
  std::string missing;
  const auto find = [&](const char* function, auto& pointer) {
    void* const found = ::dlsym(library->file, function);
    if (found == nullptr && missing.empty()) missing = function;
    pointer = reinterpret_cast<std::remove_reference_t<decltype(pointer)>>(found);
  };
  find("hdInitDevice", library->init_device);
  find("hdDisableDevice", library->disable_device);
  find("hdMakeCurrentDevice", library->make_current);
  find("hdBeginFrame", library->begin_frame);
  find("hdEndFrame", library->end_frame);
  find("hdEnable", library->enable);
  find("hdGetDoublev", library->get_doubles);
  find("hdGetIntegerv", library->get_integers);
  find("hdSetDoublev", library->set_doubles);
  find("hdCheckCalibration", library->check_calibration);
  find("hdGetError", library->get_error);
  find("hdGetErrorString", library->get_error_string);
  find("hdScheduleAsynchronous", library->schedule);
  find("hdUnschedule", library->unschedule);
  find("hdStartScheduler", library->start_scheduler);
  find("hdStopScheduler", library->stop_scheduler);
  if (missing.empty()) return library;
  return base::Error{base::ErrorCode::kDeviceUnsupported,
                     name + " has no function " + missing + "; OpenHaptics 3 is needed"};
}

}  // namespace trocar::device::hd
