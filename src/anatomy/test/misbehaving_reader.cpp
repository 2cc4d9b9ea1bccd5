// SPDX-License-Identifier: Apache-2.0
/// \file misbehaving_reader.cpp  Speaks import_protocol.h and does what a reader must not; what, its own name
/// says.
#include <dirent.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "import_protocol.h"
#include "import_socket.h"

extern char** environ;

namespace {

using namespace trocar::anatomy;

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
    Send(reply);
  }
  return 0;
}
