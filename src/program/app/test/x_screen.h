// SPDX-License-Identifier: Apache-2.0
/// \file x_screen.h  A display as a person uses it: windows, real clicks and keys, pictures.
#pragma once

#include <X11/XKBlib.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>
#include <X11/keysym.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "trocar_test/window_picture.h"

namespace trocar::test {

using Clock = std::chrono::steady_clock;

inline constexpr unsigned kLeastWidth = 600;         // of a window: a tip or a list is smaller [pixels]
inline constexpr std::chrono::seconds kLongest{90};  // for what a busy computer does

/// A colour of assets/looks/window.css.
struct Colour {
  int red, green, blue;
  bool Is(const unsigned char* pixel) const {
    return std::abs(pixel[0] - red) < 3 && std::abs(pixel[1] - green) < 3 && std::abs(pixel[2] - blue) < 3;
  }
};
inline constexpr Colour kCautionColour{0x33, 0x29, 0x0f}, kPassedColour{0x16, 0x30, 0x1f},
    kButtonColour{0x1d, 0x7a, 0x8c}, kLookColour{0xff, 0xc2, 0x4d};

inline int CountColour(const WindowPicture& picture, Colour colour) {
  return picture.Count(0, 0, picture.width, picture.height,
                       [colour](const unsigned char* pixel) { return colour.Is(pixel); });
}

struct Place {
  int x = 0, y = 0;
};

/// In the first row that has a run of so many pixels of the colour: the middle of it, a little below. The header bar is left out.
inline std::optional<Place> FindField(const WindowPicture& picture, Colour colour, int width) {
  constexpr unsigned kHeader = 60;
  for (unsigned y = kHeader; y < picture.height; ++y) {
    int run = 0;
    for (unsigned x = 0; x < picture.width; ++x) {
      run = colour.Is(picture.At(x, y)) ? run + 1 : 0;
      if (run >= width) return Place{static_cast<int>(x) - width / 2, static_cast<int>(y) + 8};
    }
  }
  return std::nullopt;
}

/// A window may be gone between two questions.
inline int IgnoreError(Display*, XErrorEvent*) {
  return 0;
}

template <typename Is>
bool WaitFor(Clock::duration longest, Is is) {
  for (const auto end = Clock::now() + longest; Clock::now() < end;) {
    if (is()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return false;
}

class Screen {
 public:
  Screen(Display* display, std::string folder) : display_(display), folder_(std::move(folder)) {}

  struct Shown {
    Window window;
    int x, y;
    unsigned width, height;
  };
  /// All that is seen, tips and lists among it, the topmost last.
  std::vector<Shown> FindAll() const {
    Window root = DefaultRootWindow(display_), parent = 0, *children = nullptr;
    unsigned count = 0;
    std::vector<Shown> found;
    if (XQueryTree(display_, root, &root, &parent, &children, &count) == 0) return found;
    for (unsigned i = 0; i < count; ++i) {
      XWindowAttributes now;
      if (XGetWindowAttributes(display_, children[i], &now) != 0 && now.map_state == IsViewable &&
          now.width > 1 && now.height > 1)
        found.push_back(
            {children[i], now.x, now.y, static_cast<unsigned>(now.width), static_cast<unsigned>(now.height)});
    }
    if (children != nullptr) XFree(children);
    return found;
  }
  /// Windows of the program, the topmost last.
  std::vector<Window> Find() const {
    std::vector<Window> found;
    for (const Shown& one : FindAll()) {
      if (one.width >= kLeastWidth) found.push_back(one.window);
    }
    return found;
  }
  /// Waits for a window that is none of these. \return nothing where none opens
  std::optional<Window> WaitForOther(const std::vector<Window>& known) const {
    std::optional<Window> other;
    WaitFor(kLongest, [&] {
      for (const Window window : Find()) {
        if (std::find(known.begin(), known.end(), window) == known.end()) other = window;
      }
      return other.has_value();
    });
    return other;
  }
  bool WaitUntilClosed(Window window, Clock::duration longest = kLongest) const {
    return WaitFor(longest, [&] {
      const auto now = Find();
      return std::find(now.begin(), now.end(), window) == now.end();
    });
  }
  const std::string& Folder() const { return folder_; }
  void MovePointer(int x, int y) const {
    XTestFakeMotionEvent(display_, -1, x, y, 0);
    XSync(display_, False);
  }
  /// As a mouse that is pushed.
  void MoveBy(int dx, int dy) const {
    XTestFakeRelativeMotionEvent(display_, dx, dy, 0);
    XSync(display_, False);
  }
  /// A pixel of the mouse is a pixel of the screen from now on.
  void SwitchOffAcceleration() const {
    XChangePointerControl(display_, True, True, 1, 1, 1000);
    XSync(display_, False);
  }
  Place Pointer() const {
    Window root = 0, child = 0;
    int x = 0, y = 0, ignored_x = 0, ignored_y = 0;
    unsigned mask = 0;
    XQueryPointer(display_, DefaultRootWindow(display_), &root, &child, &x, &y, &ignored_x, &ignored_y,
                  &mask);
    return {x, y};
  }
  void Focus(Window window) const {
    XRaiseWindow(display_, window);
    XSetInputFocus(display_, window, RevertToPointerRoot, CurrentTime);
    XSync(display_, False);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
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
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
  }
  void PressTimes(KeySym key, int times) const {
    for (int i = 0; i < times; ++i) Press(key);
  }
  /// Types a line of ASCII text.
  void Type(const std::string& text) const {
    for (const char c : text) {
      // the key symbols of these characters are their codes
      const auto symbol = static_cast<KeySym>(static_cast<unsigned char>(c));
      const KeyCode code = XKeysymToKeycode(display_, symbol);
      const bool is_shifted = XkbKeycodeToKeysym(display_, code, 0, 0) != symbol;
      if (is_shifted) XTestFakeKeyEvent(display_, XKeysymToKeycode(display_, XK_Shift_L), True, 10);
      XTestFakeKeyEvent(display_, code, True, 10);
      XTestFakeKeyEvent(display_, code, False, 10);
      if (is_shifted) XTestFakeKeyEvent(display_, XKeysymToKeycode(display_, XK_Shift_L), False, 10);
      XSync(display_, False);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  void Hold(KeySym key, std::chrono::milliseconds time) const {
    const KeyCode code = XKeysymToKeycode(display_, key);
    XTestFakeKeyEvent(display_, code, True, 20);
    XSync(display_, False);
    std::this_thread::sleep_for(time);
    XTestFakeKeyEvent(display_, code, False, 0);
    XSync(display_, False);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
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

/// Whether an attempt is recorded, into the check's folder. \return false after kLongest
inline bool WaitForRecording(const Screen& screen) {
  const std::filesystem::path recordings = std::filesystem::path(screen.Folder()) / "recordings";
  return WaitFor(kLongest, [&] {
    for (const auto& file : std::filesystem::directory_iterator(recordings)) {
      if (file.path().extension() == ".trocar") return true;
    }
    return false;
  });
}

/// The program of a check: CHECK FOLDER. Where the check fails, the screen is saved.
inline int RunCheck(int argc, char** argv, int (*check)(const Screen&)) {
  if (argc != 2) return Fail("usage: CHECK FOLDER, where pictures are saved");
  Display* display = XOpenDisplay(nullptr);
  if (display == nullptr) return Fail("there is no display");
  XSetErrorHandler(IgnoreError);
  const Screen screen(display, argv[1]);
  const int status = check(screen);
  if (status != 0) screen.Save("failed.png");
  XCloseDisplay(display);
  return status;
}

}  // namespace trocar::test
