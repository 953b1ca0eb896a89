// The process between Mottle and a program: waits for the program and, once Mottle asks or dies, ends all of it.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace mottle::drivers {

/// What the guard says at the end.
struct GuardMessage {
  int wait_status = 0;
  int start_error = 0;    ///< errno where the program could not be started
  bool is_asked = false;  ///< the guard got SIGTERM
};

/// A program's start in plain pointers: nothing is allocated after the fork.
struct ProgramStart {
  std::vector<std::string> texts = {};
  std::vector<char*> arguments = {};
  std::vector<char*> environment = {};
  std::string program = {};
  std::string directory = {};
  std::string output = {};
  std::string error = {};
};

/// Starts the program and waits for its end, in a process of its own that has just been forked. SIGTERM, of Mottle or
/// of its death, ends the program's group: first asked, after the grace or a second SIGTERM killed.
///
/// @param pipe    end for writing; gets a GuardMessage and stays open until then
/// @param mottle  id of the process that forked
[[noreturn]] void guard(const ProgramStart& start, int pipe, pid_t mottle, std::chrono::milliseconds grace);

}  // namespace mottle::drivers
