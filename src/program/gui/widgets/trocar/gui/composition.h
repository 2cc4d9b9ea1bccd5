// SPDX-License-Identifier: Apache-2.0
/// \file composition.h  Choice of the renderer that puts widgets and picture together into the window.
#pragma once

namespace trocar::gui {

/// Lets GTK put the window together with Cairo where OpenGL is done by the processor, unless GSK_RENDERER
/// says something. GTK's OpenGL way redraws the whole window in every frame there: measured 23 ms against 6
/// ms. With a graphics card nothing changes. Before the first window.
void ChooseComposition();

}  // namespace trocar::gui
