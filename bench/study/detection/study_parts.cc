// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/study_parts.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <system_error>

#include "bench/roster/threshold_file.h"
#include "bench/score/parallel.h"
#include "bench/study/study_runs.h"
#include "mjcf/trace/digest.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/text.h"

namespace tauext::study {
namespace {

[[noreturn]] void fail_as_system(const std::string& path) {
  throw std::runtime_error(path + ": " + std::error_code(errno, std::generic_category()).message());
}

}  // namespace

Journal::Journal(const std::string& path) : path_(path) {
  refuse_input(path);
  fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd_ < 0) fail_as_system(path);
  if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
  const int why = errno;
  ::close(fd_);
  if (why == EWOULDBLOCK) throw std::runtime_error(path + ": another program is writing it");
  throw std::runtime_error(path + ": cannot be locked against other writers (" +
                           std::error_code(why, std::generic_category()).message() +
                           "); another file system may do that");
}

Journal::~Journal() {
  ::close(fd_);
}

void Journal::cut(std::size_t bytes) {
  if (::ftruncate(fd_, static_cast<off_t>(bytes)) != 0 || ::lseek(fd_, 0, SEEK_END) < 0)
    fail_as_system(path_);
  end_ = bytes;
}

void Journal::add(std::string_view line) {
  if (broken_) throw std::runtime_error(path_ + ": a line could not be written");
  std::string rest(line);
  rest += '\n';
  const std::size_t whole = end_ + rest.size();
  while (!rest.empty()) {
    const ssize_t n = ::write(fd_, rest.data(), rest.size());
    if (n > 0) rest.erase(0, static_cast<std::size_t>(n));
    if (n >= 0 || errno == EINTR) continue;
    const int why = errno;
    broken_ = true;  // nothing may stand behind half a line
    [[maybe_unused]] const int cut = ::ftruncate(fd_, static_cast<off_t>(end_));
    errno = why;
    fail_as_system(path_);
  }
  end_ = whole;
  ::fdatasync(fd_);  // for a machine that is lost
}

namespace {

using Json = nlohmann::ordered_json;

template <class... Args>
[[noreturn]] void fail(const std::string& path, fmt::format_string<Args...> text, Args&&... args) {
  throw std::runtime_error(path + ": " + fmt::format(text, std::forward<Args>(args)...));
}

Json counts_json(const RegionCount& r) {
  return {r.touches, r.found, r.delays, r.moved, r.peaks, r.until_found, r.found_at};
}

RegionCount region_of(const Json& j) {
  RegionCount r;
  j.at(0).get_to(r.touches), j.at(1).get_to(r.found);
  j.at(2).get_to(r.delays), j.at(3).get_to(r.moved), j.at(4).get_to(r.peaks);
  j.at(5).get_to(r.until_found), j.at(6).get_to(r.found_at);
  return r;
}

// counts alone, and of them what is not 0
Json counts_json(const Cell& c) {
  Json j = Json::object();
  for (const auto& [name, count] : kCellCounts) {
    if (c.*count != 0) j[name] = c.*count;
  }
  if (c.quiet_samples != 0) j["quiet_samples"] = c.quiet_samples;
  if (c.alarmed_samples != 0) j["alarmed_samples"] = c.alarmed_samples;
  if (!c.delays.empty()) j["delays"] = c.delays;
  if (c.blows != 0) j["detected_at"] = c.detected_at;
  if (c.quiet_samples != 0) j["alarms_at"] = c.alarms_at;
  for (std::size_t i = 0; i < c.regions.size(); ++i) {
    if (c.regions[i].touches > 0) j["regions"][fmt::to_string(i)] = counts_json(c.regions[i]);
  }
  return j;
}

Cell cell_of(const Json& j) {
  Cell c;
  for (const auto& [name, count] : kCellCounts) c.*count = j.value(name, 0);
  c.quiet_samples = j.value("quiet_samples", 0L);
  c.alarmed_samples = j.value("alarmed_samples", 0L);
  if (j.contains("delays")) j["delays"].get_to(c.delays);
  if (j.contains("detected_at")) j["detected_at"].get_to(c.detected_at);
  if (j.contains("alarms_at")) j["alarms_at"].get_to(c.alarms_at);
  if (!j.contains("regions")) return c;
  c.regions.resize(region_classes().size());
  for (const auto& [i, region] : j["regions"].items())
    c.regions.at(std::stoul(i)) = region_of(region);
  return c;
}

Json counts_json(const Added& added) {
  Json all = Json::object();
  for (const auto& [cell, counts] : added) all[fmt::to_string(cell)] = counts_json(counts);
  return all;
}

Added added_of(const Json& j) {
  Added all;
  for (const auto& [cell, counts] : j.items()) all.emplace_back(std::stoul(cell), cell_of(counts));
  return all;
}

Json first_line(const DetectionStudy& study, const StudyAbout& about, const Shard& shard) {
  Json j = {{"format", kPartFormat},
            {"robot", about.robot->name()},
            {"thresholds_trained_on", about.trained_on},
            {"margin", about.margin},
            {"plan", about.plan},
            {"pieces", study.pieces()}};
  j["cells"] = Json::array();
  for (const Cell& c : study.cells())
    j["cells"].push_back({c.condition, c.estimator, c.detector, c.Ts});
  j["shard"] = {shard.index, shard.count};
  j["context"] = Json::object();
  for (const auto& [key, text] : about.context) j["context"][key] = text;
  return j;
}

std::vector<Cell> cells_of(const Json& first) {
  std::vector<Cell> cells;
  for (const Json& c : first.at("cells")) {
    cells.push_back({.condition = c.at(0).get<std::string>(),
                     .estimator = c.at(1).get<std::string>(),
                     .detector = c.at(2).get<std::string>(),
                     .Ts = c.at(3).get<double>()});
  }
  return cells;
}

// what must be alike in all parts: the programs, too
Json study_of(Json first) {
  first.erase("shard");
  for (const char* of_one : {"date", "cpu"}) first.at("context").erase(of_one);
  return first;
}

// whether a line of ours may have begun so
bool is_begun(const std::string& text) {
  for (const std::string& line :
       {fmt::format("{{\"format\":\"{}\"", kPartFormat), std::string("{\"piece\":")}) {
    if (text.compare(0, line.size(), line, 0, text.size()) == 0) return true;
  }
  return false;
}

// a file of a part as it is
class Part {
 public:
  explicit Part(const std::string& path) : path_(path) {
    std::ifstream in(path);
    if (!in) fail(path, "{}", std::error_code(errno, std::generic_category()).message());
    std::string line;
    while (std::getline(in, line)) {
      if (in.eof()) {  // it has no end: whoever wrote it was killed meanwhile
        if (!is_begun(line)) refuse("its last line is none of ours");
        return;
      }
      take(line);
      end_ += line.size() + 1;
    }
    if (in.bad()) fail(path, "{}", std::error_code(errno, std::generic_category()).message());
  }

  bool empty() const { return first_.is_null(); }
  const Json& first() const { return first_; }
  const std::map<int, Added>& pieces() const { return pieces_; }
  std::size_t end() const { return end_; }  // [bytes] of its whole lines

 private:
  void take(const std::string& line) {
    try {
      const Json j = Json::parse(line);
      if (first_.is_null()) {
        if (j.value("format", "") != kPartFormat)
          throw std::runtime_error(
              fmt::format("its first line has no \"format\": \"{}\"", kPartFormat));
        index_ = j.at("shard").at(0).get<int>(), count_ = j.at("shard").at(1).get<int>();
        cells_ = cells_of(j).size();
        study_of(j), j.at("pieces").get<int>();  // which throw if they are not there
        if (index_ < 1 || count_ < index_) throw std::runtime_error("\"shard\" is no part");
        first_ = j;
        return;
      }
      const int piece = j.at("piece").get<int>();
      if (piece < 0 || piece >= first_.at("pieces").get<int>() || piece % count_ != index_ - 1)
        throw std::runtime_error(fmt::format("piece {} is not of this part", piece));
      Added added = added_of(j.at("adds"));
      for (const auto& [cell, counts] : added) {
        if (cell >= cells_) throw std::runtime_error(fmt::format("there is no cell {}", cell));
      }
      if (!pieces_.emplace(piece, std::move(added)).second)
        throw std::runtime_error(fmt::format("piece {} is there twice", piece));
    } catch (const std::exception& e) {
      refuse(fmt::format("line {}: {}", first_.is_null() ? 1 : pieces_.size() + 2,
                         one_line(e.what())));
    }
  }
  [[noreturn]] void refuse(const std::string& why) const {
    fail(path_, "no part of a study, as tauext-detect --shard writes it: {}", why);
  }

  std::string path_;
  Json first_;
  std::map<int, Added> pieces_;
  std::size_t end_ = 0, cells_ = 0;
  int index_ = 1, count_ = 1;
};

}  // namespace

Shard shard_of(const std::string& text) {
  const std::vector<std::string_view> parts = split(text, '/');
  const auto index = number_in<int>(parts.front()), count = number_in<int>(parts.back());
  if (parts.size() == 2 && index >= 1 && count >= index && count <= 1'000'000)
    return {*index, *count};
  throw std::invalid_argument(
      fmt::format("--shard {}: I/N, the I-th of N parts, like 2/7", printable(text)));
}

StudyAbout about(const StudyOptions& o, const Thresholds& thresholds) {
  // all that there are, so that none is forgotten; the cells say which pairs are tried, and the
  // last three change no count
  const auto& [robot, conditions, estimators, detectors, tuned, blows, pushes, clampings, regions,
               hours, first_seed, threads, progress, stop] = o;
  return {touched_runs(robot).robot,
          thresholds.trained_on,
          thresholds.margin,
          {{"conditions", conditions},
           {"collisions", blows},
           {"pushes", pushes},
           {"clampings", clampings},
           {"regions", regions},
           {"hours", hours},
           {"seed", first_seed},
           {"thresholds", fmt::format("{:016x}", fnv1a(thresholds_json(thresholds)))}},
          {}};
}

bool run_part(const DetectionStudy& study, const StudyAbout& about, const Shard& shard,
              const std::string& path, const StudyOptions& o) {
  Journal journal(path);
  const Part part(path);
  const Json first = first_line(study, about, shard);
  if (!part.empty() &&
      (study_of(part.first()) != study_of(first) || part.first().at("shard") != first.at("shard")))
    fail(path, "is a part of another study, or another part; remove it, or choose another file");
  journal.cut(part.end());
  if (part.empty()) journal.add(first.dump());
  std::vector<int> missing;
  for (int i = shard.index - 1; i < study.pieces(); i += shard.count) {
    if (!part.pieces().contains(i)) missing.push_back(i);
  }
  std::mutex mutex;
  std::size_t done = 0;
  const auto work = [&](int i) {
    if (o.stop && o.stop()) return;
    const int piece = missing[static_cast<std::size_t>(mixed(i, static_cast<int>(missing.size())))];
    const std::string line =
        Json({{"piece", piece}, {"adds", counts_json(study.run(piece))}}).dump();
    const std::lock_guard lock(mutex);
    journal.add(line);
    ++done;
  };
  parallel_for(static_cast<int>(missing.size()), o.threads, work, o.progress);
  return done == missing.size();
}

Merged merge_parts(const std::vector<std::string>& paths) {
  Json first;                     // of the part with the smallest number
  std::map<int, std::string> in;  // which file has a piece
  std::optional<StudySum> sum;
  for (const std::string& path : paths) {
    claim_input(path);
    const Part part(path);
    if (part.empty()) fail(path, "is empty");
    if (first.is_null()) {
      sum.emplace(cells_of(part.first()));
    } else if (study_of(part.first()) != study_of(first)) {
      fail(path, "is a part of another study than {}, or another program made it", paths.front());
    } else if (part.first().at("shard").at(1) != first.at("shard").at(1)) {
      fail(path, "is one of another number of parts than {}", paths.front());
    }
    if (first.is_null() || part.first().at("shard") < first.at("shard")) first = part.first();
    for (const auto& [piece, added] : part.pieces()) {
      const auto [at, is_new] = in.try_emplace(piece, path);
      if (!is_new) fail(path, "has a piece that {} has, too: {}", at->second, piece);
      sum->add(added);
    }
  }
  const int pieces = first.at("pieces").get<int>(), count = first.at("shard").at(1).get<int>();
  std::set<std::string> missing;
  for (int i = 0; i < pieces; ++i) {
    if (!in.contains(i)) missing.insert(fmt::format("{}/{}", i % count + 1, count));
  }
  if (!missing.empty())
    throw std::runtime_error(fmt::format(
        "of {} pieces {} are missing, of --shard {}: run these again with the same --out, which go "
        "on where they stopped",
        pieces, pieces - static_cast<int>(in.size()), fmt::join(missing, ", ")));
  StudyAbout about{&robot(first.at("robot").get<std::string>()),
                   first.at("thresholds_trained_on").get<std::string>(),
                   first.at("margin").get<double>(),
                   first.at("plan"),
                   {}};
  for (const auto& [key, text] : first.at("context").items())
    about.context.emplace_back(key, text.get<std::string>());
  return {std::move(about), sum->sorted()};
}

}  // namespace tauext::study
