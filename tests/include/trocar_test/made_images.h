// SPDX-License-Identifier: Apache-2.0
/// \file made_images.h  Image files made byte by byte, sound ones and, by changing a field, damaged ones.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace trocar::test {

template <typename Number>
std::string Bytes(Number number) {
  std::string bytes(sizeof(number), '\0');
  std::memcpy(bytes.data(), &number, sizeof(number));
  return bytes;
}

template <typename Number>
void Put(std::string& bytes, std::size_t at, Number number) {
  std::memcpy(bytes.data() + at, &number, sizeof(number));
}

inline std::string Gzip(std::string_view plain) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, plain.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
  stream.avail_in = static_cast<uInt>(plain.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

/// The sample that every made volume holds at (x, y, z).
inline std::int16_t Sample(int x, int y, int z) {
  return static_cast<std::int16_t>(100 * z + 10 * y + x - 50);
}

inline std::string Samples(int width, int height, int depth) {
  std::string bytes;
  for (int z = 0; z < depth; ++z) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) bytes += Bytes(Sample(x, y, z));
    }
  }
  return bytes;
}

/// 8 x 6 x 4 voxels of 0.5 x 0.5 x 2 mm, short, RAS with an sform whose columns run to the left.
inline std::string MakeNifti() {
  std::string file(352, '\0');
  Put<std::int32_t>(file, 0, 348);
  const std::int16_t sides[] = {3, 8, 6, 4, 1, 1, 1, 1};
  for (int i = 0; i < 8; ++i) Put(file, 40 + 2 * static_cast<std::size_t>(i), sides[i]);
  Put<std::int16_t>(file, 70, 4);
  Put<std::int16_t>(file, 72, 16);
  const float spacing[] = {1, 0.5f, 0.5f, 2, 1, 1, 1, 1};
  for (int i = 0; i < 8; ++i) Put(file, 76 + 4 * static_cast<std::size_t>(i), spacing[i]);
  Put<float>(file, 108, 352);
  file[123] = 2;  // millimetres
  Put<std::int16_t>(file, 254, 1);
  const float rows[3][4] = {{-0.5f, 0, 0, 10}, {0, 0.5f, 0, -20}, {0, 0, 2, 30}};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 4; ++c) Put(file, 280 + 16 * r + 4 * c, rows[r][c]);
  }
  file.replace(344, 4, std::string("n+1\0", 4));
  return file + Samples(8, 6, 4);
}

/// The same in NRRD's words; `extra` lines replace fields of the same name.
inline std::string MakeNrrd(const std::vector<std::string>& extra = {}, bool with_data = true) {
  std::vector<std::string> lines = {"type: short",
                                    "dimension: 3",
                                    "sizes: 8 6 4",
                                    "encoding: raw",
                                    "endian: little",
                                    "space: left-posterior-superior",
                                    "space directions: (0.5,0,0) (0,0.5,0) (0,0,2)",
                                    "space origin: (1,2,3)"};
  for (const std::string& line : extra) {
    const std::string name = line.substr(0, line.find(':'));
    const auto same = std::find_if(lines.begin(), lines.end(),
                                   [&](const std::string& other) { return other.starts_with(name + ":"); });
    if (same != lines.end())
      *same = line;
    else
      lines.push_back(line);
  }
  std::string file = "NRRD0004\n";
  for (const std::string& line : lines) file += line + "\n";
  return with_data ? file + "\n" + Samples(8, 6, 4) : file;
}

inline std::string MakeMetaImage(const std::vector<std::string>& extra = {},
                                 std::string_view data = "LOCAL") {
  std::vector<std::string> lines = {"ObjectType = Image",     "NDims = 3",
                                    "BinaryData = True",      "BinaryDataByteOrderMSB = False",
                                    "CompressedData = False", "TransformMatrix = 1 0 0 0 1 0 0 0 1",
                                    "Offset = 1 2 3",         "ElementSpacing = 0.5 0.5 2",
                                    "DimSize = 8 6 4",        "ElementType = MET_SHORT"};
  for (const std::string& line : extra) {
    const std::string name = line.substr(0, line.find(" ="));
    const auto same = std::find_if(lines.begin(), lines.end(),
                                   [&](const std::string& other) { return other.starts_with(name + " ="); });
    if (same != lines.end())
      *same = line;
    else
      lines.push_back(line);
  }
  std::string file;
  for (const std::string& line : lines) file += line + "\n";
  file += "ElementDataFile = " + std::string(data) + "\n";
  return data == "LOCAL" ? file + Samples(8, 6, 4) : file;
}

inline std::string BigEndian(std::uint32_t number) {
  std::string bytes = Bytes(number);
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

inline std::string PngChunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto sum = static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size())));
  return BigEndian(static_cast<std::uint32_t>(data.size())) + body + BigEndian(sum);
}

inline std::string Zlib(std::string_view plain) {
  uLongf size = compressBound(plain.size());
  std::string packed(size, '\0');
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(plain.data()),
            plain.size(), 9);
  packed.resize(size);
  return packed;
}

/// Grey picture; `rows` lines of pixels are there, whatever the height says.
inline std::string MakePng(std::uint32_t width, std::uint32_t height, std::uint32_t rows, int bits = 8,
                           const std::function<int(int x, int y)>& grey = {}) {
  std::string plain;
  for (std::uint32_t y = 0; y < rows; ++y) {
    plain += '\0';
    for (std::uint32_t x = 0; x < width; ++x) {
      const int value =
          grey ? grey(static_cast<int>(x), static_cast<int>(y)) : static_cast<int>(7 * x + 3 * y) % 256;
      if (bits == 16) plain += static_cast<char>(value >> 8);
      plain += static_cast<char>(value);
    }
  }
  return "\x89PNG\r\n\x1a\n" +
         PngChunk("IHDR",
                  BigEndian(width) + BigEndian(height) + static_cast<char>(bits) + std::string(4, '\0')) +
         PngChunk("IDAT", Zlib(plain)) + PngChunk("IEND", "");
}

/// TIFF of grey pages, 8 bits, uncompressed.
inline std::string MakeTiff(std::uint32_t width, std::uint32_t height, int pages,
                            std::uint32_t strip_offset = 0) {
  std::string file("II*\0", 4);
  file += Bytes<std::uint32_t>(8);
  for (int page = 0; page < pages; ++page) {
    const auto begin = static_cast<std::uint32_t>(file.size());
    constexpr std::uint16_t kEntries = 9;
    const std::uint32_t pixels = begin + 2 + 12 * kEntries + 4;
    const auto entry = [&](std::uint16_t tag, std::uint16_t type, std::uint32_t value) {
      file += Bytes(tag) + Bytes(type) + Bytes<std::uint32_t>(1) + Bytes(value);
    };
    file += Bytes(kEntries);
    entry(256, 4, width), entry(257, 4, height), entry(258, 3, 8), entry(259, 3, 1), entry(262, 3, 1);
    entry(273, 4, strip_offset != 0 ? strip_offset : pixels), entry(277, 3, 1), entry(278, 4, height);
    entry(279, 4, width * height);
    const bool is_last = page + 1 == pages;
    const std::uint32_t stored = strip_offset != 0 ? 16 : width * height;
    file += Bytes<std::uint32_t>(is_last ? 0 : pixels + stored);
    for (std::uint32_t i = 0; i < stored; ++i) file += static_cast<char>(10 * page + static_cast<int>(i));
  }
  return file;
}

/// One element, explicit VR, little endian.
inline std::string Element(std::uint16_t group, std::uint16_t element, const std::string& vr,
                           std::string value) {
  if (value.size() % 2 != 0) value += vr == "UI" || vr == "OB" ? '\0' : ' ';
  const bool is_long = vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UN" || vr == "UT";
  const auto size = static_cast<std::uint32_t>(value.size());
  return Bytes(group) + Bytes(element) + vr +
         (is_long ? std::string(2, '\0') + Bytes(size) : Bytes(static_cast<std::uint16_t>(size))) + value;
}

/// What stands in a made DICOM file.
struct DicomFields {
  std::string transfer_syntax = "1.2.840.10008.1.2.1";                   // explicit VR, little endian
  std::string sop_class = "1.2.840.10008.5.1.4.1.1.2", modality = "CT";  // CT Image Storage
  std::string preamble = std::string(128, '\0');
  std::string patient = "Doe^Jane", series = "1.2.3.4", frame = "1.2.3.5";
  std::string instance_uid;  ///< in place of one made of the instance number
  int instance = 1, rows = 6, columns = 8;
  std::string position = "-10\\-20\\30", orientation = "1\\0\\0\\0\\1\\0", spacing = "0.5\\0.5";
  std::string shown = "MONOCHROME2", slope = "1", intercept = "-1024", window;
  std::uint16_t allocated = 16, stored = 16, high = 15, is_signed = 1;
  std::string image_type, acquisition;  ///< image type; acquisition number
  std::string times;          ///< elements of group 8 between the instance and the modality, as bytes
  std::string scanning;       ///< elements of group 18, as bytes
  std::string more;           ///< elements after group 20, as bytes
  std::string padding;        ///< elements behind Pixel Representation, as bytes
  std::string palette;        ///< elements before the pixels, as bytes
  std::string dimensions;     ///< in place of Rows and Columns
  std::string pixels;         ///< in place of Samples(columns, rows, 1)
  std::string pixel_element;  ///< in place of the whole last element
};

inline std::string MakeDicom(const DicomFields& f) {
  const auto number = [](std::uint16_t group, std::uint16_t element, std::uint16_t value) {
    return Element(group, element, "US", Bytes(value));
  };
  const std::string meta = Element(2, 1, "OB", std::string("\0\1", 2)) + Element(2, 2, "UI", f.sop_class) +
                           Element(2, 3, "UI", "1.2.3.4.5") + Element(2, 0x10, "UI", f.transfer_syntax) +
                           Element(2, 0x12, "UI", "1.2.3.4.6");
  std::string file =
      f.preamble + "DICM" + Element(2, 0, "UL", Bytes(static_cast<std::uint32_t>(meta.size()))) + meta;
  if (!f.image_type.empty()) file += Element(8, 8, "CS", f.image_type);
  const std::string instance =
      f.instance_uid.empty() ? "1.2.3.4.5." + std::to_string(f.instance) : f.instance_uid;
  file += Element(8, 0x16, "UI", f.sop_class) + Element(8, 0x18, "UI", instance) + f.times +
          Element(8, 0x60, "CS", f.modality);
  file += Element(0x10, 0x10, "PN", f.patient) + Element(0x10, 0x20, "LO", "ID of " + f.patient) + f.scanning;
  file += Element(0x20, 0xD, "UI", "1.2.3.3") + Element(0x20, 0xE, "UI", f.series);
  if (!f.acquisition.empty()) file += Element(0x20, 0x12, "IS", f.acquisition);
  file += Element(0x20, 0x13, "IS", std::to_string(f.instance));
  if (!f.position.empty()) file += Element(0x20, 0x32, "DS", f.position);
  if (!f.orientation.empty()) file += Element(0x20, 0x37, "DS", f.orientation);
  file += Element(0x20, 0x52, "UI", f.frame) + f.more;
  const bool has_three = f.shown == "RGB" || f.shown.starts_with("YBR");
  file += number(0x28, 2, has_three ? 3 : 1) + Element(0x28, 4, "CS", f.shown);
  if (has_three) file += number(0x28, 6, 0);
  file += f.dimensions.empty() ? number(0x28, 0x10, static_cast<std::uint16_t>(f.rows)) +
                                     number(0x28, 0x11, static_cast<std::uint16_t>(f.columns))
                               : f.dimensions;
  if (!f.spacing.empty()) file += Element(0x28, 0x30, "DS", f.spacing);
  file += number(0x28, 0x100, f.allocated) + number(0x28, 0x101, f.stored) + number(0x28, 0x102, f.high) +
          number(0x28, 0x103, f.is_signed) + f.padding;
  if (!f.window.empty()) {
    const auto comma = f.window.find(',');
    file += Element(0x28, 0x1050, "DS", f.window.substr(0, comma)) +
            Element(0x28, 0x1051, "DS", f.window.substr(comma + 1));
  }
  if (!f.intercept.empty()) file += Element(0x28, 0x1052, "DS", f.intercept);
  if (!f.slope.empty()) file += Element(0x28, 0x1053, "DS", f.slope);
  file += f.palette;
  if (!f.pixel_element.empty()) return file + f.pixel_element;
  return file + Element(0x7FE0, 0x10, "OW", f.pixels.empty() ? Samples(f.columns, f.rows, 1) : f.pixels);
}

/// A sequence of items of known length; each item's elements as bytes.
inline std::string Sequence(std::uint16_t group, std::uint16_t element,
                            const std::vector<std::string>& items) {
  std::string inside;
  for (const std::string& item : items) {
    inside += Bytes<std::uint16_t>(0xFFFE) + Bytes<std::uint16_t>(0xE000) +
              Bytes(static_cast<std::uint32_t>(item.size())) + item;
  }
  return Element(group, element, "SQ", inside);
}

/// Pixel data in fragments, as compressed files have them; the offset table is empty.
inline std::string Fragments(const std::vector<std::string>& fragments, bool is_closed = true) {
  const auto item = [](std::uint16_t element, const std::string& data) {
    return Bytes<std::uint16_t>(0xFFFE) + Bytes(element) + Bytes(static_cast<std::uint32_t>(data.size())) +
           data;
  };
  std::string bytes = Bytes<std::uint16_t>(0x7FE0) + Bytes<std::uint16_t>(0x10) + "OB" +
                      std::string(2, '\0') + Bytes<std::uint32_t>(0xFFFFFFFF) + item(0xE000, "");
  for (const std::string& fragment : fragments) bytes += item(0xE000, fragment);
  return is_closed ? bytes + item(0xE0DD, "") : bytes;
}

}  // namespace trocar::test
