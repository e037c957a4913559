// SPDX-License-Identifier: Apache-2.0
/// @file
/// Text from outside, for a terminal that should not obey it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tauext {

/// The text with ? for every control character, also those that turn the direction of writing, and
/// for every byte that is no UTF-8; line ends stay.
std::string printable(std::string_view text);

/// The same of a name: in one line, and at most so many bytes of it.
std::string printable_name(std::string_view text, std::size_t most = 60);

/// The same of a text that came in several lines, with "; " between them, cut where it is too long.
std::string one_line(std::string_view text, std::size_t most = 1000);

/// Says a line on standard error, printable, in the place of a progress line that a terminal shows.
void say(std::string_view line);

}  // namespace tauext
