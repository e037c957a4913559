// SPDX-License-Identifier: Apache-2.0
/// @file
/// A program that is told to end takes its children and its folders with it.
#pragma once

#include <sys/types.h>

#include <string>

namespace tauext::gate {

/// From now on SIGINT, SIGTERM and SIGHUP end the children that are listed, remove the folders that
/// are, and then the program. To be called before there are threads.
void end_with_children_and_folders();

/// Lists a child while it is there.
class ListedChild {
 public:
  explicit ListedChild(pid_t pid);
  ~ListedChild();
  ListedChild(const ListedChild&) = delete;
  ListedChild& operator=(const ListedChild&) = delete;

 private:
  pid_t pid_;
};

/// Lists a folder, or takes it from the list.
void list_folder(const std::string& path);
void unlist_folder(const std::string& path);

}  // namespace tauext::gate
