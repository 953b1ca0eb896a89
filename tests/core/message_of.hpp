// The message of the error that a call throws, for tests of what users are told.
#pragma once

#include <string>

#include "mottle/core/error.hpp"

namespace mottle::test {

/// what() of the Expected that `call` throws; "nothing thrown" where it throws none. Other errors pass through.
template <typename Expected, typename Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const Expected& error) {
    return error.what();
  }
  return "nothing thrown";
}

}  // namespace mottle::test
