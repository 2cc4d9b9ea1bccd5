// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <optional>

#include "binding.h"
#include "running.h"
#include "trocar/environment/environment.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/view/labels.h"
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
    InContext([&] { return DrawNow(simulation); });
    py::array_t<std::uint8_t> out({image_.height, image_.width, 3});
    std::memcpy(out.mutable_data(), image_.pixels.data(), image_.pixels.size());
    return out;
  }

  /// What lies at each pixel, and the camera's pose and lens.
  py::dict Geometry(const Simulation& simulation) {
    double focal = 0;
    InContext([&] {
      if (const auto shown = Show(simulation); !shown) return shown;
      focal = view_->FocalLength(target_->Height());
      return view_->DrawGeometry(target_->Width(), target_->Height(), geometry_);
    });
    const int h = geometry_.height, w = geometry_.width;
    py::array_t<float> depth({h, w}), normals({h, w, 3});
    std::copy(geometry_.depth.begin(), geometry_.depth.end(), depth.mutable_data());
    std::copy(geometry_.normals.begin(), geometry_.normals.end(), normals.mutable_data());
    py::array_t<std::uint8_t> classes({h, w}), instances({h, w});
    std::transform(geometry_.labels.begin(), geometry_.labels.end(), classes.mutable_data(),
                   [](std::uint16_t label) { return static_cast<std::uint8_t>(view::ClassOf(label)); });
    std::transform(geometry_.labels.begin(), geometry_.labels.end(), instances.mutable_data(),
                   view::InstanceOf);
    py::dict out;
    out["depth"] = depth;
    out["normals"] = normals;
    out["classes"] = classes;
    out["instances"] = instances;
    out["pose"] = ToMatrix(simulation.GetSnapshot().X_world_laparoscope);
    out["focal_length"] = focal;
    return out;
  }

 private:
  template <typename Work>
  void InContext(const Work& work) {
    py::gil_scoped_release release;
    Check(context_->MakeCurrent());
    const core::Status done = work();
    context_->Release();
    Check(done);
  }

  core::Status Show(const Simulation& simulation) {
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
    return {};
  }

  core::Status DrawNow(const Simulation& simulation) {
    if (const auto shown = Show(simulation); !shown) return shown;
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
  render::GeometryPicture geometry_;
};

}  // namespace

void BindPicture(py::module_& module) {
  const char* about = "(height, width, 3) uint8, sRGB, first row at the top.";
  const char* about_geometry =
      "What lies at each pixel: depth (h, w) float32 along the line of sight [m], 0 where nothing is; "
      "normals (h, w, 3) "
      "float32, unit, camera frame (+x right, +y up, +z to the eye); classes (h, w) uint8 after "
      "trocar.CLASSES; instances "
      "(h, w) uint8; pose (4, 4) of the camera in the world, looking along -z; focal_length [pixels], about "
      "the middle.";
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
          py::arg("environment"), py::keep_alive<1, 2>(), about)
      .def(
          "geometry",
          [](Camera& camera, const Running& running) { return camera.Geometry(running.simulation); },
          py::arg("simulation"), py::keep_alive<1, 2>(), about_geometry)
      .def(
          "geometry",
          [](Camera& camera, const environment::Environment& environment) {
            return camera.Geometry(environment.GetSimulation());
          },
          py::arg("environment"), py::keep_alive<1, 2>(), about_geometry);
  py::dict classes;
  for (std::size_t i = 0; i < view::kLabelClassCount; ++i)
    classes[py::str(std::string(view::NameOf(static_cast<view::LabelClass>(i))))] = i;
  module.attr("CLASSES") = classes;
}

}  // namespace trocar::python
