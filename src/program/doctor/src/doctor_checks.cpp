// SPDX-License-Identifier: Apache-2.0
#include "trocar/doctor/doctor_checks.h"

#include <dlfcn.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>

#include "child_process.h"
#include "trocar/base/simd_choice.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/program.h"
#include "trocar/host/real_time.h"
#include "trocar/render/image.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/video_writer.h"
#include "trocar/scene/scene.h"
#include "trocar/sound/player.h"
#include "trocar/sound/speech.h"
#include "trocar/tissue_cuda/gpu_solver.h"

namespace trocar::doctor {
namespace {

namespace fs = std::filesystem;

constexpr double kDriverTimeout = 30;   // the first shader cache of a cold driver takes seconds [s]
constexpr int kWantedAboveLowest = 20;  // of the haptic supervisor, the highest that Trocar asks for

std::string ReadEnvironment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

std::string ReadFirstLine(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// Names in a folder that begin with `prefix`, sorted; none where the folder is missing.
std::vector<std::string> ListNames(const fs::path& folder, std::string_view prefix) {
  std::vector<std::string> names;
  std::error_code failure;
  for (fs::directory_iterator it(folder, failure), end; !failure && it != end; it.increment(failure)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with(prefix)) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Whether a server listens on a socket of the file system, or with `is_abstract` on an abstract one.
bool CanConnect(const std::string& path, bool is_abstract) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t offset = is_abstract ? 1 : 0;
  if (path.empty() || path.size() + offset >= sizeof address.sun_path) return false;
  std::memcpy(address.sun_path + offset, path.data(), path.size());
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return false;
  const auto size =
      static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + offset + path.size() + (1 - offset));
  const bool is_connected = ::connect(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0;
  ::close(socket);
  return is_connected;
}

/// The GPU that tissue can be computed on, or why there is none.
bool AskGpu(std::string& text) {
  const base::Result<tissue_cuda::GpuInformation> gpu = tissue_cuda::FindGpu();
  if (!gpu) {
    text = gpu.error().Text();
    return false;
  }
  text = gpu->name + ", compute capability " + std::to_string(gpu->compute_capability / 10) + "." +
         std::to_string(gpu->compute_capability % 10) + "; driver of CUDA " +
         std::to_string(gpu->driver_version / 1000) + "." + std::to_string(gpu->driver_version % 1000 / 10);
  return true;
}

/// Encodes a moment of grey in a folder of its own, and removes it.
bool TryVideo(std::string& text) {
  std::string folder = (fs::temp_directory_path() / "trocar-doctor-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) {
    text = "no temporary folder: " + std::string(std::strerror(errno));
    return false;
  }
  const render::VideoSettings settings{64, 64, 30, 100'000};
  const render::Image grey{64, 64, std::vector<std::uint8_t>(3 * 64 * 64, 128)};
  base::Status status;
  if (auto writer = render::VideoWriter::Make(fs::path(folder) / "doctor.webm", settings); !writer) {
    status = writer.error();
  } else {
    for (int i = 0; i < 3 && status; ++i) status = writer->AddFrame(grey);
    if (status) status = writer->Finish();
  }
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  if (!status) text = status.error().Text();
  return status.ok();
}

bool TryRealTime(std::string& text) {
  if (host::AskForRealTime(host::RealTimePolicy::kFirstInFirstOut, kWantedAboveLowest)) return true;
  text = "the system permits no real-time priority";
  return false;
}

/// A 3-D mouse by its USB vendor and product as the kernel prints them ("256F", "C635").
bool IsThreeDMouse(std::string vendor, std::string product) {
  for (std::string* word : {&vendor, &product}) {
    std::transform(word->begin(), word->end(), word->begin(),
                   [](unsigned char c) { return std::tolower(c); });
    word->erase(0, std::min(word->find_first_not_of('0'), word->size()));
  }
  // 3Dconnexion; older ones carry Logitech's number
  return vendor == "256f" || (vendor == "46d" && product.size() == 4 && product.starts_with("c62"));
}

}  // namespace

std::string_view HealthName(Health health) noexcept {
  switch (health) {
    case Health::kGood:
      return "good";
    case Health::kLimited:
      return "limited";
    case Health::kMissing:
      return "missing";
  }
  return "missing";
}

Finding CheckOpenGl() {
  // in a child: a driver that crashes must not take the doctor with it
  const ChildAnswer answer = AskChild(
      [](std::string& text) {
        const base::Result<render::OffscreenContext> context = render::OffscreenContext::Make();
        text =
            context ? context->RendererText() + "; OpenGL " + context->VersionText() : context.error().Text();
        return context.ok();
      },
      kDriverTimeout);
  Finding finding{"opengl", Health::kMissing, answer.text, "", ""};
  if (answer.end != ChildEnd::kAnswered) {
    finding.meaning =
        "no pictures can be drawn: neither the window nor the demonstration works; trocar simulate does";
    finding.remedy =
        "install libegl1, libegl-mesa0 and libgl1-mesa-dri (tools/install-packages --runtime), or mend the "
        "graphics driver";
    return finding;
  }
  const bool is_software = answer.text.find("llvmpipe") != std::string::npos ||
                           answer.text.find("softpipe") != std::string::npos ||
                           answer.text.find("SWR") != std::string::npos;
  finding.health = is_software ? Health::kLimited : Health::kGood;
  finding.meaning = is_software ? "pictures are drawn by the processor: all works, with fewer frames a second"
                                : "pictures are drawn by the graphics card";
  if (is_software) {
    finding.remedy = "if this computer has a graphics card, install its driver; nothing is needed otherwise";
  }
  return finding;
}

Finding CheckVideoEncoder() {
  const ChildAnswer answer = AskChild(TryVideo, kDriverTimeout);
  if (answer.end == ChildEnd::kAnswered) {
    return {"video", Health::kGood, "WebM (VP8) by GStreamer", "the demonstration can write its video", ""};
  }
  return {
      "video", Health::kMissing, answer.text, "the demonstration cannot write its video",
      "install gstreamer1.0-plugins-base and gstreamer1.0-plugins-good (tools/install-packages --runtime)"};
}

Finding CheckGpu() {
  const ChildAnswer answer = AskChild(AskGpu, kDriverTimeout);
  if (answer.end == ChildEnd::kAnswered) {
    return {"gpu", Health::kGood, answer.text,
            "trocar simulate --gpu and trocar bench tissue_cuda compute tissue on it", ""};
  }
  const bool is_none = answer.text.starts_with(base::CodeText(base::ErrorCode::kGpuMissing));
  if (is_none)
    return {"gpu", Health::kGood, answer.text, "not needed: tissue is computed on the processor", ""};
  return {"gpu", Health::kLimited, answer.text, "tissue is computed on the processor",
          "update NVIDIA's driver, restart, and look again (docs/gpu.md)"};
}

Finding CheckDisplay() {
  Finding finding{
      "display", Health::kMissing, "",
      "the window cannot open here; trocar demo, play and simulate need no display",
      "log in to a desktop, or set DISPLAY or WAYLAND_DISPLAY; without one, use ./run --headless"};
  const std::string wayland = ReadEnvironment("WAYLAND_DISPLAY");
  if (!wayland.empty()) {
    const fs::path socket =
        fs::path(ReadEnvironment("XDG_RUNTIME_DIR")) / wayland;  // an absolute name stays as it is
    if (CanConnect(socket.string(), false)) {
      return {"display", Health::kGood, "Wayland, " + wayland, "the window can open", ""};
    }
    finding.found = "WAYLAND_DISPLAY is " + wayland + " and nothing listens there";
  }
  const std::string display = ReadEnvironment("DISPLAY");
  if (!display.empty()) {
    const std::size_t colon = display.rfind(':');
    const std::string host = display.substr(0, std::min(colon, display.size()));
    const std::string number =
        colon == std::string::npos ? "" : display.substr(colon + 1, display.find('.', colon) - colon - 1);
    const std::string socket = "/tmp/.X11-unix/X" + number;
    if (!host.empty() && host != "unix") {
      return {"display", Health::kLimited, "X11 on another computer, " + display,
              "the window can open if that computer lets it; drawing over a network is slow", ""};
    }
    if (!number.empty() && (CanConnect(socket, false) || CanConnect(socket, true))) {
      return {"display", Health::kGood, "X11, " + display, "the window can open", ""};
    }
    finding.found = "DISPLAY is " + display + " and nothing listens there";
  }
  if (finding.found.empty()) finding.found = "neither DISPLAY nor WAYLAND_DISPLAY is set";
  finding.health = Health::kLimited;
  return finding;
}

Finding CheckWindow(const fs::path& program_folder) {
  if (::access((program_folder / "trocar-window").c_str(), X_OK) == 0) {
    return {"window", Health::kGood, "trocar-window lies beside this program", "trocar window can start it",
            ""};
  }
  return {"window", Health::kLimited, "trocar-window is not beside this program",
          "trocar window does not work",
          "build it: install libgtkmm-4.0-dev (tools/install-packages) and run ./run"};
}

Finding CheckImageReader(const fs::path& program_folder) {
  for (const fs::path& program :
       {program_folder / "trocar-import", program_folder.parent_path() / "libexec/trocar/trocar-import"}) {
    if (::access(program.c_str(), X_OK) == 0)
      return {"images", Health::kGood, "trocar-import can be started", "images can be read", ""};
  }
  return {"images", Health::kMissing, "trocar-import is not beside this program",
          "no image and no label map can be read: trocar anatomy images, build, contours, from-labels do not "
          "work",
          "build it: run ./run, or ninja trocar-import"};
}

Finding CheckSupervisor(const fs::path& program_folder) {
  for (const fs::path& program : {program_folder / "trocar-supervisor",
                                  program_folder.parent_path() / "libexec/trocar/trocar-supervisor"}) {
    if (::access(program.c_str(), X_OK) == 0)
      return {"haptics", Health::kGood, "trocar-supervisor can be started", "haptic devices may push back",
              ""};
  }
  return {"haptics", Health::kLimited, "trocar-supervisor is not beside this program",
          "haptic devices move the tools, but without force",
          "build it: run ./run, or ninja trocar-supervisor"};
}

Finding CheckProcessor() {
  std::vector<std::string> levels;
  for (const base::SimdLevel level : base::ListSimdLevels()) levels.emplace_back(base::SimdLevelName(level));
  Finding finding{
      "processor", Health::kGood,
      std::string(base::SimdLevelName(base::FindSimdLevel())) + "; this processor has " + Join(levels),
      "the widest vector instructions that there are", ""};
  if (base::FindSimdLevel() != base::FindWidestSimdLevel()) {
    finding.health = Health::kLimited;
    finding.meaning = "TROCAR_SIMD asks for narrower vector instructions: ticks take longer";
    finding.remedy = "leave TROCAR_SIMD unset where nothing is to be compared";
  }
  return finding;
}

Finding CheckRealTime() {
  rlimit limit{};
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  const std::string allowed = limit.rlim_cur == RLIM_INFINITY
                                  ? "unlimited"
                                  : std::to_string(static_cast<unsigned long>(limit.rlim_cur));
  const ChildAnswer answer = AskChild(TryRealTime, kDriverTimeout);
  if (answer.end == ChildEnd::kAnswered) {
    return {"real-time", Health::kGood,
            "priority " + std::to_string(sched_get_priority_min(SCHED_FIFO) + kWantedAboveLowest) +
                " granted (limit " + allowed + ")",
            "simulation and force feedback run before drawing, so that their ticks are even", ""};
  }
  return {"real-time", Health::kLimited, answer.text + " (limit " + allowed + ")",
          "ticks and forces may come late while the same processor cores draw",
          "put \"@audio - rtprio 70\" into /etc/security/limits.d/trocar.conf, add yourself to the group "
          "audio, log in "
          "again"};
}

Finding CheckInputDevices(const fs::path& root) {
  // the desktop hands mouse and keyboard to the window; the kernel's own list tells whether there are any
  std::vector<std::string> devices;
  for (const std::string& name : ListNames(root / "sys/class/input", "event")) {
    devices.push_back(ReadFirstLine(root / "sys/class/input" / name / "device/name"));
  }
  std::erase(devices, "");
  if (devices.empty()) {
    return {"input", Health::kLimited, "no input device",
            "neither mouse nor keyboard can hold the instruments",
            "connect a mouse and a keyboard, use a device of trocar devices list, or the script of a scene"};
  }
  return {"input", Health::kGood, Join(devices), "mouse and keyboard drive the hands, through the desktop",
          ""};
}

Finding CheckSerialDevices(const fs::path& root) {
  std::vector<std::string> devices, locked;
  for (const char* prefix : {"ttyACM", "ttyUSB"}) {
    for (const std::string& name : ListNames(root / "dev", prefix)) {
      const bool is_open = ::access((root / "dev" / name).c_str(), R_OK | W_OK) == 0;
      (is_open ? devices : locked).push_back("/dev/" + name);
    }
  }
  if (!locked.empty()) {
    return {"serial", Health::kLimited, Join(locked) + " may not be opened by you",
            "a tracker or jaw sensor on that line cannot be read",
            "add yourself to the group dialout (sudo usermod -aG dialout $USER) and log in again"};
  }
  if (devices.empty()) {
    return {"serial", Health::kGood, "no serial device",
            "not needed: only trackers and jaw sensors use one (docs/devices.md)", ""};
  }
  return {"serial", Health::kGood, Join(devices),
          "can be opened; trocar devices test shows what a tracker or jaw sensor there says", ""};
}

Finding CheckThreeDMouse(const fs::path& root) {
  for (const std::string& name : ListNames(root / "sys/class/input", "event")) {
    const fs::path device = root / "sys/class/input" / name / "device";
    if (!IsThreeDMouse(ReadFirstLine(device / "id/vendor"), ReadFirstLine(device / "id/product"))) continue;
    // the service reads it, so that it does not matter whether you may
    return {"3d-mouse", Health::kGood, ReadFirstLine(device / "name"),
            "holds an instrument with --device spacemouse while the service spacenavd runs; trocar devices "
            "list says "
            "whether it does",
            ""};
  }
  return {"3d-mouse", Health::kGood, "no 3-D mouse",
          "not needed: mouse and keyboard hold the instruments too", ""};
}

Finding CheckSound(const fs::path& root, const std::string& speaker) {
  const std::string output = sound::FindSoundOutput(root);
  if (output.empty()) {
    return {"sound", Health::kLimited, "no sound card", "the simulator's window is silent; all else works",
            "connect a sound card, or log in where PulseAudio or PipeWire runs"};
  }
  if (speaker.empty()) {
    return {"sound", Health::kLimited, output + "; no espeak-ng", "tones are heard, words are not spoken",
            "install the package espeak-ng"};
  }
  return {"sound", Health::kGood, output + "; " + speaker,
          "the window sounds current, clips and pulse, and speaks", ""};
}

Finding CheckDataFolder() {
  const base::Result<fs::path> folder = host::FindDataFolder();
  const std::string remedy =
      "set TROCAR_DATA_DIR to the folder that holds assets/ and scenes/, or restore both from the repository";
  if (!folder)
    return {"data", Health::kMissing, folder.error().Text(), "the built-in patient cannot be found", remedy};
  const base::Result<scene::Scene> scene = files::ReadScene(*folder / "scenes/demonstration.json");
  if (!scene) {
    return {"data", Health::kMissing, scene.error().Text(), "the built-in scene cannot be read", remedy};
  }
  std::size_t triangles = 0;
  for (const auto& organ : scene->patient.organs) triangles += organ.mesh.triangles.size();
  return {"data", Health::kGood,
          folder->string() + ": " + std::to_string(scene->patient.organs.size()) + " organs, " +
              std::to_string(triangles) + " triangles",
          "the built-in patient is whole", ""};
}

std::vector<Finding> CheckAll() {
  return {CheckDataFolder(),
          CheckOpenGl(),
          CheckVideoEncoder(),
          CheckDisplay(),
          CheckWindow(host::FindProgramFolder()),
          CheckImageReader(host::FindProgramFolder()),
          CheckSupervisor(host::FindProgramFolder()),
          CheckGpu(),
          CheckProcessor(),
          CheckRealTime(),
          CheckInputDevices("/"),
          CheckSerialDevices("/"),
          CheckThreeDMouse("/"),
          CheckSound("/", sound::FindSpeechProgram())};
}

}  // namespace trocar::doctor
