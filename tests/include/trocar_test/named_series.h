// SPDX-License-Identifier: Apache-2.0
/// \file named_series.h  A person's data in DICOM files, and a search for it in the bytes and names of files. The attributes are
/// those of DICOM PS3.15, table E.1-1, basic profile, that a CT series carries in its main data set.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "trocar_test/made_images.h"

namespace trocar::test {

struct NamedAttribute {
  std::uint16_t group, element;
  const char *vr, *value;
};
// ascending, as a data set is
inline constexpr NamedAttribute kNamedAttributes[] = {
    {0x0008, 0x0020, "DA", "19710203"},
    {0x0008, 0x0030, "TM", "123456.654321"},
    {0x0008, 0x0050, "SH", "ACCESSION77413"},
    {0x0008, 0x0080, "LO", "Zephyr Institution"},
    {0x0008, 0x0081, "ST", "Zephyr Lane 9"},
    {0x0008, 0x0090, "PN", "Referrer^Quentin"},
    {0x0008, 0x0092, "ST", "Referrer Address"},
    {0x0008, 0x0094, "SH", "0049-555-7741"},
    {0x0008, 0x1010, "SH", "STATION7741"},
    {0x0008, 0x1030, "LO", "Study of Zephyrine"},
    {0x0008, 0x103E, "LO", "Series of Zephyrine"},
    {0x0008, 0x1040, "LO", "Department Zephyr"},
    {0x0008, 0x1048, "PN", "Recorder^Rufus"},
    {0x0008, 0x1050, "PN", "Performer^Petra"},
    {0x0008, 0x1060, "PN", "Reader^Rosalind"},
    {0x0008, 0x1070, "PN", "Operator^Oswald"},
    {0x0008, 0x1080, "LO", "Diagnosis Zebra"},
    {0x0008, 0x2111, "ST", "Derived from Zephyrine"},
    {0x0009, 0x0010, "LO", "PRIVATECREATOR"},
    {0x0009, 0x1001, "LO", "PrivateZephyrine"},
    {0x0010, 0x0010, "PN", "Gruenwald^Zephyrine"},
    {0x0010, 0x0020, "LO", "PATIENTID774133"},
    {0x0010, 0x0030, "DA", "19480917"},
    {0x0010, 0x0032, "TM", "031415.926535"},
    {0x0010, 0x1000, "LO", "OTHERID774134"},
    {0x0010, 0x1001, "PN", "Othername^Zephyrine"},
    {0x0010, 0x1005, "PN", "Birthname^Zephyrine"},
    {0x0010, 0x1010, "AS", "078Y"},
    {0x0010, 0x1040, "LO", "Home Street 123"},
    {0x0010, 0x1060, "PN", "Mothername^Zenobia"},
    {0x0010, 0x2000, "LO", "Alert of Zephyrine"},
    {0x0010, 0x2154, "SH", "0049-555-8852"},
    {0x0010, 0x2180, "SH", "Lighthousekeeper"},
    {0x0010, 0x21B0, "LT", "History of Zephyrine"},
    {0x0010, 0x4000, "LT", "Comments on Zephyrine"},
    {0x0018, 0x1000, "LO", "SERIAL774135"},
    {0x0018, 0x1030, "LO", "Protocol Zephyrine"},
    {0x0020, 0x000D, "UI", "1.2.826.0.1.77413.1"},
    {0x0020, 0x000E, "UI", "1.2.826.0.1.77413.2"},
    {0x0020, 0x0010, "SH", "STUDYID774136"},
    {0x0020, 0x0052, "UI", "1.2.826.0.1.77413.3"},
    {0x0020, 0x4000, "LT", "Image of Zephyrine"},
    {0x0032, 0x1032, "PN", "Requester^Roland"},
    {0x0032, 0x1060, "LO", "Procedure Zephyrine"},
    {0x0032, 0x4000, "LT", "Studycomment Zephyr"},
    {0x0038, 0x0010, "LO", "ADMISSION774137"},
    {0x0038, 0x0300, "LO", "Ward Zephyr"},
    {0x0038, 0x0500, "LO", "State of Zephyrine"},
    {0x0040, 0x0253, "SH", "STEP774138"},
    {0x0040, 0x0254, "LO", "Step of Zephyrine"},
    {0x0040, 0x2016, "LO", "PLACER774139"},
    {0x4008, 0x0300, "ST", "Impression Zephyrine"},
};
// the folders that series come in are often called after the person
inline constexpr const char* kNamedFolder = "Foldername_Zephyrine";

/// The DICOM file (explicit VR, little endian) with the person's data in it.
/// \param slice  makes the instance's UID
inline std::string WithPerson(const std::string& file, int slice) {
  const auto number = [&](std::size_t at, int bytes) {
    std::uint32_t sum = 0;
    for (int i = 0; i < bytes; ++i)
      sum |= static_cast<std::uint32_t>(static_cast<unsigned char>(file[at + static_cast<std::size_t>(i)]))
             << 8 * i;
    return sum;
  };
  std::map<std::uint32_t, std::string> elements;
  std::size_t begin = 0;
  for (std::size_t at = 132; at < file.size();) {
    const std::uint32_t tag = number(at, 2) << 16 | number(at + 2, 2);
    const std::string vr = file.substr(at + 4, 2);
    const bool is_long = vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UN" || vr == "UT";
    const std::size_t size = is_long ? 12 + number(at + 8, 4) : 8 + number(at + 6, 2);
    if (tag >> 16 > 2) elements[tag] = file.substr(at, size);
    at += size;
    if (tag >> 16 == 2) begin = at;
  }
  const auto put = [&](std::uint16_t group, std::uint16_t element, const char* vr, const std::string& value) {
    elements[std::uint32_t{group} << 16 | element] = Element(group, element, vr, value);
  };
  for (const NamedAttribute& a : kNamedAttributes) put(a.group, a.element, a.vr, a.value);
  put(8, 0x18, "UI", "1.2.826.0.1.77413.4." + std::to_string(slice));
  std::string named = file.substr(0, begin);
  for (const auto& [tag, bytes] : elements) named += bytes;
  return named;
}

inline std::string Lower(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

/// The value as bytes of UTF-8 and of UTF-16 of both orders.
inline std::vector<std::string> Forms(const std::string& value) {
  std::string little, big;
  for (const char c : Lower(value)) little += c, little += '\0', big += '\0', big += c;
  return {Lower(value), little, big};
}

/// What of the person stands in the files of a folder, in their bytes or names.
inline std::vector<std::string> FindLeaks(const std::filesystem::path& folder) {
  std::vector<std::string> values = {"Zephyrine", "Gruenwald", kNamedFolder, "1.2.826.0.1.77413"};
  for (const NamedAttribute& a : kNamedAttributes) {
    const std::string value = a.value;
    // an age is too short to be told from a number
    if (value.size() < 6) continue;
    values.push_back(value);
    // a name's parts, and as it is spoken
    if (const auto cut = value.find('^'); cut != std::string::npos) {
      values.push_back(value.substr(0, cut));
      values.push_back(value.substr(cut + 1) + " " + value.substr(0, cut));
    }
  }
  std::vector<std::string> leaks;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    std::string bytes = std::filesystem::relative(entry.path(), folder).string() + "\n";
    if (entry.is_regular_file()) {
      std::ifstream file(entry.path(), std::ios::binary);
      bytes.append(std::istreambuf_iterator<char>(file), {});
    }
    bytes = Lower(std::move(bytes));
    for (const std::string& value : values) {
      for (const std::string& form : Forms(value)) {
        if (bytes.find(form) != std::string::npos)
          leaks.push_back(entry.path().filename().string() + ": " + value);
      }
    }
  }
  return leaks;
}

}  // namespace trocar::test
