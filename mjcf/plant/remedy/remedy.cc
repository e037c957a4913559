// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/remedy/remedy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "mjcf/import/mendable.h"
#include "mjcf/mujoco/misfits.h"
#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/mujoco/ties.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

// a name, as an expression that it matches
std::string as_expression(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (std::string_view("^$\\.*+?()[]{}|").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string either(const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (const std::string& n : names) all.push_back(as_expression(n));
  return fmt::format("{}", fmt::join(all, "|"));
}

ImportOptions with(const Mending& by, ImportOptions options) {
  options.balance = options.balance || by.balance;
  if (by.lock.empty()) return options;
  options.lock += (options.lock.empty() ? "" : "|") + either({by.lock.begin(), by.lock.end()});
  return options;
}

std::string name_of(const mjModel& m, int joint) {
  return mj_id2name(&m, mjOBJ_JOINT, joint);  // the import has named all of them
}

void refuse_misfits(const mjModel& m) {
  const std::vector<Misfit> misfits = misfits_of(m);
  if (misfits.empty()) return;
  Mending by;
  for (const Misfit& misfit : misfits)
    for (const int j : misfit.joints) by.lock.insert(name_of(m, j));
  throw Mendable(in_words(misfits), by);
}

bool is_small(const Ties& ties) {
  const auto leaders = static_cast<Eigen::Index>(ties.free.size());
  return leaders <= kMostLeaders && ties.T.rows() - leaders <= kMostTied;
}

bool is_small_arm(const ImportOptions& options, const Reading& read) {
  try {
    const Model m = read(options);
    refuse_misfits(*m);
    return is_small(ties_of(*m));
  } catch (const std::runtime_error&) {
    return false;
  }
}

std::string flags(const std::string& path, const ImportOptions& given, const ImportOptions& more) {
  if (more.balance == given.balance)
    return more.lock == given.lock ? "" : "--lock " + shell_quoted(more.lock);
  return fmt::format("tauext-import {}{}{} --balance --out arm.xml", shell_word(path),
                     more.lock.empty() ? "" : " --lock ",
                     more.lock.empty() ? "" : shell_quoted(more.lock));
}

// where it has too many joints: how to keep some of them
std::string advice(const mjModel& m, const std::string& path, const ImportOptions& given,
                   const ImportOptions& options, const Reading& read) {
  const Ties ties = ties_of(m);
  if (is_small(ties)) return "";
  const FewerJoints fewer = fewer_joints(m);
  ImportOptions row = options;
  row.lock += (row.lock.empty() ? "" : "|") + either(fewer.others);
  if (const std::string all_but = "(?!(" + either(fewer.kept) + ")$).*";
      all_but.size() < row.lock.size())
    row.lock = all_but;  // which fixes the base, too, as `options` do
  const bool tied = static_cast<int>(ties.free.size()) <= kMostLeaders;
  const std::string many =
      tied ? "too many joints move with others: "
           : fmt::format("estimators take arms of {} joints at most, and here are {}: ",
                         kMostLeaders, ties.free.size());
  if (!is_small_arm(row, read)) return many + "--lock REGEX fixes others";
  return many + fmt::format("{} keeps the {} from '{}' to '{}'", flags(path, given, row),
                            fewer.row.size(), printable_name(fewer.row.front()),
                            printable_name(fewer.row.back()));
}

// the joint that carries each one; -1: none
std::vector<int> carriers(const mjModel& m) {
  std::vector<int> all;
  for (int j = 0; j < m.njnt; ++j) {
    int body = m.jnt_bodyid[j];
    if (j > m.body_jntadr[body]) {
      all.push_back(j - 1);
      continue;
    }
    do body = m.body_parentid[body];
    while (body > 0 && m.body_jntnum[body] == 0);
    all.push_back(body == 0 ? -1 : m.body_jntadr[body] + m.body_jntnum[body] - 1);
  }
  return all;
}

bool contains(const std::vector<int>& all, int one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

// joints of which each carries the next, and no other one
std::vector<int> longest_row(const mjModel& m, const Ties& ties) {
  std::vector<std::vector<int>> carried(static_cast<std::size_t>(m.njnt));
  const std::vector<int> carrier = carriers(m);
  for (int j = 0; j < m.njnt; ++j)
    if (const int by = carrier[static_cast<std::size_t>(j)]; by >= 0)
      carried[static_cast<std::size_t>(by)].push_back(j);
  std::vector<int> longest;
  for (int first = 0; first < m.njnt; ++first) {
    std::vector<int> row;
    for (int at = first;;) {
      if (contains(ties.free, at)) row.push_back(at);
      const std::vector<int>& next = carried[static_cast<std::size_t>(at)];
      if (next.size() != 1) break;
      at = next.front();
    }
    if (row.size() > longest.size()) longest = row;
  }
  if (longest.size() > kMostLeaders) longest.erase(longest.begin(), longest.end() - kMostLeaders);
  return longest;
}

}  // namespace

FewerJoints fewer_joints(const mjModel& m) {
  const Ties ties = ties_of(m);
  const std::vector<int> row = longest_row(m, ties);
  Eigen::RowVectorXd moves(ties.T.cols());
  for (Eigen::Index i = 0; i < moves.size(); ++i)
    moves[i] = contains(row, ties.free[static_cast<std::size_t>(i)]) ? 1 : 0;
  FewerJoints out;
  for (int j = 0; j < m.njnt; ++j) {  // each has one degree of freedom
    const Eigen::RowVectorXd by = ties.T.row(j);
    const bool kept = !by.isZero(0) && by.cwiseProduct(moves) == by;
    (kept ? out.kept : out.others).push_back(name_of(m, j));
    if (contains(row, j)) out.row.push_back(name_of(m, j));
  }
  return out;
}

std::string with_remedy(const std::string& why, const std::string& path,
                        const ImportOptions& options, const Reading& read) {
  std::string words = why;
  const auto add = [&](const std::string& more) {
    if (words.find(more) == words.npos) words += "; " + more;
  };
  std::string remedy;
  Mending by;
  ImportOptions more = options;
  for (int round = 0; round < 10; ++round) {
    try {
      const Model model = read(more);
      if (model->nv == 0 && !by.empty()) break;  // there is no arm among what would be fixed
      refuse_misfits(*model);
      if (!by.empty()) remedy = "; to mend it: " + flags(path, options, more);
      if (const std::string fewer = advice(*model, path, options, more, read); !fewer.empty())
        remedy += "; " + fewer;
      break;
    } catch (const Mendable& e) {
      add(e.what());
      const std::size_t before = by.lock.size() + (by.balance ? 1 : 0);
      by.add(e.by());
      if (by.lock.size() + (by.balance ? 1 : 0) == before) break;
      more = with(by, options);
    } catch (const std::exception& e) {
      add(e.what());
      break;
    }
  }
  return one_line(words, 6000) + one_line(remedy, 6000);  // whatever is cut, the command is whole
}

}  // namespace tauext
