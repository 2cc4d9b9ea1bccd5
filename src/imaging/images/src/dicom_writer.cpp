// SPDX-License-Identifier: Apache-2.0
// CT images as DICOM PS3.3, A.3 (CT Image IOD) and PS3.10 ask for: explicit values' kinds, little endian, uncompressed.
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <span>
#include <string>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/state_hash.h"
#include "trocar/host/safe_file.h"
#include "trocar/images/ct_render.h"

namespace trocar::images {
namespace {

constexpr const char* kCtImageStorage = "1.2.840.10008.5.1.4.1.1.2";
constexpr const char* kExplicitLittleEndian = "1.2.840.10008.1.2.1";

std::string Short(int number) {
  return {static_cast<char>(number & 0xFF), static_cast<char>(number >> 8 & 0xFF)};
}
std::string Long(std::size_t number) {
  return Short(static_cast<int>(number & 0xFFFF)) + Short(static_cast<int>(number >> 16 & 0xFFFF));
}

std::string Element(int group, int element, const char* kind, std::string value) {
  if (value.size() % 2 != 0) value += std::strcmp(kind, "UI") == 0 || kind[0] == 'O' ? '\0' : ' ';
  std::string bytes = Short(group) + Short(element) + kind;
  bytes += kind[0] == 'O' ? std::string(2, '\0') + Long(value.size()) : Short(static_cast<int>(value.size()));
  return bytes + value;
}
std::string Element(int group, int element, int number) {
  return Element(group, element, "US", Short(number));
}

/// A decimal string of at most 16 letters.
std::string Decimal(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", value);
  return text;
}

std::uint64_t Hash(const CtVolume& volume) {
  base::StateHash hash;
  for (const int side : volume.size) hash.Add(static_cast<std::uint64_t>(side));
  for (const double length : {volume.pixel_mm, volume.slice_mm}) hash.Add(length);
  hash.Add(std::span<const double>(volume.origin_mm));
  for (const std::int16_t value : volume.hounsfield)
    hash.Add(std::uint64_t{static_cast<std::uint16_t>(value)});
  return hash.Value();
}

/// A UID out of a UUID (PS3.5, B.2), made from what it names.
std::string MakeUid(std::uint64_t hash, std::uint64_t what) {
  std::uint64_t high = (hash ^ what * 0x9e3779b97f4a7c15ULL) * 0xbf58476d1ce4e5b9ULL;
  std::uint64_t low = (high ^ (high >> 31)) * 0x94d049bb133111ebULL + what;
  // RFC 9562: version 8, a maker's own
  high = (high & ~0xF000ULL) | 0x8000ULL;
  low = (low & ~(3ULL << 62)) | 2ULL << 62;
  // 128 bits as decimal digits, by long division of 32 bits at a time
  std::uint64_t words[4] = {high >> 32, high & 0xFFFFFFFF, low >> 32, low & 0xFFFFFFFF};
  std::string digits;
  while ((words[0] | words[1] | words[2] | words[3]) != 0) {
    std::uint64_t rest = 0;
    for (std::uint64_t& word : words) {
      const std::uint64_t value = rest << 32 | word;
      word = value / 10, rest = value % 10;
    }
    digits.insert(digits.begin(), static_cast<char>('0' + rest));
  }
  return "2.25." + digits;
}

std::string MakeFile(const CtVolume& volume, int slice, std::uint64_t hash) {
  const std::string instance = MakeUid(hash, 1000 + static_cast<std::uint64_t>(slice));
  const std::string meta = Element(2, 1, "OB", std::string("\0\1", 2)) +
                           Element(2, 2, "UI", kCtImageStorage) + Element(2, 3, "UI", instance) +
                           Element(2, 0x10, "UI", kExplicitLittleEndian) +
                           Element(2, 0x12, "UI", MakeUid(0, 1));
  std::string file = std::string(128, '\0') + "DICM" + Element(2, 0, "UL", Long(meta.size())) + meta;
  const std::string phase = volume.phase == CtPhase::kNone       ? "no contrast"
                            : volume.phase == CtPhase::kArterial ? "arterial phase"
                                                                 : "portal venous phase";
  file += Element(8, 5, "CS", "ISO_IR 192") + Element(8, 8, "CS", "DERIVED\\SECONDARY\\AXIAL") +
          Element(8, 0x16, "UI", kCtImageStorage) + Element(8, 0x18, "UI", instance) +
          Element(8, 0x20, "DA", "") + Element(8, 0x30, "TM", "") + Element(8, 0x50, "SH", "") +
          Element(8, 0x60, "CS", "CT") + Element(8, 0x70, "LO", "Trocar") + Element(8, 0x90, "PN", "") +
          Element(8, 0x103E, "LO", "Phantom, " + phase);
  // a phantom has no name, number, birthday or sex
  file += Element(0x10, 0x10, "PN", "") + Element(0x10, 0x20, "LO", "") + Element(0x10, 0x30, "DA", "") +
          Element(0x10, 0x40, "CS", "") + Element(0x12, 0x62, "CS", "YES") +
          Element(0x12, 0x63, "LO", "Drawn by a program");
  file += Element(0x18, 0x50, "DS", Decimal(volume.slice_mm)) + Element(0x18, 0x60, "DS", "");
  const double z = volume.origin_mm[2] + slice * volume.slice_mm;
  file += Element(0x20, 0xD, "UI", MakeUid(hash, 1)) + Element(0x20, 0xE, "UI", MakeUid(hash, 2)) +
          Element(0x20, 0x10, "SH", "") + Element(0x20, 0x11, "IS", "1") + Element(0x20, 0x12, "IS", "1") +
          Element(0x20, 0x13, "IS", std::to_string(slice + 1)) +
          Element(0x20, 0x32, "DS",
                  Decimal(volume.origin_mm[0]) + "\\" + Decimal(volume.origin_mm[1]) + "\\" + Decimal(z)) +
          Element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0") + Element(0x20, 0x52, "UI", MakeUid(hash, 3)) +
          Element(0x20, 0x1040, "LO", "");
  file += Element(0x28, 2, 1) + Element(0x28, 4, "CS", "MONOCHROME2") + Element(0x28, 0x10, volume.size[1]) +
          Element(0x28, 0x11, volume.size[0]) +
          Element(0x28, 0x30, "DS", Decimal(volume.pixel_mm) + "\\" + Decimal(volume.pixel_mm)) +
          Element(0x28, 0x100, 16) + Element(0x28, 0x101, 16) + Element(0x28, 0x102, 15) +
          Element(0x28, 0x103, 1) + Element(0x28, 0x1050, "DS", "60") + Element(0x28, 0x1051, "DS", "400") +
          Element(0x28, 0x1052, "DS", "0") + Element(0x28, 0x1053, "DS", "1") +
          Element(0x28, 0x1054, "LO", "HU");
  const std::size_t plane = static_cast<std::size_t>(volume.size[0]) * volume.size[1];
  std::string pixels;
  pixels.reserve(2 * plane);
  for (std::size_t i = 0; i < plane; ++i) pixels += Short(volume.hounsfield[slice * plane + i]);
  return file + Element(0x7FE0, 0x10, "OW", std::move(pixels));
}

}  // namespace

base::Status WriteDicom(const std::filesystem::path& folder, const CtVolume& volume,
                        const Progress& progress) {
  TROCAR_ASSERT(volume.size[0] <= 65535 && volume.size[1] <= 65535);
  const std::uint64_t hash = Hash(volume);
  for (int slice = 0; slice < volume.size[2]; ++slice) {
    char name[32];
    std::snprintf(name, sizeof(name), "slice-%04d.dcm", slice + 1);
    if (auto status = host::WriteFile(folder / name, MakeFile(volume, slice, hash)); !status) return status;
    if (progress) progress("writing slices", static_cast<double>(slice + 1) / volume.size[2]);
  }
  return {};
}

}  // namespace trocar::images
