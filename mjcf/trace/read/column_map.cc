// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/column_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <numbers>
#include <regex>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/files/several_files.h"
#include "mjcf/trace/read/joint_names.h"

namespace tauext {
namespace {

// of each unit one of ours
constexpr std::pair<std::string_view, double> kUnits[] = {
    {"s", 1},     {"ms", 1e-3},   {"us", 1e-6},
    {"ns", 1e-9}, {"rad", 1},     {"deg", std::numbers::pi / 180},
    {"m", 1},     {"mm", 1e-3},   {"rad/s", 1},
    {"m/s", 1},   {"mm/s", 1e-3}, {"deg/s", std::numbers::pi / 180},
    {"Nm", 1},    {"Nmm", 1e-3},  {"rpm", std::numbers::pi / 30},
    {"N", 1},     {"A", 1},       {"mA", 1e-3},
    {"1", 1},
};

double factor_of(std::string_view unit) {
  return std::find_if(std::begin(kUnits), std::end(kUnits),
                      [&](const auto& u) { return u.first == unit; })
      ->second;
}

// one for each, or the same for all
template <class T>
T each(const std::vector<T>& all, std::size_t i, const T& otherwise) {
  return all.empty() ? otherwise : all[all.size() == 1 ? 0 : i];
}

template <class List>
void require_one_or_each(const List& list, std::size_t count, const char* what,
                         std::string_view quantity, const std::string& path) {
  if (list.size() <= 1 || list.size() == count) return;
  throw std::runtime_error(
      fmt::format("{}: [{}] has {} columns, and the map {} {}s for it: does a column have another "
                  "name than it says?",
                  path, quantity, count, list.size(), what));
}

constexpr std::size_t kLongestName = 200;  // std::regex goes as deep as a name is long

bool matches(const std::string& name, const std::regex& expression, std::smatch& match,
             std::string_view quantity, const std::string& path) {
  try {
    return std::regex_match(name, match, expression);
  } catch (const std::regex_error& e) {  // too much work
    throw std::runtime_error(fmt::format("{}: columns of [{}]: {}", path, quantity, e.what()));
  }
}

// what the first group has matched, by which joints are in order; without a group the name
std::string joint_in(const std::smatch& match) {
  for (std::size_t i = 1; i < match.size(); ++i) {
    if (match[i].matched) return match[i].str();
  }
  return match[0].str();
}

// of a name that begins with it; else 0
int number_of_joint(const std::string& joint) {
  return std::atoi(joint.c_str());
}

bool is_number(std::string_view text) {
  return text.find_first_not_of("0123456789") == text.npos;
}

bool of_joints(std::string_view quantity) {
  return std::find_if(std::begin(kQuantities), std::end(kQuantities),
                      [&](const Quantity& q) { return q.name == quantity; })
      ->of_joints;
}

// one whose name is another but for its case, or a unit behind it; else ""
std::string nearly(const std::string& expression, const std::vector<std::string>& columns) {
  const std::regex wanted(expression, std::regex::ECMAScript | std::regex::icase);
  for (const std::string& name : columns) {
    const std::string word = name.substr(0, std::min(name.find_first_of(" [("), kLongestName));
    if (std::regex_match(word, wanted))
      return fmt::format(" (but '{}' is nearly so)", printable_name(name));
  }
  return "";
}

// "'q1'", "'q1' to 'q6'"
std::string named(const std::vector<int>& which, const std::vector<std::string>& columns) {
  const auto name = [&](int c) {
    return '\'' + printable_name(columns[static_cast<std::size_t>(c)]) + '\'';
  };
  return which.size() == 1 ? name(which[0])
                           : fmt::format("{} to {}", name(which.front()), name(which.back()));
}

// those of one number are in the order of the file, which somebody has to have said
void require_order(const std::vector<std::pair<int, int>>& numbered, std::string_view quantity,
                   const std::string& expression, const std::string& path) {
  const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
  if (std::adjacent_find(numbered.begin(), numbered.end(), same) == numbered.end()) return;
  throw std::runtime_error(fmt::format(
      "{}: [{}] matches {} columns by '{}', and no group in it gives each its own number, like "
      "'q_(\\d)'; a list of names puts them in order, too, and so does `order`",
      path, quantity, numbered.size(), expression));
}

}  // namespace

namespace detail {

// which columns are those of the robot's joints by their names, and what there is to say of it
class JointColumns {
 public:
  explicit JointColumns(const std::vector<std::string>& joints) : joints_(joints) {}

  // where the joints are in a list of names, in the robot's order; empty: it has none of them
  std::vector<std::size_t> places(const std::vector<std::string>& names, bool all_or_none,
                                  std::string_view quantity, const std::string& path) {
    const std::string whose = fmt::format("{}: the columns of [{}]", path, quantity);
    const std::set<std::string> all(names.begin(), names.end());
    const JointNames found = find_joint_names(all, joints_, whose);
    if (!found.any() || (all_or_none && !found.all())) return {};
    std::vector<std::string> missing;
    std::vector<std::size_t> at;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      if (found.called[i].empty()) missing.push_back(joints_[i]);
      at.push_back(static_cast<std::size_t>(std::find(names.begin(), names.end(), found.called[i]) -
                                            names.begin()));
    }
    if (!missing.empty()) fail_missing_joints(missing, joints_, all, whose);
    return at;
  }

  void leave_out(const std::string& column) { others_.push_back(column); }
  void reorder(std::string_view quantity) { reordered_ += fmt::format(" [{}]", quantity); }
  // one whose names are not the robot's, or numbers
  void keep_order(std::string_view quantity) { kept_ += fmt::format(" [{}]", quantity); }
  // @throws std::runtime_error where nobody knows the order of some, as it is not that of others
  void require_one_order(const std::string& path) const {
    if (reordered_.empty() || kept_.empty()) return;
    throw std::runtime_error(fmt::format(
        "{}: by the robot's names the joints are in another order than in the map's list of{}, and "
        "nothing tells that of{}: list all by such names, or all by numbers, in the robot's order",
        path, reordered_, kept_));
  }
  void take_as_they_are(std::string_view quantity) {
    if (!joints_.empty()) nameless_ += fmt::format(" [{}]", quantity);
  }

  void note(std::vector<std::string>& notes) const {
    if (!others_.empty())
      notes.push_back(fmt::format("{} columns of other joints are left out: {}", others_.size(),
                                  listed_names(others_)));
    if (!reordered_.empty())
      notes.push_back("joints are taken by the robot's names, and not in the map's order:" +
                      reordered_);
    if (!nameless_.empty())
      notes.push_back(
          fmt::format("no column has the name of a joint of the robot ({}), so joints are in the "
                      "file's order:{}",
                      listed_names(joints_), nameless_));
  }

 private:
  const std::vector<std::string>& joints_;
  std::vector<std::string> others_;          // columns
  std::string reordered_, kept_, nameless_;  // quantities
};

}  // namespace detail

std::vector<int> ColumnMap::find_matching(std::string_view quantity, const Wanted& w,
                                          const std::vector<std::string>& columns,
                                          const std::string& path,
                                          detail::JointColumns& joints) const {
  const std::regex expression(w.expression);
  std::vector<std::pair<int, int>> numbered;  // by joint
  std::vector<std::string> names;             // of joints
  std::vector<int> found;
  for (int i = 0; i < static_cast<int>(columns.size()); ++i) {
    const std::string& name = columns[static_cast<std::size_t>(i)];
    std::smatch match;
    if (name.size() > kLongestName || !matches(name, expression, match, quantity, path)) continue;
    names.push_back(joint_in(match));
    numbered.emplace_back(number_of_joint(names.back()), i);
  }
  if (of_joints(quantity) && order_.empty() &&
      !std::all_of(names.begin(), names.end(), is_number)) {
    for (const std::size_t at : joints.places(names, false, quantity, path))
      found.push_back(std::exchange(numbered[at].second, -1));
    for (const auto& [joint, column] : numbered)
      if (!found.empty() && column >= 0)
        joints.leave_out(columns[static_cast<std::size_t>(column)]);
    if (!found.empty()) return found;
    if (names.size() > 1) joints.take_as_they_are(quantity);
  }
  std::sort(numbered.begin(), numbered.end());
  // a preset leaves the order to others, unless q has one by now
  const bool in_any_order =
      !order_.empty() || (w.of_preset && (leaves_order_open() || !of_joints(quantity)));
  if (!in_any_order) require_order(numbered, quantity, w.expression, path);
  for (const auto& [joint, column] : numbered) found.push_back(column);
  return found;
}

std::vector<int> ColumnMap::find(std::string_view quantity, const Wanted& w,
                                 const std::vector<std::string>& columns, const std::string& path,
                                 detail::JointColumns& joints) const {
  std::vector<int> found;
  if (!w.expression.empty()) found = find_matching(quantity, w, columns, path, joints);
  for (const std::string& name : w.names) {
    const auto at = std::find(columns.begin(), columns.end(), name);
    if (at == columns.end())
      throw std::runtime_error(
          fmt::format("{}: no column '{}' for [{}]; there are: {}", path, name, quantity,
                      printable_name(fmt::format("{}", fmt::join(columns, ", ")))));
    found.push_back(static_cast<int>(at - columns.begin()));
  }
  for (const int n : w.numbers) {
    if (n > static_cast<int>(columns.size()))
      throw std::runtime_error(fmt::format("{}: no column {} for [{}]: there are {}", path, n,
                                           quantity, columns.size()));
    found.push_back(n - 1);
  }
  for (const int c : found) {
    if (std::count(found.begin(), found.end(), c) > 1)
      throw std::runtime_error(
          fmt::format("{}: [{}] names column {} twice", path, quantity, named({c}, columns)));
    const std::string& name = columns[static_cast<std::size_t>(c)];
    if (w.numbers.empty() && std::count(columns.begin(), columns.end(), name + "#2") > 0)
      throw std::runtime_error(
          fmt::format("{}: column '{}' appears twice; a map (--columns) takes one by its number: "
                      "[{}] columns = [{}{}]",
                      path, printable_name(name), quantity, c + 1, found.size() > 1 ? ", .." : ""));
  }
  return found;
}

std::vector<int> ColumnMap::find_in_file(std::string_view quantity, const Wanted& w,
                                         const std::vector<std::string>& columns,
                                         const std::string& path,
                                         detail::JointColumns& joints) const {
  const std::string prefix = w.file.empty() ? "" : w.file + kOfFile;
  const std::vector<std::string> others = files();
  std::vector<std::string> names;
  std::vector<int> places;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string& name = columns[i];
    const bool of_another =
        w.file.empty() && std::any_of(others.begin(), others.end(), [&](const std::string& f) {
          return name.starts_with(f + kOfFile);
        });
    if (!name.starts_with(prefix) || of_another) continue;
    names.push_back(name.substr(prefix.size()));
    places.push_back(static_cast<int>(i));
  }
  std::vector<int> found =
      find(quantity, w, names, w.file.empty() ? path : path + ", " + w.file, joints);
  for (int& c : found) c = places[static_cast<std::size_t>(c)];
  return found;
}

std::vector<std::string> ColumnMap::files() const {
  std::vector<std::string> all;
  for (const auto& [name, w] : wanted_)
    if (!w.file.empty() && std::find(all.begin(), all.end(), w.file) == all.end())
      all.push_back(w.file);
  return all;
}

bool ColumnMap::needs_first_file() const {
  return std::any_of(wanted_.begin(), wanted_.end(), [](const auto& one) {
    return one.second.file.empty() && !one.second.of_preset;
  });
}

void ColumnMap::put_in_order(std::string_view quantity, const std::vector<int>& order,
                             MappedQuantity& m, const std::string& path) const {
  if (order.empty()) return;
  MappedQuantity ordered;
  ordered.has_gain = m.has_gain, ordered.held = m.held;
  for (const int j : order) {
    if (std::count(order.begin(), order.end(), j) > 1)
      throw std::runtime_error(
          fmt::format("{}: `order` names joint {} of the recording twice", path, j));
    if (j > static_cast<int>(m.columns.size()))
      throw std::runtime_error(fmt::format("{}: [{}] has {} columns, and `order` names joint {}",
                                           path, quantity, m.columns.size(), j));
    ordered.columns.push_back(m.columns[static_cast<std::size_t>(j - 1)]);
    ordered.gain.push_back(m.gain[static_cast<std::size_t>(j - 1)]);
    ordered.zero.push_back(m.zero[static_cast<std::size_t>(j - 1)]);
  }
  m = std::move(ordered);
}

// that of the map, or by the names in its list
std::vector<int> ColumnMap::order_of(std::string_view quantity, const Wanted& w,
                                     const std::string& path, detail::JointColumns& joints) const {
  if (order_.empty() && !w.numbers.empty()) joints.keep_order(quantity);
  if (!order_.empty() || w.names.empty()) return order_;
  std::vector<int> order;
  for (const std::size_t at : joints.places(w.names, true, quantity, path))
    order.push_back(static_cast<int>(at) + 1);
  if (order.empty()) joints.keep_order(quantity);
  if (!std::is_sorted(order.begin(), order.end())) joints.reorder(quantity);
  for (std::size_t i = 0; i < w.names.size() && !order.empty(); ++i)
    if (std::count(order.begin(), order.end(), i + 1) == 0) joints.leave_out(w.names[i]);
  return order;
}

bool ColumnMap::leaves_order_open() const {
  const auto q = wanted_.find("q");
  return q != wanted_.end() && q->second.of_preset && order_.empty();
}

std::string ColumnMap::choose_torque(MappedColumns& found,
                                     const std::vector<std::string>& columns) const {
  const auto current = found.find("current");
  if (current == found.end() || !wanted_.find("current")->second.of_preset) return "";
  for (const std::string_view name : kTorques) {
    if (name == "current" || found.find(name) == found.end()) continue;
    std::string note = fmt::format(
        "tau is read from {}, and not made of {}; a map with [current] does that",
        named(found.find(name)->second.columns, columns), named(current->second.columns, columns));
    found.erase(current);
    return note;
  }
  return "";
}

std::vector<std::string> ColumnMap::missing_in(const MappedColumns& found) const {
  std::vector<std::string> all;
  for (const auto& [name, w] : wanted_) {
    if (!w.of_preset && found.find(name) == found.end())
      all.push_back(fmt::format("no column has [{}]: none is called '{}'", name, w.expression));
  }
  return all;
}

MappedColumns ColumnMap::mapped(const std::vector<std::string>& columns, const std::string& path,
                                const std::vector<std::string>& joints,
                                std::vector<std::string>* notes) const {
  MappedColumns all;
  detail::JointColumns of_robot(joints);
  for (const Quantity& q : kQuantities) {
    const auto wanted = wanted_.find(q.name);
    if (wanted == wanted_.end() || (rate_ > 0 && q.name == "t")) continue;
    const Wanted& w = wanted->second;
    MappedQuantity m{find_in_file(q.name, w, columns, path, of_robot), {}};
    if (m.columns.empty() && (q.name == "t" || q.name == "q"))
      throw std::runtime_error(
          fmt::format("{}: no column has the {}, [{}]: none is called '{}'{}; --columns says which "
                      "it is{}. There "
                      "are: {}",
                      path, q.help.substr(0, q.help.find(';')), q.name, w.expression,
                      nearly(w.expression, columns),
                      q.name == "t" ? ", or with `rate` that rows have no time" : "",
                      printable_name(fmt::format("{}", fmt::join(columns, ", ")), 200)));
    if (m.columns.empty()) continue;
    const std::size_t count = m.columns.size();
    m.has_gain = !w.gain.empty(), m.held = w.held;
    require_one_or_each(w.units, count, "unit", q.name, path);
    require_one_or_each(w.gain, count, "gain", q.name, path);
    require_one_or_each(w.sign, count, "sign", q.name, path);
    require_one_or_each(w.zero, count, "zero", q.name, path);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string ours(q.units.substr(0, q.units.find(' ')));
      m.gain.push_back(factor_of(each(w.units, i, ours)) * each(w.gain, i, 1.) *
                       each(w.sign, i, 1.));
      m.zero.push_back(each(w.zero, i, 0.));
    }
    if (q.of_joints) put_in_order(q.name, order_of(q.name, w, path, of_robot), m, path);
    for (const auto& [name, other] : all) {
      const auto shared = std::find_first_of(m.columns.begin(), m.columns.end(),
                                             other.columns.begin(), other.columns.end());
      if (shared != m.columns.end())
        throw std::runtime_error(fmt::format("{}: column {} is both [{}] and [{}]", path,
                                             named({*shared}, columns), name, q.name));
    }
    all.emplace(q.name, std::move(m));
  }
  of_robot.require_one_order(path);
  if (notes != nullptr) of_robot.note(*notes);
  return all;
}

namespace {

[[noreturn]] void fail_missing(const std::string& path, const char* what,
                               const std::vector<std::string>& columns) {
  std::string all;
  for (const std::string& c : columns) all += (all.empty() ? "" : ", ") + printable_name(c);
  constexpr std::size_t kMost = 200;
  if (all.size() > kMost) all = all.substr(0, kMost) + " ..";
  throw std::runtime_error(fmt::format(
      "{}: no columns for {}; --columns says which they are. There are: {}", path, what, all));
}

class LayoutMaker {
 public:
  LayoutMaker(const MappedColumns& mapped, const std::vector<std::string>& columns,
              const std::string& path)
      : mapped_(mapped), columns_(columns), path_(path) {}

  SampleLayout operator()(bool has_t) {
    const MappedQuantity* const t = find("t");
    if (t == nullptr && has_t) fail_missing(path_, "the time", columns_);
    for (std::size_t i = 0; t != nullptr && i < t->columns.size(); ++i)
      l_.t.emplace_back(t->columns[i], t->gain[i]);
    const MappedQuantity* const q = find("q");
    if (q == nullptr) fail_missing(path_, "q", columns_);
    l_.dof = static_cast<int>(q->columns.size());
    l_.names = {"[t]"};
    l_.q = add("q");
    l_.qd = add("qd");
    l_.tau = add_torque();
    l_.tau_ext = add("tau_ext");
    l_.driver = add("driver");
    l_.force = add("force", 3);
    l_.contact = add("contact", 1);
    return std::move(l_);
  }

 private:
  const MappedQuantity* find(std::string_view name) const {
    const auto it = mapped_.find(name);
    return it == mapped_.end() ? nullptr : &it->second;
  }

  int append(std::string_view name, const MappedQuantity& m) {
    const int at = l_.size;
    for (std::size_t i = 0; i < m.columns.size(); ++i) {
      l_.rest.push_back({m.columns[i], m.gain[i], m.zero[i]});
      l_.names.push_back(i == 0 || name == "force" ? fmt::format("[{}]", name)
                                                   : fmt::format("[{}] of joint {}", name, i + 1));
    }
    l_.size += static_cast<int>(m.columns.size());
    return at;
  }

  int add(std::string_view name) { return add(name, l_.dof); }
  int add(std::string_view name, int count) {
    const MappedQuantity* const m = find(name);
    if (m == nullptr) return -1;
    if (static_cast<int>(m->columns.size()) == count) return append(name, *m);
    const std::string wanted = count == l_.dof ? "as q has" : "are wanted";
    throw std::runtime_error(fmt::format("{}: [{}] has {} columns ({}), and not {}, {}", path_,
                                         name, m->columns.size(), named(m->columns, columns_),
                                         count, wanted));
  }

  int add_torque() {
    int at = -1;
    std::string_view first;
    for (const std::string_view name : kTorques) {
      if (find(name) == nullptr) continue;
      if (at >= 0)
        throw std::runtime_error(
            fmt::format("{}: {} are [{}], and {} are [{}]: the map must choose one of them", path_,
                        named(find(first)->columns, columns_), first,
                        named(find(name)->columns, columns_), name));
      at = add(name);
      first = name;
      l_.instants = !find(name)->held.value_or(name == "tau");
      l_.currents = name == "current" && !find(name)->has_gain;
      l_.without_gravity = name == "tau_without_gravity";
    }
    if (at < 0) fail_missing(path_, "tau", columns_);
    return at;
  }

  const MappedColumns& mapped_;
  const std::vector<std::string>& columns_;
  const std::string& path_;
  SampleLayout l_;
};

}  // namespace

std::vector<int> SampleLayout::columns() const {
  std::vector<int> all;
  for (const auto& [c, gain] : t) all.push_back(c);
  for (const Number& n : rest) all.push_back(n.column);
  return all;
}

void SampleLayout::convert(const std::vector<double>& row, std::vector<double>& sample) const {
  sample.resize(static_cast<std::size_t>(size));
  sample[0] = 0;
  for (const auto& [c, gain] : t) sample[0] += gain * row[static_cast<std::size_t>(c)];
  for (std::size_t i = 0; i < rest.size(); ++i) {
    sample[i + 1] = rest[i].gain * row[static_cast<std::size_t>(rest[i].column)];
    if (rest[i].zero != 0) sample[i + 1] += rest[i].zero;  // and -0 stays what it is
  }
}

SampleLayout layout_of(const MappedColumns& mapped, const std::vector<std::string>& columns,
                       const std::string& path, bool has_t) {
  return LayoutMaker(mapped, columns, path)(has_t);
}

}  // namespace tauext
