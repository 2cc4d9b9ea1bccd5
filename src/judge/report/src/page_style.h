// SPDX-License-Identifier: Apache-2.0
/// \file page_style.h  The style sheet of the reports' pages.
#pragma once

#include <string>

namespace trocar::report {

/// CSS, the same for every page.
std::string FormatPageStyle();

}  // namespace trocar::report
