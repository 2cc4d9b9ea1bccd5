// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <memory>

#include "binding.h"
#include "camera.h"
#include "drawn_pool.h"
#include "running.h"
#include "trocar/view/labels.h"

namespace trocar::python {
namespace {

using simulation::Simulation;

std::unique_ptr<Camera> MakeCamera(int width, int height) {
  return Take(Camera::Make(width, height));
}

/// (height, width, 3)
py::array_t<std::uint8_t> Draw(Camera& camera, const Simulation& simulation, double light) {
  render::Image image;
  {
    const py::gil_scoped_release release;
    Check(camera.Draw(simulation, light, image));
  }
  py::array_t<std::uint8_t> out({image.height, image.width, 3});
  std::memcpy(out.mutable_data(), image.pixels.data(), image.pixels.size());
  return out;
}

/// What lies at each pixel, and the camera's pose and lens.
py::dict LookAt(Camera& camera, const Simulation& simulation, bool has_flow) {
  render::GeometryPicture seen;
  {
    const py::gil_scoped_release release;
    Check(camera.LookAt(simulation, has_flow, seen));
  }
  const int h = seen.height, w = seen.width;
  py::array_t<float> depth({h, w}), normals({h, w, 3});
  std::copy(seen.depth.begin(), seen.depth.end(), depth.mutable_data());
  std::copy(seen.normals.begin(), seen.normals.end(), normals.mutable_data());
  py::array_t<std::uint8_t> classes({h, w}), instances({h, w});
  std::transform(seen.labels.begin(), seen.labels.end(), classes.mutable_data(),
                 [](std::uint16_t label) { return static_cast<std::uint8_t>(view::ClassOf(label)); });
  std::transform(seen.labels.begin(), seen.labels.end(), instances.mutable_data(), view::InstanceOf);
  py::dict out;
  out["depth"] = depth;
  out["normals"] = normals;
  out["classes"] = classes;
  out["instances"] = instances;
  out["pose"] = ToMatrix(simulation.GetSnapshot().X_world_laparoscope);
  out["focal_length"] = camera.FocalLength();
  if (has_flow) {
    py::array_t<float> flow({h, w, 2});
    std::copy(seen.flow.begin(), seen.flow.end(), flow.mutable_data());
    out["flow"] = flow;
  }
  return out;
}

double LightOf(const environment::Environment& environment) {
  return environment.Drawn()[static_cast<std::size_t>(environment::Varied::kLight)];
}

}  // namespace

void BindPicture(py::module_& module) {
  const char* about = "(height, width, 3) uint8, sRGB, first row at the top.";
  const char* about_geometry =
      "What lies at each pixel: depth (h, w) float32 along the line of sight [m], 0 where nothing is; "
      "normals (h, w, 3) "
      "float32, unit, camera frame (+x right, +y up, +z to the eye); classes (h, w) uint8 after "
      "trocar.CLASSES; instances "
      "(h, w) uint8; pose (4, 4) of the camera in the world, looking along -z; focal_length [pixels], about "
      "the middle. With flow=True also flow (h, w, 2) float32: the pixel less that of the same surface point "
      "when flow was "
      "asked for last, +x right, +y down [pixels]; NaN where nothing lies or nothing is known of before.";
  py::class_<Camera>(module, "Camera",
                     "Draws what the laparoscope of a simulation or environment shows, off-screen.")
      .def(py::init(&MakeCamera), py::arg("width"), py::arg("height"))
      .def(
          "draw", [](Camera& camera, const Running& running) { return Draw(camera, running.simulation, 1); },
          py::arg("simulation"), py::keep_alive<1, 2>(), about)
      .def(
          "draw",
          [](Camera& camera, const RunningEnvironment& running) {
            return Draw(camera, running.Simulation(), LightOf(running.environment));
          },
          py::arg("environment"), py::keep_alive<1, 2>(), about)
      .def(
          "draw",
          [](Camera& camera, const DrawnPool& pool, std::int32_t id) {
            const environment::Environment& environment = *Take(pool.pool->Look(id));
            return Draw(camera, environment.GetSimulation(), LightOf(environment));
          },
          py::arg("pool"), py::arg("id"), py::keep_alive<1, 2>(), about)
      .def(
          "geometry",
          [](Camera& camera, const Running& running, bool flow) {
            return LookAt(camera, running.simulation, flow);
          },
          py::arg("simulation"), py::arg("flow") = false, py::keep_alive<1, 2>(), about_geometry)
      .def(
          "geometry",
          [](Camera& camera, const RunningEnvironment& running, bool flow) {
            return LookAt(camera, running.Simulation(), flow);
          },
          py::arg("environment"), py::arg("flow") = false, py::keep_alive<1, 2>(), about_geometry);
  py::dict classes;
  for (std::size_t i = 0; i < view::kLabelClassCount; ++i)
    classes[py::str(std::string(view::NameOf(static_cast<view::LabelClass>(i))))] = i;
  module.attr("CLASSES") = classes;
}

}  // namespace trocar::python
