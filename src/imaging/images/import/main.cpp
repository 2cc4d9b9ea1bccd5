// SPDX-License-Identifier: Apache-2.0
/// \file main.cpp  trocar-import: answers requests of import_protocol.h on descriptor 3 until it is closed.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <span>
#include <stdexcept>
#include <string_view>

#include "byte_source.h"
#include "import_socket.h"
#include "reader.h"

namespace trocar::images::import {

using base::ErrorCode;

std::uint64_t CheckedProduct(std::initializer_list<std::uint64_t> factors) {
  std::uint64_t product = 1;
  for (const std::uint64_t factor : factors) {
    if (__builtin_mul_overflow(product, factor, &product)) {
      throw Failure{ErrorCode::kImageTooLarge,
                    "its header announces more samples than any computer can hold"};
    }
  }
  return product;
}

void CheckSize(const ImageHeader& header, const ImportRequest& request) {
  if (header.width == 0 || header.height == 0 || header.depth == 0 || header.channels == 0) {
    throw Failure{ErrorCode::kImageUndecodable, "its header announces no pixels"};
  }
  if (header.width > request.most_side || header.height > request.most_side) {
    throw Failure{ErrorCode::kImageTooLarge,
                  "its pictures measure more than " + std::to_string(request.most_side) + " pixels a side"};
  }
  const std::uint64_t bytes = CheckedProduct(
      {header.width, header.height, header.depth, header.channels, SampleBytes(header.samples)});
  if (bytes > request.most_bytes) {
    throw Failure{ErrorCode::kImageTooLarge, "it unpacks to " + std::to_string(bytes >> 20) +
                                                 " MiB, more than the " +
                                                 std::to_string(request.most_bytes >> 20) + " MiB allowed"};
  }
}

void CheckGeometry(const ImageHeader& header) {
  for (int axis = 0; axis < 3; ++axis) {
    const double spacing = header.spacing[axis];
    if (!std::isfinite(spacing)) {
      throw Failure{ErrorCode::kImageGeometryInvalid,
                    "a pixel or slice distance in its header is not a finite number"};
    }
    if (spacing != 0 && !(spacing >= 0.001 && spacing <= 200.0)) {
      char text[32];
      std::snprintf(text, sizeof(text), "%.4g", spacing);
      throw Failure{ErrorCode::kImageGeometryInvalid, "a pixel or slice distance in its header is " +
                                                          std::string(text) +
                                                          " mm, not between 0.001 and 200 mm"};
    }
    bool is_finite = std::isfinite(header.origin[axis]);
    for (const double part : header.direction[axis]) is_finite = is_finite && std::isfinite(part);
    if (!is_finite) {
      throw Failure{ErrorCode::kImageGeometryInvalid, "its position or orientation is not a finite number"};
    }
  }
  if (!std::isfinite(header.slope) || !std::isfinite(header.intercept)) {
    throw Failure{ErrorCode::kImageGeometryInvalid, "the scale of its grey values is not a finite number"};
  }
}

namespace {

/// Memory of the other program, for as long as one picture is decoded.
class SampleMemory {
 public:
  SampleMemory(int fd, std::uint64_t offset, std::uint64_t capacity) {
    // a mapping begins with a page
    const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    const std::uint64_t begin = offset / page * page;
    struct stat info {};
    std::uint64_t end = 0;
    if (__builtin_add_overflow(offset, capacity, &end) || ::fstat(fd, &info) != 0 ||
        static_cast<std::uint64_t>(info.st_size) < end) {
      throw Failure{ErrorCode::kImportCrashed, "the memory for its samples is too small"};
    }
    bytes_ = end - begin;
    void* mapped = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd,
                          static_cast<off_t>(begin));
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    begin_ = static_cast<std::byte*>(mapped);
    samples_ = begin_ + (offset - begin);
  }
  ~SampleMemory() { ::munmap(begin_, bytes_); }
  SampleMemory(const SampleMemory&) = delete;
  SampleMemory& operator=(const SampleMemory&) = delete;
  std::byte* Samples() const { return samples_; }

 private:
  std::byte* begin_ = nullptr;
  std::byte* samples_ = nullptr;
  std::uint64_t bytes_ = 0;
};

InputFile Measure(const Descriptor& descriptor) {
  struct stat info {};
  if (::fstat(descriptor.Get(), &info) != 0 || !S_ISREG(info.st_mode)) {
    throw Failure{ErrorCode::kImagePathUnsafe, "it is no regular file"};
  }
  return {descriptor.Get(), static_cast<std::uint64_t>(info.st_size)};
}

void Read(const Job& job, ImportReply& reply) {
  const FileKind kind = FindKind(job.file);
  if (job.request.operation == ImportOperation::kProbeFrames && kind != FileKind::kDicom)
    throw Failure{ErrorCode::kImageChanged, "it is no longer a DICOM file"};
  switch (kind) {
    case FileKind::kJpeg:
      return ReadPicture(job, FileKind::kJpeg, reply);
    case FileKind::kPng:
      return ReadPicture(job, FileKind::kPng, reply);
    case FileKind::kTiff:
      return ReadPicture(job, FileKind::kTiff, reply);
    case FileKind::kDicom:
      return ReadDicom(job, reply);
    case FileKind::kNifti:
      return ReadNifti(job, reply);
    case FileKind::kNrrd:
      return ReadNrrd(job, reply);
    case FileKind::kMetaImage:
      return ReadMetaImage(job, reply);
    case FileKind::kUnknown:
      break;
  }
  constexpr std::size_t kAnalyzeBytes = 348;
  if (const std::string begin = ReadUnpacked(job.file, kAnalyzeBytes); IsAnalyze(begin)) {
    if (begin.size() < kAnalyzeBytes)
      throw Failure{ErrorCode::kImageUndecodable, "it begins like NIfTI and ends within its header"};
    throw Failure{
        ErrorCode::kImageGeometryInvalid,
        "its header has no NIfTI mark, as those of ANALYZE 7.5, which leave open which side is left"};
  }
  if (IsGzip(job.file))
    throw Failure{ErrorCode::kImageUndecodable, "what gzip has packed in it is no NIfTI file"};
  throw Failure{ErrorCode::kImageUndecodable,
                "it is no DICOM, NIfTI, NRRD, MetaImage, PNG, JPEG or TIFF file"};
}

void Answer(const ImportRequest& request, std::span<const Descriptor> descriptors, ImportReply& reply) {
  Job job;
  job.request = request;
  job.file = Measure(descriptors[0]);
  if (request.has_data_file != 0) job.data_file = Measure(descriptors[1]);
  std::optional<SampleMemory> memory;
  if (request.operation != ImportOperation::kProbe) {
    memory.emplace(descriptors[request.has_data_file != 0 ? 2 : 1].Get(), request.offset, request.capacity);
    job.samples = memory->Samples();
    if (request.operation == ImportOperation::kDecode)
      job.request.most_bytes = std::min(request.most_bytes, request.capacity);
  }
  Read(job, reply);
}

ImportReply MakeReply(const ImportRequest& request, std::span<const Descriptor> descriptors) {
  ImportReply reply;
  const auto fail = [&](ErrorCode code, std::string_view why) {
    reply.code = static_cast<std::int32_t>(code);
    why.copy(reply.why, sizeof(reply.why) - 1);
  };
  // what libraries say may quote the file: only our own words go out
  try {
    Answer(request, descriptors, reply);
  } catch (const Failure& failure) {
    fail(failure.code, failure.why);
  } catch (const std::bad_alloc&) {
    fail(ErrorCode::kImportOutOfMemory, "it needs more memory than its reader may have");
  } catch (const std::length_error&) {
    fail(ErrorCode::kImportOutOfMemory, "it needs more memory than its reader may have");
  } catch (const std::exception&) {
    fail(ErrorCode::kImageUndecodable, "its decoder refuses it as damaged or of an unknown kind");
  }
  return reply;
}

int Serve() {
  for (;;) {
    ImportRequest request;
    std::array<Descriptor, kMostDescriptors> descriptors;
    if (!ReceiveMessage(kImportSocket, &request, sizeof(request), descriptors)) return 0;
    if (request.version != kImportVersion) return 1;
    // should the other program die while this one hangs, nobody else would end it
    ::alarm(request.seconds);
    const ImportReply reply = MakeReply(request, descriptors);
    ::alarm(0);
    if (!SendMessage(kImportSocket, &reply, sizeof(reply), {})) return 0;
  }
}

}  // namespace
}  // namespace trocar::images::import

int main(int argc, char** argv) {
  std::uint64_t memory_bytes = 0;
  const std::string_view text = argc == 2 ? argv[1] : "";
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), memory_bytes);
  if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) {
    std::fputs("trocar-import reads image files for trocar, which starts it; it is of no use by hand\n",
               stderr);
    return 2;
  }
  trocar::images::import::EnterSandbox(memory_bytes);
  return trocar::images::import::Serve();
}
