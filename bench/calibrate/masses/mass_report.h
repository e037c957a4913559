// SPDX-License-Identifier: Apache-2.0
/// @file
/// What an identification of masses says, for people.
#pragma once

#include <string>

#include "bench/calibrate/masses/masses.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {

/// The bodies' numbers, which have no errors, as torques do not show them one by one.
std::string body_table(const IdentifiedMasses& m, TableFormat format);

/// What they are good for, joint by joint; and in sentences what was shown, and what nobody can
/// see.
std::string mass_report(const IdentifiedMasses& m);

}  // namespace tauext
