// SPDX-License-Identifier: Apache-2.0
/// \file stand_in_page.h  The stand-in's state in a file that it shares with a test, where the library lives in another process.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <new>

#include "stand_in_hd.h"
#include "trocar_test/temporary_folder.h"

/// As long as it lives, every stand-in that this process or its children load has its state here.
class StandInPage {
 public:
  StandInPage() {
    const std::filesystem::path path = folder_.Path() / "page";
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    EXPECT_EQ(::ftruncate(file, sizeof(StandInState)), 0);
    void* memory = ::mmap(nullptr, sizeof(StandInState), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    EXPECT_NE(memory, MAP_FAILED);
    state_ = new (memory) StandInState;
    ::setenv(kStandInPage, path.c_str(), 1);
  }
  ~StandInPage() {
    ::unsetenv(kStandInPage);
    ::munmap(state_, sizeof(StandInState));
  }
  StandInPage(const StandInPage&) = delete;
  StandInPage& operator=(const StandInPage&) = delete;

  StandInState* Get() const { return state_; }

 private:
  trocar::test::TemporaryFolder folder_;
  StandInState* state_ = nullptr;
};
