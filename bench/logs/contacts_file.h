// SPDX-License-Identifier: Apache-2.0
/// @file
/// Contacts that are labelled in a file beside the recordings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tauext {

/// One of them, from a time to a time, both included.
struct LabelledContact {
  double from = 0, to = 0;  ///< [s] of the recording's own time
  std::uint8_t what = 1;    ///< as Trace::contact has it
  long line = 0;            ///< of the file, from 1
};

/// CSV with the columns `file`, `start` and `end` [s], and maybe `kind`: collision (also
/// accidental), which is what no kind means, or intended (intentional). A file is known by its name
/// or its path. A line without times says that nothing touches the arm in that file. Lines of other
/// files are left out, and standard error tells it.
class ContactsFile {
 public:
  /// @param logs all recordings that are read beside it
  /// @throws std::runtime_error or std::invalid_argument naming the path and the line: unreadable,
  /// no such columns, no number, an end before its start, contacts of a file that overlap, a file
  /// that is more than one of these; or one of these without a line
  ContactsFile(const std::string& path, const std::vector<std::string>& logs);

  const std::string& path() const { return path_; }  ///< its own
  /// Those of one of the recordings, by time.
  const std::vector<LabelledContact>& of(const std::string& log) const;

 private:
  struct OfLog {
    std::string log, canonical, name;  // its path as it was given, the only one, and its end
    std::vector<LabelledContact> contacts;
    bool named = false;
    long free = 0;  // line that says that nothing touches the arm in it; 0: none does
  };

  [[noreturn]] void fail(long line, const std::string& what) const;
  void read(const std::string& text);
  OfLog* find(const std::string& file, long line);
  void require_apart(OfLog& log) const;

  std::string path_;
  std::vector<OfLog> logs_;
};

/// Nothing, if there is no path.
std::shared_ptr<const ContactsFile> contacts_of(const std::string& path,
                                                const std::vector<std::string>& logs);

/// The labels of one recording, sample by sample.
class ContactLabels {
 public:
  /// Those of that log.
  ContactLabels(const ContactsFile& file, const std::string& log);

  /// The label at that time [s], which is the next one: as Trace::contact has it.
  /// @throws std::invalid_argument naming the line of a contact that begins before the first
  /// sample, or has none in it
  std::uint8_t at(double t);
  /// No sample follows.
  /// @throws std::invalid_argument likewise, also for one that goes on behind the last sample
  void finish();

 private:
  [[noreturn]] void fail(const LabelledContact& c, const std::string& what) const;
  [[noreturn]] void fail_empty(const LabelledContact& c) const;

  const ContactsFile& file_;
  std::string log_;
  const std::vector<LabelledContact>& contacts_;
  std::size_t next_ = 0;
  bool any_ = false, seen_ = false;  // a sample; one of the next contact
  double first_ = 0, last_ = 0;      // [s]
};

}  // namespace tauext
