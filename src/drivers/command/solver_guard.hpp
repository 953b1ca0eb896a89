// The process between Mottle and a program: waits for the program and, once Mottle asks or dies, ends all of it.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace mottle::drivers {

/// What the guard says at the end of a program.
struct GuardMessage {
  int wait_status = 0;
  int start_error = 0;    ///< errno where the program could not be started
  bool is_asked = false;  ///< the guard got SIGTERM
};

/// A program's start, for guard_request().
struct ProgramStart {
  std::string program = {};
  std::string directory = {};
  std::string output = {};  ///< files of the directory
  std::string error = {};
  std::vector<std::string> arguments = {};    ///< the program's name first
  std::vector<std::string> environment = {};  ///< "NAME=value"
  std::chrono::milliseconds grace = {};       ///< from asking the program to end to ending it
};

/// The bytes that ask a guard to run a program.
std::string guard_request(const ProgramStart& start);

/// The life of a guard, in a process of its own that has just been forked: runs programs one after the other, each on a
/// guard_request() that it reads from the socket, and answers each with a GuardMessage. It ends once the socket is
/// closed. SIGTERM, of Mottle or of its death, ends the program's group: first asked, after the grace or a second
/// SIGTERM killed. A SIGTERM that comes between two programs is told at the next, which is not started.
///
/// @param mottle  id of the process that forked
[[noreturn]] void guard(int socket, pid_t mottle);

/// A guard and Mottle's end of the socket. The thread that has made it keeps it: the guard ends its program when that
/// thread ends.
class GuardProcess {
 public:
  /// Throws SystemFailure where no process can be started.
  GuardProcess();
  /// Waits for the guard's end, which is at once unless a program is at work.
  ~GuardProcess();
  GuardProcess(const GuardProcess&) = delete;
  GuardProcess& operator=(const GuardProcess&) = delete;

  pid_t id() const { return id_; }
  int socket() const { return socket_; }
  /// Whether the guard was there to take it.
  bool send(const std::string& request) const;

 private:
  int socket_ = -1;
  pid_t id_ = -1;
};

}  // namespace mottle::drivers
