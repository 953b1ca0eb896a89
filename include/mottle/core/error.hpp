// The errors that cross a layer's border. Each says by its type who can act on it; the command turns the
// type into an exit code. A failed model run is not here: it is a value (model/model.hpp).
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace mottle {

/// Base of every error that Mottle throws; what() is one complete message for the user.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user's input is wrong and the user can mend it: says where, what was found, what is allowed. Exit code 2.
class InvalidInput : public Error {
 public:
  using Error::Error;
};

/// A file cannot be understood; the message starts with "file:line: ". Exit code 2.
class FormatError : public InvalidInput {
 public:
  /// @param line  counted from 1; 0 where the fault belongs to the file as a whole
  FormatError(const std::string& file, int line, const std::string& message)
      : InvalidInput(line > 0 ? fmt::format("{}:{}: {}", file, line, message) : fmt::format("{}: {}", file, message)) {}
};

/// A solver or the file system failed although the input is sound (full disk, lost folder). Exit code 3.
class SystemFailure : public Error {
 public:
  using Error::Error;
};

/// The model gives no answer where a method needs one: its runs fail there. The machine is sound, so a method may look
/// elsewhere. Exit code 3.
class ModelFailure : public SystemFailure {
 public:
  using SystemFailure::SystemFailure;
};

/// The run was asked to stop (signal) and can be resumed. Exit code 4.
class Stopped : public Error {
 public:
  using Error::Error;
};

/// Throws InvalidInput with the formatted message unless `claim` holds.
template <typename... Arguments>
void require(bool claim, fmt::format_string<Arguments...> message, Arguments&&... arguments) {
  if (!claim) throw InvalidInput(fmt::format(message, std::forward<Arguments>(arguments)...));
}

}  // namespace mottle
