// SPDX-License-Identifier: Apache-2.0
// What a call throws, as text: error messages are part of the interface.
#pragma once

#include <exception>
#include <string>

namespace tauext::test {

template <class Call>
std::string error_of(Call&& call) {
  try {
    call();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace tauext::test
