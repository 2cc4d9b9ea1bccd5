// SPDX-License-Identifier: Apache-2.0
#include "dicom_content.h"

#include <algorithm>
#include <iterator>

#include "trocar/host/translate.h"

namespace trocar::images::import {
namespace {

constexpr std::string_view kStorage = "1.2.840.10008.5.1.4.1.1.";
constexpr std::string_view kSyntaxes = "1.2.840.10008.1.2";

struct KnownClass {
  std::string_view suffix;  // behind kStorage; with a dot at its end: and all that begin so
  DicomContent content;
};
// the first that fits
constexpr KnownClass kClasses[] = {
    {"66.1", DicomContent::kRegistration}, {"66.3", DicomContent::kRegistration},
    {"66.2", DicomContent::kRegistration}, {"66.4", DicomContent::kSegmentation},
    {"66.7", DicomContent::kSegmentation}, {"66.5", DicomContent::kSurface},
    {"66", DicomContent::kRawData},        {"68.", DicomContent::kSurface},
    {"67", DicomContent::kOther},          {"481.2", DicomContent::kDose},
    {"481.3", DicomContent::kStructures},  {"481.1", DicomContent::kPictures},
    {"481.", DicomContent::kPlan},         {"88.59", DicomContent::kKeyObjects},
    {"88.", DicomContent::kReport},        {"11.", DicomContent::kPresentation},
    {"104.", DicomContent::kDocument},     {"9.", DicomContent::kWaveform},
    {"30", DicomContent::kParametricMap}};

struct KnownModality {
  std::string_view modality;
  DicomContent content;
};
constexpr KnownModality kModalities[] = {
    {"SEG", DicomContent::kSegmentation}, {"RTSTRUCT", DicomContent::kStructures},
    {"RTDOSE", DicomContent::kDose},      {"RTPLAN", DicomContent::kPlan},
    {"RTRECORD", DicomContent::kPlan},    {"SR", DicomContent::kReport},
    {"KO", DicomContent::kKeyObjects},    {"PR", DicomContent::kPresentation},
    {"REG", DicomContent::kRegistration}, {"DOC", DicomContent::kDocument},
    {"ECG", DicomContent::kWaveform},     {"RWV", DicomContent::kOther},
    {"FID", DicomContent::kRegistration}, {"PLAN", DicomContent::kPlan},
    {"M3D", DicomContent::kDocument}};

/// The number of ".4.107", 107; -1 for what is none of ".4.".
int PartFour(std::string_view suffix) {
  if (!suffix.starts_with(".4.") || suffix.size() < 4 || suffix.size() > 6) return -1;
  int number = 0;
  for (const char c : suffix.substr(3)) {
    if (c < '0' || c > '9') return -1;
    number = 10 * number + (c - '0');
  }
  return number;
}

}  // namespace

DicomContent FindContent(std::string_view sop_class, std::string_view modality) {
  if (sop_class == "1.2.840.10008.1.3.10") return DicomContent::kDirectory;
  if (sop_class.starts_with(kStorage)) {
    const std::string_view suffix = sop_class.substr(kStorage.size());
    for (const KnownClass& known : kClasses) {
      if (suffix == known.suffix || (known.suffix.ends_with('.') && suffix.starts_with(known.suffix)))
        return known.content;
    }
    return DicomContent::kPictures;
  }
  for (const KnownModality& known : kModalities) {
    if (modality == known.modality) return known.content;
  }
  return DicomContent::kPictures;
}

const char* DescribeContent(DicomContent content) {
  switch (content) {
    case DicomContent::kPictures:
      return host::Mark("it is a DICOM image");
    case DicomContent::kSegmentation:
      return host::Mark("it is a DICOM segmentation (SEG)");
    case DicomContent::kStructures:
      return host::Mark("it is a DICOM set of structures (RTSTRUCT)");
    case DicomContent::kDose:
      return host::Mark("it is a DICOM dose of radiotherapy (RTDOSE)");
    case DicomContent::kPlan:
      return host::Mark("it is a DICOM plan or record of radiotherapy");
    case DicomContent::kReport:
      return host::Mark("it is a DICOM report (SR)");
    case DicomContent::kKeyObjects:
      return host::Mark("it is a DICOM selection of key objects (KO)");
    case DicomContent::kPresentation:
      return host::Mark("it is a DICOM presentation state (PR)");
    case DicomContent::kDirectory:
      return host::Mark("it is a DICOM list of contents (DICOMDIR)");
    case DicomContent::kDocument:
      return host::Mark("it is a document in DICOM");
    case DicomContent::kRawData:
      return host::Mark("it is DICOM raw data");
    case DicomContent::kRegistration:
      return host::Mark("it is a DICOM registration");
    case DicomContent::kWaveform:
      return host::Mark("it is a DICOM waveform");
    case DicomContent::kParametricMap:
      return host::Mark("it is a DICOM parametric map");
    case DicomContent::kSurface:
      return host::Mark("it is a DICOM surface");
    case DicomContent::kOther:
      break;
  }
  return host::Mark("it is a DICOM file without a picture");
}

const char* FindPackingProblem(std::string_view transfer_syntax) {
  if (transfer_syntax.empty()) return nullptr;  // elements without group 2
  // private ones begin otherwise; the one of General Electric is read
  if (transfer_syntax == "1.2.840.113619.5.2") return nullptr;
  if (!transfer_syntax.starts_with(kSyntaxes))
    return host::Mark("its transfer syntax is a maker's own, which is not read");
  const std::string_view suffix = transfer_syntax.substr(kSyntaxes.size());
  constexpr std::string_view kPlain[] = {"", ".1", ".1.99", ".2", ".5"};
  if (std::find(std::begin(kPlain), std::end(kPlain), suffix) != std::end(kPlain)) return nullptr;
  if (suffix == ".1.98")
    return host::Mark("its pixels are encapsulated without being packed, which is not read");
  if (suffix.starts_with(".7."))
    return host::Mark("its pixels are a video (SMPTE ST 2110), which is not read");
  const int part = PartFour(suffix);
  if ((part >= 50 && part <= 66) || part == 70 || part == 80 || part == 81 || part == 90 || part == 91)
    return nullptr;
  if (part == 92 || part == 93)
    return host::Mark("its pixels are packed as JPEG 2000 part 2, which is not read");
  if (part == 94 || part == 95) return host::Mark("its pixels lie on a server (JPIP), which is not asked");
  if (part >= 100 && part <= 106) return host::Mark("its pixels are a video (MPEG), which is not read");
  if (part == 107 || part == 108) return host::Mark("its pixels are a video (HEVC), which is not read");
  if (part >= 110 && part <= 112) return host::Mark("its pixels are packed as JPEG XL, which is not read");
  if (part >= 201 && part <= 203)
    return host::Mark("its pixels are packed as high-throughput JPEG 2000, which is not read");
  if (part == 204 || part == 205) return host::Mark("its pixels lie on a server (JPIP), which is not asked");
  return host::Mark("its transfer syntax is not known");
}

}  // namespace trocar::images::import
