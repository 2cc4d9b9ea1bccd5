// SPDX-License-Identifier: Apache-2.0
#if TROCAR_HAS_SDL2
#include <SDL.h>
#endif

#include <algorithm>
#include <initializer_list>

#include "trocar/device/rate_hands.h"

namespace trocar::device {

#if TROCAR_HAS_SDL2
namespace {

constexpr double kFull = 32767.0;

base::Status StartSdl() {
  SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
  if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) == 0) return {};
  return base::Error{base::ErrorCode::kDeviceLost,
                     std::string("gamepad: SDL does not start: ") + SDL_GetError()};
}

int FindGamepad() {
  for (int i = 0; i < SDL_NumJoysticks(); ++i) {
    if (SDL_IsGameController(i) == SDL_TRUE) return i;
  }
  return -1;
}

class SdlGamepad : public GamepadSource {
 public:
  ~SdlGamepad() override { Close(); }

  base::Status Open() override {
    if (base::Status started = StartSdl(); !started) return started;
    is_started_ = true;
    const int index = FindGamepad();
    pad_ = index < 0 ? nullptr : SDL_GameControllerOpen(index);
    if (pad_ != nullptr) return {};
    Close();
    return base::Error{base::ErrorCode::kDeviceLost,
                       "no gamepad is found; plug one in, and see that you may read /dev/input/event*"};
  }

  bool Poll(GamepadState& state) noexcept override {
    SDL_GameControllerUpdate();
    if (SDL_GameControllerGetAttached(pad_) != SDL_TRUE) return false;
    const auto axis = [this](SDL_GameControllerAxis which) {
      return std::max(-1.0, SDL_GameControllerGetAxis(pad_, which) / kFull);
    };
    const auto is_down = [this](SDL_GameControllerButton which) {
      return SDL_GameControllerGetButton(pad_, which) != 0;
    };
    const auto bits = [&](std::initializer_list<SDL_GameControllerButton> buttons) {
      std::uint32_t bit = 1, down = 0;
      for (const SDL_GameControllerButton button : buttons) {
        if (is_down(button)) down |= bit;
        bit <<= 1;
      }
      return down;
    };
    state.sides[0] = {axis(SDL_CONTROLLER_AXIS_LEFTX), axis(SDL_CONTROLLER_AXIS_LEFTY),
                      axis(SDL_CONTROLLER_AXIS_TRIGGERLEFT), is_down(SDL_CONTROLLER_BUTTON_LEFTSHOULDER),
                      bits({SDL_CONTROLLER_BUTTON_DPAD_DOWN, SDL_CONTROLLER_BUTTON_DPAD_RIGHT,
                            SDL_CONTROLLER_BUTTON_DPAD_LEFT, SDL_CONTROLLER_BUTTON_DPAD_UP,
                            SDL_CONTROLLER_BUTTON_LEFTSTICK, SDL_CONTROLLER_BUTTON_BACK})};
    state.sides[1] = {
        axis(SDL_CONTROLLER_AXIS_RIGHTX), axis(SDL_CONTROLLER_AXIS_RIGHTY),
        axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT), is_down(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER),
        bits({SDL_CONTROLLER_BUTTON_A, SDL_CONTROLLER_BUTTON_B, SDL_CONTROLLER_BUTTON_X,
              SDL_CONTROLLER_BUTTON_Y, SDL_CONTROLLER_BUTTON_RIGHTSTICK, SDL_CONTROLLER_BUTTON_START})};
    return true;
  }

  void Close() noexcept override {
    if (pad_ != nullptr) SDL_GameControllerClose(pad_);
    pad_ = nullptr;
    if (is_started_) SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
    is_started_ = false;
  }

 private:
  SDL_GameController* pad_ = nullptr;
  bool is_started_ = false;
};

}  // namespace

std::unique_ptr<GamepadSource> MakeSdlGamepad() {
  return std::make_unique<SdlGamepad>();
}

std::vector<std::string> ListGamepads() {
  std::vector<std::string> names;
  if (!StartSdl()) return names;
  for (int i = 0; i < SDL_NumJoysticks(); ++i) {
    if (SDL_IsGameController(i) == SDL_TRUE) names.emplace_back(SDL_GameControllerNameForIndex(i));
  }
  SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  return names;
}
#else
namespace {

class NoGamepad : public GamepadSource {
 public:
  base::Status Open() override {
    return base::Error{base::ErrorCode::kDeviceUnsupported,
                       "this build has no gamepads: install libsdl2-dev and build again"};
  }
  bool Poll(GamepadState&) noexcept override { return false; }
  void Close() noexcept override {}
};

}  // namespace

std::unique_ptr<GamepadSource> MakeSdlGamepad() {
  return std::make_unique<NoGamepad>();
}
std::vector<std::string> ListGamepads() {
  return {};
}
#endif

}  // namespace trocar::device
