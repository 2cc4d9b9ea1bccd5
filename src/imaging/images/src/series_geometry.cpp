// SPDX-License-Identifier: Apache-2.0
#include "series_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include "image_frame.h"
#include "series_content.h"
#include "trocar/base/to_integer.h"
#include "volume_file.h"

namespace trocar::images {
namespace {

using base::Error;
using base::ErrorCode;
using math::Vec3;

constexpr double kSameLength = 0.01;  // share by which a given distance may differ from the file's
constexpr double kSquare = 1e-3;      // share by which pixels may differ from squares

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

/// A length that a file says, a person gives, or both.
base::Result<double> Agree(const char* option, double said, const std::optional<double>& given) {
  if (!given) return said;
  if (said > 0 && std::fabs(said - *given) > kSameLength * said) {
    return Error{ErrorCode::kImageGeometryInvalid, "its header says " + Number(said) + " mm, but " + option +
                                                       " " + Number(*given) +
                                                       " was given; leave the option out"};
  }
  return said > 0 ? said : *given;
}

/// \param header  of the first slice
void SetGreyValues(const ImageHeader& header, const GreyStatistics& grey, ImageSeriesInfo& info) {
  info.grey_range = {grey.least, grey.greatest};
  if (header.has_window != 0) {
    info.suggested_window = {header.window_centre, header.window_width};
  } else if (header.samples != SampleKind::kUint8 || header.slope != 1 || header.intercept != 0) {
    info.suggested_window = grey.window;
  } else if (constexpr double kFewLabels = 32.0; grey.greatest < kFewLabels) {
    // labels, not light: all of them are to be seen
    info.suggested_window = {0.5 * grey.greatest, std::max(1.0, grey.greatest)};
  }
}

}  // namespace

SaidGeometry GeometryOf(const ImageHeader& header) {
  SaidGeometry said;
  said.spacing[0] = header.spacing[0], said.spacing[1] = header.spacing[1];
  said.slice_mm = header.spacing[2];
  said.has_direction = header.frame != FileFrame::kNotSaid;
  for (int axis = 0; axis < 3; ++axis)
    said.direction[axis] = {header.direction[axis][0], header.direction[axis][1], header.direction[axis][2]};
  said.origin = {header.origin[0], header.origin[1], header.origin[2]};
  return said;
}

base::Status SetGeometry(const SaidGeometry& said, const ImageHeader& header,
                         const ImageSeriesOptions& options, ImageSeriesInfo& info) {
  const double finer = std::min(said.spacing[0], said.spacing[1]);
  const auto pixel_mm = Agree("--pixel-mm", finer, options.pixel_mm);
  if (!pixel_mm) return pixel_mm.error();
  const auto slice_mm = Agree("--slice-mm", said.slice_mm, options.slice_mm);
  if (!slice_mm) return slice_mm.error();
  const bool has_sizes = *pixel_mm > 0 && *slice_mm > 0, has_axes = said.has_direction || options.axes;
  if (!has_sizes || !has_axes) {
    std::string missing;
    const auto ask = [&](bool is_known, const char* option) {
      if (!is_known) missing += (missing.empty() ? "" : ", ") + std::string(option);
    };
    ask(*pixel_mm > 0, "--pixel-mm MM (side of a pixel)");
    ask(*slice_mm > 0, "--slice-mm MM (from one slice number to the next)");
    ask(has_axes,
        "--axes COLUMN,ROW,SLICE (where they grow to in the patient, for example left,posterior,superior)");
    if (has_sizes) {
      return Error{ErrorCode::kImageSpacingUnknown,
                   "the files do not say how the patient lies; give " + missing};
    }
    if (header.kind <= FileKind::kTiff && !has_axes) {
      return Error{
          ErrorCode::kImageSpacingUnknown,
          "pictures do not say how large the patient is and how it lies (a resolution in them is for "
          "printers and is not used); give " +
              missing};
    }
    if (header.kind <= FileKind::kTiff) {
      return Error{
          ErrorCode::kImageSpacingUnknown,
          "pictures do not say how large the patient is (a resolution in them is for printers and is "
          "not used); give " +
              missing};
    }
    if (has_axes)
      return Error{ErrorCode::kImageSpacingUnknown,
                   "the files do not say how large the patient is; give " + missing};
    return Error{ErrorCode::kImageSpacingUnknown,
                 "the files do not say how large the patient is and how it lies; give " + missing};
  }
  info.pixel_mm = *pixel_mm;
  info.slice_mm = *slice_mm;
  if (!(info.pixel_mm >= 0.01 && info.pixel_mm <= 20.0) ||
      !(info.slice_mm >= 0.01 && info.slice_mm <= 50.0)) {
    return Error{
        ErrorCode::kImageGeometryInvalid,
        "pixels of " + Number(info.pixel_mm) + " mm in slices " + Number(info.slice_mm) +
            " mm apart are no images of a patient; pixels of 0.01 to 20 mm and slices of 0.01 to 50 mm are"};
  }
  const auto given = options.axes ? FindDirections(*options.axes) : said.direction;
  if (!given) return given.error();
  const auto named = NameAxes(said.has_direction ? said.direction : *given);
  if (!named) return named.error();
  if (options.axes && named->axes != *options.axes) {
    return Error{ErrorCode::kImageGeometryInvalid, "its axes run " + named->axes[0] + ", " + named->axes[1] +
                                                       ", " + named->axes[2] +
                                                       " by its header, not as --axes says; leave "
                                                       "the option out"};
  }
  info.axes = named->axes;
  info.tilt_deg = named->tilt_deg;
  const auto& direction = said.has_direction ? said.direction : *given;
  for (int axis = 0; axis < 3; ++axis)
    info.direction[axis] = {direction[axis].x, direction[axis].y, direction[axis].z};
  info.origin_mm = {said.origin.x, said.origin.y, said.origin.z};

  info.width = static_cast<int>(header.width), info.height = static_cast<int>(header.height);
  if (finer > 0) {
    const auto resampled = [&](std::uint32_t stored, double spacing) {
      if (spacing <= finer * (1 + kSquare)) return static_cast<int>(stored);
      return base::TruncateTo<int>(std::round((stored - 1) * spacing / finer) + 1);
    };
    info.width = resampled(header.width, said.spacing[0]);
    info.height = resampled(header.height, said.spacing[1]);
  }
  constexpr int kMostSide = 16384;
  if (info.width > kMostSide || info.height > kMostSide) {
    return Error{ErrorCode::kImageGeometryInvalid, "its pixels are " + Number(said.spacing[0]) + " x " +
                                                       Number(said.spacing[1]) +
                                                       " mm, too far from square; resample it"};
  }
  return {};
}

const char* FormatName(FileKind kind) {
  switch (kind) {
    case FileKind::kJpeg:
      return "JPEG";
    case FileKind::kPng:
      return "PNG";
    case FileKind::kTiff:
      return "TIFF";
    case FileKind::kDicom:
      return "DICOM";
    case FileKind::kNifti:
      return "NIfTI";
    case FileKind::kNrrd:
      return "NRRD";
    case FileKind::kMetaImage:
      return "MetaImage";
    case FileKind::kUnknown:
      break;
  }
  return "";
}

const char* FrameName(FileFrame frame) {
  return frame == FileFrame::kLps ? "LPS" : frame == FileFrame::kRas ? "RAS" : "";
}

void SetGreyValues(const ImageHeader& header, const std::byte* samples, std::size_t count,
                   ImageSeriesInfo& info) {
  info.is_color = header.channels == 3;
  info.bits = static_cast<int>(header.bits);
  if (!info.is_color) SetGreyValues(header, MeasureGrey(header, samples, count), info);
}

void SetGreyValues(const ImageSeries::Content& content, ImageSeriesInfo& info) {
  const ImageHeader& first = content.headers[0];
  info.is_color = first.channels == 3;
  info.bits = static_cast<int>(first.bits);
  if (info.is_color) return;
  const std::size_t count = PictureBytes(first) / SampleBytes(first.samples);
  const bool is_alike =
      std::all_of(content.headers.begin(), content.headers.end(), [&](const ImageHeader& header) {
        return header.slope == first.slope && header.intercept == first.intercept;
      });
  if (is_alike && content.samples.Bytes() == content.headers.size() * PictureBytes(first))
    return SetGreyValues(first, MeasureGrey(first, content.samples.Data(), count * content.headers.size()),
                         info);
  GreyStatistics all;
  double low = 0, high = 0;
  for (std::size_t i = 0; i < content.headers.size(); ++i) {
    const GreyStatistics one = MeasureGrey(content.headers[i], content.SamplesOf(i), count);
    const double one_low = one.window.centre - 0.5 * one.window.width,
                 one_high = one.window.centre + 0.5 * one.window.width;
    all.least = i == 0 ? one.least : std::min(all.least, one.least);
    all.greatest = i == 0 ? one.greatest : std::max(all.greatest, one.greatest);
    low = i == 0 ? one_low : std::min(low, one_low);
    high = i == 0 ? one_high : std::max(high, one_high);
  }
  all.window = {0.5 * (low + high), high - low};
  SetGreyValues(first, all, info);
}

}  // namespace trocar::images
