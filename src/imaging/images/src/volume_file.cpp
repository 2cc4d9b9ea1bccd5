// SPDX-License-Identifier: Apache-2.0
#include "volume_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/host/printable.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;

template <typename Sample>
double Load(const std::byte* samples, std::size_t i) {
  Sample value;
  std::memcpy(&value, samples + i * sizeof(Sample), sizeof(Sample));
  return static_cast<double>(value);
}

/// Calls `use` with a function that reads sample i, chosen once for all samples.
template <typename Use>
auto WithReader(const ImageHeader& header, const std::byte* samples, const Use& use) {
  switch (header.samples) {
    case SampleKind::kUint8:
      return use([samples](std::size_t i) { return Load<std::uint8_t>(samples, i); });
    case SampleKind::kInt16:
      return use([samples](std::size_t i) { return Load<std::int16_t>(samples, i); });
    case SampleKind::kUint16:
      return use([samples](std::size_t i) { return Load<std::uint16_t>(samples, i); });
    case SampleKind::kInt32:
      return use([samples](std::size_t i) { return Load<std::int32_t>(samples, i); });
    case SampleKind::kUint32:
      return use([samples](std::size_t i) { return Load<std::uint32_t>(samples, i); });
    case SampleKind::kFloat32:
      break;
  }
  return use([samples](std::size_t i) { return Load<float>(samples, i); });
}

constexpr double kLargestFloatLabel = 16777216.0;  // 2^24

std::string FormatValue(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.10g", value);
  return text.data();
}

std::uint8_t Shade(double value, const DisplayWindow& window, bool is_inverted) {
  // no number is shown black
  const double share =
      std::isfinite(value) ? (value - (window.centre - 0.5 * window.width)) / window.width : 0.0;
  const double clamped = std::clamp(share, 0.0, 1.0);
  return base::RoundTo<std::uint8_t>(255.0 * (is_inverted ? 1.0 - clamped : clamped));
}

/// Where picture index `at` of `made` lies among `stored` samples.
struct Between {
  std::size_t low, high;
  double part;  // of high
};
std::vector<Between> MakeSteps(std::uint32_t stored, int made) {
  std::vector<Between> steps;
  const double ratio = made > 1 ? static_cast<double>(stored - 1) / (made - 1) : 0.0;
  for (int at = 0; at < made; ++at) {
    const double place = at * ratio;
    const auto low = std::min(base::TruncateTo<std::size_t>(place), static_cast<std::size_t>(stored - 1));
    const std::size_t high = std::min(low + 1, static_cast<std::size_t>(stored - 1));
    steps.push_back({low, high, place - static_cast<double>(low)});
  }
  return steps;
}

/// The path without `ending`, in small letters or capitals, and what the ending was; none where it has another one.
std::optional<std::pair<std::string, std::string>> SplitEnding(const fs::path& path,
                                                               std::string_view ending) {
  const std::string whole = path.string();
  if (whole.size() < ending.size()) return std::nullopt;
  const std::size_t at = whole.size() - ending.size();
  const bool is_same =
      std::equal(ending.begin(), ending.end(), whole.begin() + static_cast<std::ptrdiff_t>(at),
                 [](char small, char c) { return small == c || std::toupper(small) == c; });
  if (!is_same) return std::nullopt;
  return std::pair{whole.substr(0, at), whole.substr(at)};
}

/// Where one of a pair of files lies, by the name of the other: a.hdr and a.img, either of them perhaps packed.
/// \return empty where there is none
fs::path FindOther(const fs::path& path, const std::string& mine, const std::string& other) {
  for (const char* packed : {"", ".gz"}) {
    const auto split = SplitEnding(path, mine + packed);
    if (!split) continue;
    const bool is_capital = split->second[1] < 'a';
    for (const char* wanted : {packed, "", ".gz"}) {
      std::string ending = other + wanted;
      if (is_capital) std::transform(ending.begin(), ending.end(), ending.begin(), ::toupper);
      std::error_code ignored;
      const fs::path found = split->first + ending;
      if (fs::symlink_status(found, ignored).type() != fs::file_type::not_found) return found;
    }
  }
  return {};
}

/// The samples that belong to the header of a pair.
base::Result<ImportFile> OpenBeside(const fs::path& header) {
  const fs::path samples = FindOther(header, ".hdr", ".img");
  if (samples.empty()) {
    return base::Error{base::ErrorCode::kFileMissing,
                       host::Printable(header.string()) +
                           ": its samples belong into a file of the same name that ends in .img (its own in "
                           ".hdr), which is not there; put both into one folder"};
  }
  return ImportFile::Open(samples, Links::kRefuse);
}

}  // namespace

fs::path FindHeader(const fs::path& path) {
  fs::path header = FindOther(path, ".img", ".hdr");
  return header.empty() ? path : header;
}

base::Result<DecodedFile> DecodeFile(const std::filesystem::path& typed, Links links, ImportPool& pool) {
  const fs::path path = FindHeader(typed);
  const auto file = ImportFile::Open(path, links);
  if (!file) return file.error();
  auto reply = pool.Probe(*file);
  if (!reply) return reply.error();
  std::optional<ImportFile> data_file;
  if (reply->header.data_file[0] != '\0' || reply->header.is_data_beside != 0) {
    auto opened = reply->header.is_data_beside != 0
                      ? OpenBeside(path)
                      : ImportFile::OpenBelow(path.parent_path(), reply->header.data_file);
    if (!opened) return opened.error();
    data_file = std::move(*opened);
    reply = pool.Probe(*file, &*data_file);
    if (!reply) return reply.error();
  }
  DecodedFile decoded;
  decoded.header = reply->header;
  auto samples = SampleBuffer::Make(decoded.header.SampleCount() * SampleBytes(decoded.header.samples));
  if (!samples) return samples.error();
  decoded.samples = std::move(*samples);
  const auto status =
      pool.Decode(*file, data_file ? &*data_file : nullptr, decoded.header, decoded.samples, 0);
  if (!status) return status.error();
  decoded.names.assign(reply->names, reply->names + decoded.header.segments);
  return decoded;
}

double SampleAt(const ImageHeader& header, const std::byte* samples, std::size_t i) {
  return WithReader(header, samples, [i](const auto& at) { return at(i); });
}

std::string CopyLabels(const ImageHeader& header, const std::byte* samples, std::uint32_t channel,
                       std::span<std::int32_t> labels) {
  // between larger ones not every whole number is a float, so that two labels may have become one
  const double largest = header.samples == SampleKind::kFloat32 ? kLargestFloatLabel : kLargestLabel;
  return WithReader(header, samples, [&](const auto& at) -> std::string {
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const double label = header.slope * at(i * header.channels + channel) + header.intercept;
      if (!std::isfinite(label)) return "one is no number";
      if (label != std::floor(label)) return FormatValue(label) + " is no whole number";
      if (label < 0) return FormatValue(label) + " is negative";
      if (label > largest) return FormatValue(label) + " is larger than " + FormatValue(largest);
      labels[i] = base::TruncateTo<std::int32_t>(label);
    }
    return {};
  });
}

GreyStatistics MeasureGrey(const ImageHeader& header, const std::byte* samples, std::size_t count) {
  constexpr std::size_t kBins = 4096;
  constexpr double kLeftOut = 0.005;  // at either end
  GreyStatistics result;
  WithReader(header, samples, [&](const auto& at) {
    double least = HUGE_VAL, greatest = -HUGE_VAL;
    for (std::size_t i = 0; i < count; ++i) {
      const double value = at(i);
      if (!std::isfinite(value)) continue;
      least = std::min(least, value), greatest = std::max(greatest, value);
    }
    if (least > greatest) least = greatest = 0;  // not one number
    std::array<std::size_t, kBins> bins{};
    const double scale = greatest > least ? (kBins - 1) / (greatest - least) : 0.0;
    std::size_t counted = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double value = at(i);
      if (!std::isfinite(value)) continue;
      ++bins[base::TruncateTo<std::size_t>((value - least) * scale)];
      ++counted;
    }
    const auto find = [&](double share) {
      const double wanted = share * static_cast<double>(counted);
      std::size_t bin = 0;
      for (double seen = 0; bin + 1 < kBins; ++bin) {
        seen += static_cast<double>(bins[bin]);
        if (seen > wanted) break;
      }
      return scale > 0 ? least + static_cast<double>(bin) / scale : least;
    };
    const auto real = [&](double value) { return header.slope * value + header.intercept; };
    const double low = real(find(kLeftOut)), high = real(find(1.0 - kLeftOut));
    result.least = std::min(real(least), real(greatest));
    result.greatest = std::max(real(least), real(greatest));
    result.window = {0.5 * (low + high), std::max(std::fabs(high - low), 1e-6)};
    // label maps and other sparse images: what is rare is what matters
    if (high == low)
      result.window = {0.5 * (result.least + result.greatest),
                       std::max(result.greatest - result.least, 1e-6)};
  });
  return result;
}

ColorImage RenderSlice(const ImageHeader& header, const std::byte* samples, const DisplayWindow& window,
                       int width, int height) {
  ColorImage image{width, height, {}};
  image.samples.resize(static_cast<std::size_t>(width) * height * 3);
  const bool is_resampled =
      width != static_cast<int>(header.width) || height != static_cast<int>(header.height);
  if (header.channels == 3 && !is_resampled) {
    std::memcpy(image.samples.data(), samples, image.samples.size());
    return image;
  }
  const auto columns = MakeSteps(header.width, width), rows = MakeSteps(header.height, height);
  const std::size_t stored = header.width, channels = header.channels;
  WithReader(header, samples, [&](const auto& at) {
    std::size_t out = 0;
    for (const Between& row : rows) {
      for (const Between& column : columns) {
        for (std::size_t c = 0; c < channels; ++c) {
          const auto value = [&](std::size_t x, std::size_t y) {
            return at((y * stored + x) * channels + c);
          };
          double mixed = value(column.low, row.low);
          if (column.part > 0) mixed += column.part * (value(column.high, row.low) - mixed);
          if (row.part > 0) {
            double below = value(column.low, row.high);
            if (column.part > 0) below += column.part * (value(column.high, row.high) - below);
            mixed += row.part * (below - mixed);
          }
          if (channels == 3) {
            image.samples[out++] = base::RoundTo<std::uint8_t>(mixed);
            continue;
          }
          const std::uint8_t shade =
              Shade(header.slope * mixed + header.intercept, window, header.is_inverted != 0);
          for (int k = 0; k < 3; ++k) image.samples[out++] = shade;
        }
      }
    }
  });
  return image;
}

}  // namespace trocar::images
