// SPDX-License-Identifier: Apache-2.0
#include "driver.h"

#include <dlfcn.h>

#include <utility>

namespace trocar::tissue_cuda {

using base::Error;
using base::ErrorCode;
using base::Status;

namespace {

constexpr const char* kCpuGoesOn = "; tissue is computed on the processor";

std::string VersionText(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

std::string CodeName(const DriverFunctions& driver, CudaCode code) {
  const char* name = nullptr;
  if (driver.get_error_name != nullptr && driver.get_error_name(code, &name) == kCudaSuccess &&
      name != nullptr) {
    return std::string(name) + " (" + std::to_string(code) + ")";
  }
  return "error " + std::to_string(code);
}

/// Starts the driver and looks at the first GPU.
struct FoundGpu {
  GpuInformation information;
  CudaDevice device = 0;
  int max_shared_bytes = 0;
};

base::Result<FoundGpu> LookAtGpu(const DriverFunctions& driver, const DriverSource& source) {
  const CudaCode started = driver.init(0);
  if (started == kCudaNoDevice)
    return Error{ErrorCode::kGpuMissing, std::string("the NVIDIA driver sees no GPU") + kCpuGoesOn};
  if (started == kCudaDriverMismatch) {
    return Error{
        ErrorCode::kGpuTooOld,
        std::string("the NVIDIA driver's parts have different versions: restart the computer") + kCpuGoesOn};
  }
  if (Status status = CheckCall(driver, started, "starting the NVIDIA driver"); !status)
    return status.error();
  FoundGpu found;
  GpuInformation& information = found.information;
  int count = 0;
  if (Status status = CheckCall(driver, driver.get_device_count(&count), "counting GPUs"); !status)
    return status.error();
  if (count == 0)
    return Error{ErrorCode::kGpuMissing, std::string("the NVIDIA driver sees no GPU") + kCpuGoesOn};
  if (Status status = CheckCall(driver, driver.get_version(&information.driver_version),
                                "asking for the driver's version");
      !status) {
    return status.error();
  }
  char name[256] = "";
  CudaCode code = driver.get_device(&found.device, 0);
  if (code == kCudaSuccess) code = driver.get_device_name(name, sizeof name - 1, found.device);
  if (code == kCudaSuccess) code = driver.get_device_memory(&information.memory_bytes, found.device);
  int major = 0, minor = 0, is_cooperative = 0, clock_khz = 0, bus_bits = 0;
  const std::pair<int*, int> questions[] = {{&information.multiprocessors, kMultiprocessorCount},
                                            {&major, kCapabilityMajor},
                                            {&minor, kCapabilityMinor},
                                            {&is_cooperative, kCooperativeLaunch},
                                            {&found.max_shared_bytes, kMaxSharedBytesPerBlock}};
  for (const auto& question : questions) {
    if (code == kCudaSuccess)
      code = driver.get_device_attribute(question.first, question.second, found.device);
  }
  if (Status status = CheckCall(driver, code, "asking what the GPU is"); !status) return status.error();
  information.name = name;
  information.compute_capability = 10 * major + minor;
  // newer drivers may not tell; the roof is then unknown
  if (driver.get_device_attribute(&clock_khz, kMemoryClockRate, found.device) == kCudaSuccess &&
      driver.get_device_attribute(&bus_bits, kMemoryBusWidth, found.device) == kCudaSuccess) {
    information.memory_bandwidth = 2.0 * 1e3 * clock_khz * bus_bits / 8.0;  // two transfers a clock
  }
  if (information.compute_capability < kOldestCapability || is_cooperative == 0) {
    return Error{ErrorCode::kGpuTooOld, "the GPU \"" + information.name + "\" has compute capability " +
                                            std::to_string(major) + "." + std::to_string(minor) +
                                            ", and 7.5 is needed" + kCpuGoesOn};
  }
  if (source.code.empty()) {
    return Error{ErrorCode::kGpuMissing,
                 "the GPU \"" + information.name +
                     "\" is there, and this build has no GPU code: nvcc was not found when it "
                     "was configured (docs/gpu.md)" +
                     kCpuGoesOn};
  }
  if (information.driver_version / 1000 < source.code_version / 1000) {
    return Error{ErrorCode::kGpuTooOld,
                 "the NVIDIA driver knows CUDA " + VersionText(information.driver_version) +
                     ", and this build's GPU code is of CUDA " + VersionText(source.code_version) +
                     ": update the driver" + kCpuGoesOn};
  }
  return found;
}

}  // namespace

base::Result<DriverFunctions> LoadDriver(const DriverSource& source) {
  if (source.functions) return *source.functions;
  // never closed: NVIDIA's driver does not like to be unloaded
  void* const handle = ::dlopen(source.file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    return Error{ErrorCode::kGpuMissing,
                 "no NVIDIA driver (libcuda.so.1) is installed" + std::string(kCpuGoesOn)};
  }
  DriverFunctions driver;
  const char* missing = nullptr;
#define TROCAR_FIND(name, symbol, arguments)                                       \
  driver.name = reinterpret_cast<decltype(driver.name)>(::dlsym(handle, #symbol)); \
  if (driver.name == nullptr) missing = #symbol;
  TROCAR_DRIVER_FUNCTIONS(TROCAR_FIND)
#undef TROCAR_FIND
  if (missing != nullptr) {
    return Error{ErrorCode::kGpuTooOld,
                 "the NVIDIA driver lacks " + std::string(missing) + ": update it" + kCpuGoesOn};
  }
  return driver;
}

Status CheckCall(const DriverFunctions& driver, CudaCode code, const char* what) {
  if (code == kCudaSuccess) return {};
  if (code == kCudaOutOfMemory) {
    return Error{
        ErrorCode::kGpuMemory,
        std::string(what) + ": the GPU's memory is full; close other programs that use it" + kCpuGoesOn};
  }
  return Error{ErrorCode::kGpuFailed,
               std::string(what) + ": the NVIDIA driver answers " + CodeName(driver, code) + kCpuGoesOn};
}

base::Result<GpuInformation> FindGpu(const DriverSource& source) {
  const base::Result<DriverFunctions> driver = LoadDriver(source);
  if (!driver) return driver.error();
  base::Result<FoundGpu> found = LookAtGpu(*driver, source);
  if (!found) return found.error();
  return std::move(found->information);
}

base::Result<GpuInformation> FindGpu() {
  return FindGpu(BuiltInSource());
}

base::Result<std::unique_ptr<Gpu>> Gpu::Open(const DriverSource& source) {
  std::unique_ptr<Gpu> gpu(new Gpu());
  if (Status status = gpu->Start(source); !status) return status.error();
  return gpu;
}

Status Gpu::Start(const DriverSource& source) {
  base::Result<DriverFunctions> driver = LoadDriver(source);
  if (!driver) return driver.error();
  driver_ = *driver;
  base::Result<FoundGpu> found = LookAtGpu(driver_, source);
  if (!found) return found.error();
  information_ = found->information;
  device_ = found->device;
  max_shared_bytes_ = found->max_shared_bytes;
  if (Status status = CheckCall(driver_, driver_.retain_context(&context_, device_), "opening the GPU");
      !status) {
    context_ = nullptr;
    return status;
  }
  if (Status status = Enter(); !status) return status;
  const CudaCode loaded = driver_.load_module(&module_, source.code.data());
  if (loaded == kCudaInvalidImage || loaded == kCudaNoBinaryForGpu || loaded == kCudaInvalidPtx ||
      loaded == kCudaUnsupportedPtx) {
    module_ = nullptr;
    return Error{ErrorCode::kGpuTooOld,
                 "the NVIDIA driver (CUDA " + VersionText(information_.driver_version) +
                     ") cannot take this build's GPU code for \"" + information_.name +
                     "\": " + CodeName(driver_, loaded) +
                     "; update the driver, or build with TROCAR_CUDA_ARCHITECTURES for this GPU" +
                     kCpuGoesOn};
  }
  if (Status status = CheckCall(driver_, loaded, "loading the kernels"); !status) {
    module_ = nullptr;
    return status;
  }
  if (Status status = CheckCall(driver_, driver_.create_stream(&stream_, 1), "opening the GPU's queue");
      !status) {
    stream_ = nullptr;
    return status;
  }
  for (CudaEvent& mark : marks_) {
    if (Status status = CheckCall(driver_, driver_.create_event(&mark, 0), "making the GPU's clock");
        !status) {
      mark = nullptr;
      return status;
    }
  }
  return {};
}

Gpu::~Gpu() {
  // whatever fails here fails because the GPU is lost already
  if (context_ == nullptr) return;
  (void)driver_.set_context(context_);
  for (CudaEvent mark : marks_) {
    if (mark != nullptr) (void)driver_.destroy_event(mark);
  }
  if (stream_ != nullptr) (void)driver_.destroy_stream(stream_);
  if (module_ != nullptr) (void)driver_.unload_module(module_);
  (void)driver_.set_context(nullptr);
  (void)driver_.release_context(device_);
}

Status Gpu::Enter() noexcept {
  return CheckCall(driver_, driver_.set_context(context_), "turning to the GPU");
}

base::Result<CudaFunction> Gpu::FindKernel(const std::string& name) {
  CudaFunction kernel = nullptr;
  if (Status status =
          CheckCall(driver_, driver_.get_function(&kernel, module_, name.c_str()), "finding a kernel");
      !status) {
    return status.error();
  }
  return kernel;
}

base::Result<std::uint32_t> Gpu::CountResidentBlocks(CudaFunction kernel, std::uint32_t threads,
                                                     std::uint32_t shared_bytes) {
  if (shared_bytes > static_cast<std::uint32_t>(max_shared_bytes_)) return std::uint32_t{0};
  int blocks = 0;
  CudaCode code =
      driver_.set_function_attribute(kernel, kMaxDynamicSharedBytes, static_cast<int>(shared_bytes));
  if (code == kCudaSuccess)
    code = driver_.count_active_blocks(&blocks, kernel, static_cast<int>(threads), shared_bytes);
  if (Status status = CheckCall(driver_, code, "asking how many blocks run at once"); !status)
    return status.error();
  return static_cast<std::uint32_t>(blocks * information_.multiprocessors);
}

base::Result<CudaAddress> Gpu::Allocate(std::size_t bytes) {
  CudaAddress address = 0;
  if (Status status = CheckCall(driver_, driver_.allocate(&address, bytes), "taking memory of the GPU");
      !status)
    return status.error();
  return address;
}

void Gpu::Free(CudaAddress address) noexcept {
  (void)driver_.free(address);
}

base::Result<void*> Gpu::AllocateHost(std::size_t bytes) {
  void* address = nullptr;
  if (Status status =
          CheckCall(driver_, driver_.allocate_host(&address, bytes, 0), "taking memory to copy from");
      !status) {
    return status.error();
  }
  return address;
}

void Gpu::FreeHost(void* address) noexcept {
  (void)driver_.free_host(address);
}

Status Gpu::CopyToGpu(CudaAddress to, const void* from, std::size_t bytes) noexcept {
  if (bytes == 0) return {};
  return CheckCall(driver_, driver_.copy_to(to, from, bytes, stream_), "copying to the GPU");
}

Status Gpu::CopyFromGpu(void* to, CudaAddress from, std::size_t bytes) noexcept {
  if (bytes == 0) return {};
  return CheckCall(driver_, driver_.copy_from(to, from, bytes, stream_), "copying from the GPU");
}

Status Gpu::CopyWithinGpu(CudaAddress to, CudaAddress from, std::size_t bytes) noexcept {
  return CheckCall(driver_, driver_.copy_within(to, from, bytes, stream_), "copying on the GPU");
}

Status Gpu::Clear(CudaAddress address, std::size_t bytes) noexcept {
  return CheckCall(driver_, driver_.fill_bytes(address, 0, bytes, stream_), "clearing memory of the GPU");
}

Status Gpu::Launch(CudaFunction kernel, const LaunchShape& shape, void** arguments) noexcept {
  const CudaCode code = shape.is_cooperative
                            ? driver_.launch_cooperative(kernel, shape.blocks, 1, 1, shape.threads, 1, 1,
                                                         shape.shared_bytes, stream_, arguments)
                            : driver_.launch(kernel, shape.blocks, 1, 1, shape.threads, 1, 1,
                                             shape.shared_bytes, stream_, arguments, nullptr);
  return CheckCall(driver_, code, "starting a kernel");
}

Status Gpu::Finish() noexcept {
  return CheckCall(driver_, driver_.synchronize(stream_), "computing");
}

Status Gpu::Mark(int mark) noexcept {
  return CheckCall(driver_, driver_.record_event(marks_[mark], stream_), "reading the GPU's clock");
}

double Gpu::SecondsBetween(int first, int second) const noexcept {
  float milliseconds = 0;
  if (driver_.elapsed(&milliseconds, marks_[first], marks_[second]) != kCudaSuccess) return 0.0;
  return 1e-3 * static_cast<double>(milliseconds);
}

}  // namespace trocar::tissue_cuda
