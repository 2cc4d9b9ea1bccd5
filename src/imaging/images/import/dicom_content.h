// SPDX-License-Identifier: Apache-2.0
/// \file dicom_content.h  Content of a DICOM file and packing of its pixels, by the identifiers in its header.
/// Source: DICOM PS3.6 tables, PS3.3 section C.7.3.1.1.1 (Modality).
#pragma once

#include <string_view>

#include "import_protocol.h"

namespace trocar::images::import {

/// \param sop_class  the file's kind; empty where it is not said
/// \param modality   decides where the kind is not known
DicomContent FindContent(std::string_view sop_class, std::string_view modality);

/// "it is a DICOM segmentation" and the like.
const char* DescribeContent(DicomContent content);

/// Why pixels of this transfer syntax cannot be read; null where they can.
const char* FindPackingProblem(std::string_view transfer_syntax);

}  // namespace trocar::images::import
