// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/sample_layout.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

#include "mjcf/trace/printable.h"

namespace tauext {
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
    const std::string wanted = count == l_.dof ? fmt::format("{} columns are q", count)
                                               : fmt::format("{} columns are wanted", count);
    throw std::runtime_error(
        fmt::format("{}: {}, and {} are {}", path_, wanted, m->columns.size(), name));
  }

  int add_torque() {
    int at = -1;
    for (const std::string_view name : kTorques) {
      if (find(name) == nullptr) continue;
      if (at >= 0)
        throw std::runtime_error(fmt::format(
            "{}: has {}, and another torque, too: the map must choose one of them", path_, name));
      at = add(name);
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
