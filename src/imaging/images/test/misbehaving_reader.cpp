// SPDX-License-Identifier: Apache-2.0
/// \file misbehaving_reader.cpp  Speaks import_protocol.h and does what a reader must not; what, its own name
/// says.
#include <dirent.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "import_protocol.h"
#include "import_socket.h"
#include "reader.h"

extern char** environ;

namespace {

using namespace trocar::images;

/// A good reply.
ImportReply MakeReply() {
  ImportReply reply;
  ImageHeader& header = reply.header;
  header.kind = FileKind::kPng;
  header.width = 8, header.height = 6, header.depth = 1, header.channels = 1, header.bits = 8;
  return reply;
}

/// What came with it from its parent: open descriptors and variables.
std::string Spy() {
  std::string seen = "descriptors";
  DIR* folder = ::opendir("/proc/self/fd");
  while (const dirent* entry = ::readdir(folder)) {
    if (entry->d_name[0] != '.' && std::atoi(entry->d_name) != ::dirfd(folder))
      seen += std::string(" ") + entry->d_name;
  }
  ::closedir(folder);
  seen += " variables";
  for (char** variable = environ; *variable != nullptr; ++variable)
    seen += " " + std::string(*variable, std::strcspn(*variable, "="));
  return seen;
}

/// Enters the real sandbox and tries what it must not allow.
std::string TryInsideSandbox() {
  import::EnterSandbox(std::uint64_t{256} << 20);
  std::string could;
  const auto note = [&](const char* what, bool is_possible) {
    could += is_possible ? std::string(" ") + what : "";
  };
  note("socket", ::socket(AF_UNIX, SOCK_STREAM, 0) >= 0);
  note("write", ::open("trocar-sandbox-test", O_WRONLY | O_CREAT, 0600) >= 0);
  char* const none[] = {nullptr};
  ::execve("/bin/true", none, none);  // on success there is no reply at all
  note("remove", ::unlink("trocar-sandbox-none") == 0 || errno != EPERM);
  void* memory = std::malloc(std::size_t{1} << 30);
  note("memory", memory != nullptr);
  std::free(memory);
  note("read", ::open("/proc/self/exe", O_RDONLY) >= 0);
  return "could" + could;
}

void Send(const ImportReply& reply) {
  SendMessage(kImportSocket, &reply, sizeof(reply), {});
}

}  // namespace

int main(int, char** argv) {
  const std::string path = argv[0];
  const std::string how = path.substr(path.rfind('/') + 1);
  ImportRequest request;
  std::array<Descriptor, kMostDescriptors> descriptors;
  while (ReceiveMessage(kImportSocket, &request, sizeof(request), descriptors)) {
    ImportReply reply = MakeReply();
    if (how == "hang") ::pause();
    if (how == "crash") std::raise(SIGSEGV);
    if (how == "leave") return 3;
    if (how == "eat") return kExitOutOfMemory;
    if (how == "killed") std::raise(SIGKILL);
    if (how == "short") {
      SendMessage(kImportSocket, "no", 2, {});
      continue;
    }
    if (how == "noise") std::memset(static_cast<void*>(&reply), 0x5a, sizeof(reply));
    if (how == "huge") reply.header.width = reply.header.height = 16384, reply.header.depth = 16384;
    if (how == "wide") reply.header.width = 4000000000u;
    if (how == "empty") reply.header.height = 0;
    if (how == "nan") reply.header.spacing[1] = std::nan("");
    if (how == "path") std::strcpy(reply.header.data_file, "../secret");
    if (how == "unterminated") std::memset(reply.why, 'a', sizeof(reply.why));
    if (how == "segments") reply.header.segments = 1000000;
    if (how == "code") reply.code = 1;
    if (how == "control") reply.code = 11, std::strcpy(reply.why, "red \x1b[31m\ntext");
    if (how == "spy") reply.code = 11, Spy().copy(reply.why, sizeof(reply.why) - 1);
    if (how == "boxed") reply.code = 11, TryInsideSandbox().copy(reply.why, sizeof(reply.why) - 1);
    Send(reply);
  }
  return 0;
}
