// SPDX-License-Identifier: Apache-2.0
/// @file
/// A bag of ROS 2 as it lies on the disk: a file, which may be compressed as a whole, or a folder
/// of several.
#pragma once

#include <memory>
#include <string>

#include "mjcf/trace/read/bag/bag_messages.h"

namespace tauext {

/// Whether this is one: its first bytes, unpacked, are those of a storage of ROS 2; or it is a
/// folder with such files or with a metadata.yaml.
bool is_bag(const std::string& path);

/// Opens it, and chooses a topic (BagMessages::choose). The parts of a folder follow each other as
/// its metadata.yaml lists them or, without one, by the numbers in their names. A compressed file
/// is unpacked into a file without a name, in the folder for temporary files ($TMPDIR), which ends
/// with the process.
/// @throws std::runtime_error naming the path and what is wrong: unreadable, no bag, a part that
/// metadata.yaml names and that is not there, no such topic
std::unique_ptr<BagMessages> open_bag(const std::string& path, const std::string& topic);

}  // namespace tauext
