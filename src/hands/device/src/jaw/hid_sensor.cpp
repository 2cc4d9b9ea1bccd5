// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cwchar>

#include "trocar/device/jaw_sensor.h"
#include "trocar/device/local_port.h"
#if TROCAR_HAS_HIDAPI
#include <hidapi.h>
#endif

namespace trocar::device {

#if TROCAR_HAS_HIDAPI
namespace {

/// Leonardo and Pro Micro boards with the firmware of docs/hardware/jaw-sensor.md.
constexpr unsigned short kVendor = 0x2341, kProduct = 0x8036;

/// Each Read() gives one report or nothing.
class HidTransport : public Transport {
 public:
  explicit HidTransport(hid_device* device) noexcept : device_(device) {}
  ~HidTransport() override { hid_close(device_); }
  HidTransport(const HidTransport&) = delete;
  HidTransport& operator=(const HidTransport&) = delete;

  IoResult Read(std::span<char> buffer) noexcept override {
    const int got = hid_read(device_, reinterpret_cast<unsigned char*>(buffer.data()), buffer.size());
    return {got > 0 ? static_cast<std::size_t>(got) : 0, got < 0};
  }
  IoResult Write(std::string_view) noexcept override { return {}; }

 private:
  hid_device* device_;
};

std::string Narrow(const wchar_t* text) {
  std::string narrow;
  for (; text != nullptr && *text != L'\0'; ++text)
    narrow += *text > 31 && *text < 127 ? static_cast<char>(*text) : '?';
  return narrow;
}

}  // namespace

std::vector<HidInfo> ListHidSensors() {
  std::vector<HidInfo> found;
  hid_device_info* devices = hid_enumerate(kVendor, kProduct);
  for (const hid_device_info* device = devices; device != nullptr; device = device->next) {
    found.push_back(
        {device->path, Narrow(device->manufacturer_string) + " " + Narrow(device->product_string)});
  }
  hid_free_enumeration(devices);
  return found;
}

base::Result<std::unique_ptr<Transport>> OpenHidSensor(const std::string& path) {
  if (IsLocalSocket(path)) return ConnectLocal(path, LocalLine::kPackets);
  hid_device* device = path.empty() ? hid_open(kVendor, kProduct, nullptr) : hid_open_path(path.c_str());
  if (device == nullptr) {
    return base::Error{
        base::ErrorCode::kDeviceLost,
        "no jaw sensor opens as HID device" + (path.empty() ? std::string() : " " + path) +
            "; is it plugged in, and may you read /dev/hidraw*? docs/devices.md has the udev rule"};
  }
  hid_set_nonblocking(device, 1);
  return std::unique_ptr<Transport>(std::make_unique<HidTransport>(device));
}
#else
std::vector<HidInfo> ListHidSensors() {
  return {};
}

base::Result<std::unique_ptr<Transport>> OpenHidSensor(const std::string& path) {
  if (IsLocalSocket(path)) return ConnectLocal(path, LocalLine::kPackets);
  return base::Error{
      base::ErrorCode::kDeviceUnsupported,
      "this build has no HID support: install libhidapi-dev and build again, or use the sensor's text lines"};
}
#endif

}  // namespace trocar::device
