// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <optional>

#include "binding.h"
#include "running.h"
#include "trocar/environment/environment.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::python {
namespace {

using simulation::Simulation;

/// A laparoscope's picture off-screen, in a context of its own that any thread may use in turn.
class Camera {
 public:
  Camera(int width, int height) {
    if (width < 8 || width > 4096 || height < 8 || height > 4096)
      throw Failure({core::ErrorCode::kUsage, "a picture has 8 to 4096 pixels a side"});
    context_.emplace(Take(render::OffscreenContext::Make()));
    target_.emplace(Take(render::OffscreenTarget::Make(width, height)));
    context_->Release();
  }
  ~Camera() {
    if (!context_ || !context_->MakeCurrent().ok()) return;
    view_.reset();
    target_.reset();
  }
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// (height, width, 3)
  py::array_t<std::uint8_t> Draw(const Simulation& simulation) {
    {
      py::gil_scoped_release release;
      Check(context_->MakeCurrent());
      const core::Status drawn = DrawNow(simulation);
      context_->Release();
      Check(drawn);
    }
    py::array_t<std::uint8_t> out({image_.height, image_.width, 3});
    std::memcpy(out.mutable_data(), image_.pixels.data(), image_.pixels.size());
    return out;
  }

 private:
  core::Status DrawNow(const Simulation& simulation) {
    if (!view_ || scene_ != &simulation.GetScene() || model_ != simulation.ModelFingerprint()) {
      view_.reset();
      auto made = view::LaparoscopeView::Make(simulation.GetScene(), simulation.Surfaces(),
                                              simulation.GetSnapshot(), simulation.Strands());
      if (!made) return made.error();
      view_.emplace(std::move(*made));
      // exposure control remembers earlier pictures: here a picture is a function of the state alone
      view_->SetOptions({.has_force_arrows = false, .has_automatic_exposure = false});
      scene_ = &simulation.GetScene();
      model_ = simulation.ModelFingerprint();
    }
    view_->Update(simulation.GetSnapshot());
    target_->Bind();
    view_->Draw(target_->Width(), target_->Height());
    target_->Read(image_);
    return {};
  }

  std::optional<render::OffscreenContext> context_;
  std::optional<render::OffscreenTarget> target_;
  std::optional<view::LaparoscopeView> view_;
  const scene::Scene* scene_ = nullptr;  // that view_ is of
  std::uint64_t model_ = 0;
  render::Image image_;
};

}  // namespace

void BindPicture(py::module_& module) {
  const char* about = "(height, width, 3) uint8, sRGB, first row at the top.";
  py::class_<Camera>(module, "Camera",
                     "Draws what the laparoscope of a simulation or environment shows, off-screen.")
      .def(py::init<int, int>(), py::arg("width"), py::arg("height"))
      .def(
          "draw", [](Camera& camera, const Running& running) { return camera.Draw(running.simulation); },
          py::arg("simulation"), py::keep_alive<1, 2>(), about)
      .def(
          "draw",
          [](Camera& camera, const environment::Environment& environment) {
            return camera.Draw(environment.GetSimulation());
          },
          py::arg("environment"), py::keep_alive<1, 2>(), about);
}

}  // namespace trocar::python
