// SPDX-License-Identifier: Apache-2.0
/// \file x_screen.h  A display as a person uses it: windows, real clicks and keys, pictures.
#pragma once

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>

#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "trocar_test/window_picture.h"

namespace trocar::test {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

inline constexpr unsigned kLeastWidth = 600;  // of a window: a tip or a list is smaller [pixels]
inline constexpr seconds kLongest{90};        // for what a busy computer does

inline int IgnoreError(Display*, XErrorEvent*) {
  return 0;
}

template <typename Is>
bool WaitFor(Clock::duration longest, Is is) {
  for (const auto end = Clock::now() + longest; Clock::now() < end;) {
    if (is()) return true;
    std::this_thread::sleep_for(milliseconds(100));
  }
  return false;
}

class Screen {
 public:
  Screen(Display* display, std::string folder) : display_(display), folder_(std::move(folder)) {}

  /// Windows of the program, the topmost last.
  std::vector<Window> Find() const {
    Window root = DefaultRootWindow(display_), parent = 0, *children = nullptr;
    unsigned count = 0;
    std::vector<Window> found;
    if (XQueryTree(display_, root, &root, &parent, &children, &count) == 0) return found;
    for (unsigned i = 0; i < count; ++i) {
      XWindowAttributes attributes;
      if (XGetWindowAttributes(display_, children[i], &attributes) != 0 &&
          attributes.map_state == IsViewable && attributes.width >= static_cast<int>(kLeastWidth))
        found.push_back(children[i]);
    }
    if (children != nullptr) XFree(children);
    return found;
  }
  void Focus(Window window) const {
    XRaiseWindow(display_, window);
    XSetInputFocus(display_, window, RevertToPointerRoot, CurrentTime);
    XSync(display_, False);
    std::this_thread::sleep_for(milliseconds(400));
  }
  void Click(int x, int y) const {
    XTestFakeMotionEvent(display_, -1, x, y, 0);
    XTestFakeButtonEvent(display_, 1, True, 30);
    XTestFakeButtonEvent(display_, 1, False, 60);
    XSync(display_, False);
  }
  void Drag(int x, int y, int dx, int dy) const {
    XTestFakeMotionEvent(display_, -1, x, y, 0);
    XTestFakeButtonEvent(display_, 1, True, 30);
    for (int step = 1; step <= 10; ++step)
      XTestFakeMotionEvent(display_, -1, x + dx * step / 10, y + dy * step / 10, 30);
    XTestFakeButtonEvent(display_, 1, False, 60);
    XSync(display_, False);
  }
  void Press(KeySym key, KeySym held = 0) const {
    const auto code = [this](KeySym symbol) { return XKeysymToKeycode(display_, symbol); };
    if (held != 0) XTestFakeKeyEvent(display_, code(held), True, 20);
    XTestFakeKeyEvent(display_, code(key), True, 20);
    XTestFakeKeyEvent(display_, code(key), False, 40);
    if (held != 0) XTestFakeKeyEvent(display_, code(held), False, 20);
    XSync(display_, False);
    std::this_thread::sleep_for(milliseconds(150));
  }
  void Hold(KeySym key, milliseconds time) const {
    const KeyCode code = XKeysymToKeycode(display_, key);
    XTestFakeKeyEvent(display_, code, True, 20);
    XSync(display_, False);
    std::this_thread::sleep_for(time);
    XTestFakeKeyEvent(display_, code, False, 0);
    XSync(display_, False);
    std::this_thread::sleep_for(milliseconds(200));
  }
  void Move(int x, int y) const {
    XTestFakeMotionEvent(display_, -1, x, y, 0);
    XSync(display_, False);
  }
  /// The wheel. \param step  1: away from the person, -1: towards
  void Turn(int step) const {
    const unsigned button = step > 0 ? 4 : 5;
    XTestFakeButtonEvent(display_, button, True, 0);
    XTestFakeButtonEvent(display_, button, False, 5);
    XSync(display_, False);
  }
  WindowPicture Look() const {
    const int width = DisplayWidth(display_, 0), height = DisplayHeight(display_, 0);
    XImage* image = XGetImage(display_, DefaultRootWindow(display_), 0, 0, static_cast<unsigned>(width),
                              static_cast<unsigned>(height), AllPlanes, ZPixmap);
    WindowPicture picture;
    if (image == nullptr) return picture;
    picture.width = static_cast<unsigned>(width), picture.height = static_cast<unsigned>(height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const unsigned long pixel = XGetPixel(image, x, y);
        for (const int shift : {16, 8, 0})
          picture.pixels.push_back(static_cast<unsigned char>(pixel >> shift));
      }
    }
    XDestroyImage(image);
    return picture;
  }
  void Save(const char* name) const {
    const WindowPicture picture = Look();
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = picture.width, image.height = picture.height;
    image.format = PNG_FORMAT_RGB;
    png_image_write_to_file(&image, (folder_ + "/" + name).c_str(), 0, picture.pixels.data(), 0, nullptr);
  }

 private:
  Display* display_;
  std::string folder_;
};

}  // namespace trocar::test
